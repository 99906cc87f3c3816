#include "skinning/under_skin.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "anatomy/muscle_line.h"
#include "anatomy/muscle_surface.h"
#include "anatomy/outline.h"
#include "anatomy/posed_contact.h"
#include "anatomy/regrow.h"
#include "skinning/nearest_surface.h"
#include "skinning/normals.h"
#include "skinning/skin_survey.h"

namespace ecorche {

struct SkinProbe {
  int section = 0, spoke = 0;
  int vertex = 0;       // of the skin, nearest at rest
  float margin = 0;     // m, that the point stays below the skin: less than its depth at rest
};

struct UnderSkin::Data {
  int sections = 0;
  Eigen::Index vertices = 0;
  std::vector<SkinProbe> probes;          // by section
  std::vector<int> owners, owner_begin;   // sections that have some; #owners + 1 into probes
  std::vector<SliceRange> strips;
  std::vector<float> thickness;           // #sections, of sheets as they are drawn
  std::vector<int> ring_begin, ring;      // #V + 1; triangles about each vertex
  std::vector<int> near_begin, near;      // #V + 1; its neighbours
  Triangles F;
};

namespace {

// What a section must give.
struct Giving {
  Vec3 way = Vec3::Zero();                                  // of the section, inward
  std::array<float, kOutlinePoints / 2> press{}, held{};    // of every second direction of its outline
  bool any = false;
};

}  // namespace

struct UnderSkinScratch {
  std::vector<Giving> givings;
  std::vector<Vec3> ways;
  std::vector<std::pair<int, float>> wishes;  // #probes: of vertices to rise, m
  std::vector<float> rise, rise_before;       // #V, m
  std::vector<char> changed;                  // #sections
};

namespace {

constexpr double kNear = 0.025;      // m below the skin at rest: deeper points are not looked at
constexpr double kMargin = 1.2e-3;   // m
constexpr double kDeep = 0.008;      // m: below that nothing is asked but that it is so
constexpr int kMostSteps = 40;       // of a walk
constexpr double kMostOut = 0.06;    // m
constexpr double kPressed = 0.35;    // of an outline's radius; what is more moves the section
constexpr double kSkinShare = 0.85;  // of the way out that the skin rises
constexpr int kSpreading = 8;        // rounds
constexpr float kFoldShare = 0.12f;
constexpr int kEasing = 4;           // rounds
constexpr double kOver = 1.1;        // the belly swells back a part of what is pressed

Vec3 spoke_of(const Ellipse& e, double thickness, int spoke) {
  const Vec2& d = outline_directions()[2 * static_cast<std::size_t>(spoke)];
  const double f = static_cast<double>(e.outline[2 * static_cast<std::size_t>(spoke)]);
  return f * (e.radii.x() * d.x() * e.axes.col(0) + thickness * e.radii.y() * d.y() * e.axes.col(1));
}

struct Lie {
  int vertex = 0;               // of the skin, nearest
  double height = 0;            // m over the skin, negative below
  Vec3 normal = Vec3::UnitY();  // outward
};

class Walk {
 public:
  Walk(const UnderSkin::Data& data, const SkinFrame& skin) : data_(data), skin_(skin) {}

  Lie lie_of(const Vec3& p, int from) const {
    int at = from;
    double least = (point(at) - p).squaredNorm();
    for (int step = 0; step < kMostSteps; ++step) {
      const int before = at;
      for (int r = data_.near_begin[static_cast<std::size_t>(before)]; r < data_.near_begin[static_cast<std::size_t>(before) + 1]; ++r) {
        const int v = data_.near[static_cast<std::size_t>(r)];
        const double d = (point(v) - p).squaredNorm();
        if (d < least) least = d, at = v;
      }
      if (at == before) break;
    }
    Lie lie{at, (p - point(at)).dot(normal(at)), normal(at)};
    if (lie.height < -kDeep) return lie;
    least = 1e300;
    for (int r = data_.ring_begin[static_cast<std::size_t>(at)]; r < data_.ring_begin[static_cast<std::size_t>(at) + 1]; ++r) {
      const int f = data_.ring[static_cast<std::size_t>(r)];
      const Vec3 a = point(data_.F(f, 0)), b = point(data_.F(f, 1)), c = point(data_.F(f, 2));
      const Vec3 q = nearest_in_triangle(p, a, b, c);
      const double d = (q - p).squaredNorm();
      if (!(d < least)) continue;
      least = d;
      const double pa = 1 / ((q - a).norm() + 1e-9), pb = 1 / ((q - b).norm() + 1e-9), pc = 1 / ((q - c).norm() + 1e-9);
      lie.normal = (pa * normal(data_.F(f, 0)) + pb * normal(data_.F(f, 1)) + pc * normal(data_.F(f, 2))).normalized();
      lie.height = (p - q).dot(lie.normal);
    }
    return lie;
  }

