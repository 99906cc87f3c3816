#include "morph/fit/containment.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using SkinSide = CGAL::Side_of_triangle_mesh<Mesh, Kernel>;

Mesh cgal_mesh(const TriMesh& skin) {
  std::vector<Mesh::Vertex_index> vertex(skin.V.rows());
  Mesh mesh;
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    Mesh::Vertex_index corner[3];
    for (int k = 0; k < 3; ++k) {
      const int i = skin.F(f, k);
      Mesh::Vertex_index& v = vertex[i];
      if (v == Mesh::null_vertex()) v = mesh.add_vertex({skin.V(i, 0), skin.V(i, 1), skin.V(i, 2)});
      corner[k] = v;
    }
    if (mesh.add_face(corner[0], corner[1], corner[2]) == Mesh::null_face()) {
      throw std::invalid_argument("check_containment: the skin is not a manifold");
    }
  }
  if (mesh.is_empty() || !CGAL::is_closed(mesh))
    throw std::invalid_argument("check_containment: the skin is not closed");
  return mesh;
}

bool is_outside(const SkinSide& side, const Vec3& p) {
  return side({p.x(), p.y(), p.z()}) == CGAL::ON_UNBOUNDED_SIDE;
}

int outline_points_outside(const SkinSide& side, const Muscle& muscle, int around) {
  int outside = 0;
  for (const Strip& strip : muscle.strips) {
    for (const Ellipse& e : rest_slices(strip)) {
      for (int k = 0; k < around; ++k) {
        const double angle = 6.283185307179586 * k / around;
        const double factor = outline_factor(e.outline, double(k) * kOutlinePoints / around);
        outside += is_outside(side, e.center + factor * e.axes.leftCols<2>() *
                                                   Vec2(e.radii.x() * std::cos(angle),
                                                        e.radii.y() * std::sin(angle)));
      }
    }
  }
  return outside;
}

}  // namespace

Containment check_containment(const Anatomy& anatomy, const TriMesh& closed_skin, int around) {
  const Mesh mesh = cgal_mesh(closed_skin);
  const SkinSide side(mesh);
  side({0, 0, 0});  // builds its tree, which several threads must not do at once
  Containment result;
  result.bones.resize(anatomy.bones.size());
  result.muscles.resize(anatomy.muscles.size());
  tbb::parallel_for(std::size_t{0}, anatomy.bones.size(), [&](std::size_t b) {
    const Points& V = anatomy.bones[b].mesh.V;
    for (Eigen::Index i = 0; i < V.rows(); ++i) result.bones[b] += is_outside(side, V.row(i));
  });
  tbb::parallel_for(std::size_t{0}, anatomy.muscles.size(), [&](std::size_t m) {
    result.muscles[m] = outline_points_outside(side, anatomy.muscles[m], around);
  });
  for (const Bone& bone : anatomy.bones) result.bone_points += bone.mesh.V.rows();
  result.bone_points_outside = std::accumulate(result.bones.begin(), result.bones.end(), 0);
  result.muscle_points = around * slice_count(anatomy);
  result.muscle_points_outside = std::accumulate(result.muscles.begin(), result.muscles.end(), 0);
  return result;
}

}  // namespace ecorche::inline v1
