#include "skinning/files/character_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/limits.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche::inline v1 {
namespace {

static_assert(limits::kStripSlices == kMaxStripSlices && limits::kPathPoints == kMaxPathPoints);

constexpr double kFarthest = 10;  // m from the origin; a body stands on it
constexpr double kWidest = 1;     // m, across a section or a surface that lines wrap over
constexpr double kRounding = 1e-6;

void require(bool holds, const std::string& where, const std::string& what) {
  if (!holds) throw InputError(where + ": " + what);
}

void require_near(const Vec3& place, const std::string& where) {
  require(place.cwiseAbs().maxCoeff() <= kFarthest, where,
          fmt::format("it lies at {:.3g}, {:.3g}, {:.3g} m, further than {} m from the origin",
                      place.x(), place.y(), place.z(), kFarthest));
}

void require_range(double value, double low, double high, const std::string& where,
                   const char* what) {
  require(value >= low && value <= high, where,
          fmt::format("'{}' is {:.6g}; expected {:.6g} to {:.6g}", what, value, low, high));
}

void check_mesh(const TriMesh& mesh, const std::string& where) {
  require(mesh.F.rows() > 0, where, "no triangles");
  Eigen::Index row = 0, column = 0;
  const double most = mesh.V.cwiseAbs().maxCoeff(&row, &column);
  require(most <= kFarthest, where,
          fmt::format("vertex {} lies {:.3g} m from the origin; at most {} m are a body", row, most,
                      kFarthest));
}

void check_slice(const Slice& slice, const std::string& where) {
  require_range(slice.radii.maxCoeff(), 0, kWidest, where, "radius");
  require_range(slice.offset.cwiseAbs().maxCoeff(), 0, kWidest, where, "offset");
  require_range(std::abs(slice.roll), 0, 100, where, "roll");
  const float widest = *std::max_element(slice.outline.begin(), slice.outline.end());
  require_range(double(widest) * slice.radii.maxCoeff(), 0, kWidest, where, "outline");
}

void check_wrap(const Wrap& wrap, const std::string& where) {
  require_near(wrap.X_WO.translation(), where + ": wrap");
  require_range(wrap.radii.minCoeff(), kRounding, kFarthest, where, "radii of a wrap");
  require_range(wrap.radii.maxCoeff(), kRounding, kFarthest, where, "radii of a wrap");
}

void check_strip(const Strip& strip, const std::string& where) {
  if (strip.slices.size() > std::size_t(limits::kStripSlices) ||
      strip.path.size() > std::size_t(limits::kPathPoints) ||
      strip.wraps.size() > std::size_t(limits::kStripWraps))
    throw LimitError(
        fmt::format("{}: {} slices, {} path points, {} wraps; the limits are {}, {} and {}", where,
                    strip.slices.size(), strip.path.size(), strip.wraps.size(),
                    limits::kStripSlices, limits::kPathPoints, limits::kStripWraps));
  require(strip.slices.size() >= 2, where,
          fmt::format("{} slices; two are needed", strip.slices.size()));
  for (const PathPoint& point : strip.path) {
    require_near(point.rest, where + ": path point");
    require_range(point.share, -kRounding, 1 + kRounding, where, "share of a path point");
  }
  for (const Slice& slice : strip.slices) check_slice(slice, where);
  for (const Wrap& wrap : strip.wraps) check_wrap(wrap, where);
  require_range(strip.belly_begin, -kRounding, strip.belly_end + kRounding, where, "belly");
  require_range(strip.belly_end, strip.belly_begin - kRounding, 1 + kRounding, where, "belly");
  double before = 0;
  for (const double place : strip.intersections) {
    require(place > before && place < 1, where,
            fmt::format("'intersections' has {:.6g} after {:.6g}; they rise from 0 to 1", place,
                        before));
    before = place;
  }
  require_range(strip.raphe, 0, 0.5, where, "raphe");
  require(strip.reference.norm() > kRounding, where, "'reference' has no length");
  const double length = line_length(strip.path);
  require(length > kRounding, where, "its line has no length");
  require_range(strip.rest_length, 0.8 * length, 1.25 * length, where, "rest_length");
  for (const Ellipse& slice : rest_slices(strip))
    require(slice.center.allFinite() && slice.axes.allFinite(), where,
            "its line turns back on itself, so that a section has no direction");
}

void check_muscle(const Muscle& muscle, const std::string& where) {
  require_range(muscle.volume, 0, 0.1, where, "volume");
  require_range(muscle.fibre_length, 0, 2, where, "fibre_length");
  require_range(std::abs(muscle.pennation), 0, std::numbers::pi / 2, where, "pennation");
  require_range(muscle.max_force, 0, 1e6, where, "max_force");
  require_range(muscle.tendon_slack, 0, 2, where, "tendon_slack");
  require_range(muscle.tense_thickness, 0, 3, where, "tense_thickness");
  for (std::size_t i = 0; i < muscle.strips.size(); ++i)
    check_strip(muscle.strips[i], fmt::format("{}: strip {}", where, i + 1));
}

void check_fascia(const FasciaSheet& sheet, const std::string& file) {
  const std::string where = fmt::format("{}: fascia '{}'", file, sheet.name);
  for (Eigen::Index i = 0; i < sheet.V.rows(); ++i)
    require_near(sheet.V.row(i), fmt::format("{}: point {}", where, i));
  for (const float share : sheet.belly)
    require_range(double(share), -kRounding, 1 + kRounding, where, "_BELLY");
}

}  // namespace

