// Laws of kinematics: rest gives rest, rigid motion moves everything alike.
#include "anatomy/skeleton.h"

#include <gtest/gtest.h>

using namespace ecorche;

namespace {

Skeleton chain() {
  Skeleton skeleton;
  for (int j = 0; j < 4; ++j) {
    Joint joint;
    joint.name = "j" + std::to_string(j);
    joint.parent = j - 1;
    joint.X_PJ.translation() = Vec3(0.1 * j, 0.3, -0.05 * j);
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

}  // namespace

TEST(Skeleton, RestPoseGivesRestPositions) {
  const Skeleton skeleton = chain();
  std::vector<Transform> X_WJ;
  forward_kinematics(skeleton, rest_pose(skeleton), X_WJ);
  const auto rest = rest_positions(skeleton);
  for (size_t j = 0; j < rest.size(); ++j) {
    EXPECT_LT((X_WJ[j].translation() - rest[j]).norm(), 1e-15);
    EXPECT_TRUE(X_WJ[j].linear().isIdentity(1e-15));
  }
}

TEST(Skeleton, TurningTheRootMovesEverythingRigidly) {
  const Skeleton skeleton = chain();
  Pose pose = rest_pose(skeleton);
  pose.rotations[2] = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  std::vector<Transform> before, after;
  forward_kinematics(skeleton, pose, before);
  Transform rigid = Transform::Identity();
  rigid.linear() = Eigen::AngleAxisd(1.1, Vec3(-1, 0.5, 2).normalized()).toRotationMatrix();
  rigid.translation() = Vec3(1, -2, 3);
  pose.root = rigid * pose.root;
  pose.rotations[0] = Quat(rigid.linear()) * pose.rotations[0];
  forward_kinematics(skeleton, pose, after);
  for (size_t j = 0; j < before.size(); ++j)
    EXPECT_TRUE((rigid * before[j]).isApprox(after[j], 1e-12));
}

TEST(Skeleton, WrongPoseSizeIsRefused) {
  std::vector<Transform> out;
  EXPECT_THROW(forward_kinematics(chain(), Pose{}, out), std::invalid_argument);
}
