#include "app/fitting.h"

#include <fmt/format.h>

#include <algorithm>

namespace ecorche {
namespace {

constexpr double kMuscleOutsideLimit = 1e-3;  // share of surface points
constexpr double kGapLimit = 3e-3;            // m, median
constexpr double kDepthSlack = 4e-3;          // m, beyond a landmark's bracket

int landmarks_off(const FitReport& fit) {
  return static_cast<int>(std::count_if(fit.landmarks.begin(), fit.landmarks.end(), [](const LandmarkDepth& landmark) {
    return landmark.depth < landmark.low - kDepthSlack || landmark.depth > landmark.high + kDepthSlack;
  }));
}

}  // namespace

FittedCharacter fit_character(const Template& body_template, const Body& body, const FitOptions& options, Report& report) {
  Fit fit = fit_anatomy(body_template, body, options);
  const FitReport& found = fit.report;
  report.set("timings_ms.fit_bones", found.bones_ms);
  report.set("timings_ms.fit_muscles", found.muscles_ms);
  report.set("timings_ms.dilation", found.dilation_ms);
  report.set("rays", static_cast<double>(found.dilation.rays));
  report.set("fit.ray_misses", static_cast<double>(found.dilation.misses));
  report.set("fit.stature", found.stature);
  report.set("fit.bone_vertices", found.bone_vertices);
  report.set("fit.bone_vertices_outside", found.bones_outside);
  report.set("fit.muscle_points", found.containment.points);
  report.set("fit.muscle_points_outside_share", found.containment.outside_share);
  report.set("fit.muscle_points_outside_max", found.containment.furthest);
  report.set("fit.superficial_gap_median", found.gap.median);
  report.set("fit.landmarks", static_cast<int>(found.landmarks.size()));
  report.set("fit.landmarks_off_bracket", landmarks_off(found));
  for (const LandmarkDepth& landmark : found.landmarks) report.set("fit.landmark_depth." + landmark.name, landmark.depth);
  report.set("fit.muscle_volume_wanted", found.dilation.wanted_volume);
  report.set("fit.muscle_volume", found.dilation.volume);
  return {{std::move(fit.anatomy), body}, std::move(fit.report)};
}

std::vector<std::string> missed_targets(const FitReport& fit) {
  std::vector<std::string> missed;
  if (fit.bones_outside > 0) missed.push_back(fmt::format("{} bone vertices are outside the skin, up to {:.1f} mm", fit.bones_outside, 1e3 * fit.bones_furthest));
  if (fit.containment.outside_share > kMuscleOutsideLimit)
    missed.push_back(fmt::format("{:.2f} % of the muscle surface is outside the skin; at most 0.1 % was asked", 100 * fit.containment.outside_share));
  if (fit.gap.median > kGapLimit)
    missed.push_back(fmt::format("superficial muscles stay {:.1f} mm from the fat layer (median); at most 3 mm was asked", 1e3 * fit.gap.median));
  for (const LandmarkDepth& landmark : fit.landmarks)
    if (landmark.depth < landmark.low - kDepthSlack || landmark.depth > landmark.high + kDepthSlack)
      missed.push_back(fmt::format("{} lies {:.1f} mm deep; {:.0f} to {:.0f} mm were asked", landmark.name, 1e3 * landmark.depth, 1e3 * landmark.low, 1e3 * landmark.high));
  return missed;
}

}  // namespace ecorche
