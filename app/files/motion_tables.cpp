#include "app/files/motion_tables.h"

#include <fmt/format.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/errors.h"
#include "anatomy/model_files/coordinates.h"
#include "anatomy/muscles/belly_length.h"
#include "app/files/skin_markers.h"
#include "skinning/motion/activation.h"
#include "skinning/motion_files/joint_angle_table.h"

namespace ecorche {
namespace {
constexpr double kArmStep = 0.2 / kDegreesPerRadian;  // to either side, for moment arms
constexpr double kLeastArm = 1e-4;  // m; strips that never have one do not cross the joint
const std::string kArms = "moment-arms:";

using Rows = std::vector<std::vector<double>>;

// Actuators as `export` names them.
std::vector<std::string> strip_names(const Anatomy& anatomy) {
  std::vector<std::string> out;
  for (const Muscle& muscle : anatomy.muscles)
    for (std::size_t k = 0; k < muscle.strips.size(); ++k)
      out.push_back(muscle.strips.size() > 1 ? fmt::format("{}.{}", muscle.name, k + 1)
                                             : muscle.name);
  return out;
}

// Lengths of all strips in poses that `pose_of` makes, #poses x #strips.
template <class PoseOf>
Rows lengths_in(const Anatomy& anatomy, std::size_t poses, const PoseOf& pose_of) {
  const PosingTable table = make_posing_table(anatomy);
  Rows out(poses);
  tbb::enumerable_thread_specific<PosedAnatomy> memory;
  tbb::parallel_for(std::size_t{0}, poses, [&](std::size_t i) {
    PosedAnatomy& posed = memory.local();
    pose_anatomy(table, anatomy.skeleton, pose_of(i), posed);
    out[i] = posed.lengths;
  });
  return out;
}

Rows frame_lengths(const Anatomy& anatomy, const Motion& motion) {
  return lengths_in(anatomy, motion.frames.size(),
                    [&](std::size_t f) -> const Pose& { return motion.frames[f]; });
}

// By differences to the frames before and after; at the ends to the one that there is.
Rows rates(const Rows& values, double fps) {
  Rows out = values;
  const std::size_t last = values.size() - 1;
  for (std::size_t f = 0; f <= last; ++f) {
    const std::size_t before = f > 0 ? f - 1 : 0, after = std::min(f + 1, last);
    for (std::size_t i = 0; i < values[f].size(); ++i)
      out[f][i] = after > before
                      ? (values[after][i] - values[before][i]) * fps / double(after - before)
                      : 0;
  }
  return out;
}

// The muscle of each strip.
std::vector<std::size_t> strip_muscles(const Anatomy& anatomy) {
  std::vector<std::size_t> out;
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m)
    out.insert(out.end(), anatomy.muscles[m].strips.size(), m);
  return out;
}

bool is_known(const std::string& what) {
  for (const char* one :
       {"angles", "markers", "lengths", "velocities", "bellies", "tendons", "activations"})
    if (what == one) return true;
  return what.starts_with(kArms) && what.size() > kArms.size();
}

}  // namespace

void add_table_option(CLI::App& verb, std::vector<std::string>& texts) {
  verb.add_option("--table", texts,
                  "WHAT=FILE, a row a frame (.csv, .sto, .mot); may be repeated. WHAT: angles "
                  "(degrees), lengths, velocities, bellies, tendons (of every "
                  "strip of a muscle), activations, moment-arms:COORDINATE (as "
                  "moment-arms:knee_l_flexion), markers (.trc)")
      ->allow_extra_args(false);
}

std::vector<TableRequest> table_requests(const std::vector<std::string>& texts) {
  std::vector<TableRequest> out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == text.npos || equals + 1 == text.size())
      throw UsageError(fmt::format("--table {}: give WHAT=FILE, like lengths=walk.csv", text));
    const TableRequest request{text.substr(0, equals), text.substr(equals + 1)};
    if (!is_known(request.what))
      throw UsageError(
          fmt::format("--table {}: there are angles, lengths, velocities, bellies, tendons, "
                      "activations, markers and moment-arms:COORDINATE",
                      request.what));
    const std::string kind = request.file.extension().string();
    const bool fits = request.what == "markers"
                          ? kind == ".trc"
                          : kind == ".csv" || kind == ".sto" || kind == ".mot";
    if (!fits)
      throw UsageError(fmt::format("{}: {} are written as {}", request.file.string(), request.what,
                                   request.what == "markers" ? ".trc" : ".csv, .sto or .mot"));
    out.push_back(request);
  }
  return out;
}

bool is_table(const std::filesystem::path& output) {
  return output.extension() == ".mot" || output.extension() == ".trc";
}

TableRequest table_request(const std::filesystem::path& output) {
  return {output.extension() == ".mot" ? "angles" : "markers", output};
}

void require_coordinates(const std::vector<TableRequest>& requests, const Skeleton& skeleton) {
  const auto coordinates = model_coordinates(skeleton);
  for (const TableRequest& request : requests) {
    if (!request.what.starts_with(kArms)) continue;
    const std::string name = request.what.substr(kArms.size());
    if (std::none_of(coordinates.begin(), coordinates.end(),
                     [&](const Coordinate& one) { return one.name == name; }))
      throw UsageError(
          fmt::format("--table {}: no coordinate '{}'; a joint's are named like knee_l_flexion, "
                      "shoulder_r_abduction, hip_l_rotation, and "
                      "`--table angles=FILE.csv` lists them all",
                      request.what, name));
  }
}

