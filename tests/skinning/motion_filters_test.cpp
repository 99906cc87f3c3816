// Laws of filters: what mirrors, loops, warps of time, smoothing, blends, paths and slopes keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "anatomy/errors.h"
#include "skinning/constraints/contact_snaps.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/filters/edit_path.h"
#include "skinning/filters/mirror_motion.h"
#include "skinning/filters/motion_filters.h"
#include "skinning/filters/slope_ground.h"
#include "skinning/filters/smooth_frames.h"
#include "skinning/filters/warp_time.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {

const fs::path kMotions = fs::path(ECORCHE_TEST_DIR) / ".." / "data" / "motions";

const Skeleton& body() {
  static const Skeleton skeleton = plain_skeleton();
  return skeleton;
}

Motion played(const char* file, const std::vector<MotionFilter>& filters, RetargetReport& report,
              bool plant = true) {
  RetargetOptions options;
  options.filters = filters;
  options.plant_feet = plant;
  options.ballistic_flights = false;
  return retarget(read_motion(kMotions / file), body(), options, report);
}

// The walk with its planted feet, as filters find it.
const FilteredMotion& walk() {
  static const FilteredMotion out = [] {
    RetargetReport report;
    Motion motion = played("walk.bvh", {}, report);
    return FilteredMotion{.motion = std::move(motion), .contacts = report.contacts};
  }();
  return out;
}

// Largest distance of any joint between two poses, m.
double apart(const Pose& a, const Pose& b) {
  std::vector<Transform> Xa, Xb;
  forward_kinematics(body(), a, Xa);
  forward_kinematics(body(), b, Xb);
  double out = 0;
  for (std::size_t j = 0; j < Xa.size(); ++j)
    out = std::max(out, (Xa[j].translation() - Xb[j].translation()).norm());
  return out;
}

double apart(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.frames.size(), b.frames.size());
  double out = 0;
  for (std::size_t f = 0; f < std::min(a.frames.size(), b.frames.size()); ++f)
    out = std::max(out, apart(a.frames[f], b.frames[f]));
  return out;
}

Vec3 place_of(const Pose& pose, const char* joint) {
  std::vector<Transform> X;
  forward_kinematics(body(), pose, X);
  return X[std::size_t(find_joint(body(), joint))].translation();
}

// Mean square of the third differences of a wrist's path.
double jerk(const Motion& motion) {
  std::vector<Vec3> path;
  for (const Pose& pose : motion.frames) path.push_back(place_of(pose, "wrist_l"));
  double sum = 0;
  for (std::size_t f = 3; f < path.size(); ++f)
    sum += (path[f] - 3 * path[f - 1] + 3 * path[f - 2] - path[f - 3]).squaredNorm();
  return sum / double(path.size() - 3);
}

}  // namespace

TEST(MotionFilters, MirroredTwiceIsTheMotionItself) {
  FilteredMotion twice = walk();
  turn_motion(0.7, twice);
  const FilteredMotion given = twice;
  mirror_motion(body(), twice);
  EXPECT_GT(apart(twice.motion, given.motion), 0.05);
  EXPECT_NE(twice.contacts[0].side, given.contacts[0].side);
  // The left wrist goes where the right one went, as far from the plane.
  EXPECT_LT(apart(twice.motion.frames[0], given.motion.frames[0]), 0.8);
  mirror_motion(body(), twice);
  EXPECT_LT(apart(twice.motion, given.motion), 1e-9);
}

TEST(MotionFilters, AMirrorExchangesSides) {
  FilteredMotion mirrored = walk();
  mirror_motion(body(), mirrored);
  const GroundMove place = ground_place(walk().motion.frames[0]), back = inverse(place);
  for (const std::size_t f : {std::size_t(0), std::size_t(20)}) {
    const Vec3 left = back * place_of(walk().motion.frames[f], "ankle_l"),
               right = back * place_of(mirrored.motion.frames[f], "ankle_r");
    EXPECT_LT((right - Vec3(-left.x(), left.y(), left.z())).norm(), 1e-6);
  }
}

TEST(MotionFilters, TimeAtItsOwnSpeedIsTheMotion) {
  FilteredMotion same = walk();
  warp_time(1, same);
  EXPECT_EQ(apart(same.motion, walk().motion), 0);
  EXPECT_EQ(same.contacts.size(), walk().contacts.size());
}

