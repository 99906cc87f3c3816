#include "app/files/dynamics_tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/model_files/coordinates.h"

namespace ecorche {
namespace {

// Joints that have a segment at or beyond them.
std::vector<char> loaded_joints(const Skeleton& skeleton,
                                const std::vector<BodySegment>& segments) {
  std::vector<char> out(skeleton.joints.size(), 0);
  for (const BodySegment& segment : segments)
    for (int j = segment.joint; j >= 0; j = skeleton.joints[j].parent) out[j] = 1;
  return out;
}

// The axis of an anatomical angle in the parent's frame: angles turn in order, each carried along
// by those before it (coordinates.h).
Vec3 angle_axis(const Joint& joint, const Vec3& angles, int axis) {
  Quat turned = Quat::Identity();
  for (int k = 0; k < axis; ++k)
    turned = turned * Quat(Eigen::AngleAxisd(angles[k], Vec3::Unit(k)));
  return joint.axes * (turned * Vec3::Unit(axis));
}

class TableRows {
 public:
  TableRows(std::string what, const MotionDynamics& dynamics) {
    table_.what = std::move(what);
    table_.fps = dynamics.fps;
    table_.rows.resize(dynamics.frames.size());
  }
  // value(f) of every frame.
  template <class Value>
  void add(const std::string& name, const char* unit, const Value& value) {
    table_.columns.push_back(name);
    table_.units.push_back(unit);
    for (std::size_t f = 0; f < table_.rows.size(); ++f) table_.rows[f].push_back(value(f));
  }
  // The components of a vector, in OpenSim's axes.
  template <class Value>
  void add_vector(const std::string& name, const char* unit, const Value& value) {
    add(name + "x", unit, [&](std::size_t f) { return value(f).z(); });
    add(name + "y", unit, [&](std::size_t f) { return value(f).y(); });
    add(name + "z", unit, [&](std::size_t f) { return -value(f).x(); });
  }
  MotionTable take() { return std::move(table_); }

 private:
  MotionTable table_;
};

}  // namespace

std::vector<MomentCurve> moment_curves(const Skeleton& skeleton,
                                       const std::vector<BodySegment>& segments,
                                       const MotionDynamics& dynamics) {
  const std::vector<char> loaded = loaded_joints(skeleton, segments);
  std::vector<MomentCurve> out;
  for (const Coordinate& one : model_coordinates(skeleton)) {
    if (!loaded[one.joint]) continue;
    const Joint& joint = skeleton.joints[one.joint];
    MomentCurve& curve = out.emplace_back(MomentCurve{one.name, {}});
    Vec3 angles = joint.zero;
    for (std::size_t f = 0; f < dynamics.frames.size(); ++f) {
      const BodyLoads& loads = dynamics.frames[f].loads;
      angles = turn_angles(joint, dynamics.states[f].pose.rotations[one.joint], angles);
      curve.moment.push_back(loads.joints[one.joint].moment.dot(
          loads.X_WJ[joint.parent].linear() * angle_axis(joint, angles, one.axis)));
    }
  }
  return out;
}

MotionTable dynamics_table(const Skeleton& skeleton, const std::vector<BodySegment>& segments,
                           const MotionDynamics& dynamics, const MuscleEfforts* efforts) {
  TableRows rows("forces of the motion", dynamics);
  const auto& frames = dynamics.frames;
  for (const std::size_t foot : {0, 1}) {
    const std::string side = foot == 0 ? "l" : "r";
    rows.add_vector("ground_force_" + side + "_v", "N",
                    [&](std::size_t f) { return frames[f].feet[foot].force; });
    rows.add_vector("ground_force_" + side + "_p", "m",
                    [&](std::size_t f) { return frames[f].feet[foot].place; });
    rows.add("ground_torque_" + side + "_y", "N m",
             [&](std::size_t f) { return frames[f].feet[foot].free_moment; });
  }
  for (const MomentCurve& curve : moment_curves(skeleton, segments, dynamics))
    rows.add(curve.name + "_moment", "N m", [&](std::size_t f) { return curve.moment[f]; });
  const std::vector<char> loaded = loaded_joints(skeleton, segments);
  for (std::size_t j = 1; j < loaded.size(); ++j)
    if (loaded[j])
      rows.add(skeleton.joints[j].name + "_power", "W",
               [&](std::size_t f) { return frames[f].loads.power[j]; });
  rows.add_vector("center_of_mass_", "m",
                  [&](std::size_t f) { return frames[f].loads.momentum.center; });
  rows.add_vector("residual_force_", "N", [&](std::size_t f) { return frames[f].residual_force; });
  rows.add_vector("residual_moment_", "N m",
                  [&](std::size_t f) { return frames[f].residual_moment; });
  if (efforts)
    for (const MuscleMoment& moment : efforts->moments)
      rows.add(moment.name + "_reserve", "N m", [&](std::size_t f) {
        return value_between(efforts->times, moment.reserve, double(f) / dynamics.fps);
      });
  return rows.take();
}

MotionTable activation_table(const Anatomy& anatomy, const MotionDynamics& dynamics,
                             const MuscleEfforts& efforts) {
  TableRows rows("activations of muscles", dynamics);
  for (const ActivationCurve& curve : activations_of(efforts).curves)
    rows.add(anatomy.muscles[std::size_t(curve.muscles.front())].name, "", [&](std::size_t f) {
      return value_between(curve.times, curve.values, double(f) / dynamics.fps);
    });
  return rows.take();
}

}  // namespace ecorche
