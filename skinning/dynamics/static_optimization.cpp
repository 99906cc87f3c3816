#include "skinning/dynamics/static_optimization.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "anatomy/compute/cholesky.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/dynamics/joint_loads.h"
#include "skinning/motion/center_of_mass.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kRate = 20;                      // samples a second
constexpr double kSpan = 0.04;                    // s, to either side, for accelerations
constexpr double kStress = 3e5;                   // N/m^2 of a muscle's section
constexpr double kLeastRange = 0.15;              // rad; axes that turn less are held by the joint
constexpr double kStepStaticOptimization = 0.01;  // rad, for moment arms
constexpr double kStiffness = 1e3;                // of the reserve, over capacity squared
constexpr double kLowFoot = 0.04, kFastFoot = 0.8;  // m, m/s
constexpr double kFlight = 0.1;                     // of the weight: less than that is flight
constexpr double kLeastEffort = 0.005;

struct Axis {
  int joint = 0;
  Vec3 direction = Vec3::UnitX();  // in the joint's frame
};

Pose pose_between(const Motion& motion, double seconds) {
  const double at = std::clamp(seconds * motion.fps, 0.0, double(motion.frames.size() - 1));
  const std::size_t k = at;
  const Pose &a = motion.frames[k], &b = motion.frames[std::min(k + 1, motion.frames.size() - 1)];
  const double share = at - double(k);
  Pose pose = a;
  pose.root = (1 - share) * a.root + share * b.root;
  for (std::size_t j = 0; j < pose.rotations.size(); ++j)
    pose.rotations[j] = a.rotations[j].slerp(share, b.rotations[j]);
  return pose;
}

std::vector<Axis> loaded_axes(const Skeleton& skeleton) {
  std::vector<Axis> axes;
  for (const char* name :
       {"l4",        "t12",        "thorax",     "c5",         "head",      "scapula_l",
        "scapula_r", "shoulder_l", "shoulder_r", "elbow_l",    "elbow_r",   "forearm_l",
        "forearm_r", "wrist_l",    "wrist_r",    "hip_l",      "hip_r",     "knee_l",
        "knee_r",    "ankle_l",    "ankle_r",    "subtalar_l", "subtalar_r"}) {
    const int j = joint_of(skeleton, name);
    const Joint& joint = skeleton.joints[j];
    for (int k = 0; k < 3; ++k)
      if (joint.max[k] - joint.min[k] > kLeastRange) axes.push_back({j, joint.axes.col(k)});
  }
  return axes;
}

// A force somewhere on the body.
struct Load {
  int joint = 0;                                    // that carries the place
  Vec3 place = Vec3::Zero(), force = Vec3::Zero();  // what the muscles have to give, world
};

struct Ground {
  std::array<FootShape, 2> feet;
  std::vector<double> floor;  // a frame
};

class Dynamics {
 public:
  Dynamics(const Anatomy& anatomy, const Body& body, const Motion& motion)
      : skeleton_(anatomy.skeleton),
        motion_(motion),
        center_(anatomy.skeleton),
        mass_(body.mass > 0 ? body.mass : 70) {
    const double sole =
        body.skin.V.rows() > 0 ? body.skin.V.col(1).minCoeff() : guess_sole_height(skeleton_);
    ground_.feet = {foot_shape(skeleton_, Side::left, sole),
                    foot_shape(skeleton_, Side::right, sole)};
    std::array<FootPaths, 2> paths;
    std::vector<Transform> X;
    for (const Pose& pose : motion.frames) {
      forward_kinematics(skeleton_, pose, X);
      for (std::size_t f = 0; f < 2; ++f) {
        const FootPoints points = foot_points(skeleton_, ground_.feet[f], X);
        paths[f].heel.push_back(points.heel);
        paths[f].ball.push_back(points.ball);
      }
    }
    ground_.floor = floor_heights(paths, motion);
  }

  // Loads at a moment; X: frames then. The ground's share of the weight comes back over the weight.
  std::vector<Load> loads(double seconds, const std::vector<Transform>& X, double& carried) const {
    std::vector<Transform> before, after;
    forward_kinematics(skeleton_, pose_between(motion_, seconds - kSpan), before);
    forward_kinematics(skeleton_, pose_between(motion_, seconds + kSpan), after);
    std::vector<Load> out;
    Vec3 force = Vec3::Zero(), center = Vec3::Zero();
    const bool inside =
        seconds >= kSpan && seconds + kSpan <= double(motion_.frames.size() - 1) / motion_.fps;
    for (const CenterOfMass::Segment& s : center_.segments()) {
      const std::size_t j = s.joint;
      const Vec3 at = X[j] * s.centre;
      Vec3 acceleration = Vec3::Zero();
      if (inside)
        acceleration = (before[j] * s.centre - 2 * at + after[j] * s.centre) / (kSpan * kSpan);
      acceleration.y() += kGravity;
      out.push_back({s.joint, at, s.mass * mass_ * acceleration});
      force += out.back().force;
      center += s.mass * at;
    }
    carried = std::max(0.0, force.y()) / (mass_ * kGravity);
    if (carried < kFlight)
      carried = 0;
    else
      stand(seconds, X, before, after, force, center, out);
    return out;
  }

