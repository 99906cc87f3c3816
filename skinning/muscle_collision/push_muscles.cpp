#include "skinning/muscle_collision/push_muscles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "anatomy/contact/muscle_contact.h"
#include "anatomy/contact/press_outline.h"
#include "anatomy/posing/restore_volume.h"
#include "skinning/muscle_collision/collision_tables.h"

namespace ecorche::inline v1 {
namespace {

constexpr PushParameters kParametersPushMuscles;
constexpr std::size_t kStrips = 32;  // a task
// Cosine of a radial with the skin's way in. Smaller: edges of flat sections stay outside the skin;
// larger: a breast's underside lifts the muscles below it.
constexpr double kMostAgainst = 0.2;

Vec3 to_vec3(Float4 v) { return {double(v[0]), double(v[1]), double(v[2])}; }

// Whether the skin over one of a section's probes is marked.
bool under_any(const SectionProbes& probes, std::span<const char> marks) {
  return !marks.empty() && std::any_of(probes.vertex.begin(), probes.vertex.end(),
                                       [&](int v) { return marks[v] != 0; });
}

bool same_push_muscles(const Ellipse& a, const Ellipse& b) {
  return a.center == b.center && a.axes == b.axes && a.radii == b.radii && a.outline == b.outline;
}

// Displacement of a section: its way inward, and fractions of its radials. `held`: how far the skin
// keeps them from growing.
SectionResponse response_of(const SectionProbes& probes,
                            std::span<const ProbeProjection> projections, const Wide3& all_radials,
                            RadialSamples& held) {
  SectionResponse out;
  std::array<double, kContactDirections> depth{};
  std::array<Vec3, kContactDirections> inward, radials;
  Vec3 direction = Vec3::Zero();
  double over = 0;
  for (const ProbeProjection& projection : projections) {
    const std::size_t i = projection.lane;
    const float out_by =
        std::clamp(projection.height + probes.margin[i], 0.0f, kParametersPushMuscles.most_depth);
    held[i] = std::clamp(
        1 + (projection.height + probes.margin[i]) / kParametersPushMuscles.held_below, 0.0f, 1.0f);
    if (!(out_by > 0)) continue;
    inward[i] = -to_vec3(projection.normal);
    const int lane = i;
    radials[i] = to_vec3(Float4{all_radials.x[lane], all_radials.y[lane], all_radials.z[lane], 0});
    // Skin that faces the section's middle is the other side of a fold: its inside is not ours.
    if (radials[i].dot(inward[i]) > kMostAgainst * radials[i].norm()) continue;
    depth[i] = double(out_by);
    const double excess =
        std::max(0.0, depth[i] - kParametersPushMuscles.most_press * radials[i].norm());
    over = std::max(over, excess);
    direction += excess * inward[i];
    out.any = true;
  }
  if (!out.any) return out;
  if (over > 0) out.way = over * direction.normalized();
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!(depth[i] > 0)) continue;
    const double left = depth[i] - out.way.dot(inward[i]);
    if (left <= 0) continue;
    const double length = radials[i].norm() + 1e-9,
                 facing = std::max(0.4, -radials[i].dot(inward[i]) / length);
    out.press[i] =
        float(std::min(1.0, kParametersPushMuscles.over_press * left / (facing * length)));
  }
  return out;
}

// Moves a strip's sections; one that moves takes its neighbours along by half. Bones hold ends.
void move_strip(const SliceRange& strip, std::span<const char> on_bone, std::span<const Vec3> ways,
                std::span<Ellipse> slices, std::span<char> changed) {
  for (int k = strip.begin; k < strip.end; ++k) {
    const std::size_t i = k;
    if (on_bone[i]) continue;
    const Vec3 before = k > strip.begin ? ways[i - 1] : ways[i],
               after = k + 1 < strip.end ? ways[i + 1] : ways[i];
    const Vec3 drawn = 0.25 * (before + after) + 0.5 * ways[i];
    const Vec3 way = drawn.squaredNorm() > ways[i].squaredNorm() ? drawn : ways[i];
    if (way == Vec3::Zero()) continue;
    slices[i].center += way;
    changed[i] = 1;
  }
}

