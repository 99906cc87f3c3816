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
#include "skinning/elastic_skin.h"
#include "skinning/nearest_surface.h"
#include "skinning/normals.h"
#include "skinning/skin_over_muscles.h"
#include "skinning/skin_rise.h"
#include "skinning/skin_tables.h"

namespace ecorche {

struct SkinProbe {
  int spoke = 0;
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
  SkinRings rings;
  std::vector<int> triangles;
};

namespace {

// What a section must give to the skin.
struct Giving {
  Vec3 way = Vec3::Zero();                                // inward
  std::array<float, kContactPoints> press{}, held{};      // of every second direction of its outline
  bool any = false;
};

}  // namespace

struct UnderSkinScratch {
  std::vector<float> normals, half;           // #V x 4
  std::vector<Pierce> pierces;                // #probes
  std::vector<char> near;                     // #owners: whether a point of theirs is at the surface, or nearly so; then, or under skin that was pressed in
  RiseScratch rise;
  std::vector<Giving> givings;                // #owners
  std::vector<Ellipse> asked;                 // #owners: sections as they were when they were asked first
  std::vector<Vec3> ways;
  std::vector<char> changed;                  // #sections
  RegrowMemory growing;
  std::vector<ContactSpokes> held;            // #sections, by the skin
  PartMemory part;
};

namespace {

constexpr double kNear = 0.025;     // m below the skin at rest: deeper points are not looked at
constexpr float kMargin = 1.2e-3f;  // m
constexpr float kMostOut = 0.06f;   // m
constexpr float kAside = 0.01f, kAsideDepths = 1.5f;  // m; times how deep it lies: further off, another part of the skin may be nearer
constexpr float kHeldBelow = 0.004f;  // m: what lies deeper is free to swell
constexpr double kPressed = 0.35;   // of an outline's radius; what is more moves the section
constexpr float kNearly = 0.003f;   // m
constexpr double kOver = 1.1;       // the belly swells back a part of what is pressed
constexpr std::size_t kStrips = 32;  // a task
constexpr int kRounds = 2;          // by turns, to the skin and to one another: what gives way to the one swells towards the other

Vec3 to_vec3(Float4 v) { return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])}; }

// A section's outline in single precision, about its centre.
class Spokes {
 public:
  Spokes(const Ellipse& e, float thickness) : e_(e) {
    for (int k = 0; k < 3; ++k) {
      width_[k] = static_cast<float>(e.radii.x() * e.axes(k, 0));
      thickness_[k] = thickness * static_cast<float>(e.radii.y() * e.axes(k, 1));
    }
  }

  Float4 operator()(int spoke) const {
    static const auto directions = [] {
      std::array<std::array<float, 2>, kContactPoints> out;
      for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t k = 0; k < 2; ++k) out[i][k] = static_cast<float>(outline_directions()[2 * i][static_cast<Eigen::Index>(k)]);
      return out;
    }();
    const auto i = static_cast<std::size_t>(spoke);
    return e_.outline[2 * i] * (directions[i][0] * width_ + directions[i][1] * thickness_);
  }

  Float4 center_from(Float4 point) const {
    Float4 out{};
    for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(e_.center[k] - static_cast<double>(point[k]));
    return out;
  }

 private:
  const Ellipse& e_;
  Float4 width_{}, thickness_{};
};

// A section's points that are looked at. Places are taken from a vertex near them: nothing is lost far from the origin.
class Lookers {
 public:
  Lookers(const UnderSkin::Data& data, const PosedSkin& skin, std::span<const Ellipse> slices, std::size_t owner)
      : data_(data),
        skin_(skin),
        spokes_(slices[static_cast<std::size_t>(data.owners[owner])], data.thickness[static_cast<std::size_t>(data.owners[owner])]),
        origin_(load4(&skin.positions[4 * static_cast<std::size_t>(data.probes[static_cast<std::size_t>(data.owner_begin[owner])].vertex)])),
        center_(spokes_.center_from(origin_)) {}

  Float4 spoke(const SkinProbe& probe) const { return spokes_(probe.spoke); }

