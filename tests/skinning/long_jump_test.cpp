// Our own motions keep what they promise, as files and on our skeleton: planted feet stand, flights
// fall, nothing sinks.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "anatomy/joint_angles.h"
#include "skinning/motion/shoulder_rhythm.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;

namespace {
MotionClip own_motion(const char* name) {
  return read_motion(std::string(ECORCHE_TEST_DIR) + "/../data/motions/" + name);
}

// Points of a foot, metres, by frame.
struct Foot {
  std::vector<Vec3> heel, ball, tip;
};

// The file's own figure: feet, and the centre of mass by Winter's segment table on its joints.
struct FileFigure {
  std::map<std::string, Foot> feet;
  std::vector<Vec3> center;
};

FileFigure follow(const MotionClip& file) {
  std::map<std::string, int> id;
  for (size_t j = 0; j < file.joints.size(); ++j) id[file.joints[j].name] = int(j);
  FileFigure out;
  std::vector<Transform> X;
  for (int f = 0; f < file.frame_count; ++f) {
    clip_kinematics(file, f, X);
    auto point = [&](const std::string& joint, const Vec3& place) {
      return Vec3(0.01 * (X[id.at(joint)] * (100 * place)));
    };
    auto at = [&](const std::string& joint) { return point(joint, Vec3::Zero()); };
    Vec3 sum = 0.142 * point("Hips", {0, 0.05, -0.01}) + 0.139 * point("Spine", {0, 0.085, 0.01}) +
               0.216 * point("Spine1", {0, 0.17, 0.012}) + 0.081 * point("Neck", {0, 0.165, 0.022});
    for (const std::string s : {"Left", "Right"}) {
      Foot& foot = out.feet[s];
      foot.heel.push_back(point(s + "Foot", {0, -0.072, -0.055}));
      foot.ball.push_back(at(s + "ToeBase"));
      foot.tip.push_back(point(s + "ToeBase", {0, 0, 0.08}));
      auto between = [&](const std::string& a, const std::string& b, double share) {
        return Vec3(at(a) + share * (at(b) - at(a)));
      };
      sum += 0.028 * between(s + "Arm", s + "ForeArm", 0.436) +
             0.016 * between(s + "ForeArm", s + "Hand", 0.430) +
             0.006 * point(s + "Hand", {0, -0.08, 0}) +
             0.1 * between(s + "UpLeg", s + "Leg", 0.433) +
             0.0465 * between(s + "Leg", s + "Foot", 0.433) +
             0.0145 * point(s + "Foot", {0, -0.04, 0.055});
    }
    out.center.push_back(sum);
  }
  return out;
}

// Our posed figure, the same way, from joint positions alone.
Vec3 our_center(const Skeleton& skeleton, const std::vector<Transform>& X) {
  auto at = [&](const std::string& name) {
    return Vec3(X[find_joint(skeleton, name)].translation());
  };
  auto between = [&](const std::string& a, const std::string& b, double share) {
    return Vec3(at(a) + share * (at(b) - at(a)));
  };
  Vec3 sum = 0.142 * between("pelvis", "l5", 0.6) + 0.139 * between("l4", "t12", 0.6) +
             0.216 * between("thorax", "c7", 0.6) +
             0.081 * (at("head") + 0.4 * (at("head") - at("c7")));
  for (const std::string s : {"_l", "_r"})
    sum += 0.028 * between("shoulder" + s, "elbow" + s, 0.436) +
           0.016 * between("elbow" + s, "wrist" + s, 0.43) +
           0.006 * between("wrist" + s, "mcp3" + s, 0.8) +
           0.1 * between("hip" + s, "knee" + s, 0.433) +
           0.0465 * between("knee" + s, "ankle" + s, 0.433) +
           0.0145 * between("ankle" + s, "mtp2" + s, 0.45);
  return sum;
}

// Gravity of the best parabola through y(t), and how far the points are from it.
std::pair<double, double> fall(const std::vector<Vec3>& path, int begin, int end, double fps) {
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (int f = begin; f < end; ++f) {
    const double t = (f - begin) / fps;
    const Vec3 row(1, t, t * t);
    A += row * row.transpose();
    b += row * path[f].y();
  }
  const Vec3 c = A.ldlt().solve(b);
  double off = 0;
  for (int f = begin; f < end; ++f) {
    const double t = (f - begin) / fps;
    off = std::max(off, std::abs(c.dot(Vec3(1, t, t * t)) - path[f].y()));
  }
  return {-2 * c[2], off};
}

// The longest span without a foot on the ground.
std::pair<int, int> longest_flight(const std::vector<double>& lowest, double touching) {
  std::pair<int, int> best{0, 0};
  for (int f = 0; f < int(lowest.size()); ++f) {
    int end = f;
    while (end < int(lowest.size()) && lowest[end] > touching) ++end;
    if (end - f > best.second - best.first) best = {f, end};
    f = std::max(f, end);
  }
  return best;
}

std::vector<double> lowest_points(const FileFigure& figure) {
  std::vector<double> out(figure.center.size(), 1e9);
  for (const auto& [side, foot] : figure.feet)
    for (size_t f = 0; f < out.size(); ++f)
      out[f] = std::min({out[f], foot.heel[f].y(), foot.ball[f].y(), foot.tip[f].y()});
  return out;
}

// Largest horizontal travel of a point while it is on the ground (half a millimetre) in two frames
// or more; frames in `sand` are left out.
double largest_slide(const std::vector<Vec3>& point, std::pair<int, int> sand) {
  double largest = 0;
  for (size_t f = 0; f < point.size(); ++f) {
    size_t end = f;
    auto down = [&](size_t g) {
      const bool free = int(g) >= sand.first && int(g) < sand.second;
      return !free && point[g].y() < 5e-4;
    };
    while (end < point.size() && down(end)) ++end;
    for (size_t a = f; a < end; ++a)
      largest =
          std::max(largest, std::hypot(point[a].x() - point[f].x(), point[a].z() - point[f].z()));
    f = std::max(f, end);
  }
  return largest;
}

}  // namespace

