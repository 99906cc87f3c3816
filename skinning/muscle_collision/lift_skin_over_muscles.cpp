#include "skinning/muscle_collision/lift_skin_over_muscles.h"

#include <algorithm>
#include <stdexcept>

#include "anatomy/geometry/vertex_normals.h"
#include "skinning/muscle_collision/collision_tables.h"
#include "skinning/muscle_collision/lift_skin.h"

namespace ecorche::inline v1 {
namespace {

constexpr float kNearly = 0.003f;  // m below the skin, from which a probe counts as exposed

// Those of a section's probes that are out of the skin, or that the skin must not sink upon; how
// many. `exposed`: whether one of them is out, or nearly so.
std::size_t find_penetrations(const SectionProbes& probes,
                              std::span<const ProbeProjection> projections,
                              SkinPenetration* penetrations, char& exposed) {
  std::size_t count = 0;
  for (const ProbeProjection& projection : projections) {
    const float depth = projection.height + probes.margin[projection.lane];
    if (depth <= -kClearance) continue;
    penetrations[count++] = {projection.vertex, depth};
    exposed = exposed || depth > -kNearly;
  }
  return count;
}

}  // namespace

void lift_skin_over_muscles(const MuscleCollision& collision, std::span<const Ellipse> slices,
                            RelaxedSkin& surface, SkinLift& lift, LiftWorkspace& s) {
  if (!collision.data) throw std::invalid_argument("lift_skin_over_muscles: an empty table");
  const CollisionTables& data = *collision.data;
  std::vector<float>& positions = surface.positions;
  if (int(slices.size()) != data.sections || Eigen::Index(positions.size()) != 4 * data.vertices ||
      4 * surface.liftable.size() != positions.size())
    throw std::invalid_argument(
        "lift_skin_over_muscles: another skin or anatomy than it was made of");
  s.normals.resize(positions.size());
  s.penetrations.resize(8 * data.probes.size());
  s.penetration_count.resize(data.probes.size());
  lift.exposed.resize(data.probes.size());
  const PosedSkin skin{positions, s.normals};
  vertex_normals(positions, data.triangles, s.normals, s.half);
  std::fill(s.penetration_count.begin(), s.penetration_count.end(), 0);
  std::fill(lift.exposed.begin(), lift.exposed.end(), 0);
  for_probes_near_skin(
      data, skin, slices, [](std::size_t) { return true; },
      [&](std::size_t o, std::span<const ProbeProjection> projections) {
        const std::size_t found =
            find_penetrations(data.probes[o], projections, &s.penetrations[8 * o], lift.exposed[o]);
        if (!data.following[o]) s.penetration_count[o] = static_cast<unsigned char>(found);
      });
  std::size_t count = 0;
  for (std::size_t o = 0; o < data.probes.size(); ++o) {
    const auto first = s.penetrations.begin() + std::ptrdiff_t(8 * o);
    std::copy(first, first + s.penetration_count[o],
              s.penetrations.begin() + std::ptrdiff_t(count));
    count += s.penetration_count[o];
  }
  lift.lifted = lift_skin(data.rings, std::span(s.penetrations).first(count), s.normals,
                          surface.liftable, positions, lift.clearance, s);
  for (std::size_t i = 0; lift.lifted && i < surface.openness.size(); ++i)
    surface.openness[i] *= lift.clearance[i];
}

}  // namespace ecorche::inline v1