  // Whether it lies so deep below the vertex that it had at rest that it cannot be out.
  bool deep(const SkinProbe& probe) const {
    const Float4 p = point(probe);
    const float height = sum4(p * load4(&skin_.normals[4 * static_cast<std::size_t>(probe.vertex)]))[0];
    const float aside = std::max(kAside, -kAsideDepths * height);
    return height < -kDeepLie && sum4(p * p)[0] - height * height < aside * aside;
  }

  Lie lie(const SkinProbe& probe) const { return lie_of(data_.rings, skin_, point(probe), probe.vertex); }

 private:
  Float4 point(const SkinProbe& probe) const {
    return center_ + spokes_(probe.spoke) - (load4(&skin_.positions[4 * static_cast<std::size_t>(probe.vertex)]) - origin_);
  }

  const UnderSkin::Data& data_;
  const PosedSkin& skin_;
  Spokes spokes_;
  Float4 origin_, center_;
};

std::span<const SkinProbe> probes_of(const UnderSkin::Data& data, std::size_t owner) {
  return {data.probes.data() + data.owner_begin[owner], data.probes.data() + data.owner_begin[owner + 1]};
}

// How far a section's probes are out of the skin. Whether one of them is, or nearly so.
bool find_pierces(const UnderSkin::Data& data, const PosedSkin& skin, std::span<const Ellipse> slices, std::size_t owner, std::span<Pierce> pierces) {
  const Lookers lookers(data, skin, slices, owner);
  bool any = false;
  auto pierce = pierces.begin() + data.owner_begin[owner];
  for (const SkinProbe& probe : probes_of(data, owner)) {
    *pierce = {probe.vertex, -kDeepLie};
    if (!lookers.deep(probe)) {
      const Lie lie = lookers.lie(probe);
      *pierce = {lie.vertex, lie.height + probe.margin};
    }
    any = any || pierce->out > -kNearly;
    ++pierce;
  }
  return any;
}

// Whether the skin over one of a section's probes is marked.
bool under_any(const UnderSkin::Data& data, std::size_t owner, std::span<const char> marks) {
  if (marks.empty()) return false;
  const std::span<const SkinProbe> probes = probes_of(data, owner);
  return std::any_of(probes.begin(), probes.end(), [&](const SkinProbe& probe) { return marks[static_cast<std::size_t>(probe.vertex)] != 0; });
}

tbb::blocked_range<std::size_t> owners_of(const UnderSkin::Data& data) { return {0, data.owners.size(), 64}; }

bool same(const Ellipse& a, const Ellipse& b) {
  return a.center == b.center && a.axes == b.axes && a.radii == b.radii && a.outline == b.outline;
}

// What a section must give: its way inward, and the share of its spokes.
Giving give_of(const UnderSkin::Data& data, const PosedSkin& skin, std::span<const Ellipse> slices, std::size_t owner) {
  Giving out;
  std::array<double, kContactPoints> wish{};
  std::array<Vec3, kContactPoints> inward;
  const Lookers lookers(data, skin, slices, owner);
  Vec3 direction = Vec3::Zero();
  double over = 0;
  std::array<Vec3, kContactPoints> spokes;
  for (const SkinProbe& probe : probes_of(data, owner)) {
    if (lookers.deep(probe)) continue;
    const auto i = static_cast<std::size_t>(probe.spoke);
    const Lie lie = lookers.lie(probe);
    const float out_by = std::clamp(lie.height + probe.margin, 0.0f, kMostOut);
    out.held[i] = std::clamp(1 + (lie.height + probe.margin) / kHeldBelow, 0.0f, 1.0f);
    if (!(out_by > 0)) continue;
    wish[i] = static_cast<double>(out_by);
    inward[i] = -to_vec3(lie.normal);
    spokes[i] = to_vec3(lookers.spoke(probe));
    const double excess = std::max(0.0, wish[i] - kPressed * spokes[i].norm());
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
    const double length = spokes[i].norm() + 1e-9, facing = std::max(0.4, -spokes[i].dot(inward[i]) / length);
    out.press[i] = static_cast<float>(std::min(1.0, kOver * left / (facing * length)));
  }
  return out;
}

