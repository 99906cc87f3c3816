#include "skinning/muscle_collision/muscle_collision.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "anatomy/contact/muscle_contact.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posing/restore_volume.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/muscle_collision/lift_skin.h"
#include "skinning/muscle_collision/outline_probes.h"
#include "skinning/muscle_collision/skin_over_muscles.h"
#include "skinning/settle/elastic_skin.h"

namespace ecorche {

struct UnderSkin::Data {
  int sections = 0;
  Eigen::Index vertices = 0;
  std::vector<SectionProbes> probes;  // owners: sections that have some
  std::vector<SliceRange> strips;
  std::vector<int> strip_begin;  // #strips + 1 into probes
  std::vector<float> thickness;  // #sections, of sheets as they are drawn
  SkinRings rings;
  std::vector<int> triangles;
};

namespace {

// What a section must give to the skin.
struct Giving {
  Vec3 way = Vec3::Zero();  // inward
  ContactSpokes press{};
  bool any = false;
};

}  // namespace

struct UnderSkinScratch {
  std::vector<float> normals, half;         // #V x 4
  std::vector<Pierce> pierces;              // eight an owner; then, those that are near the skin
  std::vector<unsigned char> pierce_count;  // #owners
  // #owners: whether a point of theirs is at the surface, or nearly so; then, or under skin that
  // was pressed in
  std::vector<char> near;
  RiseScratch rise;
  std::vector<Giving> givings;  // #owners
  std::vector<Ellipse> asked;   // #owners: sections as they were when they were asked first
  std::vector<Vec3> ways;
  std::vector<char> changed;  // #sections
  RegrowMemory growing;
  std::vector<ContactSpokes> held;  // #sections, by the skin
  PartMemory part;
};

namespace {

constexpr float kMostOut = 0.06f;     // m
constexpr float kHeldBelow = 0.004f;  // m: what lies deeper is free to swell
constexpr double kPressed = 0.35;     // of an outline's radius; what is more moves the section
constexpr float kNearly = 0.003f;     // m
constexpr double kOver = 1.1;         // the belly swells back a part of what is pressed
constexpr std::size_t kStrips = 32;   // a task
// by turns, to the skin and to one another: what gives way to the one swells towards the other
constexpr int kRounds = 2;

// act(owner, its lies) for those of some owners that are wanted, where a probe may be out.
template <class Wanted, class Act>
void each_lying(const UnderSkin::Data& data, const PosedSkin& skin, std::span<const Ellipse> slices,
                const Wanted& wanted, const Act& act) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, data.probes.size(), ShallowProbes::kSections),
      [&](const auto& range) {
        for (std::size_t begin = range.begin(); begin < range.end();
             begin += ShallowProbes::kSections) {
          ShallowProbes shallow;
          for (std::size_t o = begin; o < std::min(begin + ShallowProbes::kSections, range.end());
               ++o) {
            if (!wanted(o)) continue;
            const std::size_t section = data.probes[o].section;
            shallow.add(int(o), data.probes[o], slices[section], data.thickness[section], skin);
          }
          for (std::span<const ProbeLie> left = shallow.lie(data.rings, skin); !left.empty();) {
            const int owner = left.front().owner;
            std::size_t count = 1;
            while (count < left.size() && left[count].owner == owner) ++count;
            act(std::size_t(owner), left.first(count));
            left = left.subspan(count);
          }
        }
      });
}

Vec3 to_vec3(Float4 v) { return {double(v[0]), double(v[1]), double(v[2])}; }

// Those of a section's probes that are out of the skin, or that the skin must not sink upon; how
// many. `near`: whether one of them is out, or nearly so.
std::size_t find_pierces(const SectionProbes& probes, std::span<const ProbeLie> lies,
                         Pierce* pierces, char& near) {
  std::size_t count = 0;
  for (const ProbeLie& lie : lies) {
    const float out = lie.height + probes.margin[lie.lane];
    if (out <= -kRoom) continue;
    pierces[count++] = {lie.vertex, out};
    near = near || out > -kNearly;
  }
  return count;
}

// Whether the skin over one of a section's probes is marked.
bool under_any(const SectionProbes& probes, std::span<const char> marks) {
  return !marks.empty() && std::any_of(probes.vertex.begin(), probes.vertex.end(),
                                       [&](int v) { return marks[v] != 0; });
}

bool same(const Ellipse& a, const Ellipse& b) {
  return a.center == b.center && a.axes == b.axes && a.radii == b.radii && a.outline == b.outline;
}

