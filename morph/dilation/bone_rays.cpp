#include "morph/dilation/bone_rays.h"

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mirror_mesh.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {

BoneRays make_bone_rays(const Anatomy& anatomy, std::optional<double> even_about) {
  std::vector<const TriMesh*> parts;
  std::vector<int> of;  // #triangles
  std::vector<TriMesh> images;
  images.reserve(anatomy.bones.size());
  const auto add = [&](const TriMesh& mesh, std::size_t bone) {
    parts.push_back(&mesh);
    of.insert(of.end(), std::size_t(mesh.F.rows()), int(bone));
  };
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    const Bone& bone = anatomy.bones[b];
    add(bone.mesh, b);
    if (!even_about || bone.side != Side::middle) continue;
    add(images.emplace_back(mirror_mesh(bone.mesh, *even_about)), b);
  }
  TriMesh all = join_meshes(parts);
  all.V = all.V.unaryExpr([](double x) { return rounded(x); }).eval();
  return {SkinRays(all), std::move(of)};
}

}  // namespace ecorche::inline v1