// Moves sections and presses outlines; marks those that have changed in s.changed.
void apply_responses(const CollisionTables& data, PosedAnatomy& posed, PushWorkspace& s) {
  s.ways.resize(posed.slices.size());
  s.changed.assign(posed.slices.size(), 0);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, data.strips.size(), kStrips), [&](const auto& range) {
        for (std::size_t strip = range.begin(); strip < range.end(); ++strip) {
          const std::size_t first = data.strip_begin[strip], end = data.strip_begin[strip + 1];
          const auto moves = [&](std::size_t o) {
            return s.responses[o].any && s.responses[o].way != Vec3::Zero();
          };
          bool any = false;
          for (std::size_t o = first; o < end; ++o) any = any || moves(o);
          if (any) {
            std::fill(s.ways.begin() + data.strips[strip].begin,
                      s.ways.begin() + data.strips[strip].end, Vec3::Zero());
            for (std::size_t o = first; o < end; ++o)
              if (moves(o)) s.ways[data.probes[o].section] = s.responses[o].way;
            move_strip(data.strips[strip], data.on_bone, s.ways, posed.slices, s.changed);
          }
          for (std::size_t o = first; o < end; ++o) {
            if (!s.responses[o].any) continue;
            const std::size_t k = data.probes[o].section;
            press_outline(s.responses[o].press, s.held[k], posed.slices[k].outline);
            s.changed[k] = 1;
          }
        }
      });
}

// Finds the sections' displacements. Sections that had none and are as they were in the first round
// are not examined `again`.
void find_responses(const CollisionTables& data, const PosedSkin& skin,
                    std::span<const char> pressed, std::span<const Ellipse> slices, bool again,
                    PushWorkspace& s) {
  const auto section_of = [&](std::size_t o) { return std::size_t(data.probes[o].section); };
  const auto wanted = [&](std::size_t o) {
    SectionResponse& response = s.responses[o];
    if (!again) {
      response.any = false;
      s.near[o] = s.near[o] || under_any(data.probes[o], pressed);
    }
    const Ellipse& section = slices[section_of(o)];
    if (!s.near[o] || (again && !response.any && same_push_muscles(section, s.examined[o])))
      return false;
    if (!again) s.examined[o] = section;
    response.any = false;
    s.held[section_of(o)] = {};
    return true;
  };
  for_probes_near_skin(
      data, skin, slices, wanted, [&](std::size_t o, std::span<const ProbeProjection> projections) {
        const std::size_t section = section_of(o);
        s.responses[o] =
            response_of(data.probes[o], projections,
                        probe_radials(slices[section], data.thickness[section]), s.held[section]);
      });
}

}  // namespace

void push_muscles_below_skin(const MuscleCollision& collision, const MuscleModel& muscles,
                             const RelaxedSkin& surface, const SkinLift& lift, PosedAnatomy& posed,
                             PushWorkspace& s, NeighbourContact contact) {
  if (!collision.data) throw std::invalid_argument("push_muscles_below_skin: an empty table");
  const CollisionTables& data = *collision.data;
  if (lift.exposed.size() != data.probes.size() ||
      Eigen::Index(surface.positions.size()) != 4 * data.vertices)
    throw std::invalid_argument(
        "push_muscles_below_skin: a skin that was not lifted over these muscles");
  s.near = lift.exposed;
  s.responses.resize(data.probes.size());
  s.examined.resize(data.probes.size());
  s.held.assign(posed.slices.size(), {});
  const PosedSkin skin{surface.positions, surface.normals};
  for (int round = 0; round < kParametersPushMuscles.rounds; ++round) {
    find_responses(data, skin, surface.pressed, posed.slices, round > 0, s);
    apply_responses(data, posed, s);
    restore_volumes(muscles.posing, s.changed, posed, s.volumes, Threads::all);
    if (contact == NeighbourContact::left) continue;
    if (round == 0) {
      resolve_muscle_contact(muscles.contact, muscles.posing, s.held, posed, s.contact_state,
                             s.contact, Threads::all);
      continue;
    }
    for (int pass = 0; pass < 2; ++pass)
      resolve_deep_contact(muscles.contact, muscles.posing, s.held, posed, s.contact_state,
                           s.contact, Threads::all);
  }
}

}  // namespace ecorche::inline v1
