#include "skinning/muscle_collision/keep_skin_over_bones.h"

#include <stdexcept>

#include "anatomy/geometry/vertex_normals.h"
#include "skinning/muscle_collision/collision_tables.h"
#include "skinning/muscle_collision/lift_skin.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kRounds = 6;

}  // namespace

void keep_skin_over_bones(const MuscleCollision& collision, std::span<const Transform> X_WJ,
                          RelaxedSkin& surface, LiftWorkspace& s) {
  if (!collision.data) throw std::invalid_argument("keep_skin_over_bones: an empty table");
  const CollisionTables& data = *collision.data;
  if (X_WJ.size() != data.joints || Eigen::Index(surface.positions.size()) != 4 * data.vertices)
    throw std::invalid_argument(
        "keep_skin_over_bones: another skin or anatomy than it was made of");
  std::vector<float>& positions = surface.positions;
  surface.normals.resize(positions.size());
  vertex_normals(positions, data.triangles, surface.normals, s.half);
  for (int round = 0; round < kRounds; ++round) {
    find_bone_penetrations(data.bones, X_WJ, data.rings, {positions, surface.normals}, s.of_bones,
                           s.penetrations);
    if (s.penetrations.empty()) return;
    if (round == 0) begin_raise(data.rings, positions, surface.normals, s);
    raise_skin(data.rings, s.penetrations, positions, s);
    vertex_normals(positions, data.triangles, surface.normals, s.half);
  }
}

}  // namespace ecorche::inline v1