// Sections and outlines give what they must; memory.changed tells which did.
void give_way(const UnderSkin::Data& data, PosedAnatomy& posed, UnderSkinScratch& memory) {
  std::vector<Vec3>& ways = memory.ways;
  ways.assign(posed.slices.size(), Vec3::Zero());
  memory.changed.assign(posed.slices.size(), 0);
  for (std::size_t o = 0; o < data.owners.size(); ++o)
    if (memory.givings[o].any) ways[static_cast<std::size_t>(data.owners[o])] = memory.givings[o].way;
  // A section that moves takes its neighbours along by half.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, data.strips.size(), kStrips), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s)
      for (int k = data.strips[s].begin; k < data.strips[s].end; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const Vec3 before = k > data.strips[s].begin ? ways[i - 1] : ways[i], after = k + 1 < data.strips[s].end ? ways[i + 1] : ways[i];
        const Vec3 drawn = 0.25 * (before + after) + 0.5 * ways[i];
        const Vec3 way = drawn.squaredNorm() > ways[i].squaredNorm() ? drawn : ways[i];
        if (way == Vec3::Zero()) continue;
        posed.slices[i].center += way;
        memory.changed[i] = 1;
      }
  });
  tbb::parallel_for(owners_of(data), [&](const auto& range) {
    for (std::size_t o = range.begin(); o < range.end(); ++o) {
      if (!memory.givings[o].any) continue;
      const auto k = static_cast<std::size_t>(data.owners[o]);
      press_outline(memory.givings[o].press, memory.givings[o].held, posed.slices[k].outline);
      memory.changed[k] = 1;
    }
  });
}

// What sections must give. Those that had nothing to give and are as they were when they were asked first are not asked `again`.
void ask(const UnderSkin::Data& data, const PosedSkin& skin, std::span<const char> pressed, std::span<const Ellipse> slices, bool again,
         UnderSkinScratch& memory) {
  tbb::parallel_for(owners_of(data), [&](const auto& range) {
    for (std::size_t o = range.begin(); o < range.end(); ++o) {
      Giving& giving = memory.givings[o];
      if (!again) memory.near[o] = memory.near[o] || under_any(data, o, pressed);
      if (!memory.near[o]) {
        if (!again) giving = {};
        continue;
      }
      const Ellipse& section = slices[static_cast<std::size_t>(data.owners[o])];
      if (again && !giving.any && same(section, memory.asked[o])) continue;
      if (!again) memory.asked[o] = section;
      giving = give_of(data, skin, slices, o);
    }
  });
}

std::vector<float> rows_of(const Points& points) {
  std::vector<float> out;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (int k = 0; k < 4; ++k) out.push_back(k < 3 ? static_cast<float>(points(v, k)) : 1);
  return out;
}

// Points of all outlines that lie near the skin at rest.
void place_probes(const PosedAnatomy& rest, const TriMesh& skin, UnderSkin::Data& data) {
  const std::vector<float> positions = rows_of(skin.V);
  std::vector<float> normals(positions.size());
  vertex_normals(positions, data.triangles, normals);
  const PosedSkin still{positions, normals};
  const NearestSurface nearest(skin);
  std::vector<SkinProbe> all(rest.slices.size() * kContactPoints);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rest.slices.size(), 32), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      const Spokes spokes(rest.slices[k], data.thickness[k]);
      for (int i = 0; i < kContactPoints; ++i) {
        SkinProbe& probe = all[k * kContactPoints + static_cast<std::size_t>(i)];
        probe = {i, -1, 0};
        const Vec3 p = rest.slices[k].center + to_vec3(spokes(i));
        const SurfacePoint hit = nearest.nearest(p);
        if (hit.distance > kNear) continue;
        const auto far = [&](int corner) { return (skin.V.row(skin.F(hit.triangle, corner)).transpose() - p).squaredNorm(); };
        int corner = 0;
        for (int c = 1; c < 3; ++c)
          if (far(c) < far(corner)) corner = c;
        probe.vertex = skin.F(hit.triangle, corner);
        const Float4 vertex = load4(&positions[4 * static_cast<std::size_t>(probe.vertex)]);
        const Lie lie = lie_of(data.rings, still, spokes.center_from(vertex) + spokes(i), probe.vertex);
        probe.margin = std::min(kMargin, -lie.height - 1e-5f);
      }
    }
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].vertex < 0) continue;
    const int section = static_cast<int>(k / kContactPoints);
    if (data.owners.empty() || data.owners.back() != section) {
      data.owners.push_back(section);
      data.owner_begin.push_back(static_cast<int>(data.probes.size()));
    }
    data.probes.push_back(all[k]);
  }
  data.owner_begin.push_back(static_cast<int>(data.probes.size()));
}

}  // namespace

UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin) {
  auto data = std::make_shared<UnderSkin::Data>();
  data->sections = static_cast<int>(rest.slices.size());
  data->vertices = skin.V.rows();
  data->strips = slice_ranges(anatomy);
  data->rings = make_skin_rings(skin);
  data->triangles.assign(skin.F.data(), skin.F.data() + skin.F.size());
  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, true});
  data->thickness.assign(rest.slices.size(), 1);
  for (const SliceRange& range : data->strips) {
    const MuscleSurface::Part& part = surface.parts[static_cast<std::size_t>(range.muscle)];
    if (part.sheet) std::fill(data->thickness.begin() + range.begin, data->thickness.begin() + range.end, part.thickness);
  }
  place_probes(rest, skin, *data);
  return {data};
}

UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const Binding& binding) {
  if (!binding.tables) throw std::invalid_argument("make_under_skin: an empty binding");
  const SkinTables& tables = binding.tables->base ? *binding.tables->base : *binding.tables;
  TriMesh skin{Points(tables.vertex_count, 3), Triangles(static_cast<Eigen::Index>(tables.triangles.size() / 3), 3)};
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) skin.V.row(v) = tables.elastic->rest[static_cast<std::size_t>(v)];
  std::copy(tables.triangles.begin(), tables.triangles.end(), skin.F.data());
  return make_under_skin(anatomy, rest, skin);
}

bool rise_over_muscles(const UnderSkin& under, std::span<const Ellipse> slices, std::span<const float> open, std::span<float> positions,
                        UnderSkinMemory& own) {
  if (!under.data) throw std::invalid_argument("rise_over_muscles: an empty table");
  const UnderSkin::Data& data = *under.data;
  if (static_cast<int>(slices.size()) != data.sections || static_cast<Eigen::Index>(positions.size()) != 4 * data.vertices || 4 * open.size() != positions.size())
    throw std::invalid_argument("rise_over_muscles: another skin or anatomy than it was made of");
  if (!own.own) own.own = std::make_shared<UnderSkinScratch>();
  UnderSkinScratch& memory = *own.own;
  memory.normals.resize(positions.size());
  memory.pierces.resize(data.probes.size());
  memory.near.resize(data.owners.size());
  const PosedSkin skin{positions, memory.normals};
  vertex_normals(positions, data.triangles, memory.normals, memory.half);
  tbb::parallel_for(owners_of(data), [&](const auto& range) {
    for (std::size_t o = range.begin(); o < range.end(); ++o) memory.near[o] = find_pierces(data, skin, slices, o, memory.pierces);
  });
  return rise(data.rings, memory.pierces, memory.normals, open, positions, memory.rise);
}

std::span<const float> room_over_muscles(const UnderSkinMemory& memory) { return memory.own->rise.room; }

void give_way_to_skin(const UnderSkin& under, const PosingTable& table, std::span<const float> positions, std::span<const float> normals,
                      std::span<const char> pressed, PosedAnatomy& posed, UnderSkinMemory& own) {
  if (!table.data) throw std::invalid_argument("give_way_to_skin: an empty table");
  const UnderSkin::Data& data = *under.data;
  UnderSkinScratch& memory = *own.own;
  memory.givings.resize(data.owners.size());
  memory.asked.resize(data.owners.size());
  const PosedSkin skin{positions, normals};
  for (int round = 0; round < kRounds; ++round) {
    ask(data, skin, pressed, posed.slices, round > 0, memory);
    give_way(data, posed, memory);
    regrow(*table.data, memory.changed, posed, memory.growing, Threads::all);
    memory.held.assign(posed.slices.size(), {});
    for (std::size_t o = 0; o < data.owners.size(); ++o) memory.held[static_cast<std::size_t>(data.owners[o])] = memory.givings[o].held;
    part_again(*table.data, memory.held, round == 0 ? Parting::all : Parting::deep, posed, memory.part, Threads::all);
    if (round > 0) part_again(*table.data, memory.held, Parting::deep, posed, memory.part, Threads::all);
  }
}

}  // namespace ecorche
