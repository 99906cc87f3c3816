#include "skinning/lift/lift.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/mesh_measures.h"
#include "skinning/lift/pressure_map.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

// Hooks of the spreader bar from its middle, and how long straps are when drawn in, m: the head's
// end is held higher, so that the person half sits.
constexpr double kHookAcross = 0.33, kHookAlong = 0.16;
constexpr double kShoulderStrap = 0.30, kHipStrap = 0.62, kLegStrap = 0.40;
constexpr double kAboveCrown = 0.06;
constexpr double kSheetHeight = 0.001;

Vec3 joint_place(const Patient& patient, const Pose& pose, const std::string& name) {
  std::vector<Transform> X_WJ;
  forward_kinematics(patient.skeleton, pose, X_WJ);
  return X_WJ[std::size_t(joint_of(patient.skeleton, name))].translation();
}

// The sheet's ends along z.
struct Reach {
  double head = 0, legs = 0;
};

Reach reach_of(const Patient& patient, const Pose& lying, const SlingOptions& options) {
  Points V;
  carried_skin(patient, lying, {}, V);
  const double knees =
      0.5 * (joint_place(patient, lying, "knee_l").z() + joint_place(patient, lying, "knee_r").z());
  return {V.col(2).minCoeff() - kAboveCrown, knees + options.below_knee};
}

void add_straps_at_corners(const SlingOptions& options, double hips, Sheet& sheet) {
  const Points& V = sheet.mesh.V;
  for (const int side : {1, -1}) {
    const char* suffix = side > 0 ? "_l" : "_r";
    const auto outermost = [&](double along) {
      Eigen::Index at = 0;
      (double(side) * V.col(0) + along * V.col(2)).maxCoeff(&at);
      return Vec3(V.row(at).transpose());
    };
    const double x = side * kHookAcross;
    add_strap(sheet, std::string("shoulder") + suffix, outermost(-1), Vec3(x, 0, -kHookAlong),
              kShoulderStrap);
    if (options.straps == 6) {
      Eigen::Index at = 0;
      (double(side) * V.col(0) - 0.5 * (V.col(2).array() - hips).abs().matrix()).maxCoeff(&at);
      add_strap(sheet, std::string("hip") + suffix, V.row(at).transpose(), Vec3(x, 0, 0),
                kHipStrap);
    }
    add_strap(sheet, std::string("leg") + suffix, outermost(1), Vec3(x, 0, kHookAlong), kLegStrap);
  }
}

void take_frame(const CarryModel& model, const CarryState& state, std::vector<LiftFrame>& frames) {
  LiftFrame frame;
  frame.time = state.time;
  frame.pose = state.body.pose;
  frame.nodes = state.nodes;
  frame.bar = state.bar;
  frame.skin = state.pressed.cast<float>();
  const std::vector<double> smooth =
      smooth_pressure(model.patient.skin.F, state.forces.pressure, state.forces.contact_area);
  frame.pressure.assign(smooth.begin(), smooth.end());
  frame.region = state.forces.region;
  frame.straps = state.forces.straps;
  frame.strap_lift = state.forces.strap_sum.y();
  frame.mattress_lift = state.forces.mattress.y();
  frame.pads = state.forces.pads;
  frame.limit_excess = worst_limit_excess(model.patient, state.body.pose);
  frames.push_back(std::move(frame));
}

double core_time() { return double(std::clock()) / CLOCKS_PER_SEC; }

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Sheet make_sling(const Patient& patient, const Pose& lying, const SlingOptions& options) {
  const Reach reach = reach_of(patient, lying, options);
  Sheet sheet = make_sheet(rectangle(options.width, reach.legs - reach.head,
                                     0.5 * (reach.legs + reach.head), options.spacing),
                           options.material);
  add_straps_at_corners(options, joint_place(patient, lying, "pelvis").z(), sheet);
  return sheet;
}

