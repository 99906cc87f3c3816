#include "skinning/character/skin_model.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

// The rest shape of the mesh that relaxes, in its sorted order.
TriMesh sorted_mesh(const ElasticSkin& elastic) {
  TriMesh skin{Points(elastic.rest.size(), 3), Triangles(elastic.triangles.size() / 3, 3)};
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) skin.V.row(v) = elastic.rest[v];
  std::copy(elastic.triangles.begin(), elastic.triangles.end(), skin.F.data());
  return skin;
}

constexpr float kNoOffset = 2e-6f;  // m, rounding of single precision at a body's size

// `root`: origin of the rest positions that the meshes hold.
RefinedMap make_refined_map(const Refinement& refinement, const BlendMesh& base,
                            const BlendMesh& fine, const Points& base_rest, const Vec3& root) {
  std::vector<int> place(base.vertex_count);
  for (int s = 0; s < base.vertex_count; ++s)
    place[base.order.empty() ? std::size_t(s) : std::size_t(base.order[s])] = s;
  RefinedMap out;
  out.first.push_back(0);
  for (int s = 0; s < fine.vertex_count; ++s) {
    const int v = fine.order.empty() ? s : fine.order[s];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(refinement.map, v); it;
         ++it) {
      out.base.push_back(place[it.col()]);
      out.weight.push_back(float(it.value()));
    }
    out.first.push_back(int(out.base.size()));
  }
  const Points means = refine_points(refinement, base_rest);
  out.offset.assign(fine.rest.size(), 0);
  float most = 0;
  for (int e = 0; e < fine.vertex_count; ++e) {
    const int s = fine.sorted_index[std::size_t(e)];
    const int v = fine.order.empty() ? s : fine.order[std::size_t(s)];
    for (int c = 0; c < 3; ++c) {
      float& offset = out.offset[std::size_t(4 * e + c)];
      offset = float(fine.rest[std::size_t(4 * e + c)] + root[c] - means(v, c));
      most = std::max(most, std::abs(offset));
    }
  }
  if (most < kNoOffset) out.offset.clear();
  return out;
}

}  // namespace

SkinModel make_skin_model(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                          const BoundSkin& bound, const SkinModel* before) {
  const BlendMesh& mesh = bound.blend->mesh;
  SkinModel out;
  out.blend = out.base_blend = bound.blend;
  out.elastic =
      before ? before->elastic
             : std::make_shared<const ElasticSkin>(make_elastic_skin(
                   anatomy.skeleton, skin, {bound.depth, bound.radius, bound.binding.joint_weights},
                   mesh.order, mesh.triangles));
  if (!rest.slices.empty())
    out.collision = make_muscle_collision(anatomy, rest, sorted_mesh(*out.elastic),
                                          before ? before->collision : MuscleCollision{});
  return out;
}

SkinModel make_refined_skin_model(const Anatomy& anatomy, const PosedAnatomy& rest,
                                  const TriMesh& base, const Refinement& refinement,
                                  const BoundRefinedSkin& bound, const SkinModel* before) {
  SkinModel out = make_skin_model(anatomy, rest, base, bound.base, before);
  out.blend = bound.blend;
  out.refined = std::make_shared<const RefinedMap>(make_refined_map(
      refinement, bound.base.blend->mesh, bound.blend->mesh, base.V, rest.X_WJ[0].translation()));
  return out;
}

}  // namespace ecorche::inline v1