// What a section must give: its way inward, and the share of its spokes. `held`: how far the skin
// keeps them from growing.
Giving give_of(const SectionProbes& probes, std::span<const ProbeLie> lies, const Wide3& all_spokes,
               ContactSpokes& held) {
  Giving out;
  std::array<double, kContactPoints> wish{};
  std::array<Vec3, kContactPoints> inward, spokes;
  Vec3 direction = Vec3::Zero();
  double over = 0;
  for (const ProbeLie& lie : lies) {
    const std::size_t i = lie.lane;
    const float out_by = std::clamp(lie.height + probes.margin[i], 0.0f, kMostOut);
    held[i] = std::clamp(1 + (lie.height + probes.margin[i]) / kHeldBelow, 0.0f, 1.0f);
    if (!(out_by > 0)) continue;
    wish[i] = double(out_by);
    inward[i] = -to_vec3(lie.normal);
    const int lane = i;
    spokes[i] = to_vec3(Float4{all_spokes.x[lane], all_spokes.y[lane], all_spokes.z[lane], 0});
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
    const double length = spokes[i].norm() + 1e-9,
                 facing = std::max(0.4, -spokes[i].dot(inward[i]) / length);
    out.press[i] = float(std::min(1.0, kOver * left / (facing * length)));
  }
  return out;
}

// A strip's sections move as they must; one that does takes its neighbours along by half.
void move_strip(const SliceRange& strip, std::span<const Vec3> ways, std::span<Ellipse> slices,
                std::span<char> changed) {
  for (int k = strip.begin; k < strip.end; ++k) {
    const std::size_t i = k;
    const Vec3 before = k > strip.begin ? ways[i - 1] : ways[i],
               after = k + 1 < strip.end ? ways[i + 1] : ways[i];
    const Vec3 drawn = 0.25 * (before + after) + 0.5 * ways[i];
    const Vec3 way = drawn.squaredNorm() > ways[i].squaredNorm() ? drawn : ways[i];
    if (way == Vec3::Zero()) continue;
    slices[i].center += way;
    changed[i] = 1;
  }
}

// Sections and outlines give what they must; memory.changed tells which did.
void give_way(const UnderSkin::Data& data, PosedAnatomy& posed, UnderSkinScratch& memory) {
  memory.ways.resize(posed.slices.size());
  memory.changed.assign(posed.slices.size(), 0);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, data.strips.size(), kStrips), [&](const auto& range) {
        for (std::size_t s = range.begin(); s < range.end(); ++s) {
          const std::size_t first = data.strip_begin[s], end = data.strip_begin[s + 1];
          const auto moves = [&](std::size_t o) {
            return memory.givings[o].any && memory.givings[o].way != Vec3::Zero();
          };
          bool any = false;
          for (std::size_t o = first; o < end; ++o) any = any || moves(o);
          if (any) {
            std::fill(memory.ways.begin() + data.strips[s].begin,
                      memory.ways.begin() + data.strips[s].end, Vec3::Zero());
            for (std::size_t o = first; o < end; ++o)
              if (moves(o)) memory.ways[data.probes[o].section] = memory.givings[o].way;
            move_strip(data.strips[s], memory.ways, posed.slices, memory.changed);
          }
          for (std::size_t o = first; o < end; ++o) {
            if (!memory.givings[o].any) continue;
            const std::size_t k = data.probes[o].section;
            press_outline(memory.givings[o].press, memory.held[k], posed.slices[k].outline);
            memory.changed[k] = 1;
          }
        }
      });
}

// What sections must give. Those that had nothing to give and are as they were when they were asked
// first are not asked `again`.
void ask(const UnderSkin::Data& data, const PosedSkin& skin, std::span<const char> pressed,
         std::span<const Ellipse> slices, bool again, UnderSkinScratch& memory) {
  const auto section_of = [&](std::size_t o) { return std::size_t(data.probes[o].section); };
  const auto wanted = [&](std::size_t o) {
    Giving& giving = memory.givings[o];
    if (!again) {
      giving.any = false;
      memory.near[o] = memory.near[o] || under_any(data.probes[o], pressed);
    }
    const Ellipse& section = slices[section_of(o)];
    if (!memory.near[o] || (again && !giving.any && same(section, memory.asked[o]))) return false;
    if (!again) memory.asked[o] = section;
    giving.any = false;
    memory.held[section_of(o)] = {};
    return true;
  };
  each_lying(data, skin, slices, wanted, [&](std::size_t o, std::span<const ProbeLie> lies) {
    const std::size_t section = section_of(o);
    memory.givings[o] =
        give_of(data.probes[o], lies, probe_spokes(slices[section], data.thickness[section]),
                memory.held[section]);
  });
}

}  // namespace

UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin) {
  auto data = std::make_shared<UnderSkin::Data>();
  data->sections = rest.slices.size();
  data->vertices = skin.V.rows();
  data->strips = slice_ranges(anatomy);
  data->rings = make_skin_rings(skin);
  data->triangles.assign(skin.F.data(), skin.F.data() + skin.F.size());
  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, true});
  data->thickness.assign(rest.slices.size(), 1);
  for (const SliceRange& range : data->strips) {
    const MuscleSurface::Part& part = surface.parts[range.muscle];
    if (part.sheet)
      std::fill(data->thickness.begin() + range.begin, data->thickness.begin() + range.end,
                part.thickness);
  }
  data->probes = place_probes(rest.slices, data->thickness, skin, data->rings);
  for (const SliceRange& range : data->strips) {
    const auto first =
        std::find_if(data->probes.begin(), data->probes.end(),
                     [&](const SectionProbes& p) { return p.section >= range.begin; });
    data->strip_begin.push_back(int(first - data->probes.begin()));
  }
  data->strip_begin.push_back(int(data->probes.size()));
  return {data};
}

UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest,
                          const Binding& binding) {
  if (!binding.tables) throw std::invalid_argument("make_under_skin: an empty binding");
  const SkinTables& tables = binding.tables->base ? *binding.tables->base : *binding.tables;
  TriMesh skin{Points(tables.vertex_count, 3), Triangles(tables.triangles.size() / 3, 3)};
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) skin.V.row(v) = tables.elastic->rest[v];
  std::copy(tables.triangles.begin(), tables.triangles.end(), skin.F.data());
  return make_under_skin(anatomy, rest, skin);
}

bool rise_over_muscles(const UnderSkin& under, std::span<const Ellipse> slices,
                       std::span<const float> open, std::span<float> positions,
                       UnderSkinMemory& own) {
  if (!under.data) throw std::invalid_argument("rise_over_muscles: an empty table");
  const UnderSkin::Data& data = *under.data;
  if (int(slices.size()) != data.sections || Eigen::Index(positions.size()) != 4 * data.vertices ||
      4 * open.size() != positions.size())
    throw std::invalid_argument("rise_over_muscles: another skin or anatomy than it was made of");
  if (!own.own) own.own = std::make_shared<UnderSkinScratch>();
  UnderSkinScratch& memory = *own.own;
  memory.normals.resize(positions.size());
  memory.pierces.resize(8 * data.probes.size());
  memory.pierce_count.resize(data.probes.size());
  memory.near.resize(data.probes.size());
  const PosedSkin skin{positions, memory.normals};
  vertex_normals(positions, data.triangles, memory.normals, memory.half);
  std::fill(memory.pierce_count.begin(), memory.pierce_count.end(), 0);
  std::fill(memory.near.begin(), memory.near.end(), 0);
  each_lying(
      data, skin, slices, [](std::size_t) { return true; },
      [&](std::size_t o, std::span<const ProbeLie> lies) {
        memory.pierce_count[o] = static_cast<unsigned char>(
            find_pierces(data.probes[o], lies, &memory.pierces[8 * o], memory.near[o]));
      });
  std::size_t count = 0;
  for (std::size_t o = 0; o < data.probes.size(); ++o) {
    const auto first = memory.pierces.begin() + std::ptrdiff_t(8 * o);
    std::copy(first, first + memory.pierce_count[o],
              memory.pierces.begin() + std::ptrdiff_t(count));
    count += memory.pierce_count[o];
  }
  return rise(data.rings, std::span(memory.pierces).first(count), memory.normals, open, positions,
              memory.rise);
}

std::span<const float> room_over_muscles(const UnderSkinMemory& memory) {
  return memory.own->rise.room;
}

void give_way_to_skin(const UnderSkin& under, const PosingTable& table,
                      std::span<const float> positions, std::span<const float> normals,
                      std::span<const char> pressed, PosedAnatomy& posed, UnderSkinMemory& own) {
  if (!table.data) throw std::invalid_argument("give_way_to_skin: an empty table");
  const UnderSkin::Data& data = *under.data;
  UnderSkinScratch& memory = *own.own;
  memory.givings.resize(data.probes.size());
  memory.asked.resize(data.probes.size());
  memory.held.assign(posed.slices.size(), {});
  const PosedSkin skin{positions, normals};
  for (int round = 0; round < kRounds; ++round) {
    ask(data, skin, pressed, posed.slices, round > 0, memory);
    give_way(data, posed, memory);
    regrow(*table.data, memory.changed, posed, memory.growing, Threads::all);
    part_again(*table.data, memory.held, round == 0 ? Parting::all : Parting::deep, posed,
               memory.part, Threads::all);
    if (round > 0)
      part_again(*table.data, memory.held, Parting::deep, posed, memory.part, Threads::all);
  }
}

}  // namespace ecorche
