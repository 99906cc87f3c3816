// Laws of secondary motion: the rate of the film does not matter, what stands still stays, and the
// oscillator is the exact one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "skinning/dynamics/soft_tissue.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace ecorche {
namespace {

struct Swing {
  test::Arm arm = test::make_arm();
  CharacterModel model = test::compile_figure(arm.anatomy, arm.skin);
  // The shoulder swings to and fro for two seconds and stops.
  Motion motion(double fps) const {
    Motion out;
    out.fps = fps;
    for (int f = 0; f <= 3 * fps; ++f) {
      const double t = f / fps, a = t < 2 ? 0.5 * std::pow(std::sin(std::numbers::pi * t), 2) : 0;
      Pose pose = rest_pose(arm.anatomy.skeleton);
      pose.rotations[2] = Quat(Eigen::AngleAxisd(a, Vec3::UnitX()));
      out.frames.push_back(pose);
    }
    return out;
  }
};

std::vector<float> seen_at(const Swing& swing, const SoftTissueTables& tables, const Motion& motion,
                           double time, const Activations& efforts = {}) {
  SoftTissueState state;
  for (int f = 0; f / motion.fps <= time + 1e-9; ++f)
    advance_soft_tissue(tables, swing.arm.anatomy.skeleton, motion, efforts, f / motion.fps, state);
  return state.offsets;
}

double largest_gap(const std::vector<float>& a, const std::vector<float>& b) {
  double gap = 0;
  for (std::size_t k = 0; k < a.size(); ++k) gap = std::max(gap, std::abs(double(a[k]) - b[k]));
  return gap;
}

TEST(FleshMotion, IsTheSameAtAnyRateOfTheFilm) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  ASSERT_FALSE(tables.vertices.empty());
  double moved = 0;
  for (const double time : {0.5, 1.25, 2.0, 2.5}) {
    const std::vector<float> slow = seen_at(swing, tables, swing.motion(24), time),
                             usual = seen_at(swing, tables, swing.motion(60), time),
                             fast = seen_at(swing, tables, swing.motion(240), time);
    for (const float v : fast) moved = std::max(moved, std::abs(double(v)));
    EXPECT_LT(largest_gap(slow, fast), 2e-3) << time;
    EXPECT_LT(largest_gap(usual, fast), 2e-3) << time;
  }
  EXPECT_GT(moved, 1e-3);
}

TEST(FleshMotion, WhatStandsStillStaysAndWhatStopsSettles) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  Motion still = swing.motion(30);
  for (Pose& pose : still.frames) pose = still.frames[7];
  for (const float v : seen_at(swing, tables, still, 2)) EXPECT_LT(std::abs(v), 1e-12f);
  const auto size = [&](double time) {
    double most = 0;
    for (const float v : seen_at(swing, tables, swing.motion(60), time))
      most = std::max(most, std::abs(double(v)));
    return most;
  };
  EXPECT_LT(size(3), 0.1 * size(1.9));
}

// A unit of speed without force: e^(-z w t) sin(w' t) / w'.
TEST(FleshMotion, StepsAreTheExactOscillator) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  const SoftTissueTables::Vertex& v = tables.vertices.front();
  const double h = 1.0 / 480, w = std::sqrt(-v.vu / v.uv),
               fall = std::log(v.uu * v.vv - v.uv * v.vu) / (2 * h);  // det = e^(-2 z w h)
  double u = 0, speed = 1;
  for (int step = 1; step <= 200; ++step) {
    const double next = v.uu * u + v.uv * speed;
    speed = v.vu * u + v.vv * speed;
    u = next;
    const double damped = std::sqrt(w * w - fall * fall), t = step * h;
    EXPECT_NEAR(u, std::exp(fall * t) * std::sin(damped * t) / damped, 1e-9);
  }
  // A steady acceleration leaves it where the spring balances it.
  u = speed = 0;
  for (int step = 0; step < 5000; ++step) {
    const double next = v.uu * u + v.uv * speed + v.ua * 2.0;
    speed = v.vu * u + v.vv * speed + v.va * 2.0;
    u = next;
  }
  EXPECT_NEAR(u, -2.0 / (w * w), 1e-9);
}