 private:
  // The ground's force at the points of the feet that stand, against what the body asks for.
  void stand(double seconds, const std::vector<Transform>& X, const std::vector<Transform>& before,
             const std::vector<Transform>& after, const Vec3& force, const Vec3& center,
             std::vector<Load>& out) const {
    const std::size_t frame =
        std::clamp(std::lround(seconds * motion_.fps), 0L, long(ground_.floor.size()) - 1);
    const double floor = ground_.floor[frame];
    const Vec3 wanted = center - (center.y() - floor) / std::max(force.y(), 1.0) * force;
    struct Point {
      Vec3 at;
      int joint;
      double weight;
    };
    std::vector<Point> points;
    double sum = 0;
    for (const FootShape& foot : ground_.feet) {
      const FootPoints now = foot_points(skeleton_, foot, X),
                       was = foot_points(skeleton_, foot, before),
                       will = foot_points(skeleton_, foot, after);
      const auto add = [&](const Vec3& at, const Vec3& speed) {
        const double low = std::clamp((2 * kLowFoot - (at.y() - floor)) / kLowFoot, 0.0, 1.0),
                     slow = std::clamp(2 - speed.norm() / kFastFoot, 0.0, 1.0);
        const double away =
            (at - wanted).head<1>().squaredNorm() + (at - wanted).tail<1>().squaredNorm();
        points.push_back(
            {at, foot.subtalar, low * slow * std::exp(-away / 0.02) + 1e-9 * low * slow});
        sum += points.back().weight;
      };
      add(now.heel, (will.heel - was.heel) / (2 * kSpan));
      add(now.ball, (will.ball - was.ball) / (2 * kSpan));
    }
    if (!(sum > 0)) return;  // something else carries the body: its joints are loaded as if it hung
    for (const Point& p : points)
      if (p.weight > 0) out.push_back({p.joint, p.at, -(p.weight / sum) * force});
  }

  const Skeleton& skeleton_;
  const Motion& motion_;
  CenterOfMass center_;
  double mass_;
  Ground ground_;
};

bool carries(const Skeleton& skeleton, int joint, int part) {
  while (part > joint) part = skeleton.joints[part].parent;
  return part == joint;
}

// Largest pull of each muscle, N, and the share of its strips in it.
struct Pulls {
  std::vector<double> muscle, strip;
};

Pulls find_pulls(const Anatomy& anatomy, const std::vector<SliceRange>& ranges) {
  Pulls pulls;
  for (const Muscle& muscle : anatomy.muscles)
    pulls.muscle.push_back(muscle.fibre_length > 0
                               ? kStress * muscle.volume * std::cos(muscle.pennation) /
                                     muscle.fibre_length
                               : 0);
  for (const SliceRange& range : ranges)
    pulls.strip.push_back(pulls.muscle[range.muscle] /
                          double(anatomy.muscles[range.muscle].strips.size()));
  return pulls;
}

// What each muscle at full effort gives about each axis, N m.
Eigen::MatrixXd moments_of(const PosingTable& table, const Skeleton& skeleton, const Pose& pose,
                           const std::vector<Axis>& axes, const std::vector<SliceRange>& ranges,
                           const Pulls& pulls) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(axes.size(), Eigen::Index(pulls.muscle.size()));
  PosedAnatomy less, more;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto turned = [&](double angle) {
      Pose p = pose;
      Quat& q = p.rotations[axes[i].joint];
      q = q * Quat(Eigen::AngleAxisd(angle, axes[i].direction));
      complete_pose(skeleton, p);
      return p;
    };
    pose_anatomy(table, skeleton, turned(-kStepStaticOptimization), less);
    pose_anatomy(table, skeleton, turned(kStepStaticOptimization), more);
    for (std::size_t s = 0; s < ranges.size(); ++s) {
      const double arm = std::clamp(
          -(more.lengths[s] - less.lengths[s]) / (2 * kStepStaticOptimization), -0.12, 0.12);
      A(i, ranges[s].muscle) += arm * pulls.strip[s];
    }
  }
  return A;
}

}  // namespace