void check_body(const Body& body, const std::string& file) {
  require_range(body.age, 0, 150, file + ": body", "age");
  require_range(body.mass, 0, 1000, file + ": body", "mass");
  for (const Landmark& landmark : body.landmarks)
    require_near(landmark.position, fmt::format("{}: landmark '{}'", file, landmark.name));
  check_mesh(body.skin, file + ": skin");
}

void check_joint(const Joint& joint, const std::string& where) {
  constexpr double kHalfTurn = std::numbers::pi + kRounding;
  require_near(joint.X_PJ.translation(), where);
  require((joint.axes.transpose() * joint.axes - Mat3::Identity()).norm() < 1e-3 &&
              joint.axes.determinant() > 0,
          where, "'axes' are no right-handed frame of three directions square to one another");
  for (Eigen::Index k = 0; k < 3; ++k) {
    require_range(joint.min[k], -kHalfTurn, joint.max[k], where, "min");
    require_range(joint.max[k], joint.min[k], kHalfTurn, where, "max");
    require_range(joint.zero[k], joint.min[k] - kRounding, joint.max[k] + kRounding, where, "zero");
  }
}

void check_character(const Character& character, const std::string& file) {
  const Anatomy& anatomy = character.anatomy;
  if (anatomy.muscles.size() > std::size_t(limits::kMuscles))
    throw LimitError(fmt::format("{}: {} muscles; the limit is {}", file, anatomy.muscles.size(),
                                 limits::kMuscles));
  if (slice_count(anatomy) > limits::kSlices)
    throw LimitError(fmt::format("{}: {} sections of muscles; the limit is {}", file,
                                 slice_count(anatomy), limits::kSlices));
  if (anatomy.fascia.size() > std::size_t(limits::kFasciaSheets))
    throw LimitError(fmt::format("{}: {} sheets of fascia; the limit is {}", file,
                                 anatomy.fascia.size(), limits::kFasciaSheets));
  for (const FasciaSheet& sheet : anatomy.fascia)
    if (std::max(sheet.rows, sheet.columns) > limits::kFasciaRows)
      throw LimitError(fmt::format("{}: fascia '{}': {} rows, {} columns; the limit is {}", file,
                                   sheet.name, sheet.rows, sheet.columns, limits::kFasciaRows));
  try {
    validate(anatomy);
  } catch (const std::invalid_argument& e) {
    throw InputError(fmt::format("{}: {}", file, e.what()));
  }
  check_body(character.body, file);
  for (const Joint& joint : anatomy.skeleton.joints)
    check_joint(joint, fmt::format("{}: joint '{}'", file, joint.name));
  for (const Bone& bone : anatomy.bones)
    check_mesh(bone.mesh, fmt::format("{}: bone '{}'", file, bone.name));
  for (const Muscle& muscle : anatomy.muscles)
    check_muscle(muscle, fmt::format("{}: muscle '{}'", file, muscle.name));
  for (const FasciaSheet& sheet : anatomy.fascia) check_fascia(sheet, file);
}

}  // namespace ecorche::inline v1