TEST(MotionFilters, SlowTimeTakesAsLongAsSaidAndKeepsItsEnds) {
  FilteredMotion slow = walk();
  warp_time(0.5, slow);
  EXPECT_EQ(slow.motion.frames.size(), 2 * walk().motion.frames.size() - 1);
  EXPECT_LT(apart(slow.motion.frames.back(), walk().motion.frames.back()), 1e-9);
  EXPECT_NEAR(slow.gravity, 9.81 / 4, 1e-9);
  for (std::size_t c = 0; c < slow.contacts.size(); ++c)
    EXPECT_EQ(slow.contacts[c].begin, 2 * walk().contacts[c].begin);
  FilteredMotion fitted = walk();
  fit_length(2, fitted);
  EXPECT_NEAR(double(fitted.motion.frames.size() - 1) / fitted.motion.fps, 2, 0.02);
}

TEST(MotionFilters, FeetStayPlantedInAnyTime) {
  for (const double speed : {0.3, 2.0}) {
    RetargetReport report;
    played("walk.bvh", {WarpTime{speed}}, report);
    EXPECT_GT(report.contacts.size(), 4u);
    EXPECT_LT(report.slide_p95, 0.003);
    EXPECT_LT(report.penetration, 0.003);
    EXPECT_TRUE(report.limit_breaks.empty());
  }
}

TEST(MotionFilters, OneMotionAtAnyRateIsOneMotion) {
  FilteredMotion fine = walk(), back;
  change_rate(240, fine);
  back = fine;
  change_rate(walk().motion.fps, back);
  EXPECT_LT(apart(back.motion, walk().motion), 1e-3);
  EXPECT_EQ(fine.gravity, 9.81);
}

TEST(MotionFilters, SmoothingLowersJerkAndFeetStay) {
  RetargetReport before, after;
  const Motion raw = played("walk.bvh", {}, before),
               smooth = played("walk.bvh", {SmoothFrames{0.2}}, after);
  EXPECT_LT(jerk(smooth), 0.7 * jerk(raw));
  EXPECT_LT(after.slide_p95, before.slide_p95 + 0.001);
  EXPECT_LT(after.penetration, 0.003);
  EXPECT_EQ(after.contacts.size(), before.contacts.size());
  Motion kept = walk().motion;
  smooth_frames(0.2, kept);
  EXPECT_LT(apart(kept.frames.front(), walk().motion.frames.front()), 1e-6);
  EXPECT_LT(apart(kept.frames.back(), walk().motion.frames.back()), 1e-6);
}

TEST(MotionFilters, FeetAreAsFirmAsTheirLock) {
  RetargetReport none, weak, firm, usual;
  const Motion free = played("walk.bvh", {}, none, false),
               loose = played("walk.bvh", {LockFeet{0}}, weak),
               locked = played("walk.bvh", {LockFeet{1}}, firm),
               planted = played("walk.bvh", {}, usual);
  EXPECT_EQ(apart(locked, planted), 0);
  RetargetReport half;
  played("walk.bvh", {LockFeet{0.5}}, half);
  EXPECT_LT(firm.slide_p95, half.slide_p95);
  EXPECT_LT(half.slide_p95, weak.slide_p95);
}