Sheet make_sling(const Patient& patient, const Pose& lying, const TriMesh& mesh,
                 const SlingOptions& options) {
  const Reach reach = reach_of(patient, lying, options);
  TriMesh moved = mesh;
  moved.V.col(2).array() += reach.head - mesh.V.col(2).minCoeff();
  moved.V.col(0).array() -= 0.5 * (mesh.V.col(0).minCoeff() + mesh.V.col(0).maxCoeff());
  moved.V.col(1).array() -= mesh.V.col(1).minCoeff();
  // Its upper side is towards the body.
  if (vertex_normals(moved).col(1).sum() < 0) moved.F.col(1).swap(moved.F.col(2));
  Sheet sheet = make_sheet(moved, options.material);
  add_straps_at_corners(options, joint_place(patient, lying, "pelvis").z(), sheet);
  return sheet;
}

Vec3 bar_start(const CarryModel& model, const Pose& lying, const LiftOptions& options) {
  const double z = joint_place(model.patient, lying, "pelvis").z() - 0.12;
  return {0, model.mattress.height + options.bar_height, z};
}

LiftResult lift_patient(const CarryModel& model, const Pose& lying, const LiftOptions& options,
                        const std::function<void(double)>& progress) {
  LiftResult out;
  Pose pose = lying;
  pose.root.y() += kSheetHeight;
  CarryState state =
      start_carrying(model, pose, kSheetHeight * Vec3::UnitY(), bar_start(model, lying, options));
  double farthest = 0;
  for (std::size_t s = 0; s < state.strap_lengths.size(); ++s) {
    const Strap& strap = model.sheet->straps[s];
    double longest = strap.length;
    for (const int node : strap.nodes)
      longest =
          std::max(longest, (state.nodes.row(node).transpose() - state.bar - strap.hook).norm());
    state.strap_lengths[s] = longest;
    farthest = std::max(farthest, longest - strap.length);
  }
  const std::vector<double> slack = state.strap_lengths;
  const double h = model.options.step, draw = farthest / options.draw_speed,
               rise = 1.5 * options.rise / options.rise_speed,  // of a smooth step
      end = options.lie + draw + rise + options.hang;
  const Vec3 bar = state.bar;
  for (int frame = 0; state.time < end - 0.5 * h;) {
    const double next = state.time + h;
    const double drawn = std::clamp((next - options.lie) / draw, 0.0, 1.0);
    for (std::size_t s = 0; s < slack.size(); ++s)
      state.strap_lengths[s] =
          std::lerp(slack[s], model.sheet->straps[s].length, smooth_step(drawn));
    const double risen = options.rise * smooth_step((next - options.lie - draw) / rise);
    const double start = now(), core_start = core_time();
    carry(model, (bar + risen * Vec3::UnitY() - state.bar) / h, state);
    out.seconds += now() - start;
    out.core_seconds += core_time() - core_start;
    if (state.time + 0.5 * h >= frame / options.frames_per_second) {
      take_frame(model, state, out.frames);
      ++frame;
    }
    if (progress) progress(state.time / end);
  }
  out.last = std::move(state);
  return out;
}

LiftResult rest_patient(const CarryModel& model, const Pose& pose, double seconds,
                        double frames_per_second) {
  LiftResult out;
  CarryState state = start_carrying(model, pose, Vec3::Zero(), Vec3::Zero());
  const double start = now(), core_start = core_time();
  const double h = model.options.step;
  while (state.time < seconds - 0.5 * h) {
    carry(model, Vec3::Zero(), state);
    if (frames_per_second > 0 &&
        state.time + 0.5 * h >= double(out.frames.size()) / frames_per_second)
      take_frame(model, state, out.frames);
  }
  out.seconds = now() - start;
  out.core_seconds = core_time() - core_start;
  if (out.frames.empty()) take_frame(model, state, out.frames);
  out.last = std::move(state);
  return out;
}

}  // namespace ecorche::inline v1
