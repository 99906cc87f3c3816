#include "skinning/dynamics/inverse_dynamics.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "skinning/constraints/belt.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/dynamics/smooth_motion.h"
#include "skinning/dynamics/supported_path.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kShortestFlight = 0.08;  // s
constexpr double kEnds = 0.05;            // s, without figures
constexpr double kNoContact = 1e-3;       // of a point's gate
constexpr double kSpread = 0.12;          // periods of the cut-off, to either side
constexpr double kSharper = 1.25;         // the force's cut-off over the motion's
constexpr double kLowPoint = 0.03;        // m over the floor: it may stand on a belt
// Root mean square change of its acceleration: more is asked where contacts are seen too short, and
// the path would bounce higher than the person did.
constexpr double kMostChange = 0.35 * kGravity;
constexpr double kMostShift = 0.025;  // m, of a centre of mass that is brought to its support

// Soles over a motion.
struct Soles {
  std::vector<SolePoint> points;
  std::vector<double> floor;                       // #frames
  std::vector<std::vector<SoleContact>> contacts;  // #frames x #points
  Vec3 belt = Vec3::Zero();                        // what they stand on moves, m/s
};

Vec3 belt_under(const Soles& soles) {
  std::vector<Vec3> low;
  for (std::size_t f = 0; f < soles.contacts.size(); ++f)
    for (const SoleContact& c : soles.contacts[f])
      if (c.place.y() - soles.floor[f] < kLowPoint) low.push_back(c.velocity);
  return belt_velocity(low);
}

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
    }
  }
  out.belt = belt_under(out);
  for (std::size_t f = 0; f < n; ++f)
    for (SoleContact& c : out.contacts[f])
      c.gate = contact_gate(c.place.y() - out.floor[f], c.velocity - out.belt);
  return out;
}

// Where the feet are rolled over at one moment. `velocity`: of the body over what it stands on.
std::array<RollOver, 2> find_rolls(const std::array<FootShape, 2>& shapes, double sole_height,
                                   const std::vector<Vec3>& rest, const std::vector<Transform>& X,
                                   const Skeleton& skeleton, const Vec3& velocity) {
  std::array<RollOver, 2> out;
  for (std::size_t f = 0; f < 2; ++f) {
    const FootShape& foot = shapes[f];
    const FootPoints points = foot_points(skeleton, foot, X);
    out[f] = roll_over(X[foot.knee].translation(), X[foot.ankle].translation(),
                       rest[foot.ankle].y() - sole_height, points.heel, points.ball, velocity);
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

Vec3 center_of(const Skeleton& skeleton, std::span<const BodySegment> segments, const Pose& pose,
               std::vector<Transform>& X) {
  forward_kinematics(skeleton, pose, X);
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (const BodySegment& segment : segments)
    sum += segment.mass * (X[segment.joint] * segment.center), mass += segment.mass;
  return sum / mass;
}

std::vector<ExternalForce> forces_of(const std::array<FootForce, 2>& feet,
                                     const std::array<int, 2>& joints) {
  std::vector<ExternalForce> out;
  for (std::size_t f = 0; f < 2; ++f)
    out.push_back({joints[f], feet[f].place, feet[f].force, Vec3(0, feet[f].free_moment, 0)});
  return out;
}

// Brings the centre of mass of a motion with flights to a path that the contacts can give, where
// that is near to the one that was recorded: a body that sits or hangs has no such path, and stays
// where it is.
double support_center(const Skeleton& skeleton, std::span<const BodySegment> segments,
                      const Motion& motion, const Soles& soles, double cutoff,
                      std::vector<MotionState>& states) {
  std::vector<Vec3> seen, smoothed;
  std::vector<double> contact;
  std::vector<Transform> X;
  for (std::size_t f = 0; f < states.size(); ++f) {
    seen.push_back(center_of(skeleton, segments, motion.frames[f], X));
    smoothed.push_back(center_of(skeleton, segments, states[f].pose, X));
    double most = 0;
    for (const SoleContact& c : soles.contacts[f]) most = std::max(most, c.gate);
    contact.push_back(most);
  }
  const SupportedPath path = supported_path(seen, contact, motion.fps, cutoff);
  if (path.moved > kMostShift) return 0;
  const double rate = motion.fps;
  double off = 0;
  for (std::size_t f = 1; f + 1 < states.size(); ++f)
    off +=
        (path.acceleration[f] - rate * rate * (smoothed[f + 1] - 2 * smoothed[f] + smoothed[f - 1]))
            .squaredNorm();
  if (off > kMostChange * kMostChange * double(states.size())) return 0;
  for (std::size_t f = 0; f < states.size(); ++f) {
    const std::size_t at = std::clamp<std::size_t>(f, 1, states.size() - 2);
    const auto change = [&](std::size_t g) { return Vec3(path.place[g] - smoothed[g]); };
    MotionState& state = states[f];
    const Vec3 was = rate * rate * (smoothed[at + 1] - 2 * smoothed[at] + smoothed[at - 1]);
    state.root_acceleration += path.acceleration[at] - was;
    state.root_velocity += 0.5 * rate * (change(at + 1) - change(at - 1));
    state.pose.root += change(f);
  }
  return path.moved;
}

}  // namespace

MotionDynamics inverse_dynamics(const Skeleton& skeleton, std::span<const BodySegment> segments,
                                double sole_height, const Motion& motion,
                                const DynamicsOptions& options) {
  if (motion.frames.size() < 3 || !(motion.fps > 0))
    throw std::invalid_argument("inverse_dynamics: a motion of fewer than three frames");
  if (!options.measured.empty() && options.measured.size() != motion.frames.size())
    throw std::invalid_argument("inverse_dynamics: measured forces of other frames");
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
    out.belt = soles.belt;
    widen_contacts(out.fps, out.cutoff, soles);
    if (out.cutoff > 0 && flies(soles, motion.fps))
      out.center_moved =
          support_center(skeleton, segments, motion, soles, kSharper * out.cutoff, out.states);
  }
  const std::array<int, 2> feet{find_joint(skeleton, "subtalar_l"),
                                find_joint(skeleton, "subtalar_r")};
  const std::array<FootShape, 2> shapes{foot_shape(skeleton, Side::left, sole_height),
                                        foot_shape(skeleton, Side::right, sole_height)};
  const std::vector<Vec3> rest = rest_positions(skeleton);
  out.frames.resize(out.states.size());
  tbb::parallel_for(std::size_t{0}, out.frames.size(), [&](std::size_t f) {
    DynamicsFrame& frame = out.frames[f];
    find_joint_loads(skeleton, segments, out.states[f], {}, frame.loads);
    if (options.ground) {
      frame.contact = sum_of_gates(soles.contacts[f]);
      const GroundReaction ground =
          share_ground_reaction(frame.loads.joints[0], frame.loads.X_WJ[0].translation(),
                                out.weight, soles.floor[f], soles.points, soles.contacts[f],
                                find_rolls(shapes, sole_height, rest, frame.loads.X_WJ, skeleton,
                                           frame.loads.momentum.velocity - soles.belt));
      frame.feet = frame.estimated = ground.feet;
      if (!ground.forces.empty() && options.measured.empty())
        find_joint_loads(skeleton, segments, out.states[f], ground.forces, frame.loads);
    }
    if (!options.measured.empty()) {
      frame.feet = options.measured[f];
      find_joint_loads(skeleton, segments, out.states[f], forces_of(frame.feet, feet), frame.loads);
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
