// Documents become templates: unchanged muscles as the template has them, and a biceps from nothing
// that is the built-in one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/transform_muscles.h"
#include "app/edit/refit.h"
#include "app/edit/session.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

#define NEED_TEMPLATE_PACKAGES()                  \
  if (!fs::exists(test_assets().packages.folder)) \
  GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them"

struct Distance {
  double mean = 0, most = 0;
};

TriMesh loft(const Strip& strip) {
  const std::vector<Ellipse> slices = rest_slices(strip);
  constexpr int kAround = 32;
  TriMesh mesh;
  mesh.V.resize(Eigen::Index(slices.size()) * kAround, 3);
  mesh.F.resize(Eigen::Index(slices.size() - 1) * kAround * 2, 3);
  for (int k = 0; k < int(slices.size()); ++k)
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * M_PI * i / kAround;
      const Ellipse& e = slices[std::size_t(k)];
      mesh.V.row(k * kAround + i) = e.center + e.radii.x() * std::cos(angle) * e.axes.col(0) +
                                    e.radii.y() * std::sin(angle) * e.axes.col(1);
      if (k + 1 == int(slices.size())) continue;
      const int a = k * kAround + i, b = k * kAround + (i + 1) % kAround;
      mesh.F.row(2 * a) << a, b, a + kAround;
      mesh.F.row(2 * a + 1) << b, b + kAround, a + kAround;
    }
  return mesh;
}

Distance distance_of(const TriMesh& from, const TriMesh& to) {
  const NearestSurface surface(to);
  Distance out;
  for (Eigen::Index i = 0; i < from.V.rows(); ++i) {
    const double d = surface.nearest(from.V.row(i)).distance;
    out.mean += d / double(from.V.rows());
    out.most = std::max(out.most, d);
  }
  return out;
}

class StudioRefit : public ::testing::Test {
 protected:
  StudioRefit() {
    common_.assets = test_assets();
    common_.quiet = true;
  }
  Common common_;
  Report report_;
};

TEST_F(StudioRefit, MusclesPlacedAnewAreThoseOfTheTemplate) {
  NEED_TEMPLATE_PACKAGES();
  Workshop workshop(common_.assets);
  const Document& document = workshop.built_in();
  const std::vector<Muscle>& own = workshop.base().tables.muscles;
  ASSERT_EQ(own.size(), 2 * document.muscles.size());
  for (std::size_t m = 0; m < document.muscles.size(); m += 9) {
    const std::vector<Muscle> placed = placed_entry(workshop, document, int(m));
    for (const std::size_t side : {0u, 1u}) {
      const Muscle &a = own[2 * m + side], &b = placed[side];
      ASSERT_EQ(a.name, b.name);
      ASSERT_EQ(a.strips.size(), b.strips.size());
      EXPECT_NEAR(b.volume, a.volume, 1e-5 * a.volume) << a.name;
      for (std::size_t k = 0; k < a.strips.size(); ++k) {
        const std::vector<Ellipse> x = rest_slices(a.strips[k]), y = rest_slices(b.strips[k]);
        ASSERT_EQ(x.size(), y.size()) << a.name;
        for (std::size_t i = 0; i < x.size(); ++i)
          EXPECT_LT((x[i].center - y[i].center).norm(), 1e-6) << a.name;
      }
    }
  }
}

TEST_F(StudioRefit, AnEditedTemplateKeepsWhatWasNotEdited) {
  NEED_TEMPLATE_PACKAGES();
  Session s(common_, report_, {});
  for (const char* line : {"remove_muscle anconeus", "move_point soleus_r point=2 by=0,0,-4",
                           "move_joint elbow by=2,0,0", "set_limits knee_r flexion min=2 max=99"})
    s.run_line(line);
  const Template& base = s.workshop().base();
  const Template made = edited_template(s.workshop(), s.document());
  EXPECT_NO_THROW(validate(made.anatomy));
  EXPECT_EQ(made.anatomy.muscles.size() + 2, base.anatomy.muscles.size());
  EXPECT_EQ(find_muscle(made.anatomy, "anconeus_l"), -1);
  const auto moved = [&](const char* name) {
    const auto path = [name](const Template& of) {
      const Anatomy& anatomy = of.anatomy;
      return of.tables.muscles[std::size_t(find_muscle(anatomy, name))].strips[0].path[1].rest;
    };
    return (path(made) - path(base)).norm();
  };
  EXPECT_NEAR(moved("soleus_r"), 4e-3, 1.5e-3);
  EXPECT_LT(moved("soleus_l"), 1e-6);
  EXPECT_EQ(moved("sartorius_l"), 0);
  const auto joint = [](const Template& of, const char* name) {
    return rest_positions(of.anatomy.skeleton)[std::size_t(find_joint(of.anatomy.skeleton, name))];
  };
  EXPECT_LT((joint(made, "elbow_l") - joint(base, "elbow_l") - Vec3(2e-3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((joint(made, "elbow_r") - joint(base, "elbow_r") + Vec3(2e-3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((joint(made, "wrist_l") - joint(base, "wrist_l")).norm(), 1e-9);
  const auto limit = [&](const char* name) {
    const Skeleton& skeleton = made.anatomy.skeleton;
    return skeleton.joints[std::size_t(find_joint(skeleton, name))].max.x();
  };
  EXPECT_NEAR(limit("knee_r"), 99 * kDegree, 1e-12);
  EXPECT_NE(limit("knee_l"), limit("knee_r"));
}

TEST_F(StudioRefit, ABicepsFromNothingInTwelveActionsIsTheBuiltInOne) {
  NEED_TEMPLATE_PACKAGES();
  Session s(common_, report_, {});
  s.run_script(fs::path(ECORCHE_TEST_DIR) / ".." / "docs" / "studio" / "biceps.txt");
  EXPECT_LE(s.history().now, 12u);
  const Document& document = s.document();
  const Muscle made = placed_entry(s.workshop(), document, find_entry(document, "my_biceps"))[0];
  const Muscle own =
      placed_entry(s.workshop(), document, find_entry(document, "biceps_brachii_long"))[0];
  const TriMesh a = loft(made.strips[0]), b = loft(own.strips[0]);
  const Distance there = distance_of(a, b), back = distance_of(b, a);
  RecordProperty("mean_mm", std::to_string(1e3 * std::max(there.mean, back.mean)));
  RecordProperty("most_mm", std::to_string(1e3 * std::max(there.most, back.most)));
  EXPECT_LT(std::max(there.mean, back.mean), 0.5e-3);
  EXPECT_LT(std::max(there.most, back.most), 2e-3);
  EXPECT_NEAR(rest_volume(made) / rest_volume(own), 1, 0.03);
  EXPECT_NEAR(made.strips[0].rest_length, own.strips[0].rest_length, 3e-3);
}

}  // namespace
}  // namespace ecorche
