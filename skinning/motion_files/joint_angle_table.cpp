#include "skinning/motion_files/joint_angle_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/model_files/coordinates.h"
#include "skinning/motion_files/clip_times.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kAtZero = 1e-5;        // rad; a fixed angle nearer to its zero has no column
constexpr double kRateOfOneRow = 30;    // frames/s, of a table of one row
constexpr std::size_t kNamesTold = 40;  // in a warning
constexpr std::array kTurnNames{"flexion", "abduction", "rotation"};

std::vector<std::string> root_columns(const Skeleton& skeleton) {
  std::vector<std::string> out;
  for (const char* name : kRootCoordinates)
    out.push_back(fmt::format("{}_{}", skeleton.joints[0].name, name));
  return out;
}

// Every angle of every joint but the root: those of models, and those that they hold fixed.
std::vector<Coordinate> all_angles(const Skeleton& skeleton) {
  std::vector<Coordinate> out;
  for (int j = 1; j < int(skeleton.joints.size()); ++j)
    for (int axis = 0; axis < 3; ++axis)
      out.push_back({fmt::format("{}_{}", skeleton.joints[std::size_t(j)].name,
                                 kTurnNames[std::size_t(axis)]),
                     j, axis});
  return out;
}

}  // namespace

MotionTable joint_angle_table(const Skeleton& skeleton, const Motion& motion) {
  MotionTable out{"angles of joints", "deg", root_columns(skeleton), {}, motion.fps, {}};
  out.units = {"deg", "deg", "deg", "m", "m", "m"};
  std::vector<std::vector<Vec3>> angles;  // by frame and joint
  std::vector<Vec3> last;
  for (const Joint& joint : skeleton.joints) last.push_back(joint.zero);
  last[0] = Vec3::Zero();
  for (const Pose& pose : motion.frames) {
    last[0] = root_angles(pose.rotations[0], last[0]);
    for (std::size_t j = 1; j < last.size(); ++j)
      last[j] = turn_angles(skeleton.joints[j], pose.rotations[j], last[j]);
    angles.push_back(last);
  }
  std::vector<Coordinate> columns = model_coordinates(skeleton);
  const std::size_t of_models = columns.size();
  for (const Coordinate& one : all_angles(skeleton)) {
    const Joint& joint = skeleton.joints[std::size_t(one.joint)];
    const auto same = [&](const Coordinate& c) { return c.name == one.name; };
    if (joint.name.starts_with("patella") ||
        std::any_of(columns.begin(), columns.begin() + std::ptrdiff_t(of_models), same))
      continue;
    const auto moves = [&](const std::vector<Vec3>& frame) {
      return std::abs(frame[std::size_t(one.joint)][one.axis] - joint.zero[one.axis]) > kAtZero;
    };
    if (std::ranges::any_of(angles, moves)) columns.push_back(one);
  }
  for (const Coordinate& one : columns) {
    out.columns.push_back(one.name);
    out.units.push_back("deg");
  }
  const Vec3 rest = rest_positions(skeleton)[0];
  for (std::size_t f = 0; f < angles.size(); ++f) {
    std::vector<double>& row = out.rows.emplace_back();
    for (const double angle : angles[f][0]) row.push_back(kDegreesPerRadian * angle);
    const Vec3 moved = motion.frames[f].root - rest;
    row.insert(row.end(), {moved.z(), moved.y(), -moved.x()});
    for (const Coordinate& one : columns)
      row.push_back(kDegreesPerRadian * angles[f][std::size_t(one.joint)][one.axis]);
  }
  return out;
}

bool has_own_angles(const CoordinateTable& table) {
  constexpr std::array kNeeded{"pelvis_list",   "pelvis_turn",    "pelvis_tilt",   "hip_l_flexion",
                               "hip_r_flexion", "knee_l_flexion", "knee_r_flexion"};
  return std::ranges::all_of(kNeeded, [&](const char* name) {
    return std::ranges::find(table.columns, name) != table.columns.end();
  });
}

Motion motion_of_angles(const CoordinateTable& table, const Skeleton& skeleton,
                        std::optional<double> fps, std::vector<std::string>& warnings) {
  const std::vector<std::string> root = root_columns(skeleton);
  const std::vector<Coordinate> angles = all_angles(skeleton);
  // Where a column's value goes: angle `axis` of a joint; the root's way as axes 3 to 5.
  std::vector<std::pair<std::size_t, int>> places;
  std::vector<std::string> strange;
  for (const std::string& column : table.columns) {
    const auto own = std::ranges::find(root, column);
    const auto angle = std::ranges::find(angles, column, &Coordinate::name);
    if (own != root.end()) {
      places.emplace_back(0, int(own - root.begin()));
    } else if (angle != angles.end()) {
      places.emplace_back(std::size_t(angle->joint), angle->axis);
    } else {
      places.emplace_back(0, -1);
      strange.push_back(column);
    }
  }
  if (!strange.empty()) {
    const std::size_t count = strange.size();
    if (count > kNamesTold) strange.resize(kNamesTold);
    warnings.push_back(fmt::format("{}: {} columns are no angles that are known: {}{}", table.name,
                                   count, fmt::join(strange, ", "),
                                   count > kNamesTold ? ", ..." : ""));
  }
  const double unit = table.degrees ? 1 / kDegreesPerRadian : 1;
  const Vec3 rest = rest_positions(skeleton)[0];
  Motion out{fps ? *fps : table.times.size() > 1 ? rate_of(table.times) : kRateOfOneRow, {}};
  std::vector<Vec3> turns(skeleton.joints.size());
  for (const std::vector<double>& row : table.rows) {
    for (std::size_t j = 0; j < turns.size(); ++j)
      turns[j] = j == 0 ? Vec3(Vec3::Zero()) : skeleton.joints[j].zero;
    Vec3 way = Vec3::Zero();  // forward, up, right
    for (std::size_t c = 0; c < row.size(); ++c) {
      const auto [joint, axis] = places[c];
      if (axis >= 3) way[axis - 3] = row[c];
      if (axis >= 0 && axis < 3) turns[joint][axis] = unit * row[c];
    }
    Pose pose = rest_pose(skeleton);
    pose.root = rest + Vec3(-way.z(), way.y(), way.x());
    pose.rotations[0] = root_rotation(turns[0]);
    for (std::size_t j = 1; j < turns.size(); ++j)
      pose.rotations[j] = turn_rotation(skeleton.joints[j], turns[j]).normalized();
    complete_pose(skeleton, pose);
    out.frames.push_back(std::move(pose));
  }
  return out;
}

}  // namespace ecorche::inline v1
