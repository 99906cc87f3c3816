#include "morph/solve_measures.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

struct Linear {
  Eigen::VectorXd value;  // of the wishes' measures
  Eigen::MatrixXd J;
};

bool is_mass(const TapeMeasure& tape, const Wish& wish) { return tape.measure(wish.measure).kind == MeasureKind::mass; }

class Solver {
 public:
  Solver(const TapeMeasure& tape, const ShapeSpace& space, std::span<const Wish> wishes, const SolveOptions& options)
      : tape_(tape), space_(space), wishes_(wishes), options_(options) {
    wanted_.resize(static_cast<Eigen::Index>(wishes.size()));
    tolerance_.resize(wanted_.size());
    for (Eigen::Index i = 0; i < wanted_.size(); ++i) {
      wanted_[i] = wish(i).value;
      tolerance_[i] = is_mass(tape, wish(i)) ? 100 * options.tolerance : options.tolerance;
    }
  }

  const Wish& wish(Eigen::Index i) const { return wishes_[static_cast<std::size_t>(i)]; }

  Linear linearise(const Points& V) const {
    Linear out{Eigen::VectorXd(wanted_.size()), Eigen::MatrixXd(wanted_.size(), space_.basis.cols())};
    MeasureGradient gradient;
    for (Eigen::Index i = 0; i < wanted_.size(); ++i) {
      out.value[i] = tape_.take(wish(i).measure, V, &gradient);
      out.J.row(i) = space_gradient(space_, gradient);
    }
    return out;
  }

  double miss(const Points& V) const {
    double worst = 0;
    for (Eigen::Index i = 0; i < wanted_.size(); ++i) {
      const double off = std::abs(tape_.take(wish(i).measure, V) - wanted_[i]) / tolerance_[i];
      worst = std::max(worst, std::isfinite(off) ? off : 1e9);
    }
    return worst;
  }

  // Least z with the linearised measures as asked.
  Eigen::VectorXd meet(const Linear& at, const Eigen::VectorXd& z) const {
    Eigen::MatrixXd A = at.J * at.J.transpose();
    A.diagonal().array() += 1e-12 * A.trace() / std::max<Eigen::Index>(1, A.rows());
    return at.J.transpose() * A.ldlt().solve(wanted_ - at.value + at.J * z);
  }

  // Least misses, weighed by tolerance, with |z|^2 <= limit.
  Eigen::VectorXd approach(const Linear& at, const Eigen::VectorXd& z, double limit) const {
    Eigen::VectorXd weight(wanted_.size());
    for (Eigen::Index i = 0; i < weight.size(); ++i) weight[i] = std::pow(tape_.measure(wish(i).measure).tolerance, 2);
    const Eigen::MatrixXd A = at.J * at.J.transpose();
    const Eigen::VectorXd right = wanted_ - at.value + at.J * z;
    double low = -12, high = 12;  // of the logarithm of the share of the prior
    Eigen::VectorXd best = Eigen::VectorXd::Zero(z.size());
    for (int round = 0; round < 40; ++round) {
      const double middle = 0.5 * (low + high);
      const Eigen::MatrixXd B = A + std::exp(middle) * Eigen::MatrixXd(weight.asDiagonal());
      const Eigen::VectorXd trial = at.J.transpose() * B.ldlt().solve(right);
      if (trial.squaredNorm() <= limit) best = trial, high = middle;
      else low = middle;
    }
    return best;
  }

