#include "morph/fit/muscle_ends.h"

#include <algorithm>
#include <map>
#include <memory>

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {

MuscleEnds measure_muscle_ends(const Anatomy& anatomy) {
  std::map<int, std::unique_ptr<NearestSurface>> bones;  // by joint
  const auto distance = [&](int joint, const Vec3& end) {
    if (joint < 0) return -1.0;
    auto& surface = bones[joint];
    if (!surface) {
      std::vector<const TriMesh*> carried;
      for (const Bone& bone : anatomy.bones)
        if (bone.joint == joint) carried.push_back(&bone.mesh);
      const TriMesh all = join_meshes(carried);
      if (all.F.rows() == 0) return -1.0;
      surface = std::make_unique<NearestSurface>(all);
    }
    return surface->nearest(end).distance;
  };
  MuscleEnds out;
  out.farthest.assign(anatomy.muscles.size(), 0.0);
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    const Muscle& muscle = anatomy.muscles[m];
    for (const Strip& strip : muscle.strips) {
      const auto [origin, insertion] = end_joints(muscle, strip);
      for (const double d : {distance(origin, strip.path.front().rest),
                             distance(insertion, strip.path.back().rest)}) {
        if (d < 0) continue;
        out.distances.push_back(d);
        out.loose += d > kLooseEnd;
        out.farthest[m] = std::max(out.farthest[m], d);
      }
    }
  }
  std::sort(out.distances.begin(), out.distances.end());
  return out;
}

}  // namespace ecorche::inline v1
