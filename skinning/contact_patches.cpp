#include "skinning/contact_patches.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "skinning/float4.h"

namespace ecorche {
namespace {

constexpr std::size_t kPatch = 48, kPart = 8;          // vertices
constexpr std::size_t kTask = 16;                      // patches
constexpr float kNearer = 0.97f;                       // of the distance at rest
constexpr float kRight = std::numbers::pi_v<float> / 2;
constexpr float kFold = 0.7f, kNewFold = 0.1f;         // rad: spread of a patch that may meet itself; and beyond its own at rest

Float4 row(std::span<const float> rows, int i) { return load4(&rows[4 * static_cast<std::size_t>(i)]); }

float angle(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

std::span<const int> hull_of(const VertexGroups& groups, std::size_t g) {
  return std::span(groups.hull)
      .subspan(static_cast<std::size_t>(groups.hull_first[g]),
               static_cast<std::size_t>(groups.hull_first[g + 1] - groups.hull_first[g]));
}

PatchScratch::Shape shape_of(std::span<const int> hull, float reach, std::span<const float> positions, std::span<const float> normals) {
  PatchScratch::Shape out;
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
  store4(out.middle, sum * (1 / static_cast<float>(hull.size())));
  store4(out.up, up);
  out.spread = angle(least);
  out.facing = out.spread < kRight ? std::sin(out.spread) : 1;
  return out;
}

bool overlap(const PatchScratch::Shape& a, const PatchScratch::Shape& b) {
  const float reach = std::max(a.reach, b.reach);
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - reach > b.high[k] || b.low[k] - reach > a.high[k]) return false;
  return true;
}

bool may_meet(const ContactPatches& patches, const std::vector<PatchScratch::Shape>& shapes, std::size_t a, std::size_t b) {
  const PatchScratch::Shape &A = shapes[a], &B = shapes[b];
  if (!overlap(A, B)) return false;
  const Float4 way = load4(A.middle) - load4(B.middle), rest = load4(&patches.rest_middle[4 * a]) - load4(&patches.rest_middle[4 * b]);
  if (sum4(way * way)[0] >= kNearer * kNearer * sum4(rest * rest)[0]) return false;
  return angle(sum4(load4(A.up) * load4(B.up))[0]) + A.spread + B.spread > kRight;
}

// The way of a vertex from a little before it inwards.
struct WayIn {
  Float4 normal, from, to;
};

// Whether it leads through where a shape lies whose far side it may be on, by its normal.
bool may_enter(const WayIn& way, const PatchScratch::Shape& other) {
  const Float4 up = load4(other.up);
  if (sum4(up * way.normal)[0] > other.facing) return false;
  const Float4 beyond = most(load4(other.low) - most(way.from, way.to), least(way.from, way.to) - load4(other.high));
  if (beyond[0] > 0 || beyond[1] > 0 || beyond[2] > 0) return false;
  const float a = sum4(up * way.from)[0], b = sum4(up * way.to)[0];
  return std::max(a, b) >= other.bottom && std::min(a, b) <= other.top;
}

// The vertices of a patch that may enter another one.
bool mark(const ContactPatches& patches, std::size_t patch, std::size_t other, const SkinReach& skin, const PatchScratch& s,
          std::vector<char>& wanted) {
  const auto first = s.parts.begin() + patches.part_first[other], last = s.parts.begin() + patches.part_first[other + 1];
  bool any = false;
  for (int k = patches.groups.first[patch]; k < patches.groups.first[patch + 1]; ++k) {
    const int i = patches.groups.vertex[static_cast<std::size_t>(k)];
    const float give = skin.give[static_cast<std::size_t>(i)];
    if (give <= 0) continue;
    char& want = wanted[static_cast<std::size_t>(i)];
    if (!want) {
      const Float4 n = row(skin.normals, i), p = row(skin.positions, i);
      const WayIn way{n, p + skin.before * n, p - give * n};
      want = may_enter(way, s.shapes[other]) &&
             std::any_of(first, last, [&](const PatchScratch::Shape& part) { return may_enter(way, part); });
    }
    any = any || want;
  }
  return any;
}

// Gathers connected vertices of `list`, which `among` tells from all others by `mark`, into groups of at most `most`. A vertex's
// group goes to `group`.
void cut_groups(const Membrane& rings, std::span<const int> list, const std::vector<int>& among, int mark, std::size_t most,
                std::vector<int>& group, std::vector<int>& seen, VertexGroups& out) {
  for (const int start : list) {
    if (group[static_cast<std::size_t>(start)] >= 0) continue;
    const int g = static_cast<int>(out.first.size()) - 1;
    const std::size_t begin = out.vertex.size();
    group[static_cast<std::size_t>(start)] = g;
    out.vertex.push_back(start);
    const auto reach_for = [&](int v) {
      if (seen[static_cast<std::size_t>(v)] == g) return;
      seen[static_cast<std::size_t>(v)] = g;
      out.hull.push_back(v);
    };
    for (std::size_t k = begin; k < out.vertex.size(); ++k) {
      const std::size_t i = static_cast<std::size_t>(out.vertex[k]);
      reach_for(static_cast<int>(i));
      for (int e = rings.first[i]; e < rings.first[i + 1]; ++e) {
        const int j = rings.neighbour[static_cast<std::size_t>(e)];
        reach_for(j);
        if (among[static_cast<std::size_t>(j)] != mark || group[static_cast<std::size_t>(j)] >= 0 ||
            out.vertex.size() - begin >= most)
          continue;
        group[static_cast<std::size_t>(j)] = g;
        out.vertex.push_back(j);
      }
    }
    out.first.push_back(static_cast<int>(out.vertex.size()));
    out.hull_first.push_back(static_cast<int>(out.hull.size()));
  }
}

}  // namespace

ContactPatches cut_patches(const Membrane& rings, std::span<const float> positions, std::span<const float> normals,
                           std::span<const float> give) {
  ContactPatches out;
  const std::size_t n = give.size();
  std::vector<int> all(n), patch(n, -1), part(n, -1), seen(n, -1), seen_by_part(n, -1);
  std::iota(all.begin(), all.end(), 0);
  cut_groups(rings, all, std::vector<int>(n, 0), 0, kPatch, patch, seen, out.groups);
  const auto count = out.groups.first.size() - 1;
  for (std::size_t p = 0; p < count; ++p) {
    const auto own = std::span(out.groups.vertex)
                         .subspan(static_cast<std::size_t>(out.groups.first[p]),
                                  static_cast<std::size_t>(out.groups.first[p + 1] - out.groups.first[p]));
    float reach = 0;
    for (const int i : own) reach = std::max(reach, give[static_cast<std::size_t>(i)]);
    out.reach.push_back(reach);
    const PatchScratch::Shape shape = shape_of(hull_of(out.groups, p), reach, positions, normals);
    out.rest_middle.insert(out.rest_middle.end(), shape.middle, shape.middle + 4);
    out.rest_spread.push_back(shape.spread);
    out.part_first.push_back(static_cast<int>(out.parts.first.size()) - 1);
    cut_groups(rings, own, patch, static_cast<int>(p), kPart, part, seen_by_part, out.parts);
  }
  out.part_first.push_back(static_cast<int>(out.parts.first.size()) - 1);
  return out;
}

bool find_meetings(const ContactPatches& patches, const SkinReach& skin, PatchScratch& s, std::vector<char>& wanted) {
  const std::size_t count = patches.reach.size();
  s.shapes.resize(count);
  s.parts.resize(patches.parts.first.size() - 1);
  wanted.assign(skin.give.size(), 0);
  s.met.assign(count, 0);
  const tbb::blocked_range<std::size_t> all(0, count, kTask);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p)
      s.shapes[p] = shape_of(hull_of(patches.groups, p), patches.reach[p], skin.positions, skin.normals);
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, s.parts.size(), kTask), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p)
      s.parts[p] = shape_of(hull_of(patches.parts, p), 0, skin.positions, skin.normals);
  });
  tbb::parallel_for(all, [&](const auto& range) {  // each marks its own vertices
    for (std::size_t a = range.begin(); a < range.end(); ++a) {
      bool any = s.shapes[a].spread > std::max(kFold, patches.rest_spread[a] + kNewFold) && mark(patches, a, a, skin, s, wanted);
      for (std::size_t b = 0; b < count; ++b)
        if (a != b && may_meet(patches, s.shapes, a, b)) any = mark(patches, a, b, skin, s, wanted) || any;
      s.met[a] = any;
    }
  });
  return std::find(s.met.begin(), s.met.end(), 1) != s.met.end();
}

}  // namespace ecorche
