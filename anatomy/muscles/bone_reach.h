// How far a bone reaches from the middle of a joint, by direction: what a capsule or tendon that
// passes over the bone's end may not sink into.
//
// Seen from a joint's middle the ends of bones are star-shaped but for hollows, so that a distance
// a direction says where they lie (height field on a sphere, latitude by longitude).
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct BoneReach {
  int joint = 0;                                       // that carries the bone
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();    // from the joint, world axes at rest, m
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  // rows: two across, pole; world to sphere
  float most = 0;                                      // m, what is farther is not seen
  std::vector<float> reach;                            // m, row after row from the pole on; 0: none
};

// `centre`: in the world at rest, as the mesh is; `joint_at`: of the joint. Precondition: most > 0,
// `pole` of length one.
BoneReach bone_reach(const TriMesh& bone, int joint, const Vec3& joint_at, const Vec3& centre,
                     const Vec3& pole, double most);

// Farthest place of the bone within `most`, m; continuous in the direction, which need not be of
// length one. 0 where there is none.
float reach_toward(const BoneReach& bone, const Eigen::Vector3f& direction);

}  // namespace ecorche::inline v1