// The biceps works as hard as asked, always.
Activations effort(double level) { return {1, {{{0}, {0.0}, {level}}}}; }

double size_over(const SoftTissueTables& tables, const std::vector<float>& seen, bool muscle) {
  double most = 0;
  for (const SoftTissueTables::Vertex& v : tables.vertices) {
    const bool over = v.muscles[0].second + v.muscles[1].second + v.muscles[2].second > 0.5;
    if (over != muscle) continue;
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max(most, std::abs(double(seen[4 * v.place + k])));
  }
  return most;
}

TEST(FleshMotion, AMuscleThatWorksStiffensAndDampsWhatLiesOverIt) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  const Motion motion = swing.motion(60);
  double relaxed = 0, half = 0, full = 0;
  for (double time = 0.5; time < 2; time += 0.1) {
    relaxed = std::max(relaxed, size_over(tables, seen_at(swing, tables, motion, time), true));
    half =
        std::max(half, size_over(tables, seen_at(swing, tables, motion, time, effort(0.5)), true));
    full = std::max(full, size_over(tables, seen_at(swing, tables, motion, time, effort(1)), true));
  }
  ASSERT_GT(relaxed, 1e-3);
  EXPECT_LT(half, 0.7 * relaxed);
  EXPECT_LT(full, 0.5 * relaxed);
  // What lies over no muscle does as before, to the bit, and so does all where the muscle has
  // nothing to do.
  const std::vector<float> none = seen_at(swing, tables, motion, 1.3),
                           idle = seen_at(swing, tables, motion, 1.3, effort(0)),
                           work = seen_at(swing, tables, motion, 1.3, effort(1));
  EXPECT_EQ(none, idle);
  int free = 0;
  for (const SoftTissueTables::Vertex& v : tables.vertices) {
    if (v.muscles[0].second + v.muscles[1].second + v.muscles[2].second > 0) continue;
    ++free;
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(none[4 * v.place + k], work[4 * v.place + k]);
  }
  EXPECT_GT(free, 50);
}

TEST(FleshMotion, WithWorkTooTheRateOfTheFilmDoesNotMatter) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  const Activations efforts{1, {{{0}, {0.0, 0.7, 1.4, 3.0}, {0.0, 1.0, 0.2, 0.8}}}};
  for (const double time : {0.5, 1.25, 2.0, 2.5})
    EXPECT_LT(largest_gap(seen_at(swing, tables, swing.motion(24), time, efforts),
                          seen_at(swing, tables, swing.motion(240), time, efforts)),
              2e-3)
        << time;
}

TEST(FleshMotion, JumpingAboutEndsWherePlayingDoes) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  const Motion motion = swing.motion(60);
  SoftTissueState state;
  double most = 0;
  for (const double time : {1.5, 0.25, 2.0, 2.02, 1.0}) {
    seek_soft_tissue(tables, swing.arm.anatomy.skeleton, motion, {}, time, state);
    const std::vector<float> played = seen_at(swing, tables, motion, time);
    EXPECT_LT(largest_gap(state.offsets, played), 2e-4) << time;
    for (const float v : played) most = std::max(most, std::abs(double(v)));
  }
  EXPECT_GT(most, 1e-3);
}

TEST(FleshMotion, TimeDoesNotGoBack) {
  const Swing swing;
  const SoftTissueTables tables = make_soft_tissue(swing.model);
  SoftTissueState state;
  advance_soft_tissue(tables, swing.arm.anatomy.skeleton, swing.motion(30), {}, 1, state);
  EXPECT_THROW(
      advance_soft_tissue(tables, swing.arm.anatomy.skeleton, swing.motion(30), {}, 0.5, state),
      std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
