#include "skinning/dynamics/inverse_dynamics.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "skinning/constraints/foot_contacts.h"
#include "skinning/dynamics/smooth_motion.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kShortestFlight = 0.08;  // s
constexpr double kEnds = 0.05;            // s, without figures
constexpr double kNoContact = 1e-3;       // of a point's gate
constexpr double kSpread = 0.12;          // periods of the cut-off, to either side

// Soles over a motion.
struct Soles {
  std::vector<SolePoint> points;
  std::vector<double> floor;                       // #frames
  std::vector<std::vector<SoleContact>> contacts;  // #frames x #points
};

Soles find_soles(const Skeleton& skeleton, double sole_height, const Motion& motion) {
  Soles out;
  out.points = sole_points(skeleton, sole_height);
  const std::array<FootShape, 2> shapes{foot_shape(skeleton, Side::left, sole_height),
                                        foot_shape(skeleton, Side::right, sole_height)};
  std::array<FootPaths, 2> paths;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    for (std::size_t f = 0; f < 2; ++f) {
      const FootPoints points = foot_points(skeleton, shapes[f], X);
      paths[f].heel.push_back(points.heel);
      paths[f].ball.push_back(points.ball);
    }
    std::vector<SoleContact>& now = out.contacts.emplace_back();
    for (const SolePoint& point : out.points) now.push_back({X[point.joint] * point.place});
  }
  out.floor = floor_heights(paths, motion);
  const std::size_t n = motion.frames.size();
  for (std::size_t f = 0; f < n; ++f) {
    const std::size_t before = f > 0 ? f - 1 : 0, after = std::min(f + 1, n - 1);
    for (std::size_t i = 0; i < out.points.size(); ++i) {
      SoleContact& c = out.contacts[f][i];
      c.velocity = (out.contacts[after][i].place - out.contacts[before][i].place) * motion.fps /
                   double(after - before);
      c.gate = contact_gate(c.place.y() - out.floor[f], c.velocity);
    }
  }
  return out;
}

// Smoothing spreads an impact over the time before and after it; contacts last as much longer.
void widen_contacts(double fps, double cutoff, Soles& soles) {
  const int reach = cutoff > 0 ? int(std::lround(kSpread / cutoff * fps)) : 0,
            n = int(soles.contacts.size());
  if (reach == 0) return;
  const std::vector<std::vector<SoleContact>> was = soles.contacts;
  for (int f = 0; f < n; ++f)
    for (std::size_t i = 0; i < soles.points.size(); ++i)
      for (int g = std::max(0, f - reach); g <= std::min(n - 1, f + reach); ++g)
        soles.contacts[f][i].gate = std::max(
            soles.contacts[f][i].gate, was[g][i].gate * (1 - std::abs(g - f) / (reach + 1.0)));
}

double sum_of_gates(const std::vector<SoleContact>& contacts) {
  double sum = 0;
  for (const SoleContact& c : contacts) sum += c.gate;
  return sum;
}

bool flies(const Soles& soles, double fps) {
  int longest = 0, now = 0;
  for (const std::vector<SoleContact>& contacts : soles.contacts) {
    now = sum_of_gates(contacts) < kNoContact ? now + 1 : 0;
    longest = std::max(longest, now);
  }
  return longest >= kShortestFlight * fps;
}

Motion poses_of(const std::vector<MotionState>& states, double fps) {
  Motion out{fps, {}};
  for (const MotionState& state : states) out.frames.push_back(state.pose);
  return out;
}

void add_figures(MotionDynamics& out) {
  const std::size_t n = out.frames.size(),
                    ends = std::min(n / 3, std::size_t(std::ceil(kEnds * out.fps)));
  double count = 0, forces = 0, moments = 0, flights = 0;
  for (std::size_t f = ends; f + ends < n; ++f) {
    const DynamicsFrame& frame = out.frames[f];
    const double vertical = (frame.feet[0].force.y() + frame.feet[1].force.y()) / out.weight,
                 force = frame.residual_force.norm() / out.weight,
                 moment = frame.residual_moment.norm() / (out.weight * out.center_height);
    ++count;
    out.mean_vertical += vertical;
    out.peak_vertical = std::max(out.peak_vertical, vertical);
    out.residual_force_peak = std::max(out.residual_force_peak, force);
    forces += force * force;
    moments += moment * moment;
    if (frame.contact < kNoContact) {
      ++out.flight_frames;
      flights += force * force;
    }
  }
  out.mean_vertical /= count;
  out.residual_force_rms = std::sqrt(forces / count);
  out.residual_moment_rms = std::sqrt(moments / count);
  out.flight_residual_rms = out.flight_frames > 0 ? std::sqrt(flights / out.flight_frames) : 0;
}

}  // namespace

MotionDynamics inverse_dynamics(const Skeleton& skeleton, std::span<const BodySegment> segments,
                                double sole_height, const Motion& motion,
                                const DynamicsOptions& options) {
  if (motion.frames.size() < 3 || !(motion.fps > 0))
    throw std::invalid_argument("inverse_dynamics: a motion of fewer than three frames");
  double mass = 0;
  for (const BodySegment& segment : segments) mass += segment.mass;
  if (!(mass > 0)) throw std::invalid_argument("inverse_dynamics: a body without mass");
  MotionDynamics out;
  out.fps = motion.fps;
  out.weight = mass * kGravity;
  out.cutoff = options.cutoff >= 0                                            ? options.cutoff
               : flies(find_soles(skeleton, sole_height, motion), motion.fps) ? kFlyingCutoff
                                                                              : kWalkingCutoff;
  out.states = smooth_motion(motion, out.cutoff);
  Soles soles;
  if (options.ground) {
    soles = find_soles(skeleton, sole_height, poses_of(out.states, motion.fps));
    widen_contacts(out.fps, out.cutoff, soles);
  }
  out.frames.resize(out.states.size());
  tbb::parallel_for(std::size_t{0}, out.frames.size(), [&](std::size_t f) {
    DynamicsFrame& frame = out.frames[f];
    find_joint_loads(skeleton, segments, out.states[f], {}, frame.loads);
    if (options.ground) {
      frame.contact = sum_of_gates(soles.contacts[f]);
      const GroundReaction ground =
          share_ground_reaction(frame.loads.joints[0], frame.loads.X_WJ[0].translation(),
                                out.weight, soles.floor[f], soles.points, soles.contacts[f]);
      frame.feet = ground.feet;
      if (!ground.forces.empty())
        find_joint_loads(skeleton, segments, out.states[f], ground.forces, frame.loads);
    }
    const JointLoad& left = frame.loads.joints[0];
    frame.residual_force = left.force;
    frame.residual_moment =
        left.moment +
        (frame.loads.X_WJ[0].translation() - frame.loads.momentum.center).cross(left.force);
  });
  for (std::size_t f = 0; f < out.frames.size(); ++f)
    out.center_height +=
        (out.frames[f].loads.momentum.center.y() - (options.ground ? soles.floor[f] : 0)) /
        double(out.frames.size());
  add_figures(out);
  return out;
}

}  // namespace ecorche::inline v1