TEST(MotionFilters, ALoopHasNoSeam) {
  for (const bool travel : {true, false}) {
    RetargetReport report;
    const Motion loop = played("walk.bvh", {LoopOptions{.keep_travel = travel}}, report);
    const std::size_t n = loop.frames.size();
    // What the first frames are in the next round.
    const GroundMove round = travel ? [&] {
      // The seam's own step is as the last one's: places of the root go on.
      const Vec3 step = loop.frames[n - 1].root - loop.frames[n - 2].root;
      GroundMove move;
      move.shift = loop.frames[n - 1].root + step - loop.frames[0].root;
      move.shift.y() = 0;
      return move;
    }() : GroundMove{};
    std::vector<Pose> next(loop.frames.begin(), loop.frames.begin() + 3);
    for (Pose& pose : next) move_pose(round, pose);
    double usual = 0, bend = 0;
    for (std::size_t f = 1; f + 1 < n; ++f) {
      usual = std::max(usual, apart(loop.frames[f], loop.frames[f - 1]));
      for (const char* joint : {"wrist_l", "ankle_l", "ankle_r", "head"})
        bend = std::max(bend,
                        (place_of(loop.frames[f + 1], joint) - 2 * place_of(loop.frames[f], joint) +
                         place_of(loop.frames[f - 1], joint))
                            .norm());
    }
    EXPECT_LT(apart(next[0], loop.frames[n - 1]), 1.1 * usual);
    for (const char* joint : {"wrist_l", "ankle_l", "ankle_r", "head"})
      EXPECT_LT((place_of(next[1], joint) - 2 * place_of(next[0], joint) +
                 place_of(loop.frames[n - 1], joint))
                    .norm(),
                1.2 * bend)
          << joint;
    if (!travel) {
      EXPECT_LT((loop.frames[n - 1].root - loop.frames[0].root).norm(), 0.05);
    }
    EXPECT_LT(report.slide_p95, 0.003);
    EXPECT_TRUE(report.limit_breaks.empty());
  }
}

TEST(MotionFilters, ABlendIsItsSourcesOutsideOfItself) {
  FilteredMotion second = walk();
  mirror_motion(body(), second);
  const Motion in_place = second.motion;
  turn_motion(1, second);
  EXPECT_NEAR(std::remainder(ground_place(second.motion.frames[9]).yaw -
                                 ground_place(in_place.frames[9]).yaw - 1,
                             6.283185307),
              0, 1e-6);
  for (const double share : {0.0, 1.0}) {
    FilteredMotion mixed = walk();
    mix_with(second, share, mixed);
    EXPECT_LT(apart(mixed.motion, share == 0 ? walk().motion : in_place), 1e-9);
  }
  FilteredMotion both = walk();
  go_over_to("walk", second, {1.0, 0.3}, both);
  const double fps = both.motion.fps;
  const int begin = int(fps), end = int(1.3 * fps);
  for (int f = 0; f < begin; ++f)
    EXPECT_EQ(apart(both.motion.frames[std::size_t(f)], walk().motion.frames[std::size_t(f)]), 0);
  // From there on the second one's own movement, from another place.
  const GroundMove moved =
      ground_place(both.motion.frames.back()) * inverse(ground_place(second.motion.frames.back()));
  for (const int f : {end + 1, end + 20}) {
    Pose own = second.motion.frames[std::size_t(f - begin)];
    move_pose(moved, own);
    EXPECT_LT(apart(both.motion.frames[std::size_t(f)], own), 1e-6);
  }
  EXPECT_THROW(go_over_to("walk", second, {1e3, 0.3}, both), UnfitError);
}

TEST(MotionFilters, AStraightPathIsStraightAndAsLong) {
  FilteredMotion bent = walk();
  bend_path("walk", kDegree * 90, bent);
  const auto heading = [](const FilteredMotion& one) {
    const Pose &a = one.motion.frames[one.motion.frames.size() - 40], &b = one.motion.frames.back();
    return std::atan2(b.root.x() - a.root.x(), b.root.z() - a.root.z());
  };
  EXPECT_NEAR(std::remainder(heading(bent) - heading(walk()), 6.283185), kDegree * 90,
              kDegree * 12);
  FilteredMotion straight = bent;
  straighten_path("walk", straight);
  const Vec3 first = straight.motion.frames.front().root, last = straight.motion.frames.back().root;
  const Vec3 way = (last - first).normalized();
  for (const Pose& pose : straight.motion.frames) {
    Vec3 off = pose.root - first;
    off -= off.dot(way) * way;
    off.y() = 0;
    EXPECT_LT(off.norm(), 0.08);
  }
  EXPECT_NEAR((last - first).norm(),
              (walk().motion.frames.back().root - walk().motion.frames.front().root).norm(), 0.1);
  FilteredMotion still{.motion = {30, std::vector<Pose>(9, rest_pose(body()))}};
  EXPECT_THROW(straighten_path("still", still), UnfitError);
}

