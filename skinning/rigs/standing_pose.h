// The pose of a skeleton in which a skin stands, from the skin at rest.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// Of the vertices that hang on a joint: sums of share * [a; 1] [b; 1]^T, places in the world, m.
// A share is a squared weight: what hangs on several joints tells little of any.
struct JointMoments {
  Eigen::Matrix4d rest = Eigen::Matrix4d::Zero();  // a and b: at rest
  Eigen::Matrix4d here = Eigen::Matrix4d::Zero();  // a: where they are, b: at rest
};
// [a; 1] [b; 1]^T
Eigen::Matrix4d vertex_moment(const Vec3& a, const Vec3& b);

// The pose that carries the joints' vertices nearest to where they are. First each joint takes the
// rotation that does so for its own (Kabsch), or its parent's where few vertices tell of it; then
// all of them and the root's place give way a little, since bones that are not as long as what
// moves the skin would carry errors of places out to hands and feet (Gauss-Newton).
// Precondition: moments of each joint.
Pose pose_by_moments(const Skeleton& skeleton, const std::vector<JointMoments>& moments);

// The pose in which vertices are at `standing`. Precondition: as many rows and weights as vertices.
Pose standing_pose(const Skeleton& skeleton, const Points& rest, const Points& standing,
                   const std::vector<JointWeights>& weights);

}  // namespace ecorche::inline v1