  template <class Step>
  void iterate(const Step& step, bool stop_when_met, SolvedBody& out) const {
    out.points = space_points(space_, out.z);
    double miss_now = miss(out.points);
    for (out.rounds = 0; out.rounds < options_.rounds && !(stop_when_met && miss_now < 1 && settled_); ++out.rounds) {
      const Linear at = linearise(out.points);
      const Eigen::VectorXd next = step(at, out.z);
      const Eigen::VectorXd move = next - out.z;
      double share = 1;
      Points points = space_points(space_, next);
      double miss_then = miss(points);
      while (stop_when_met && miss_then > std::max(miss_now, 1.0) && share > 0.1) {
        share *= 0.5;
        points = space_points(space_, out.z + share * move);
        miss_then = miss(points);
      }
      out.z += share * move;
      out.points = std::move(points);
      miss_now = miss_then;
      settled_ = share * move.norm() < 0.05 * std::max(1.0, out.z.norm());
      if (!stop_when_met && move.norm() < 1e-3) break;
    }
    out.met = miss_now < 1;
  }

  std::vector<Conflict> conflicts(const Linear& at, const Eigen::VectorXd& z) const;
  double distance2(const Linear& at, const Eigen::VectorXd& z, const std::vector<int>& set) const;

 private:
  const TapeMeasure& tape_;
  const ShapeSpace& space_;
  std::span<const Wish> wishes_;
  const SolveOptions& options_;
  Eigen::VectorXd wanted_, tolerance_;
  mutable bool settled_ = false;
};

double Solver::distance2(const Linear& at, const Eigen::VectorXd& z, const std::vector<int>& set) const {
  const Eigen::VectorXd all = wanted_ - at.value + at.J * z;
  Eigen::MatrixXd J(static_cast<Eigen::Index>(set.size()), z.size());
  Eigen::VectorXd right(J.rows());
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    J.row(i) = at.J.row(set[static_cast<std::size_t>(i)]);
    right[i] = all[set[static_cast<std::size_t>(i)]];
  }
  Eigen::MatrixXd A = J * J.transpose();
  A.diagonal().array() += 1e-12 * A.trace() / std::max<Eigen::Index>(1, A.rows());
  return right.dot(A.ldlt().solve(right));
}

// While the wishes that are left are too far out, the one that matters least is let go; when none can be, what is left is one
// irreducible conflict. Its most blamed member is set aside and the rest searched for another.
std::vector<Conflict> Solver::conflicts(const Linear& at, const Eigen::VectorXd& z) const {
  std::vector<Conflict> out;
  std::vector<int> open;
  for (int i = 0; i < wanted_.size(); ++i) open.push_back(i);
  while (!open.empty() && distance2(at, z, open) > distance_limit(static_cast<int>(open.size()))) {
    std::vector<int> set = open;
    for (bool smaller = true; smaller && set.size() > 1;) {
      smaller = false;
      double most = -1;
      std::size_t let_go = 0;
      for (std::size_t i = 0; i < set.size(); ++i) {
        std::vector<int> rest = set;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
        const double left = distance2(at, z, rest) / distance_limit(static_cast<int>(rest.size()));
        if (left > 1 && left > most) most = left, let_go = i, smaller = true;
      }
      if (smaller) set.erase(set.begin() + static_cast<std::ptrdiff_t>(let_go));
    }
    Conflict conflict;
    conflict.wishes = set;
    // To blame is the one without which all the wishes fit best.
    double least = std::numeric_limits<double>::max();
    for (int candidate : set) {
      std::vector<int> rest = open;
      std::erase(rest, candidate);
      const double left = rest.empty() ? 0 : distance2(at, z, rest);
      if (left < least) least = left, conflict.blamed = candidate;
    }
    std::erase(open, conflict.blamed);
    // The law of the blamed one, the other open wishes kept.
    Eigen::MatrixXd J(static_cast<Eigen::Index>(open.size()), z.size());
    Eigen::VectorXd right(J.rows());
    const Eigen::VectorXd all = wanted_ - at.value + at.J * z;
    for (Eigen::Index i = 0; i < J.rows(); ++i) J.row(i) = at.J.row(open[static_cast<std::size_t>(i)]), right[i] = all[open[static_cast<std::size_t>(i)]];
    const Eigen::VectorXd row = at.J.row(conflict.blamed);
    double middle = 0, variance = row.squaredNorm(), used = 0;
    if (J.rows() > 0) {
      Eigen::MatrixXd A = J * J.transpose();
      A.diagonal().array() += 1e-12 * A.trace() / A.rows();
      const auto solver = A.ldlt();
      const Eigen::VectorXd gain = solver.solve(J * row);
      middle = gain.dot(right);
      variance -= gain.dot(J * row);
      used = right.dot(solver.solve(right));
    }
    const double room = std::sqrt(std::max(0.0, distance_limit(static_cast<int>(open.size()) + 1) - used) * std::max(0.0, variance));
    const double origin = wanted_[conflict.blamed] - all[conflict.blamed];  // the mean body's, linearised
    conflict.low = origin + middle - room;
    conflict.high = origin + middle + room;
    out.push_back(std::move(conflict));
  }
  return out;
}

}  // namespace

