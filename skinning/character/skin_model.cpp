#include "skinning/character/skin_model.h"

#include <algorithm>

namespace ecorche::inline v1 {
namespace {

// The rest shape of the mesh that relaxes, in its sorted order.
TriMesh sorted_mesh(const ElasticSkin& elastic) {
  TriMesh skin{Points(elastic.rest.size(), 3), Triangles(elastic.triangles.size() / 3, 3)};
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) skin.V.row(v) = elastic.rest[v];
  std::copy(elastic.triangles.begin(), elastic.triangles.end(), skin.F.data());
  return skin;
}

DisplacementMap make_displacement_map(const Refinement& refinement, const BlendMesh& base,
                                      const BlendMesh& fine) {
  std::vector<int> place(base.vertex_count);
  for (int s = 0; s < base.vertex_count; ++s)
    place[base.order.empty() ? std::size_t(s) : std::size_t(base.order[s])] = s;
  DisplacementMap out;
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
  return out;
}

}  // namespace

SkinModel make_skin_model(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                          const BoundSkin& bound) {
  const BlendMesh& mesh = bound.blend->mesh;
  SkinModel out;
  out.blend = out.base_blend = bound.blend;
  out.elastic = std::make_shared<const ElasticSkin>(make_elastic_skin(
      anatomy.skeleton, skin, {bound.depth, bound.radius, bound.binding.joint_weights}, mesh.order,
      mesh.triangles));
  if (!rest.slices.empty())
    out.collision = make_muscle_collision(anatomy, rest, sorted_mesh(*out.elastic));
  return out;
}

SkinModel make_refined_skin_model(const Anatomy& anatomy, const PosedAnatomy& rest,
                                  const TriMesh& base, const Refinement& refinement,
                                  const BoundRefinedSkin& bound) {
  SkinModel out = make_skin_model(anatomy, rest, base, bound.base);
  out.blend = bound.blend;
  out.refined = std::make_shared<const DisplacementMap>(
      make_displacement_map(refinement, bound.base.blend->mesh, bound.blend->mesh));
  return out;
}

}  // namespace ecorche::inline v1
