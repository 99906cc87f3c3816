// Activations of walking beside what electromyography has found, and what muscles cannot give.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "anatomy/files/csv_table.h"
#include "anatomy/posing/posing_table.h"
#include "app/files/actor.h"
#include "morph/fit/fit_character.h"
#include "morph/shapes/body_model.h"
#include "morph/shapes/standard_bodies.h"
#include "skinning/dynamics/segment_inertia.h"
#include "skinning/dynamics/static_optimization.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/body_fixture.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 100;       // of a stride
constexpr double kOn = 0.2;       // of a muscle's largest
constexpr double kStands = 0.05;  // of the weight

struct Timing {
  std::string muscles, against;
  double from = 0, to = 0;
  std::vector<char> found = std::vector<char>(kParts, 0);
  bool asked(int part) const {
    const double at = part + 0.5;
    return (at >= from && at < to) || at + 100 < to;
  }
};

std::map<std::string, Timing> read_timings() {
  const Table table(fs::path(ECORCHE_TEST_DIR) / "muscles/gait_timing.csv");
  std::map<std::string, Timing> out;
  for (int row = 0; row < table.rows(); ++row) {
    Timing& one = out[table.text(row, "name")];
    one.muscles = table.text(row, "muscles");
    one.against = table.text(row, "against");
    one.from = table.number(row, "from");
    one.to = table.number(row, "to");
  }
  return out;
}

// Touchdowns of a foot, s.
std::vector<double> touchdowns(const MotionDynamics& dynamics, std::size_t foot) {
  std::vector<double> out;
  const auto stands = [&](std::size_t f) {
    return dynamics.frames[f].feet[foot].force.y() > kStands * dynamics.weight;
  };
  const std::size_t ahead = std::size_t(0.3 * dynamics.fps);
  for (std::size_t f = 1; f + ahead < dynamics.frames.size(); ++f) {
    if (stands(f - 1) || !stands(f)) continue;
    std::size_t count = 0;
    for (std::size_t g = f; g < f + ahead; ++g) count += stands(g);
    if (double(count) > 0.8 * double(ahead)) out.push_back(double(f) / dynamics.fps);
  }
  return out;
}

std::vector<int> muscles_of(const Anatomy& anatomy, const std::string& names, const char* side) {
  std::vector<int> out;
  std::istringstream words(names);
  for (std::string word; words >> word;)
    for (const int m : muscles_meant(anatomy, word + side)) out.push_back(m);
  return out;
}

// Mean of the strides of both legs.
void add_found(const Anatomy& anatomy, const MotionDynamics& dynamics,
               const Activations& activations, Timing& timing) {
  std::vector<double> mean(kParts, 0), now;
  for (const std::size_t foot : {0, 1}) {
    const std::vector<int> muscles = muscles_of(anatomy, timing.muscles, foot == 0 ? "_l" : "_r");
    ASSERT_FALSE(muscles.empty()) << timing.muscles;
    const std::vector<double> downs = touchdowns(dynamics, foot);
    ASSERT_GE(downs.size(), 2u);
    for (std::size_t k = 1; k < downs.size(); ++k)
      for (int part = 0; part < kParts; ++part) {
        activation_at(activations, std::lerp(downs[k - 1], downs[k], (part + 0.5) / kParts), now);
        for (const int m : muscles) mean[std::size_t(part)] += now[std::size_t(m)];
      }
  }
  const double most = *std::max_element(mean.begin(), mean.end());
  for (int part = 0; part < kParts; ++part)
    timing.found[std::size_t(part)] = most > 0 && mean[std::size_t(part)] > kOn * most;
}

class GaitActivationTest : public BodyFixture {
 protected:
  struct Walk {
    MotionDynamics dynamics;
    MuscleEfforts efforts;
    std::map<std::string, Timing> timings;
    double agreement = 0;  // mean share of the stride
    int inverted = 0;      // muscles that work rather when what is against them should
  };

  static const BoundCharacter& person() {
    static const BoundCharacter made = [] {
      const Body body = make_body(package(), BodySpec{});
      Report report;
      return bind_character(
          test_assets(), {fit_character(*the_template(), body, package()).anatomy, body}, report);
    }();
    return made;
  }

  static Walk walk(const fs::path& file) {
    const Anatomy& anatomy = person().character.anatomy;
    const Body& body = person().character.body;
    RetargetOptions options;
    options.sole_height = body.skin.V.col(1).minCoeff();
    RetargetReport report;
    const Motion motion = retarget(read_motion(file), anatomy.skeleton, options, report);
    const SegmentInertia inertia = segment_inertia(anatomy, body, person().binding.joint_weights);
    Walk out;
    out.dynamics =
        inverse_dynamics(anatomy.skeleton, inertia.segments, *options.sole_height, motion);
    out.efforts = static_optimization(make_posing_table(anatomy), anatomy, out.dynamics);
    out.timings = read_timings();
    const Activations activations = activations_of(out.efforts);
    for (auto& [name, timing] : out.timings) {
      add_found(anatomy, out.dynamics, activations, timing);
      int right = 0;
      for (int part = 0; part < kParts; ++part)
        right += bool(timing.found[std::size_t(part)]) == timing.asked(part);
      out.agreement += right / double(kParts) / double(out.timings.size());
      std::printf("[          ] %-20s %d %%\n", name.c_str(), right);
    }
    for (const auto& [name, timing] : out.timings) {
      const Timing& other = out.timings.at(timing.against);
      int right = 0, wrong = 0;
      for (std::size_t k = 0; k < kParts; ++k) {
        const bool mine = timing.asked(int(k)), theirs = other.asked(int(k));
        if (mine == theirs) continue;
        right += timing.found[k] == mine && other.found[k] == theirs;
        wrong += timing.found[k] == theirs && other.found[k] == mine;
      }
      out.inverted += wrong > right;
      if (wrong > right) std::printf("[          ] %s: inverted\n", name.c_str());
    }
    std::printf("[          ] %s: %.1f %%\n", file.filename().c_str(), 100 * out.agreement);
    return out;
  }
};

TEST_F(GaitActivationTest, MusclesGiveWhatWalkingAsks) {
  if (!the_template()) GTEST_SKIP() << "the data packages are not there (make setup)";
  const Walk own = walk(fs::path(ECORCHE_TEST_DIR) / "../data/motions/walk.bvh");
  EXPECT_GE(own.efforts.activations.minCoeff(), 0);
  EXPECT_LE(own.efforts.activations.maxCoeff(), 1);
  EXPECT_LT(own.efforts.reserve_share, 0.05);
  for (const JointReserve& joint : joint_reserves(own.efforts))
    EXPECT_LT(joint.reserve, 0.1 * joint.wanted + 3.5)
        << person().character.anatomy.skeleton.joints[std::size_t(joint.joint)].name;
  // made by hand: it presses and turns as nobody's recording does
  EXPECT_GT(own.agreement, 0.58);
}

TEST_F(GaitActivationTest, RecordedWalkIsTimedAsPeoplesMuscles) {
  if (!the_template()) GTEST_SKIP() << "the data packages are not there (make setup)";
  const fs::path file =
      fs::path(ECORCHE_SHARED_DIR) / "testdata/motion/cmu_cgspeed31/02_01_walk.bvh";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  const Walk found = walk(file);
  EXPECT_GE(found.agreement, 0.7);
  EXPECT_EQ(found.inverted, 0);
}

}  // namespace
}  // namespace ecorche
