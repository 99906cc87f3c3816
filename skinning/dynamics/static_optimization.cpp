#include "skinning/dynamics/static_optimization.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "anatomy/muscles/force_curves.h"
#include "anatomy/posing/moment_arms.h"
#include "skinning/dynamics/distribute_moments.h"
#include "skinning/dynamics/strip_forces.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMostRate = 60;      // samples a second
constexpr double kLeastRange = 0.15;  // rad; axes that turn less are held by the joint
constexpr double kMostArm = 0.15;     // m
constexpr double kStiffness = 1e4;    // of the reserve, over capacity squared
constexpr double kLeastCapacity = 1;  // N m
constexpr int kRounds = 2;            // forces stretch tendons, which change the forces
constexpr double kLeastEffort = 0.005;

struct Axes {
  std::vector<TurnAxis> turns;
  std::vector<MuscleMoment> moments;
};

Axes loaded_axes(const Skeleton& skeleton, std::size_t samples) {
  constexpr std::array kTurns{"_flexion", "_abduction", "_rotation"};
  Axes out;
  for (const char* name :
       {"l4",        "t12",        "thorax",     "c5",         "head",      "scapula_l",
        "scapula_r", "shoulder_l", "shoulder_r", "elbow_l",    "elbow_r",   "forearm_l",
        "forearm_r", "wrist_l",    "wrist_r",    "hip_l",      "hip_r",     "knee_l",
        "knee_r",    "ankle_l",    "ankle_r",    "subtalar_l", "subtalar_r"}) {
    const int j = joint_of(skeleton, name);
    const Joint& joint = skeleton.joints[j];
    const bool hinge = std::string_view(name).starts_with("knee");
    for (int k = 0; k < (hinge ? 1 : 3); ++k) {
      if (joint.max[k] - joint.min[k] <= kLeastRange) continue;
      out.turns.push_back({j, joint.axes.col(k)});
      out.moments.push_back({std::string(name) + kTurns[std::size_t(k)], j,
                             std::vector<double>(samples, 0), std::vector<double>(samples, 0)});
    }
  }
  return out;
}

std::vector<std::size_t> sampled_frames(const MotionDynamics& dynamics) {
  const std::size_t n = dynamics.frames.size(),
                    step = std::max(1.0, std::ceil(dynamics.fps / kMostRate - 1e-6));
  std::vector<std::size_t> out;
  for (std::size_t f = 0; f < n; f += step) out.push_back(f);
  if (n > 0 && out.back() + 1 < n) out.push_back(n - 1);
  return out;
}

// What does not change from round to round. #samples
struct Sample {
  std::vector<double> lengths;  // #strips, m
  std::vector<float> arms;      // #pairs, m
  Eigen::VectorXd dual;
};

class Optimization {
 public:
  Optimization(const PosingTable& table, const Anatomy& anatomy, const MotionDynamics& dynamics)
      : dynamics_(dynamics),
        frames_(sampled_frames(dynamics)),
        axes_(loaded_axes(anatomy.skeleton, frames_.size())),
        arms_(table, anatomy.skeleton, axes_.turns),
        strips_(strip_forces(anatomy)),
        muscles_(anatomy.muscles.size()),
        samples_(frames_.size()),
        missing_(frames_.size(), 0) {
    if (table.strips() != int(strips_.size()))
      throw std::invalid_argument("static_optimization: a table of another anatomy");
    for (const std::size_t f : frames_) out_.times.push_back(double(f) / dynamics.fps);
    efforts_ = strains_ =
        Eigen::MatrixXd::Zero(Eigen::Index(strips_.size()), Eigen::Index(frames_.size()));
    columns_.assign(strips_.size(), -1);
    for (const MomentArm& pair : arms_.pairs()) {
      const std::size_t s = std::size_t(pair.strip);
      if (columns_[s] >= 0 || !(strips_[s].largest > 0)) continue;
      columns_[s] = int(pulling_.size());
      pulling_.push_back(s);
    }
    cost_.resize(Eigen::Index(pulling_.size()));
    for (std::size_t k = 0; k < pulling_.size(); ++k)
      cost_[Eigen::Index(k)] = std::max(strips_[pulling_[k]].share, 1e-3);
  }

  MuscleEfforts solve() {
    each_sample([&](std::size_t i) {
      arms_.find(dynamics_.states[frames_[i]].pose, samples_[i].lengths, samples_[i].arms);
    });
    for (int round = 0; round < kRounds; ++round) {
      const Eigen::MatrixXd strains = strains_;  // the round before's, of neighbours too
      each_sample([&](std::size_t i) { solve_sample(i, strains); });
    }
    gather();
    return std::move(out_);
  }

 private:
  template <class Work>
  void each_sample(const Work& work) const {
    tbb::parallel_for(std::size_t{0}, frames_.size(), work);
  }

  double along(std::size_t strip, std::size_t i, const Eigen::MatrixXd& strains) const {
    return fibre_along(strips_[strip], samples_[i].lengths[strip],
                       strains(Eigen::Index(strip), Eigen::Index(i)));
  }