TEST(LongJump, IsLongEnoughAndRunsUpOnSixStridesAndMore) {
  const MotionClip file = own_motion("long_jump.bvh");
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(file.fps, 60);
  EXPECT_GE(file.frame_count / file.fps, 5);
  const FileFigure figure = follow(file);
  const auto flight = longest_flight(lowest_points(figure), 2e-3);
  int touchdowns = 0;
  for (const auto& [side, foot] : figure.feet)
    for (int f = 1; f < flight.first; ++f)
      touchdowns += foot.ball[f].y() < 1e-3 && foot.ball[f - 1].y() >= 1e-3;
  EXPECT_GE(touchdowns, 12);
  // Off from the left foot, before the line at z = 0.
  EXPECT_LT(figure.feet.at("Left").tip[flight.first - 2].y(), 0.02);
  EXPECT_GT(figure.feet.at("Right").tip[flight.first - 2].y(), 0.2);
  EXPECT_LT(figure.feet.at("Left").tip[flight.first - 2].z(), 0.0);
  const double mark = std::min(figure.feet.at("Left").heel[flight.second].z(),
                               figure.feet.at("Right").heel[flight.second].z());
  EXPECT_GT(mark, 7.0);
  EXPECT_LT(mark, 7.5);
}

TEST(LongJump, FlightIsAFreeFall) {
  const MotionClip file = own_motion("long_jump.bvh");
  const FileFigure figure = follow(file);
  const auto flight = longest_flight(lowest_points(figure), 2e-3);
  const double seconds = (flight.second - flight.first) / file.fps;
  EXPECT_NEAR(seconds, 0.775, 0.03);
  const auto [gravity, off] = fall(figure.center, flight.first + 1, flight.second - 1, file.fps);
  EXPECT_NEAR(gravity, 9.81, 0.02 * 9.81);
  EXPECT_LT(off, 0.005);
  const int last = flight.second - 2, first = flight.first + 1;
  EXPECT_NEAR((figure.center[last].z() - figure.center[first].z()) * file.fps / (last - first), 8.4,
              0.2);
}