TEST(MotionFilters, AFigureFollowsPoints) {
  FilteredMotion led = walk();
  follow_points("walk", {{3, 1}, {4, 1}, {5, 1}}, led);
  EXPECT_LT(std::abs(led.motion.frames.front().root.x() - 3), 0.1);
  for (const Pose& pose : led.motion.frames) EXPECT_LT(std::abs(pose.root.z() - 1), 0.1);
  EXPECT_GT(led.motion.frames.back().root.x(), led.motion.frames.front().root.x() + 1);
}

TEST(MotionFilters, FeetOnASlopeStandOnIt) {
  for (const double angle : {8 * kDegree, -8 * kDegree}) {
    Motion up = walk().motion;
    const double sole = guess_sole_height(body());
    put_on_slope(body(), sole, angle, up);
    const Transform level = slope_of(walk().motion, angle).inverse();
    EXPECT_NEAR(up.frames.back().root.y() - up.frames.front().root.y(),
                std::sin(angle) *
                    (walk().motion.frames.back().root - walk().motion.frames.front().root).norm(),
                0.06);
    std::vector<Transform> X, X0;
    double worst = 0;
    for (std::size_t f = 0; f < up.frames.size(); ++f) {
      forward_kinematics(body(), up.frames[f], X);
      forward_kinematics(body(), walk().motion.frames[f], X0);
      for (const Side side : {Side::left, Side::right}) {
        const FootShape foot = foot_shape(body(), side, sole);
        const FootPoints now = foot_points(body(), foot, X), then = foot_points(body(), foot, X0);
        worst = std::max(
            {worst, (level * now.heel - then.heel).norm(), (level * now.ball - then.ball).norm()});
      }
    }
    EXPECT_LT(worst, 0.002);
  }
}

TEST(ContactSnaps, AKneeThatLeapsTellsItsContactAlone) {
  using Snaps = std::vector<std::vector<int>>;
  const Motion still{60, std::vector<Pose>(60, rest_pose(body()))};
  const std::vector<Contact> contacts = {{Side::left, true, 10, 20, 0},
                                         {Side::left, false, 40, 50, 0},
                                         {Side::right, true, 10, 20, 0}};
  EXPECT_EQ(contact_snaps(body(), still, still, contacts), Snaps(3));
  Motion leaps = still;
  for (std::size_t f = 15; f < 60; ++f)
    leaps.frames[f].rotations[std::size_t(find_joint(body(), "hip_l"))] =
        Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  const Snaps snaps = contact_snaps(body(), still, leaps, contacts);
  ASSERT_FALSE(snaps[0].empty());
  for (const int f : snaps[0]) EXPECT_EQ(f, 14);
  EXPECT_TRUE(snaps[1].empty());
  EXPECT_TRUE(snaps[2].empty());
  // What leaps without planting too is the recording's.
  EXPECT_EQ(contact_snaps(body(), leaps, leaps, contacts), Snaps(3));
}

TEST(ContactSnaps, OnlyWhatIsAroundASnapIsLetGo) {
  const std::vector<Contact> contacts = {
      {Side::left, true, 0, 120, 0, 0.3, 0.4}, {Side::right, true, 50, 60}, {Side::right, false}};
  const std::vector<std::vector<int>> snaps = {{60}, {55}, {}};
  const std::vector<Contact> left = contacts_between_snaps(contacts, snaps, 0.15, 60);
  ASSERT_EQ(left.size(), 3);
  EXPECT_EQ(left[0].begin, 0);
  EXPECT_EQ(left[0].end, 50);  // 0.15 s and a frame before the snap
  EXPECT_EQ(left[0].early, 0.3);
  EXPECT_EQ(left[0].late, 0);
  EXPECT_EQ(left[1].begin, 71);
  EXPECT_EQ(left[1].end, 120);
  EXPECT_EQ(left[1].late, 0.4);
  EXPECT_EQ(left[2].side, Side::right);
  EXPECT_FALSE(left[2].heel);
  // Of a snap after its end, where it fades out, the end is let go.
  const std::vector<Contact> ends = contacts_between_snaps(contacts, {{130}, {}, {}}, 0.05, 60);
  ASSERT_EQ(ends.size(), 3);
  EXPECT_EQ(ends[0].end, 115);
  EXPECT_EQ(ends[0].late, 0);
  EXPECT_EQ(contacts_between_snaps(contacts, snaps, HUGE_VAL, 60).size(), 1);
}