// The quantile of chi-squared after Wilson and Hilferty 1931 at one in a million, widened because people's measures have heavier
// tails than the normal law that the survey's figures are fitted with.
double distance_limit(int count) {
  constexpr double kQuantile = 4.75, kTails = 1.5;
  const double k = std::max(1, count), c = 2 / (9 * k);
  return kTails * k * std::pow(1 - c + kQuantile * std::sqrt(c), 3);
}

SolvedBody solve_measures(const TapeMeasure& tape, const ShapeSpace& space, std::span<const Wish> wishes, const SolveOptions& options,
                          const Eigen::VectorXd* start) {
  std::set<int> seen;
  for (const Wish& wish : wishes)
    if (!seen.insert(wish.measure).second) throw UsageError(fmt::format("measure {} is asked for twice", tape.measure(wish.measure).id));
  const Solver solver(tape, space, wishes, options);
  const double limit = distance_limit(static_cast<int>(wishes.size()));
  SolvedBody out;
  out.z = start != nullptr ? *start : Eigen::VectorXd::Zero(space.basis.cols());
  // A glance from where the request starts tells most impossible ones; the exact distance is known once it is met.
  solver.iterate([&](const Linear& at, const Eigen::VectorXd& z) { return solver.meet(at, z); }, true, out);
  out.unlikeliness = out.z.squaredNorm() / limit;
  if (out.unlikeliness > 1 || !out.met) {
    // Conflicts are told from where measures are still nearly linear: the mean body.
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(space.basis.cols());
    const Linear at = solver.linearise(space.mean);
    out.conflicts = solver.conflicts(at, zero);
    if (out.conflicts.empty() && out.unlikeliness > 1) out.conflicts = solver.conflicts(solver.linearise(out.points), out.z);
    if (!out.conflicts.empty()) {
      out.z = zero;
      solver.iterate([&](const Linear& here, const Eigen::VectorXd& z) { return solver.approach(here, z, limit); }, false, out);
      out.met = false;
    }
  }
  out.points.col(1).array() -= out.points.col(1).minCoeff();
  for (const Wish& wish : wishes) out.achieved.push_back(tape.take(wish.measure, out.points));
  return out;
}

std::string describe(const Conflict& conflict, const TapeMeasure& tape, std::span<const Wish> wishes) {
  const auto text = [&](int i) {
    const Wish& wish = wishes[static_cast<std::size_t>(i)];
    return fmt::format("{} {:.3f} {}", tape.measure(wish.measure).id, wish.value, is_mass(tape, wish) ? "kg" : "m");
  };
  const bool mass = is_mass(tape, wishes[static_cast<std::size_t>(conflict.blamed)]);
  std::string others;
  for (int i : conflict.wishes)
    if (i != conflict.blamed) others += (others.empty() ? "" : " and ") + text(i);
  return fmt::format("{} {}; from {:.3f} to {:.3f} {} is possible{}", text(conflict.blamed), others.empty() ? "lies outside what people measure" : "contradicts " + others,
                     std::max(0.0, conflict.low), conflict.high, mass ? "kg" : "m", others.empty() ? "" : " with the other measures asked");
}

}  // namespace ecorche