TEST(LongJump, PlantedFeetStandAndNothingSinks) {
  for (const char* name : {"long_jump.bvh", "walk.bvh"}) {
    SCOPED_TRACE(name);
    const FileFigure figure = follow(own_motion(name));
    const std::vector<double> lowest = lowest_points(figure);
    EXPECT_GT(*std::min_element(lowest.begin(), lowest.end()), -0.001);
    // In the pit the heels plough through the sand for 0.15 s on purpose.
    const auto flight = longest_flight(lowest, 2e-3);
    const std::pair<int, int> sand = std::string(name) == "long_jump.bvh"
                                         ? std::pair{flight.second - 1, flight.second + 11}
                                         : std::pair{0, 0};
    for (const auto& [side, foot] : figure.feet) {
      EXPECT_LT(largest_slide(foot.heel, sand), 0.005) << side;
      EXPECT_LT(largest_slide(foot.ball, sand), 0.005) << side;
    }
  }
}

TEST(LongJump, OnOurSkeletonFeetStandAndTheFlightFalls) {
  for (const double size : {1.0, 0.85, 1.15}) {
    SCOPED_TRACE(size);
    const Skeleton skeleton = plain_skeleton(size);
    const MotionClip file = own_motion("long_jump.bvh");
    const std::vector<Vec3> rest = rest_positions(skeleton);
    const double sole = rest[find_joint(skeleton, "mtp2_l")].y() - 0.024 * size;
    RetargetOptions options;
    options.sole_height = sole;
    RetargetReport report;
    const Motion motion = retarget(file, skeleton, options, report);
    EXPECT_EQ(report.unit, "cm");
    EXPECT_EQ(report.facing, "+z");
    EXPECT_LT(report.slide_p95, 0.005);
    EXPECT_LT(report.penetration, 0.005);
    EXPECT_GE(report.contacts.size(), 30u);

    // Measured here once more: soles as three points of our own under the joints.
    std::vector<Vec3> center;
    std::vector<double> lowest;
    std::vector<Transform> X;
    for (const Pose& pose : motion.frames) {
      forward_kinematics(skeleton, pose, X);
      center.push_back(our_center(skeleton, X));
      double low = 1e9;
      for (const std::string s : {"_l", "_r"}) {
        const int foot = find_joint(skeleton, "subtalar" + s),
                  ankle = find_joint(skeleton, "ankle" + s), toe = find_joint(skeleton, "mtp2" + s);
        low = std::min(
            low,
            (X[foot] * (Vec3(rest[ankle].x(), sole, rest[ankle].z() - 0.045 * size) - rest[foot]))
                .y());
        low =
            std::min(low, (X[foot] * (Vec3(rest[toe].x(), sole, rest[toe].z()) - rest[foot])).y());
      }
      lowest.push_back(low);
    }
    EXPECT_GT(*std::min_element(lowest.begin(), lowest.end()), -0.008);
    const auto theirs = longest_flight(lowest_points(follow(file)), 2e-3),
               ours = longest_flight(lowest, 0.03);
    EXPECT_NEAR(ours.second - ours.first, theirs.second - theirs.first,
                3);  // jump's flight time, frames
    const auto [gravity, off] = fall(center, ours.first + 2, ours.second - 3, motion.fps);
    EXPECT_NEAR(gravity, 9.81, 0.02 * 9.81);
    EXPECT_LT(off, 0.005);
    // No frame is a jump for any joint: less than 30 deg in 1/60 s, the root no faster than 12 m/s.
    for (size_t f = 1; f < motion.frames.size(); ++f) {
      ASSERT_LT((motion.frames[f].root - motion.frames[f - 1].root).norm() * motion.fps, 12) << f;
      for (size_t j = 0; j < skeleton.joints.size(); ++j)
        ASSERT_LT(motion.frames[f].rotations[j].angularDistance(motion.frames[f - 1].rotations[j]),
                  45 * kDegree)
            << skeleton.joints[j].name << " " << f;
    }
  }
}

