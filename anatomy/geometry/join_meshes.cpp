#include "anatomy/geometry/join_meshes.h"

namespace ecorche::inline v1 {

TriMesh join_meshes(const std::vector<const TriMesh*>& parts) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const TriMesh* part : parts) vertices += part->V.rows(), triangles += part->F.rows();
  TriMesh out{Points(vertices, 3), Triangles(triangles, 3)};
  vertices = triangles = 0;
  for (const TriMesh* part : parts) {
    out.V.middleRows(vertices, part->V.rows()) = part->V;
    out.F.middleRows(triangles, part->F.rows()) = part->F.array() + int(vertices);
    vertices += part->V.rows();
    triangles += part->F.rows();
  }
  return out;
}

TriMesh joined_bones(const Anatomy& anatomy) {
  std::vector<const TriMesh*> bones;
  for (const Bone& bone : anatomy.bones) bones.push_back(&bone.mesh);
  return join_meshes(bones);
}

}  // namespace ecorche::inline v1
