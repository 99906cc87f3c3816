// A body fitted again after one muscle's edit comes out as fitted whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/same_muscle.h"
#include "anatomy/muscles/slice_outline.h"
#include "morph/fit/refit_character.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

constexpr const char* kEdited = "biceps_brachii_long";

// Arms and lower legs alone, so that fits take little time.
Template limbs_of(const Template& whole) {
  Template out = whole;
  const auto is_elsewhere = [](const Muscle& muscle) {
    return muscle.group != "arm" && muscle.group != "forearm" && muscle.group != "hand" &&
           muscle.group != "leg";
  };
  std::erase_if(out.tables.muscles, is_elsewhere);
  std::erase_if(out.anatomy.muscles, is_elsewhere);
  out.tables.fascia.clear();
  return out;
}

void edit(Template& limbs) {
  for (Muscle& muscle : limbs.tables.muscles) {
    if (!muscle.name.starts_with(kEdited)) continue;
    for (Strip& strip : muscle.strips) {
      strip.path[strip.path.size() / 2].rest.z() += 0.006;
      for (Slice& slice : strip.slices) slice.radii *= 1.05;
    }
  }
}

FittingOptions unjudged() {
  FittingOptions out;
  out.judged = out.tissues = false;
  return out;
}

struct Fitted {
  FitRecord record;
  FittedCharacter before, whole, again;
};

// Once before an edit, and after it whole and again.
const Fitted& fitted(const Template& whole) {
  static const Fitted made = [&] {
    Fitted out;
    Template limbs = limbs_of(whole);
    const BodyPackage package = read_body_package(test_assets());
    out.before = fit_character(limbs, limbs.body, package, unjudged(), &out.record);
    edit(limbs);
    out.whole = fit_character(limbs, limbs.body, package, unjudged());
    out.again = refit_character(limbs, limbs.body, package, unjudged(), out.record).value();
    return out;
  }();
  return made;
}

// Between points of two muscles' outlines, m.
std::vector<double> distances(const Muscle& a, const Muscle& b) {
  std::vector<double> out;
  for (std::size_t s = 0; s < a.strips.size(); ++s) {
    const std::vector<Ellipse> own = rest_slices(a.strips[s]), other = rest_slices(b.strips[s]);
    for (std::size_t k = 0; k < own.size(); ++k)
      for (std::size_t i = 0; i < kOutlinePoints; ++i) {
        const auto at = [i](const Ellipse& e) -> Vec3 {
          const Vec2 p = double(e.outline[i]) * outline_directions()[i].cwiseProduct(e.radii);
          return e.center + e.axes.leftCols<2>() * p;
        };
        out.push_back((at(own[k]) - at(other[k])).norm());
      }
  }
  return out;
}

TEST(Refit, IsTheWholeFitButForHundredthsOfAMillimetre) {
  NEED_TEMPLATE();
  const Fitted& f = fitted(tmpl);
  std::vector<double> off;
  double moved = 0, sum = 0;
  for (std::size_t m = 0; m < f.whole.anatomy.muscles.size(); ++m) {
    for (const double d : distances(f.whole.anatomy.muscles[m], f.again.anatomy.muscles[m]))
      off.push_back(d), sum += d;
    for (const double d : distances(f.whole.anatomy.muscles[m], f.before.anatomy.muscles[m]))
      moved = std::max(moved, d);
  }
  std::ranges::sort(off);
  EXPECT_GT(moved, 5e-3);
  EXPECT_LT(sum / double(off.size()), 5e-5);
  EXPECT_LT(off[off.size() * 99 / 100], 5e-4);
  RecordProperty("most_um", int(1e6 * off.back()));
}

TEST(Refit, LeavesWhatIsFarAsItWas) {
  NEED_TEMPLATE();
  const Fitted& f = fitted(tmpl);
  const int far = find_muscle(f.before.anatomy, "soleus_l"),
            edited = find_muscle(f.before.anatomy, std::string(kEdited) + "_l");
  ASSERT_GE(far, 0);
  const auto most = [&](int m) {
    const std::vector<double> all = distances(f.before.anatomy.muscles[std::size_t(m)],
                                              f.again.anatomy.muscles[std::size_t(m)]);
    return *std::ranges::max_element(all);
  };
  EXPECT_EQ(most(far), 0);
  EXPECT_TRUE(is_same(f.before.anatomy.muscles[std::size_t(far)],
                      f.again.anatomy.muscles[std::size_t(far)]));
  EXPECT_GT(most(edited), 2e-3);
}

TEST(Refit, RefusesWhatAWholeFitDoesAsFast) {
  NEED_TEMPLATE();
  Template limbs = limbs_of(tmpl);
  for (Muscle& muscle : limbs.tables.muscles)
    for (Strip& strip : muscle.strips) strip.path.front().rest.y() += 1e-3;
  const BodyPackage package = read_body_package(test_assets());
  EXPECT_FALSE(refit_character(limbs, limbs.body, package, unjudged(), fitted(tmpl).record));
}

}  // namespace
}  // namespace ecorche
