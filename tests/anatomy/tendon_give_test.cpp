// Laws of the balance of fibre and tendon, and of what effort does to a posed muscle.
#include "anatomy/muscles/tendon_compliance.h"

#include <gtest/gtest.h>

#include "anatomy/posing/pose_anatomy.h"
#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {
struct Published {
  const char* name;
  MuscleTendon muscle;
  double low, high;  // m, shortening along the path at full effort, tendon strains of 3.3 to 4.9 %
};

// Fibre and path lengths as in gait models; the range of the path shortening after methods with
// both tendon stiffnesses in use.
const Published kPublished[] = {
    {"tibialis anterior", {0.068, 10 * kDegree, 0.29}, 0.007, 0.0115},
    {"gastrocnemius medialis", {0.051, 10 * kDegree, 0.44}, 0.011, 0.017},
    {"vastus lateralis", {0.099, 15 * kDegree, 0.22}, 0.004, 0.007},
    {"soleus", {0.044, 28 * kDegree, 0.30}, 0.007, 0.012}};

// The balance by plain search over a fine grid: independent of the solver.
double searched(const MuscleTendon& m, double path, double activation) {
  const double rise = m.fibre * std::sin(m.pennation),
               slack = m.path - m.fibre * std::cos(m.pennation);
  double along = path - slack;
  for (;; along -= 1e-6) {
    const double fibre = std::hypot(along, rise), l = fibre / m.fibre,
                 e = (path - along) / slack - 1;
    const double active = activation * std::exp(-std::pow(l - 1, 2) / 0.45);
    const double passive = l > 1 ? std::expm1(4 * (l - 1) / 0.6) / std::expm1(4) : 0;
    const double toe = 0.609 * 0.049;
    const double tendon = e <= 0    ? 0
                          : e < toe ? 0.33 * std::expm1(3 * e / toe) / std::expm1(3)
                                    : 0.33 + 1.712 / 0.049 * (e - toe);
    if ((active + passive) * along / fibre <= tendon) return along;
  }
}

Anatomy fibred_arm() {
  Anatomy anatomy = arm_anatomy();
  for (Muscle& muscle : anatomy.muscles) {
    muscle.fibre_length = 0.5 * muscle.strips[0].rest_length;
    muscle.pennation = 5 * kDegree;
  }
  return anatomy;
}

double widest(const PosedAnatomy& posed, const SliceRange& range) {
  double area = 0;
  for (int k = range.begin; k < range.end; ++k) area = std::max(area, posed.slices[k].radii.prod());
  return area;
}

}  // namespace

TEST(TendonCompliance, ShorteningAtFullEffortIsAsPublished) {
  for (const Published& p : kPublished) {
    const double found = isometric_shortening(p.muscle, p.muscle.path, 1);
    EXPECT_GE(found, p.low) << p.name;
    EXPECT_LE(found, p.high) << p.name;
  }
}

TEST(TendonCompliance, SolverAgreesWithAPlainSearch) {
  for (const Published& p : kPublished)
    for (double stretch : {0.95, 1.0, 1.04})
      for (double activation : {0.05, 0.4, 1.0}) {
        const double path = stretch * p.muscle.path;
        const double wanted = searched(p.muscle, path, 0) - searched(p.muscle, path, activation);
        EXPECT_NEAR(isometric_shortening(p.muscle, path, activation), wanted, 3e-6)
            << p.name << " " << stretch << " " << activation;
      }
}

TEST(TendonCompliance, MoreEffortShortensMoreAndMostOfItComesEarly) {
  for (const Published& p : kPublished) {
    double before = 0;
    for (double a = 0; a <= 1; a += 0.05) {
      const double now = isometric_shortening(p.muscle, p.muscle.path, a);
      EXPECT_GE(now, before) << p.name << " " << a;
      before = now;
    }
    EXPECT_GT(isometric_shortening(p.muscle, p.muscle.path, 0.3),
              0.5 * isometric_shortening(p.muscle, p.muscle.path, 1))
        << p.name;
  }
}

TEST(TendonCompliance, TheTableFollowsTheSolver) {
  for (const Published& p : kPublished) {
    const TendonCompliance table(p.muscle);
    for (double stretch : {0.93, 1.0, 1.05})
      for (double root : {0.0, 0.2, 0.55, 0.83, 1.0})
        EXPECT_NEAR(table.at(stretch * p.muscle.path, root),
                    isometric_shortening(p.muscle, stretch * p.muscle.path, root * root), 6e-4)
            << p.name << " " << stretch << " " << root;
  }
}