  Pull pull(std::size_t strip, std::size_t i, const Eigen::MatrixXd& strains) const {
    const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, frames_.size() - 1);
    const double span = out_.times[after] - out_.times[before];
    const double speed =
        span > 0 ? (along(strip, after, strains) - along(strip, before, strains)) / span : 0;
    return pull_of(strips_[strip], along(strip, i, strains), speed);
  }

  void solve_sample(std::size_t i, const Eigen::MatrixXd& strains) {
    const Eigen::Index n = Eigen::Index(axes_.turns.size()), m = Eigen::Index(pulling_.size());
    std::vector<Pull> pulls;
    for (const std::size_t s : pulling_) pulls.push_back(pull(s, i, strains));
    const BodyLoads& loads = dynamics_.frames[frames_[i]].loads;
    Eigen::VectorXd wanted(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const TurnAxis& turn = axes_.turns[std::size_t(k)];
      wanted[k] =
          loads.joints[turn.joint].moment.dot(loads.X_WJ[turn.joint].linear() * turn.direction);
    }
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, m);
    Eigen::VectorXd active = wanted;
    for (std::size_t k = 0; k < arms_.pairs().size(); ++k) {
      const auto [axis, strip] = arms_.pairs()[k];
      const int column = columns_[std::size_t(strip)];
      if (column < 0) continue;
      const double moment = std::clamp(double(samples_[i].arms[k]), -kMostArm, kMostArm) *
                            strips_[std::size_t(strip)].largest;
      A(axis, column) = moment * pulls[std::size_t(column)].active;
      active[axis] -= moment * pulls[std::size_t(column)].passive;
    }
    const Eigen::VectorXd capacity = A.rowwise().norm().cwiseMax(kLeastCapacity);
    A = capacity.cwiseInverse().asDiagonal() * A;
    const Eigen::VectorXd asked = active.cwiseQuotient(capacity);
    const Eigen::VectorXd a = distribute_moments(A, asked, kStiffness, cost_, &samples_[i].dual);
    const Eigen::VectorXd left = asked - A * a;
    missing_[i] = asked.norm() > 1e-9 ? left.norm() / asked.norm() : 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      MuscleMoment& moment = axes_.moments[std::size_t(k)];
      moment.wanted[i] = wanted[k];
      moment.reserve[i] = capacity[k] * left[k];
    }
    for (std::size_t k = 0; k < pulling_.size(); ++k) {
      const double effort = a[Eigen::Index(k)];
      const auto at = [&](Eigen::MatrixXd& of) -> double& {
        return of(Eigen::Index(pulling_[k]), Eigen::Index(i));
      };
      at(efforts_) = effort;
      at(strains_) = tendon_strain(effort * pulls[k].active + pulls[k].passive);
    }
  }

  void gather() {
    const Eigen::Index count = efforts_.cols();
    Eigen::MatrixXd raw = Eigen::MatrixXd::Zero(Eigen::Index(muscles_), count);
    for (std::size_t s = 0; s < strips_.size(); ++s)
      raw.row(strips_[s].muscle) += strips_[s].share * efforts_.row(Eigen::Index(s));
    out_.activations = raw;
    for (Eigen::Index i = 0; i < count; ++i) {  // muscles do not switch
      const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0),
                         after = std::min(i + 1, count - 1);
      out_.activations.col(i) =
          (0.25 * raw.col(before) + 0.5 * raw.col(i) + 0.25 * raw.col(after)).cwiseMin(1.0);
    }
    out_.moments = std::move(axes_.moments);
    for (const double share : missing_) out_.reserve_share += share / double(missing_.size());
  }

  const MotionDynamics& dynamics_;
  std::vector<std::size_t> frames_;
  Axes axes_;
  MomentArms arms_;
  std::vector<StripForce> strips_;
  std::size_t muscles_;
  std::vector<Sample> samples_;
  std::vector<double> missing_;
  std::vector<std::size_t> pulling_;   // strips that pull at an axis
  std::vector<int> columns_;           // #strips, their place in it or -1
  Eigen::VectorXd cost_;               // #pulling
  Eigen::MatrixXd efforts_, strains_;  // #strips x #samples
  MuscleEfforts out_;
};

}  // namespace

MuscleEfforts static_optimization(const PosingTable& table, const Anatomy& anatomy,
                                  const MotionDynamics& dynamics) {
  if (dynamics.frames.empty() || dynamics.states.size() != dynamics.frames.size() ||
      dynamics.frames.front().loads.joints.size() != anatomy.skeleton.joints.size())
    throw std::invalid_argument("static_optimization: dynamics of another skeleton");
  return Optimization(table, anatomy, dynamics).solve();
}

Activations activations_of(const MuscleEfforts& efforts) {
  Activations out;
  out.muscles = int(efforts.activations.rows());
  for (Eigen::Index m = 0; m < efforts.activations.rows(); ++m) {
    if (efforts.activations.row(m).maxCoeff() < kLeastEffort) continue;
    ActivationCurve curve{{int(m)}, efforts.times, {}};
    for (Eigen::Index i = 0; i < efforts.activations.cols(); ++i)
      curve.values.push_back(efforts.activations(m, i));
    out.curves.push_back(std::move(curve));
  }
  return out;
}

std::vector<JointReserve> joint_reserves(const MuscleEfforts& efforts) {
  std::vector<JointReserve> out;
  const double count = double(std::max<std::size_t>(efforts.times.size(), 1));
  for (const MuscleMoment& moment : efforts.moments) {
    if (out.empty() || out.back().joint != moment.joint) out.push_back({moment.joint, 0, 0});
    for (std::size_t i = 0; i < efforts.times.size(); ++i) {
      out.back().wanted += moment.wanted[i] * moment.wanted[i] / count;
      out.back().reserve += moment.reserve[i] * moment.reserve[i] / count;
    }
  }
  for (JointReserve& joint : out)
    joint.wanted = std::sqrt(joint.wanted), joint.reserve = std::sqrt(joint.reserve);
  return out;
}

}  // namespace ecorche::inline v1
