#include "skinning/checks/check_targets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "morph/fit/layer_gaps.h"
#include "morph/fit/shown_through.h"

namespace ecorche::inline v1 {
namespace {

std::string percent(double share, int digits = 2) {
  return std::isfinite(share) ? fmt::format("{:.{}f} %", 100 * share, digits) : "not known";
}
std::string millimetres(double metres) { return fmt::format("{:.1f} mm", 1e3 * metres); }

std::string pierced_most(const AnatomyCheck& check) {
  return percent(check.pierced_share, 1) +
         (check.pierced_muscle.empty() ? "" : " (" + check.pierced_muscle + ")");
}

std::string shown_most(const AnatomyCheck& check) {
  return fmt::format("{:.1f} cm2", 1e4 * check.shown_by_one) +
         (check.shown_most.empty() ? "" : " (" + check.shown_most + ")");
}

}  // namespace

std::vector<Target> check_targets(const AnatomyCheck& check) {
  const double outside =
      check.muscle_points > 0 ? double(check.muscle_points_outside) / check.muscle_points : 0;
  std::vector<Target> targets{
      {"bone points outside the skin", "0",
       fmt::format("{} of {}", check.bone_points_outside, check.bone_points),
       check.bone_points_outside == 0},
      {"muscle points outside the skin", "<= 0.05 %", percent(outside, 3), outside <= 0.0005},
      {"muscles within muscles, of their volume", "<= 2 %", percent(check.overlap_share),
       check.overlap_share <= 0.02},
      {"muscles within bones, of their volume", "<= 1 %", percent(check.bone_share),
       check.bone_share <= 0.01},
      {"share of the muscle that bones pierce most", "<= 5 %", pierced_most(check),
       check.pierced_share <= 0.05},
      {"bones within bones, of their volume", "<= 0.3 %", percent(check.bone_overlap.share),
       check.bone_overlap.share <= 0.003},
      {"under the fat layer, near muscle, bone or fascia", ">= 95 %",
       percent(check.filled_share, 1), check.filled_share >= kFilledAsked},
      {"muscle ends more than 10 mm from their bones", "0",
       fmt::format("{} of {}", check.loose_ends, check.ends), check.loose_ends == 0},
  };
  if (check.compared)
    targets.push_back({"muscles torn at rest", "0",
                       std::to_string(check.torn) +
                           (check.torn_muscle.empty() ? "" : " (" + check.torn_muscle + ")"),
                       check.torn == 0});
  if (std::isfinite(check.shown))
    targets.push_back({"bone or deep muscle that shows most through what covers it",
                       fmt::format("<= {:.0f} cm2", 1e4 * kShownAsked), shown_most(check),
                       check.shown_by_one <= kShownAsked});
  if (!check.poses.empty()) {
    targets.push_back({"posed: muscle points outside the skin, mean", "<= 0.2 %",
                       percent(check.posed_outside_share), check.posed_outside_share <= 0.002});
    const auto outside_poses =
        std::count_if(check.poses.begin(), check.poses.end(),
                      [](const PoseCheck& pose) { return pose.bone_points_outside > 0; });
    targets.push_back({"posed: poses with bone points outside the skin", "0",
                       fmt::format("{} of {}", outside_poses, check.poses.size()),
                       outside_poses == 0});
    targets.push_back({"posed: muscles within muscles, worst pose", "<= 2 %",
                       percent(check.posed_overlap_worst), check.posed_overlap_worst <= 0.02});
    targets.push_back({"posed: muscles within bones, worst pose", "<= 1 %",
                       percent(check.posed_bone_share_worst),
                       check.posed_bone_share_worst <= 0.01});
    targets.push_back({"posed: muscles with an end 10 mm off its bone, mean", "0",
                       fmt::format("{:.1f}", check.posed_loose_ends), check.posed_loose_ends == 0});
    targets.push_back({"posed: needles, mean", "0", fmt::format("{:.0f}", check.posed_needles),
                       check.posed_needles == 0});
    targets.push_back({"posed: daylight over 2 cm2 between what touched, mean", "0",
                       fmt::format("{:.0f} cm2", 1e4 * check.posed_daylight),
                       check.posed_daylight <= 2e-4});
    targets.push_back({"posed: outer faces within other muscles or bones, mean", "<= 2 cm2",
                       fmt::format("{:.0f} cm2", 1e4 * check.posed_buried),
                       check.posed_buried <= 2e-4});
    targets.push_back({"posed: stretch of a muscle's surface, worst", "<= 3 times",
                       fmt::format("{:.1f}", check.posed_stretch_max),
                       check.posed_stretch_max <= 3});
  }
  if (check.swept || !check.poses.empty())
    targets.push_back({"change of a belly's volume, worst", "<= 0.5 %", percent(check.drift_max),
                       check.drift_max <= 0.005});
  if (check.swept)
    targets.push_back({"jump of a path in one degree, worst", "<= 1 mm",
                       millimetres(check.jump_max), check.jump_max <= 0.001});
  return targets;
}

}  // namespace ecorche::inline v1