 private:
  Vec3 point(int v) const { return Eigen::Map<const Eigen::Vector3f>(&skin_.positions[4 * static_cast<std::size_t>(v)]).cast<double>(); }
  Vec3 normal(int v) const { return Eigen::Map<const Eigen::Vector3f>(&skin_.normals[4 * static_cast<std::size_t>(v)]).cast<double>(); }
  const UnderSkin::Data& data_;
  const SkinFrame& skin_;
};

// What a section must give: its way inward, and the share of its spokes.
Giving give_of(const UnderSkin::Data& data, const Walk& walk, const Ellipse& e, std::size_t owner) {
  Giving out;
  std::array<double, kContactPoints> wish{};
  std::array<Vec3, kContactPoints> inward;
  Vec3 direction = Vec3::Zero();
  double over = 0;
  const double thickness = static_cast<double>(data.thickness[static_cast<std::size_t>(data.owners[owner])]);
  for (int k = data.owner_begin[owner]; k < data.owner_begin[owner + 1]; ++k) {
    const SkinProbe& probe = data.probes[static_cast<std::size_t>(k)];
    const auto i = static_cast<std::size_t>(probe.spoke);
    const Vec3 spoke = spoke_of(e, thickness, probe.spoke);
    const Lie lie = walk.lie_of(e.center + spoke, probe.vertex);
    const double out_by = std::clamp(lie.height + static_cast<double>(probe.margin), 0.0, kMostOut);
    out.held[i] = static_cast<float>(std::clamp(1 + (lie.height + static_cast<double>(probe.margin)) / 0.004, 0.0, 1.0));
    if (!(out_by > 0)) continue;
    wish[i] = out_by;
    inward[i] = -lie.normal;
    const double excess = std::max(0.0, out_by - kPressed * spoke.norm());
    over = std::max(over, excess);
    direction += excess * inward[i];
    out.any = true;
  }
  if (!out.any) return out;
  if (over > 0) out.way = over * direction.normalized();
  for (std::size_t i = 0; i < wish.size(); ++i) {
    if (!(wish[i] > 0)) continue;
    const double left = wish[i] - out.way.dot(inward[i]);
    if (left <= 0) continue;
    const Vec3 spoke = spoke_of(e, thickness, static_cast<int>(i));
    const double length = spoke.norm() + 1e-9, facing = std::max(0.4, -spoke.dot(inward[i]) / length);
    out.press[i] = static_cast<float>(kOver * left / (facing * length));
  }
  return out;
}

// The skin over what has come out.
void rise_over(const UnderSkin::Data& data, const Walk& walk, std::span<const Ellipse> slices, SkinFrame& skin, UnderSkinScratch& memory) {
  std::vector<float>&rise = memory.rise, &before = memory.rise_before;
  rise.assign(static_cast<std::size_t>(data.vertices), 0);
  std::vector<std::pair<int, float>>& wishes = memory.wishes;
  wishes.resize(data.probes.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, data.probes.size(), 512), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      const SkinProbe& probe = data.probes[k];
      const Ellipse& e = slices[static_cast<std::size_t>(probe.section)];
      const Lie lie = walk.lie_of(e.center + spoke_of(e, static_cast<double>(data.thickness[static_cast<std::size_t>(probe.section)]), probe.spoke), probe.vertex);
      wishes[k] = {lie.vertex, static_cast<float>(kSkinShare * std::clamp(lie.height + static_cast<double>(probe.margin), 0.0, kMostOut))};
    }
  });
  bool any = false;
  for (const auto& [vertex, wish] : wishes) {
    float& of = rise[static_cast<std::size_t>(vertex)];
    of = std::max(of, wish);
    any = any || wish > 0;
  }
  if (!any) return;
  for (int round = 0; round < kSpreading; ++round) {
    before = rise;
    for (std::size_t v = 0; v < rise.size(); ++v) {
      float sum = 0;
      int count = 0;
      for (int r = data.near_begin[v]; r < data.near_begin[v + 1]; ++r) sum += before[static_cast<std::size_t>(data.near[static_cast<std::size_t>(r)])], ++count;
      const float mean = (before[v] + sum) / static_cast<float>(count + 1);
      rise[v] = round < kSpreading / 2 ? std::max(before[v], mean) : mean;
    }
  }
  // In a fold normals run together: the skin goes an eighth of the way to where a neighbour's meets its own.
  const auto row = [](const std::vector<float>& of, std::size_t v) { return Eigen::Map<const Eigen::Vector3f>(&of[4 * v]); };
  for (std::size_t v = 0; v < rise.size(); ++v) {
    for (int r = data.near_begin[v]; rise[v] > 0 && r < data.near_begin[v + 1]; ++r) {
      const auto u = static_cast<std::size_t>(data.near[static_cast<std::size_t>(r)]);
      const Eigen::Vector3f edge = row(skin.positions, u) - row(skin.positions, v);
      const float nearing = (row(skin.normals, v) - row(skin.normals, u)).dot(edge);
      if (nearing > 0) rise[v] = std::min(rise[v], kFoldShare * edge.squaredNorm() / nearing);
    }
  }
  for (int round = 0; round < kEasing; ++round) {  // round about a fold too
    before = rise;
    for (std::size_t v = 0; v < rise.size(); ++v) {
      float sum = before[v];
      for (int r = data.near_begin[v]; r < data.near_begin[v + 1]; ++r) sum += before[static_cast<std::size_t>(data.near[static_cast<std::size_t>(r)])];
      rise[v] = std::min(before[v], sum / static_cast<float>(data.near_begin[v + 1] - data.near_begin[v] + 1));
    }
  }
  for (std::size_t v = 0; v < rise.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) skin.positions[4 * v + k] += rise[v] * skin.normals[4 * v + k];
  vertex_normals(skin.positions, std::span(data.F.data(), static_cast<std::size_t>(data.F.size())), skin.normals);
}

}  // namespace

UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin) {
  auto data = std::make_shared<UnderSkin::Data>();
  data->sections = static_cast<int>(rest.slices.size());
  data->vertices = skin.V.rows();
  data->strips = slice_ranges(anatomy);
  data->F = skin.F;
  data->ring_begin.assign(static_cast<std::size_t>(skin.V.rows()) + 1, 0);
  for (Eigen::Index k = 0; k < skin.F.size(); ++k) ++data->ring_begin[static_cast<std::size_t>(skin.F.data()[k]) + 1];
  for (std::size_t v = 1; v < data->ring_begin.size(); ++v) data->ring_begin[v] += data->ring_begin[v - 1];
  data->ring.resize(static_cast<std::size_t>(skin.F.size()));
  std::vector<int> next(data->ring_begin.begin(), data->ring_begin.end() - 1);
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int i = 0; i < 3; ++i) data->ring[static_cast<std::size_t>(next[static_cast<std::size_t>(skin.F(f, i))]++)] = static_cast<int>(f);

  data->near_begin.push_back(0);
  for (const std::vector<int>& neighbours : vertex_neighbours(skin)) {
    data->near.insert(data->near.end(), neighbours.begin(), neighbours.end());
    data->near_begin.push_back(static_cast<int>(data->near.size()));
  }

  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, true});
  data->thickness.assign(rest.slices.size(), 1);
  for (const SliceRange& range : data->strips) {
    const MuscleSurface::Part& part = surface.parts[static_cast<std::size_t>(range.muscle)];
    if (part.sheet) std::fill(data->thickness.begin() + range.begin, data->thickness.begin() + range.end, part.thickness);
  }

  // The skin at rest, as a frame.
  SkinFrame still;
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v)
    for (int k = 0; k < 4; ++k) still.positions.push_back(k < 3 ? static_cast<float>(skin.V(v, k)) : 1);
  still.normals.resize(still.positions.size());
  vertex_normals(still.positions, std::span(skin.F.data(), static_cast<std::size_t>(skin.F.size())), still.normals);
  const Walk walk(*data, still);
  const NearestSurface nearest(skin);
  std::vector<SkinProbe> all(rest.slices.size() * kContactPoints);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rest.slices.size(), 32), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k)
      for (int i = 0; i < kContactPoints; ++i) {
        SkinProbe& probe = all[k * kContactPoints + static_cast<std::size_t>(i)];
        probe = {static_cast<int>(k), i, -1, 0};
        const Vec3 p = rest.slices[k].center + spoke_of(rest.slices[k], static_cast<double>(data->thickness[k]), i);
        const SurfacePoint hit = nearest.nearest(p);
        if (hit.distance > kNear) continue;
        int corner = 0;
        for (int c = 1; c < 3; ++c)
          if ((skin.V.row(skin.F(hit.triangle, c)).transpose() - p).squaredNorm() < (skin.V.row(skin.F(hit.triangle, corner)).transpose() - p).squaredNorm()) corner = c;
        probe.vertex = skin.F(hit.triangle, corner);
        probe.margin = static_cast<float>(std::min(kMargin, -walk.lie_of(p, probe.vertex).height - 1e-5));
      }
  });
  for (const SkinProbe& probe : all) {
    if (probe.vertex < 0) continue;
    if (data->owners.empty() || data->owners.back() != probe.section) {
      data->owners.push_back(probe.section);
      data->owner_begin.push_back(static_cast<int>(data->probes.size()));
    }
    data->probes.push_back(probe);
  }
  data->owner_begin.push_back(static_cast<int>(data->probes.size()));
  return {data};
}