MotionTables::MotionTables(const Assets& assets, std::vector<TableRequest> requests,
                           const Actor& actor, const Motion& motion, const Activations& activations)
    : requests_(std::move(requests)), actor_(actor), motion_(motion), activations_(activations) {
  require_coordinates(requests_, actor.character.anatomy.skeleton);
  if (std::none_of(requests_.begin(), requests_.end(),
                   [](const TableRequest& request) { return request.what == "markers"; }))
    return;
  for (const SkinMarker& marker : skin_markers(assets, actor.character)) {
    markers_.names.push_back(marker.name);
    marker_vertices_.push_back(marker.vertex);
  }
  markers_.fps = motion.fps;
}

void MotionTables::add(const CharacterState& frame) {
  if (marker_vertices_.empty()) return;
  Points& places = markers_.frames.emplace_back(marker_vertices_.size(), 3);
  for (std::size_t i = 0; i < marker_vertices_.size(); ++i)
    for (int k = 0; k < 3; ++k)
      places(i, k) = double(frame.skin.positions[4 * marker_vertices_[i] + k]);
}

void MotionTables::write() {
  for (const TableRequest& request : requests_) {
    if (request.what == "markers")
      write_trc(request.file, markers_);
    else
      write_motion_table(request.file, table_of(request.what));
  }
}

MotionTable MotionTables::table_of(const std::string& what) const {
  if (what == "angles") return angles();
  if (what == "activations") return activation_table();
  if (what.starts_with(kArms)) return moment_arms(what.substr(kArms.size()));
  const Anatomy& anatomy = actor_.character.anatomy;
  MotionTable out{what + " of muscles",           "m", strip_names(anatomy), {}, motion_.fps,
                  frame_lengths(anatomy, motion_)};
  if (what == "lengths") return out;
  if (what == "velocities") {
    out.unit = "m/s";
    out.rows = rates(out.rows, motion_.fps);
    return out;
  }
  const std::vector<BellyRestLength> shares = belly_rest_lengths(anatomy);
  const std::vector<std::size_t> muscles = strip_muscles(anatomy);
  std::vector<double> efforts;
  for (std::size_t f = 0; f < out.rows.size(); ++f) {
    activation_at(activations_, double(f) / motion_.fps, efforts);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      double& value = out.rows[f][i];
      const double belly =
          belly_length(shares[i], value, efforts.empty() ? 0 : efforts[muscles[i]]);
      value = what == "bellies" ? belly : value - belly;
    }
  }
  return out;
}

MotionTable MotionTables::angles() const {
  return joint_angle_table(actor_.character.anatomy.skeleton, motion_);
}

MotionTable MotionTables::activation_table() const {
  MotionTable out{"activations of muscles", "", {}, {}, motion_.fps, {}};
  for (const Muscle& muscle : actor_.character.anatomy.muscles) out.columns.push_back(muscle.name);
  for (std::size_t f = 0; f < motion_.frames.size(); ++f) {
    std::vector<double>& row = out.rows.emplace_back();
    activation_at(activations_, double(f) / motion_.fps, row);
    row.resize(out.columns.size(), 0);
  }
  return out;
}

MotionTable MotionTables::moment_arms(const std::string& coordinate) const {
  const Anatomy& anatomy = actor_.character.anatomy;
  const auto coordinates = model_coordinates(anatomy.skeleton);
  const Coordinate one = *std::find_if(coordinates.begin(), coordinates.end(),
                                       [&](const Coordinate& c) { return c.name == coordinate; });
  const std::size_t j = one.joint;
  const Joint& joint = anatomy.skeleton.joints[j];
  const Rows lengths = lengths_in(anatomy, 2 * motion_.frames.size(), [&](std::size_t i) {
    Pose pose = motion_.frames[i / 2];
    Vec3 angles = turn_angles(joint, pose.rotations[j], joint.zero);
    angles[one.axis] += i % 2 == 0 ? -kArmStep : kArmStep;
    pose.rotations[j] = turn_rotation(joint, angles);
    complete_pose(anatomy.skeleton, pose);
    return pose;
  });
  const std::vector<std::string> names = strip_names(anatomy);
  MotionTable out{fmt::format("moment arms of muscles about {}", coordinate),
                  "m",
                  {},
                  {},
                  motion_.fps,
                  Rows(motion_.frames.size())};
  const auto arm = [&](std::size_t f, std::size_t strip) {
    return (lengths[2 * f][strip] - lengths[2 * f + 1][strip]) / (2 * kArmStep);
  };
  for (std::size_t strip = 0; strip < names.size(); ++strip) {
    double most = 0;
    for (std::size_t f = 0; f < out.rows.size(); ++f)
      most = std::max(most, std::abs(arm(f, strip)));
    if (most < kLeastArm) continue;
    out.columns.push_back(names[strip]);
    for (std::size_t f = 0; f < out.rows.size(); ++f) out.rows[f].push_back(arm(f, strip));
  }
  return out;
}

}  // namespace ecorche