TEST(LongJump, ClampedItStaysInsideAllLimits) {
  const Skeleton skeleton = plain_skeleton();
  RetargetOptions options;
  options.clamp_limits = true;
  for (const char* name : {"long_jump.bvh", "walk.bvh"}) {
    RetargetReport report;
    retarget(own_motion(name), skeleton, options, report);
    EXPECT_TRUE(report.limit_breaks.empty()) << report.limit_breaks.front().joint;
  }
}

TEST(JointLimits, AnglesAndRotationsAreTheSame) {
  const Skeleton skeleton = plain_skeleton();
  for (const Joint& joint : skeleton.joints) {
    EXPECT_LT((joint_angles(joint, Quat::Identity()) - joint.zero).norm(), 1e-9) << joint.name;
    for (const Vec3& angles : {Vec3(0.3, -0.2, 0.4), Vec3(-1.2, 0.5, 0.1)})
      EXPECT_LT((joint_angles(joint, joint_rotation(joint, angles)) - angles).norm(), 1e-9)
          << joint.name;
  }
  // A knee that is bent by 40 deg about its axis has flexion 40; a leg swung outwards has
  // abduction, left and right alike.
  const Joint& knee = skeleton.joints[find_joint(skeleton, "knee_l")];
  EXPECT_NEAR(joint_angles(knee, Quat(Eigen::AngleAxisd(40 * kDegree, Vec3::UnitX())))[0],
              40 * kDegree, 1e-9);
  const Joint &left = skeleton.joints[find_joint(skeleton, "hip_l")],
              &right = skeleton.joints[find_joint(skeleton, "hip_r")];
  EXPECT_NEAR(joint_angles(left, Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ())))[1], 0.3, 1e-9);
  EXPECT_NEAR(joint_angles(right, Quat(Eigen::AngleAxisd(-0.3, Vec3::UnitZ())))[1], 0.3, 1e-9);
}

TEST(ShoulderRhythm, RaisingTheArmLiftsAndTurnsTheGirdleOnBothSidesAlike) {
  const Vec3 rest = Vec3(0.6, -0.75, 0).normalized(), raised = Vec3(0.6, 0.75, 0).normalized(),
             mirror(-1, 1, 1);
  const Girdle none = girdle_rhythm(Side::left, rest, rest);
  EXPECT_LT(none.clavicle.angularDistance(Quat::Identity()), 1e-12);
  EXPECT_LT(none.scapula.angularDistance(Quat::Identity()), 1e-12);
  const Girdle left = girdle_rhythm(Side::left, rest, raised);
  const Girdle right =
      girdle_rhythm(Side::right, mirror.cwiseProduct(rest), mirror.cwiseProduct(raised));
  // The outer end of the collar bone rises and goes back.
  const Vec3 outer = left.clavicle * Vec3::UnitX();
  EXPECT_GT(outer.y(), 0.1);
  EXPECT_LT(outer.z(), -0.1);
  EXPECT_LT((mirror.cwiseProduct(right.clavicle * -Vec3::UnitX()) - outer).norm(), 1e-12);
  EXPECT_LT(
      (mirror.cwiseProduct(right.scapula * Vec3::UnitY()) - left.scapula * Vec3::UnitY()).norm(),
      1e-12);
  // 1.5 : 1 of arm to shoulder blade: 0.396 of the elevation, to a few degrees for the tilt that
  // goes with it.
  const double elevation = std::acos(rest.dot(raised));
  EXPECT_NEAR(left.scapula.angularDistance(Quat::Identity()), 0.44 * elevation, 0.06 * elevation);
}
