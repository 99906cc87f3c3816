#include "skinning/settle/contact_patches.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "anatomy/compute/simd_lanes.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kPatch = 48, kPart = 8;  // vertices; whole eights
constexpr std::size_t kTask = 16;              // patches
constexpr float kNearer = 0.97f;               // of the distance at rest: patches that are nearer
// rad: spread of a patch that may meet itself, and what it has to exceed its own at rest by
constexpr float kFold = 0.7f, kNewFold = 0.1f;

Float4 row(std::span<const float> rows, int i) { return load4(&rows[4 * i]); }

std::span<const int> span_of(const std::vector<int>& list, const std::vector<int>& first,
                             std::size_t g) {
  return {list.data() + first[g], list.data() + first[g + 1]};
}

std::span<const int> hull_of(const VertexGroups& groups, std::size_t g) {
  return span_of(groups.hull, groups.hull_first, g);
}

PatchWorkspace::Shape shape_of(std::span<const int> hull, float reach,
                               std::span<const float> positions, std::span<const float> normals) {
  PatchWorkspace::Shape out;
  Float4 low = row(positions, hull[0]), high = low, sum{}, up{};
  for (const int i : hull) {
    const Float4 p = row(positions, i);
    low = least(low, p);
    high = most(high, p);
    sum += p;
    up += row(normals, i);
  }
  up *= 1 / std::sqrt(sum4(up * up)[0] + 1e-30f);
  float least = 1;
  out.bottom = out.top = sum4(up * row(positions, hull[0]))[0];
  for (const int i : hull) {
    least = std::min(least, sum4(up * row(normals, i))[0]);
    const float height = sum4(up * row(positions, i))[0];
    out.bottom = std::min(out.bottom, height);
    out.top = std::max(out.top, height);
  }
  store4(out.low, low);
  store4(out.high, high);
  out.reach = reach;
  store4(out.middle, sum * (1 / float(hull.size())));
  store4(out.up, up);
  out.spread = std::clamp(least, -1.0f, 1.0f);
  out.facing = out.spread > 0 ? std::sqrt(1 - out.spread * out.spread) : 1;
  return out;
}

// A lane of eight patches' boxes.
void set_lane(const PatchWorkspace::Shape& shape, std::size_t lane,
              PatchWorkspace::EightBoxes& out) {
  for (std::size_t k = 0; k < 3; ++k) {
    out.low[k][lane] = shape.low[k];
    out.high[k][lane] = shape.high[k];
  }
  out.reach[lane] = shape.reach;
}

void set_lane(const PatchWorkspace::Shape& shape, std::size_t lane,
              PatchWorkspace::EightParts& out) {
  for (std::size_t k = 0; k < 3; ++k) {
    out.low[k][lane] = shape.low[k];
    out.high[k][lane] = shape.high[k];
    out.up[k][lane] = shape.up[k];
  }
  out.facing[lane] = shape.facing;
  out.bottom[lane] = shape.bottom;
  out.top[lane] = shape.top;
}

// Shapes of a patch and of its parts. Where a patch has no eight of them, the last one fills up.
void fit_shapes(const ContactPatches& patches, std::size_t patch, std::span<const float> positions,
                std::span<const float> normals, PatchWorkspace& s) {
  s.shapes[patch] =
      shape_of(hull_of(patches.groups, patch), patches.reach[patch], positions, normals);
  const std::size_t first = patches.part_first[patch], end = patches.part_first[patch + 1];
  PatchWorkspace::EightParts* eight = &s.parts[patches.eight_first[patch]];
  for (std::size_t begin = first; begin < end; begin += 8, ++eight) {
    PatchWorkspace::Shape part;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      if (begin + lane < end)
        part = shape_of(hull_of(patches.parts, begin + lane), 0, positions, normals);
      set_lane(part, lane, *eight);
    }
  }
}

// Lanes of eight patches that are within reach of one.
unsigned overlaps(const PatchWorkspace::Shape& a, const PatchWorkspace::EightBoxes& b) {
  const Float8 own = Float8{} + a.reach, reach = own > b.reach ? own : b.reach;
  Int8 apart{};
  for (std::size_t k = 0; k < 3; ++k)
    apart |= (a.low[k] - reach > b.high[k]) | (b.low[k] - reach > a.high[k]);
  return lanes_that(apart == 0);
}