Eigen::VectorXd distribute_moments(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                   double stiffness) {
  constexpr int kSteps = 60;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  const auto efforts = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    return (A.transpose() * at).cwiseMax(0.0).cwiseMin(1.0);
  };
  // The dual, convex; its gradient is x / stiffness + A a - b.
  const auto value = [&](const Eigen::VectorXd& at) {
    const Eigen::ArrayXd s = (A.transpose() * at).array();
    const double sum = (s > 1).select(s - 0.5, (s > 0).select(0.5 * s.square(), 0.0)).sum();
    return at.squaredNorm() / (2 * stiffness) + sum - b.dot(at);
  };
  double now = value(x);
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::VectorXd s = A.transpose() * x, gradient = x / stiffness + A * efforts(x) - b;
    if (gradient.norm() <= 1e-9 * (1 + b.norm())) break;
    Eigen::MatrixXd H = Eigen::MatrixXd::Identity(b.size(), b.size()) / stiffness;
    for (Eigen::Index m = 0; m < A.cols(); ++m)
      if (s[m] >= 0 && s[m] < 1) H.noalias() += A.col(m) * A.col(m).transpose();
    const Eigen::VectorXd direction = -solve_ldlt(H, gradient);
    const double slope = gradient.dot(direction);
    double length = 1;
    for (int halvings = 0; halvings < 40; ++halvings, length *= 0.5) {
      const double next = value(x + length * direction);
      if (next <= now + 1e-4 * length * slope) {
        x += length * direction;
        now = next;
        break;
      }
    }
    if (length < 1e-11) break;
  }
  return efforts(x);
}

Activations auto_activations(const PosingTable& table, const Anatomy& anatomy, const Body& body,
                             const Motion& motion, AutoActivationReport& report) {
  if (motion.frames.empty() || !(motion.fps > 0))
    throw std::invalid_argument("auto_activations: a motion without frames");
  const Skeleton& skeleton = anatomy.skeleton;
  const Dynamics dynamics(anatomy, body, motion);
  const std::vector<Axis> axes = loaded_axes(skeleton);
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  const Pulls pulls = find_pulls(anatomy, ranges);
  const double end = double(motion.frames.size() - 1) / motion.fps;
  const int samples = int(std::ceil(end * kRate)) + 1;
  std::vector<double> times, missing(std::size_t(samples), 0.0), carried(std::size_t(samples), 0.0);
  for (int i = 0; i < samples; ++i) times.push_back(std::min(end, i / kRate));
  if (samples > 1 && !(times.back() > times[times.size() - 2]))
    times.back() = times[times.size() - 2] + 1e-6;
  Eigen::MatrixXd efforts(anatomy.muscles.size(), samples);
  tbb::parallel_for(0, samples, [&](int i) {
    const std::size_t at = i;
    const Pose pose = pose_between(motion, times[at]);
    std::vector<Transform> X;
    forward_kinematics(skeleton, pose, X);
    const std::vector<Load> loads = dynamics.loads(times[at], X, carried[at]);
    Eigen::MatrixXd A = moments_of(table, skeleton, pose, axes, ranges, pulls);
    Eigen::VectorXd b(A.rows());
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const Transform& frame = X[axes[k].joint];
      Vec3 moment = Vec3::Zero();
      for (const Load& load : loads)
        if (carries(skeleton, axes[k].joint, load.joint))
          moment += (load.place - frame.translation()).cross(load.force);
      b[k] = moment.dot(frame.linear() * axes[k].direction);
    }
    const Eigen::VectorXd capacity = A.rowwise().norm().cwiseMax(1.0),
                          wanted = b.cwiseQuotient(capacity);
    A = capacity.cwiseInverse().asDiagonal() * A;
    const Eigen::VectorXd a = distribute_moments(A, wanted, kStiffness);
    efforts.col(i) = a;
    missing[at] = wanted.norm() > 1e-9 ? (A * a - wanted).norm() / wanted.norm() : 0;
  });
  report.samples = samples;
  report.reserve_share = report.ground_force_peak = 0;
  for (int i = 0; i < samples; ++i) {
    report.reserve_share += missing[i] / samples;
    report.ground_force_peak = std::max(report.ground_force_peak, carried[i]);
  }
  Activations out;
  out.muscles = anatomy.muscles.size();
  for (Eigen::Index m = 0; m < efforts.rows(); ++m) {
    if (efforts.row(m).maxCoeff() < kLeastEffort) continue;
    ActivationCurve curve{{int(m)}, times, {}};
    for (int i = 0; i < samples; ++i)  // muscles do not switch: a mean of three neighbours
      curve.values.push_back(0.25 * efforts(m, std::max(i - 1, 0)) + 0.5 * efforts(m, i) +
                             0.25 * efforts(m, std::min(i + 1, samples - 1)));
    out.curves.push_back(std::move(curve));
  }
  return out;
}

}  // namespace ecorche::inline v1