TEST(TendonCompliance, NothingGivesWhereThereIsNothingToKnow) {
  EXPECT_EQ(TendonCompliance().at(0.3, 1), 0);
  EXPECT_EQ(TendonCompliance({0, 0, 0.3}).at(0.3, 1), 0);
  EXPECT_EQ(TendonCompliance({0.1, 0, 0}).at(0.3, 1), 0);
  EXPECT_EQ(isometric_shortening({0.1, 1.57, 0.3}, 0.3, 1), 0);
  EXPECT_EQ(isometric_shortening({0.1, 0, 0.3}, 0.05, 1), 0);
}

TEST(Effort, RelaxedIsTheSameToTheLastBit) {
  const Anatomy anatomy = fibred_arm();
  const PosingTable table = make_posing_table(anatomy);
  const std::vector<double> none(anatomy.muscles.size(), 0.0);
  PosedAnatomy without, with;
  const Pose pose = arm_pose(anatomy.skeleton, 30, 10, 5, 80, 40);
  pose_anatomy(table, anatomy.skeleton, pose, without);
  pose_anatomy(table, anatomy.skeleton, pose, with, 1, none);
  for (size_t k = 0; k < without.slices.size(); ++k)
    EXPECT_EQ(without.slices[k].radii, with.slices[k].radii) << k;
}

TEST(Effort, BelliesBulgeAtTheirVolume) {
  const Anatomy anatomy = fibred_arm();
  const PosingTable table = make_posing_table(anatomy);
  const auto ranges = slice_ranges(anatomy);
  PosedAnatomy relaxed, tense;
  for (double elbow : {0.0, 60.0, 110.0}) {
    const Pose pose = arm_pose(anatomy.skeleton, 10, 10, 0, elbow, 30);
    pose_anatomy(table, anatomy.skeleton, pose, relaxed);
    for (double effort : {0.1, 0.3, 1.0}) {
      const std::vector<double> activation(anatomy.muscles.size(), effort);
      pose_anatomy(table, anatomy.skeleton, pose, tense, 1, activation);
      for (size_t i = 0; i < ranges.size(); ++i) {
        const std::string& name = anatomy.muscles[ranges[i].muscle].name;
        EXPECT_NEAR(strip_volume(tense, ranges[i]) / strip_volume(relaxed, ranges[i]), 1, 1e-9)
            << name;
        EXPECT_EQ(tense.lengths[i], relaxed.lengths[i]) << name;
        EXPECT_GT(widest(tense, ranges[i]), widest(relaxed, ranges[i])) << name << " at " << effort;
        EXPECT_LT(widest(tense, ranges[i]), 1.5 * widest(relaxed, ranges[i]))
            << name << " at " << effort;
      }
    }
  }
}

TEST(Effort, MostOfTheBulgeComesBelowAThird) {
  const Anatomy anatomy = fibred_arm();
  const PosingTable table = make_posing_table(anatomy);
  const auto ranges = slice_ranges(anatomy);
  const Pose pose = rest_pose(anatomy.skeleton);
  PosedAnatomy relaxed, some, all;
  pose_anatomy(table, anatomy.skeleton, pose, relaxed);
  pose_anatomy(table, anatomy.skeleton, pose, some, 1,
               std::vector<double>(anatomy.muscles.size(), 0.3));
  pose_anatomy(table, anatomy.skeleton, pose, all, 1,
               std::vector<double>(anatomy.muscles.size(), 1.0));
  for (const SliceRange& range : ranges) {
    const double rest = widest(relaxed, range);
    EXPECT_GT(widest(some, range) - rest, 0.5 * (widest(all, range) - rest))
        << anatomy.muscles[range.muscle].name;
  }
}

TEST(Effort, OnlyTheOneThatIsAskedTenses) {
  const Anatomy anatomy = fibred_arm();
  const PosingTable table = make_posing_table(anatomy);
  std::vector<double> activation(anatomy.muscles.size(), 0.0);
  activation[1] = 1;
  activation[2] = std::nan("");
  PosedAnatomy relaxed, tense;
  pose_anatomy(table, anatomy.skeleton, rest_pose(anatomy.skeleton), relaxed);
  pose_anatomy(table, anatomy.skeleton, rest_pose(anatomy.skeleton), tense, 1, activation);
  for (const SliceRange& range : slice_ranges(anatomy)) {
    const bool same = widest(relaxed, range) == widest(tense, range);
    EXPECT_EQ(same, range.muscle != 1) << anatomy.muscles[range.muscle].name;
  }
  EXPECT_THROW(pose_anatomy(table, anatomy.skeleton, rest_pose(anatomy.skeleton), tense, 1,
                            std::vector<double>{1.0}),
               std::invalid_argument);
}
