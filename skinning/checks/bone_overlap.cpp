#include "skinning/checks/bone_overlap.h"

#include "anatomy/geometry/overlap_volumes.h"

namespace ecorche::inline v1 {

BoneOverlap measure_bone_overlap(const std::vector<Bone>& bones, double spacing) {
  std::vector<Solid> solids;
  // as muscles: what these share is measured, of bones with bones it is not
  for (const Bone& bone : bones)
    solids.push_back({Solid::Kind::muscle, &bone.mesh.V, &bone.mesh.F, 0, int(bone.mesh.F.rows())});
  const SolidVolumes volumes = measure_solids(solids, spacing);
  BoneOverlap out;
  out.share = volumes.muscle_overlap_share();
  for (const SharedVolume& pair : volumes.pairs)
    out.pairs.push_back({bones[pair.a].name, bones[pair.b].name, pair.volume});
  return out;
}

}  // namespace ecorche::inline v1