void keep_under_skin(const UnderSkin& under, const PosingTable& table, SkinFrame& skin, PosedAnatomy& posed, UnderSkinMemory& own) {
  if (!under.data || !table.data) throw std::invalid_argument("keep_under_skin: an empty table");
  const UnderSkin::Data& data = *under.data;
  if (static_cast<int>(posed.slices.size()) != data.sections || static_cast<Eigen::Index>(skin.positions.size()) != 4 * data.vertices)
    throw std::invalid_argument("keep_under_skin: another skin or anatomy than it was made of");
  if (!own.own) own.own = std::make_shared<UnderSkinScratch>();
  UnderSkinScratch& memory = *own.own;
  std::vector<Giving>& gives = memory.givings;
  std::vector<Vec3>& ways = memory.ways;
  gives.resize(data.owners.size());
  ways.assign(posed.slices.size(), Vec3::Zero());
  memory.changed.assign(posed.slices.size(), 0);
  const Walk walk(data, skin);
  rise_over(data, walk, posed.slices, skin, memory);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, data.owners.size(), 64), [&](const auto& range) {
    for (std::size_t o = range.begin(); o < range.end(); ++o) {
      const auto out = [](const auto& wish) { return wish.second > 0; };  // the skin has only risen since
      const bool any = std::any_of(memory.wishes.begin() + data.owner_begin[o], memory.wishes.begin() + data.owner_begin[o + 1], out);
      gives[o] = any ? give_of(data, walk, posed.slices[static_cast<std::size_t>(data.owners[o])], o) : Giving{};
    }
  });
  for (std::size_t o = 0; o < data.owners.size(); ++o)
    if (gives[o].any) ways[static_cast<std::size_t>(data.owners[o])] = gives[o].way;
  // A section that moves takes its neighbours along by half.
  for (const SliceRange& strip : data.strips)
    for (int k = strip.begin; k < strip.end; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const Vec3 before = k > strip.begin ? ways[i - 1] : ways[i], after = k + 1 < strip.end ? ways[i + 1] : ways[i];
      const Vec3 drawn = 0.25 * (before + after) + 0.5 * ways[i];
      const Vec3 way = drawn.squaredNorm() > ways[i].squaredNorm() ? drawn : ways[i];
      if (way == Vec3::Zero()) continue;
      posed.slices[i].center += way;
      memory.changed[i] = 1;
    }
  for (std::size_t o = 0; o < data.owners.size(); ++o) {
    if (!gives[o].any) continue;
    const auto k = static_cast<std::size_t>(data.owners[o]);
    press_outline(gives[o].press, gives[o].held, posed.slices[k].outline);
    memory.changed[k] = 1;
  }
  regrow(*table.data, memory.changed, posed);
}

}  // namespace ecorche