// Whether two patches that are within reach of each other may meet.
bool may_meet(const ContactPatches& patches, const std::vector<PatchWorkspace::Shape>& shapes,
              std::size_t a, std::size_t b) {
  const PatchWorkspace::Shape &A = shapes[a], &B = shapes[b];
  const Float4 way = load4(A.middle) - load4(B.middle),
               rest = load4(&patches.rest_middle[4 * a]) - load4(&patches.rest_middle[4 * b]);
  if (sum4(way * way)[0] >= kNearer * kNearer * sum4(rest * rest)[0]) return false;
  // Whether their angle and both spreads make more than a right angle: of cosines, sines by their
  // sum.
  if (A.spread <= 0 || B.spread <= 0 || A.spread * B.spread <= A.facing * B.facing) return true;
  return sum4(load4(A.up) * load4(B.up))[0] < A.facing * B.spread + A.spread * B.facing;
}

// The ways of a patch's vertices from a little before them inwards, eight at once.
struct WaysIn {
  struct Eight {
    std::array<Float8, 3> normal, from, to, low, high;
    std::array<int, 8> vertex{};
    unsigned left = 0;  // lanes that are not known to enter anything yet
  };
  std::array<Eight, kPatch / 8> eights;
  std::size_t count = 0;
};

WaysIn ways_of(std::span<const int> vertices, const ContactRays& skin) {
  WaysIn out;
  for (std::size_t begin = 0; begin < vertices.size(); begin += 8) {
    WaysIn::Eight& eight = out.eights[out.count++];
    Float8 max_push{};
    eight.left = 0;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const int i = eight.vertex[lane] = vertices[std::min(begin + lane, vertices.size() - 1)];
      max_push[lane] = skin.max_push[i];
      if (begin + lane < vertices.size() && skin.max_push[i] > 0) eight.left |= 1u << lane;
    }
    const Wide3 n = xyz(gather_eight(skin.normals.data(), eight.vertex.data())),
                p = xyz(gather_eight(skin.positions.data(), eight.vertex.data()));
    const Wide3 from = p + all_eight(skin.before) * n, to = p - max_push * n;
    eight.normal = {n.x, n.y, n.z};
    eight.from = {from.x, from.y, from.z};
    eight.to = {to.x, to.y, to.z};
    for (std::size_t k = 0; k < 3; ++k) {
      eight.low[k] = least(eight.from[k], eight.to[k]);
      eight.high[k] = most(eight.from[k], eight.to[k]);
    }
  }
  return out;
}

// Lanes of ways that lead through where a shape lies whose far side they may be on, by their
// normals. Either may be eight, or one in every lane.
template <class Way, class Shape>
unsigned may_enter(const Way& way, const Shape& shape) {
  const auto along = [&](const auto& v) {
    return shape.up[0] * v[0] + shape.up[1] * v[1] + shape.up[2] * v[2];
  };
  const Float8 a = along(way.from), b = along(way.to), bottom = Float8{} + shape.bottom,
               top = Float8{} + shape.top;
  Int8 off = (along(way.normal) > Float8{} + shape.facing) | ((a < bottom) & (b < bottom)) |
             ((a > top) & (b > top));
  for (std::size_t k = 0; k < 3; ++k)
    off |= (Float8{} + shape.low[k] > Float8{} + way.high[k]) |
           (Float8{} + way.low[k] > Float8{} + shape.high[k]);
  return lanes_that(off == 0);
}

// One of them.
struct WayIn {
  std::array<float, 3> normal, from, to, low, high;
};

WayIn way_of(const WaysIn::Eight& eight, std::size_t lane) {
  WayIn out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.normal[k] = eight.normal[k][lane];
    out.from[k] = eight.from[k][lane];
    out.to[k] = eight.to[k][lane];
    out.low[k] = eight.low[k][lane];
    out.high[k] = eight.high[k][lane];
  }
  return out;
}

// Marks the vertices of a patch that may enter another one.
void mark(const ContactPatches& patches, std::size_t other, const PatchWorkspace& s, WaysIn& ways,
          std::vector<char>& wanted) {
  const auto first = s.parts.begin() + patches.eight_first[other],
             last = s.parts.begin() + patches.eight_first[other + 1];
  for (WaysIn::Eight& eight : std::span(ways.eights).first(ways.count)) {
    if (eight.left == 0) continue;
    for (unsigned lanes = eight.left & may_enter(eight, s.shapes[other]); lanes != 0;
         lanes &= lanes - 1) {
      const std::size_t lane = std::countr_zero(lanes);
      const WayIn way = way_of(eight, lane);
      if (std::none_of(first, last, [&](const PatchWorkspace::EightParts& parts) {
            return may_enter(way, parts) != 0;
          }))
        continue;
      wanted[eight.vertex[lane]] = 1;
      eight.left &= ~(1u << lane);
    }
  }
}

