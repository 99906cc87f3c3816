// Joint angles as other programs have them: a triple for every rotation, without leaps.
#include "anatomy/model_files/coordinates.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/skinning/plain_skeleton.h"

namespace ecorche {
namespace {
TEST(Coordinates, AnglesMakeTheirRotation) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-1.2, 1.2);
  for (Joint joint : plain_skeleton().joints) {
    if (joint.parent < 0) continue;
    for (int round = 0; round < 5; ++round) {
      const Vec3 wanted(2 * angle(random), angle(random), angle(random));
      const Vec3 found =
          turn_angles(joint, turn_rotation(joint, wanted), wanted + Vec3(0.1, -0.1, 0.1));
      EXPECT_LT((found - wanted).norm(), 1e-9) << joint.name;
    }
    EXPECT_LT((turn_angles(joint, Quat::Identity(), joint.zero) - joint.zero).norm(), 1e-12)
        << joint.name;
  }
}

TEST(Coordinates, GoOnPastARightAngleAndAWholeTurn) {
  const Skeleton skeleton = plain_skeleton();
  const Joint& shoulder = skeleton.joints[find_joint(skeleton, "shoulder_l")];
  Vec3 last = shoulder.zero;
  for (int degrees = 0; degrees <= 170; degrees += 2) {
    const Vec3 wanted(0.3, degrees * kDegree, 0.2);
    if (degrees == 90) continue;  // there the first and the third axis are one
    last = turn_angles(shoulder, turn_rotation(shoulder, wanted), degrees == 0 ? wanted : last);
    EXPECT_LT((last - wanted).norm(), 1e-6) << degrees;
  }
  Vec3 root = Vec3::Zero();
  for (int degrees = 0; degrees <= 800; degrees += 10)
    root = root_angles(Quat(Eigen::AngleAxisd(degrees * kDegree, Vec3::UnitY())), root);
  EXPECT_NEAR(root[1], 800 * kDegree, 1e-9);
}

// Bending forward, to the body's own left and turning left, seen in OpenSim's axes: x forward, y
// up, z right.
TEST(Coordinates, OfTheRootAreOpenSims) {
  const auto about = [](const Vec3& axis) {
    return root_angles(Quat(Eigen::AngleAxisd(0.2, axis)), Vec3::Zero());
  };
  EXPECT_LT((about(Vec3::UnitZ()) - Vec3(0.2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((about(Vec3::UnitY()) - Vec3(0, 0.2, 0)).norm(), 1e-12);
  EXPECT_LT((about(-Vec3::UnitX()) - Vec3(0, 0, 0.2)).norm(), 1e-12);
}

TEST(Coordinates, NameWhatMoves) {
  const Skeleton skeleton = plain_skeleton();
  for (const Coordinate& one : model_coordinates(skeleton)) {
    const Joint& joint = skeleton.joints[one.joint];
    EXPECT_TRUE(one.name.starts_with(joint.name + "_")) << one.name;
    EXPECT_GT(joint.max[one.axis] - joint.min[one.axis], 4.4 * kDegree) << one.name;
    EXPECT_GE(joint.parent, 0);
  }
}

}  // namespace
}  // namespace ecorche
