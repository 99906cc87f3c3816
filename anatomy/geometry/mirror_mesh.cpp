#include "anatomy/geometry/mirror_mesh.h"

namespace ecorche::inline v1 {

TriMesh mirror_mesh(TriMesh mesh, double mid_plane) {
  mesh.V.col(0) = 2 * mid_plane - mesh.V.col(0).array();
  mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

}  // namespace ecorche::inline v1
