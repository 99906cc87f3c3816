#include "morph/fat/subcutaneous_bone.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {

namespace {

constexpr double kMillimetreSubcutaneousBone = 1e-3;
// Fraction of a row's reach from a joint; beyond it the effect fades out. Nearer to 1, the layer
// has a step at the reach; nearer to 0, little of the face is reached.
constexpr double kFade = 0.8;
constexpr double kStature = 1.75;  // m, of the body that the table's lengths are of

// One row: its bones on all sides as one soup, and the joints it is near to.
struct SubcutaneousFace {
  TriMesh bones;
  std::vector<Vec3> joints;  // empty: everywhere
  double reach = 0, deepest = 0, gone = 0, aslant = 0, parallel = 0;
};

bool is_of(const std::string& name, const std::string& plain) {
  return name == plain || name == plain + "_l" || name == plain + "_r";
}

SubcutaneousFace read_face(const Table& table, int row, const Anatomy& anatomy, double unit) {
  SubcutaneousFace face;
  std::vector<const TriMesh*> bones;
  for (const Bone& bone : anatomy.bones)
    if (is_of(bone.name, table.text(row, "bone"))) bones.push_back(&bone.mesh);
  face.bones = join_meshes(bones);
  const std::string& joint = table.text(row, "joint");
  if (!joint.empty()) {
    const std::vector<Vec3> positions = rest_positions(anatomy.skeleton);
    for (std::size_t j = 0; j < positions.size(); ++j)
      if (is_of(anatomy.skeleton.joints[j].name, joint)) face.joints.push_back(positions[j]);
    if (face.joints.empty()) face.bones = {};
  }
  face.reach = unit * table.number_or(row, "reach_mm", 0);
  face.deepest = unit * table.number(row, "deepest_mm");
  face.gone = unit * table.number(row, "gone_mm");
  face.aslant = table.number(row, "aslant");
  face.parallel = table.number(row, "parallel");
  return face;
}

double nearest_joint(const SubcutaneousFace& face, const Vec3& point) {
  double nearest = face.joints.empty() ? 0 : std::numeric_limits<double>::infinity();
  for (const Vec3& joint : face.joints) nearest = std::min(nearest, (joint - point).norm());
  return nearest;
}

}  // namespace

void reach_subcutaneous_bone(const Table& table, const SkinRays& rays, const Anatomy& anatomy,
                             std::span<const float> fatter, std::vector<float>& thickness) {
  const TriMesh& skin = rays.mesh();
  const Points normals = vertex_normals(skin);
  const std::vector<float> plain = thickness;
  const double unit = kMillimetreSubcutaneousBone *
                      (skin.V.col(1).maxCoeff() - skin.V.col(1).minCoeff()) / kStature;
  for (int row = 0; row < table.rows(); ++row) {
    const SubcutaneousFace face = read_face(table, row, anatomy, unit);
    if (face.bones.F.rows() == 0) continue;
    const SkinRays bone_rays(face.bones, RayBuild::quick);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, plain.size(), 512), [&](const auto& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Eigen::Index vertex = i;
            const Vec3 from = skin.V.row(vertex), inwards = -normals.row(vertex);
            if (inwards.squaredNorm() == 0 ||
                (!face.joints.empty() && nearest_joint(face, from) > face.reach + face.gone))
              continue;
            const double more = fatter.empty() ? 0 : double(std::max(0.0f, fatter[i]));
            const RayHit bone = bone_rays.first_hit(from, inwards, face.gone + more);
            if (bone.triangle < 0) continue;
            const double depth = double(bone.distance), now = double(plain[i]);
            double share = smooth_step(face.aslant, face.parallel, -double(bone.facing)) *
                           (1 - smooth_step(face.deepest + more, face.gone + more, depth));
            if (!face.joints.empty())
              share *= 1 - smooth_step(kFade * face.reach, face.reach,
                                       nearest_joint(face, from + depth * inwards));
            if (depth > now)
              thickness[i] = std::max(thickness[i], float(now + share * (depth - now)));
          }
        });
  }
}

}  // namespace ecorche::inline v1
