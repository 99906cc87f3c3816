#include "app/files/open_markers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "anatomy/files/input_file.h"
#include "skinning/markers/fit_markers.h"
#include "skinning/markers/marker_tables.h"
#include "skinning/motion_files/read_markers.h"

namespace ecorche {
namespace {

constexpr double kOtherSize = 0.03;    // of stature or a limb: people are told
constexpr double kBadMarker = 0.040;   // m: what OpenSim's practice asks of the worst marker
constexpr std::size_t kMostTold = 12;  // markers in a line

// Height of the head's joint over the lower ankle at rest: what sizes of segments make of stature.
double height_of(const Skeleton& skeleton) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  return rest[std::size_t(find_joint(skeleton, "head"))].y() -
         rest[std::size_t(find_joint(skeleton, "ankle_l"))].y();
}

double stature_of(const TriMesh& skin) {
  return skin.V.rows() > 0 ? skin.V.col(1).maxCoeff() - skin.V.col(1).minCoeff() : 0;
}

std::string some_of(std::vector<std::string> names) {
  const bool more = names.size() > kMostTold;
  names.resize(std::min(names.size(), kMostTold));
  return fmt::format("{}{}", fmt::join(names, ", "), more ? ", ..." : "");
}

// {"markers": {"size": {"thigh": 1.04, ...}, "stature": 1.80}}
void report_size(const MarkerFit& fit, const Character& character, const std::string& name,
                 std::vector<std::string>& warnings, Report& report) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < kFigureSizes.size(); ++k) {
    std::string key = kFigureSizes[k];
    std::replace(key.begin(), key.end(), ' ', '_');
    const double size = fit.figure.sizes[Eigen::Index(k)];
    report.set("markers.size." + key, size);
    if (std::abs(size - 1) > kOtherSize)
      parts.push_back(fmt::format("{} {:+.0f} %", kFigureSizes[k], 100 * (size - 1)));
  }
  const double ratio = height_of(fit.figure.skeleton) / height_of(character.anatomy.skeleton),
               stature = ratio * stature_of(character.body.skin);
  report.set("markers.stature", stature);
  if (std::abs(ratio - 1) < kOtherSize && parts.size() < 3) return;
  warnings.push_back(fmt::format(
      "{}: its markers were on a person of about {:.2f} m, this body is {:.2f} m ({}); turns of "
      "joints are taken over and the path is scaled; `ecorche body new --height {:.2f}` makes a "
      "body of that size",
      name, stature, stature_of(character.body.skin),
      parts.empty() ? "every part alike" : fmt::format("{}", fmt::join(parts, ", ")), stature));
}

void report_residuals(const MarkerFit& fit, const std::string& name,
                      std::vector<std::string>& warnings, Report& report) {
  report.set("markers.rms", fit.rms);
  report.set("markers.worst", fit.worst);
  report.set("markers.worst_marker", fit.worst_marker);
  report.set("markers.worst_frame", fit.worst_frame + 1);
  report.set("markers.blind_frames", fit.blind);
  std::vector<std::string> far, gaps;
  for (const MarkerResidual& marker : fit.markers) {
    const std::string key = "markers.each." + plain_marker_name(marker.marker);
    report.set(key + ".place", marker.place);
    report.set(key + ".rms", marker.rms);
    report.set(key + ".worst", marker.worst);
    report.set(key + ".offset", marker.offset);
    report.set(key + ".gaps", marker.gaps);
    if (marker.worst > kBadMarker)
      far.push_back(fmt::format("{} ({:.0f} mm in frame {})", marker.marker, 1e3 * marker.worst,
                                marker.worst_frame + 1));
    if (marker.gaps > 0)
      gaps.push_back(
          fmt::format("{} ({} frames, {} on end)", marker.marker, marker.gaps, marker.longest));
  }
  if (!far.empty())
    warnings.push_back(fmt::format("{}: {} markers are more than {:.0f} mm off in some frame: {}",
                                   name, far.size(), 1e3 * kBadMarker, some_of(far)));
  if (!gaps.empty())
    warnings.push_back(
        fmt::format("{}: {} markers are not seen in some frames, which are bridged: "
                    "{}",
                    name, gaps.size(), some_of(gaps)));
  if (fit.blind > 0)
    warnings.push_back(
        fmt::format("{}: {} frames see too few markers to tell a pose, and are gone "
                    "through from their neighbours",
                    name, fit.blind));
}

}  // namespace

MotionClip open_markers(const std::filesystem::path& file, const Character& character,
                        const MotionOptions& options, const Common& common, Report& report,
                        double& start) {
  const MarkerTake take = read_markers(file, to_read_options(options));
  MarkerTables tables = read_marker_tables(common.assets.tables / "markers");
  if (!options.markers.empty()) add_own_markers(options.markers, tables);
  const Skeleton& skeleton = character.anatomy.skeleton;
  const std::vector<BodyMarker> markers = lay_markers(tables, take, skeleton, character.body.skin);
  MarkerFitOptions wanted;
  if (!options.up.empty()) wanted.up = options.up[0];
  MarkerFit fit;
  {
    const StageTimer timer(report, "markers");
    fit = fit_markers(take, markers, skeleton, wanted);
  }
  start = take.start;
  report.set("motion.start", take.start);
  report.set("markers.known", int(markers.size()));
  report.set("markers.up", std::string(1, fit.up));
  std::vector<std::string> warnings, strange;
  std::vector<char> known(take.markers.size(), 0);
  for (const BodyMarker& marker : markers) known[std::size_t(marker.column)] = 1;
  for (std::size_t m = 0; m < known.size(); ++m)
    if (!known[m]) strange.push_back(take.markers[m]);
  report.set("markers.unknown", int(strange.size()));
  if (!strange.empty())
    warnings.push_back(fmt::format(
        "{}: {} markers are in no table and are left out: {}; --markers FILE.csv says where each "
        "is stuck",
        take.name, strange.size(), some_of(strange)));
  report_size(fit, character, take.name, warnings, report);
  report_residuals(fit, take.name, warnings, report);
  note(common, fmt::format("{}: {} of {} markers known, {} up; they lie {:.1f} mm off (RMS), at "
                           "worst {:.0f} mm ({}, frame {})",
                           take.name, markers.size(), take.markers.size(), fit.up, 1e3 * fit.rms,
                           1e3 * fit.worst, fit.worst_marker, fit.worst_frame + 1));
  fit.clip.warnings.insert(fit.clip.warnings.end(), warnings.begin(), warnings.end());
  return std::move(fit.clip);
}

}  // namespace ecorche
