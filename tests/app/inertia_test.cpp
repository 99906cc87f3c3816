// Segments of fitted bodies: they weigh what the body weighs, left as right, and near what
// anthropometrists found; scaling a body scales them by the rule of the statistics paper.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <map>

#include "app/files/actor.h"
#include "morph/fit/fit_character.h"
#include "morph/shapes/body_model.h"
#include "morph/shapes/standard_bodies.h"
#include "skinning/dynamics/segment_inertia.h"
#include "tests/body_fixture.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

class InertiaTest : public BodyFixture {
 protected:
  static BoundCharacter fitted(const Template& tmpl, Sex sex) {
    BodySpec spec;
    spec.sex = sex;
    const Body body = make_body(package(), spec);
    Report report;
    return bind_character(test_assets(), {fit_character(tmpl, body, package()).anatomy, body},
                          report);
  }
};

std::map<std::string, BodySegment> by_name(const SegmentInertia& found) {
  std::map<std::string, BodySegment> out;
  for (const BodySegment& segment : found.segments) out[segment.name] = segment;
  return out;
}

TEST_F(InertiaTest, SegmentsOfPeople) {
  NEED_TEMPLATE();
  for (const Sex sex : {Sex::male, Sex::female}) {
    const BoundCharacter person = fitted(tmpl, sex);
    const SegmentInertia found = segment_inertia(person.character.anatomy, person.character.body,
                                                 person.binding.joint_weights);
    EXPECT_GE(found.segments.size(), 16u);
    double sum = 0;
    for (const BodySegment& segment : found.segments) sum += segment.mass;
    EXPECT_NEAR(sum, person.character.body.mass, 1e-9 * sum);
    EXPECT_NEAR(found.tissue_mass / found.mass, 1, 0.04);
    auto segments = by_name(found);
    const auto share = [&](const char* name) { return segments.at(name).mass / sum; };
    for (const char* name : {"upper_arm", "forearm", "hand", "thigh", "shank", "foot"}) {
      const BodySegment &l = segments.at(std::string(name) + "_l"),
                        &r = segments.at(std::string(name) + "_r");
      EXPECT_NEAR(l.mass / r.mass, 1, 0.03) << name;
      EXPECT_LT((l.center - Vec3(-r.center.x(), r.center.y(), r.center.z())).norm(), 0.005) << name;
    }
    // de Leva 1996, men's and women's in one: shapes and cuts of people differ by so much
    EXPECT_NEAR(share("head") + share("neck"), 0.068, 0.012);
    EXPECT_NEAR(share("upper_trunk") + share("middle_trunk") + share("lower_trunk"), 0.43, 0.04);
    EXPECT_NEAR(share("upper_arm_l"), 0.0265, 0.009);
    EXPECT_NEAR(share("forearm_l"), 0.015, 0.003);
    EXPECT_NEAR(share("hand_l"), 0.0058, 0.002);
    EXPECT_NEAR(share("thigh_l"), 0.145, 0.025);
    EXPECT_NEAR(share("shank_l"), 0.0457, 0.007);
    EXPECT_NEAR(share("foot_l"), 0.0133, 0.005);
    // what turns about is inside, and inertias are those of solids: no axis has more than the
    // others together
    for (const BodySegment& segment : found.segments) {
      const Eigen::SelfAdjointEigenSolver<Mat3> solver(segment.inertia);
      const Vec3 moments = solver.eigenvalues();
      EXPECT_GT(moments[0], 0) << segment.name;
      EXPECT_LT(moments[2], (moments[0] + moments[1]) * (1 + 1e-9)) << segment.name;
    }
  }
}

TEST(ScaledSegment, FollowsTheSolid) {
  // a box of 1, 2, 3 m and 6 kg that becomes one of 2, 3, 1.5 m
  const auto box = [](const Vec3& size, double mass) {
    Mat3 inertia = Mat3::Zero();
    for (int k = 0; k < 3; ++k)
      inertia(k, k) = mass / 12 * (size.squaredNorm() - size[k] * size[k]);
    return inertia;
  };
  const BodySegment before{"box", 0, 6, {0.5, 1, 1.5}, box({1, 2, 3}, 6)};
  const BodySegment after = scaled_segment(before, {2, 1.5, 0.5});
  EXPECT_NEAR(after.mass, 9, 1e-12);
  EXPECT_LT((after.center - Vec3(1, 1.5, 0.75)).norm(), 1e-12);
  EXPECT_LT((after.inertia - box({2, 3, 1.5}, 9)).norm(), 1e-9);
}

}  // namespace
}  // namespace ecorche