// Gathers connected vertices of `list`, which `among` tells from all others by `mark`, into groups
// of at most `most`. A vertex's group goes to `group`.
void cut_groups(const Membrane& rings, std::span<const int> list, const std::vector<int>& among,
                int mark, std::size_t most, std::vector<int>& group, std::vector<int>& seen,
                VertexGroups& out) {
  for (const int start : list) {
    if (group[start] >= 0) continue;
    const int g = int(out.first.size()) - 1;
    const std::size_t begin = out.vertex.size();
    group[start] = g;
    out.vertex.push_back(start);
    const auto reach_for = [&](int v) {
      if (seen[v] == g) return;
      seen[v] = g;
      out.hull.push_back(v);
    };
    for (std::size_t k = begin; k < out.vertex.size(); ++k) {
      const std::size_t i = out.vertex[k];
      reach_for(int(i));
      for (int e = rings.first[i]; e < rings.first[i + 1]; ++e) {
        const int j = rings.neighbour[e];
        reach_for(j);
        if (among[j] != mark || group[j] >= 0 || out.vertex.size() - begin >= most) continue;
        group[j] = g;
        out.vertex.push_back(j);
      }
    }
    out.first.push_back(int(out.vertex.size()));
    out.hull_first.push_back(int(out.hull.size()));
  }
}

}  // namespace

std::span<const int> own_of(const VertexGroups& groups, std::size_t group) {
  return span_of(groups.vertex, groups.first, group);
}

ContactPatches cut_patches(const Membrane& rings, std::span<const float> positions,
                           std::span<const float> normals, std::span<const float> max_push) {
  ContactPatches out;
  const std::size_t n = max_push.size();
  std::vector<int> all(n), patch(n, -1), part(n, -1), seen(n, -1), seen_by_part(n, -1);
  std::iota(all.begin(), all.end(), 0);
  cut_groups(rings, all, std::vector<int>(n, 0), 0, kPatch, patch, seen, out.groups);
  const auto count = out.groups.first.size() - 1;
  for (std::size_t p = 0; p < count; ++p) {
    const std::span<const int> own = own_of(out.groups, p);
    float reach = 0;
    for (const int i : own) reach = std::max(reach, max_push[i]);
    out.reach.push_back(reach);
    const PatchWorkspace::Shape shape = shape_of(hull_of(out.groups, p), reach, positions, normals);
    out.rest_middle.insert(out.rest_middle.end(), shape.middle, shape.middle + 4);
    out.fold.push_back(
        std::cos(std::clamp(std::acos(shape.spread) + kNewFold, kFold, std::numbers::pi_v<float>)));
    out.part_first.push_back(int(out.parts.first.size()) - 1);
    cut_groups(rings, own, patch, int(p), kPart, part, seen_by_part, out.parts);
    const int parts = int(out.parts.first.size()) - 1 - out.part_first.back();
    out.eight_first.push_back(out.eight_first.back() + (parts + 7) / 8);
  }
  out.part_first.push_back(int(out.parts.first.size()) - 1);
  return out;
}

bool find_contact_vertices(const ContactPatches& patches, const ContactRays& skin,
                           PatchWorkspace& s, std::vector<char>& wanted) {
  const std::size_t count = patches.reach.size();
  s.shapes.resize(count);
  s.boxes.resize((count + 7) / 8);
  s.parts.resize(patches.eight_first.back());
  wanted.assign(skin.max_push.size(), 0);
  s.met.assign(count, 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, s.boxes.size()), [&](const auto& range) {
    for (std::size_t p = 8 * range.begin(); p < std::min(count, 8 * range.end()); ++p) {
      fit_shapes(patches, p, skin.positions, skin.normals, s);
      set_lane(s.shapes[p], p % 8, s.boxes[p / 8]);
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kTask),
                    [&](const auto& range) {  // each marks its own vertices
                      for (std::size_t a = range.begin(); a < range.end(); ++a) {
                        const std::span<const int> own = own_of(patches.groups, a);
                        WaysIn ways = ways_of(own, skin);
                        if (s.shapes[a].spread < patches.fold[a]) mark(patches, a, s, ways, wanted);
                        for (std::size_t eight = 0; eight < s.boxes.size(); ++eight)
                          for (unsigned near = overlaps(s.shapes[a], s.boxes[eight]); near != 0;
                               near &= near - 1) {
                            const std::size_t b = 8 * eight + std::size_t(std::countr_zero(near));
                            if (a != b && b < count && may_meet(patches, s.shapes, a, b))
                              mark(patches, b, s, ways, wanted);
                          }
                        s.met[a] = std::any_of(own.begin(), own.end(),
                                               [&](int i) { return wanted[i] != 0; });
                      }
                    });
  return std::find(s.met.begin(), s.met.end(), 1) != s.met.end();
}

}  // namespace ecorche::inline v1
