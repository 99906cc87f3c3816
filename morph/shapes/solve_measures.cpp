#include "morph/shapes/solve_measures.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "anatomy/compute/cholesky.h"
#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

bool is_mass(const TapeMeasure& tape, const MeasureTarget& target) {
  return tape.measure(target.measure).kind == MeasureKind::mass;
}

// What a set of targets says of one of them.
struct Residual {
  double away = 0;              // standard deviations, signed
  double expected = 0, sd = 0;  // of the measure, the others given
};

Residual residual(const ShapeSpace& space, const Eigen::MatrixXd& law,
                  std::span<const MeasureTarget> targets, int of, const std::vector<int>& others) {
  const auto target = [&](int i) -> const MeasureTarget& { return targets[i]; };
  const int k = target(of).measure;
  const Eigen::Index n = others.size();
  Residual out{0, space.law_mean[k], 0};
  double variance = law(k, k);
  if (n > 0) {
    Eigen::MatrixXd C(n, n);
    Eigen::VectorXd with(n), apart(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const MeasureTarget& a = target(others[i]);
      with[i] = law(a.measure, k);
      apart[i] = a.value - space.law_mean[a.measure];
      for (Eigen::Index j = 0; j < n; ++j) C(i, j) = law(a.measure, target(others[j]).measure);
    }
    const Eigen::VectorXd gain = solve_llt(C, with);
    out.expected += gain.dot(apart);
    variance -= gain.dot(with);
  }
  out.sd = std::sqrt(std::max(variance, 1e-12));
  out.away = (target(of).value - out.expected) / out.sd;
  return out;
}

// The survey's law, or for targets of somebody heavier than its people that of civilians. One
// target alone does not say who is heavy.
Eigen::MatrixXd law_of(const ShapeSpace& space, std::span<const MeasureTarget> targets) {
  if (targets.size() < 2) return space.law_covariance;
  const Eigen::MatrixXd wide = space.law_covariance + space.heavier * space.heavier.transpose();
  const std::vector<int> measures = measures_of(targets);
  Eigen::VectorXd apart = -space.law_mean(measures);
  for (std::size_t i = 0; i < targets.size(); ++i) apart[i] += targets[i].value;
  const Eigen::MatrixXd C = wide(measures, measures);
  const Eigen::VectorXd with = space.heavier(measures);
  return with.dot(solve_llt(C, apart)) > 0 ? wide : space.law_covariance;
}

std::vector<int> without(std::vector<int> set, int member) {
  std::erase(set, member);
  return set;
}

class Solver {
 public:
  Solver(const TapeMeasure& tape, const ShapeSpace& space, std::span<const MeasureTarget> targets,
         const SolveOptions& options)
      : tape_(tape),
        space_(space),
        wishes_(targets),
        options_(options),
        wanted_(targets.size() + options.also.size()),
        tolerance_(wanted_.size()) {
    for (Eigen::Index i = 0; i < wanted_.size(); ++i) {
      wanted_[i] = is_target(i) ? target(i).value : also(i).wanted;
      if (is_target(i))
        tolerance_[i] = is_mass(tape, target(i)) ? 100 * options.tolerance : options.tolerance;
      else
        tolerance_[i] = also(i).tolerance;
    }
  }

  void solve(SolvedBody& out) const {
    out.points = space_points(space_, out.z);
    double miss_now = miss(out.points);
    bool settled = wanted_.size() == 0;
    for (out.rounds = 0; out.rounds < options_.rounds && (miss_now >= 1 || !settled);
         ++out.rounds) {
      const Eigen::VectorXd move = next(out.points, out.z) - out.z;
      double share = 1;
      Points points = space_points(space_, out.z + move);
      double miss_then = miss(points);
      while (miss_then > std::max(miss_now, 1.0) && share > 0.1) {
        share *= 0.5;
        points = space_points(space_, out.z + share * move);
        miss_then = miss(points);
      }
      out.z += share * move;
      out.points = std::move(points);
      miss_now = miss_then;
      settled = share * move.norm() < kSettled * std::max(1.0, out.z.norm());
    }
    out.met = miss_now < 1;
  }

 private:
  // Moves of the coefficients that change nothing one would see, once the measures are met.
  static constexpr double kSettled = 0.05;

  bool is_target(Eigen::Index i) const { return std::size_t(i) < wishes_.size(); }
  const MeasureTarget& target(Eigen::Index i) const { return wishes_[i]; }
  const Aim& also(Eigen::Index i) const { return options_.also[i - wishes_.size()]; }

  double value(Eigen::Index i, const Points& V, MeasureGradient* gradient) const {
    if (is_target(i)) return tape_.take(target(i).measure, V, gradient);
    if (gradient != nullptr) gradient->clear();
    return also(i).value(V, gradient);
  }

  // Worst miss of a target, in tolerances.
  double miss(const Points& V) const {
    double worst = 0;
    for (Eigen::Index i = 0; i < wanted_.size(); ++i) {
      const double off = std::abs(value(i, V, nullptr) - wanted_[i]) / tolerance_[i];
      worst = std::max(worst, std::isfinite(off) ? off : 1e9);
    }
    return worst;
  }

  // The least coefficients with the measures, linearised at z, as asked.
  Eigen::VectorXd next(const Points& V, const Eigen::VectorXd& z) const {
    Eigen::VectorXd now(wanted_.size());
    Eigen::MatrixXd J(wanted_.size(), z.size());
    MeasureGradient gradient;
    for (Eigen::Index i = 0; i < wanted_.size(); ++i) {
      now[i] = value(i, V, &gradient);
      J.row(i) = space_gradient(space_, gradient);
    }
    // Measures in units of their tolerance, so that a kilogram and a metre weigh alike where
    // measures hang together exactly.
    const Eigen::VectorXd unit = tolerance_.cwiseInverse();
    J = unit.asDiagonal() * J;
    Eigen::MatrixXd A = J * J.transpose();
    A.diagonal().array() += 1e-11 * A.trace() / double(std::max<Eigen::Index>(1, A.rows()));
    return J.transpose() * solve_ldlt<Eigen::Dynamic>(A, unit.cwiseProduct(wanted_ - now) + J * z);
  }

  const TapeMeasure& tape_;
  const ShapeSpace& space_;
  std::span<const MeasureTarget> wishes_;
  const SolveOptions& options_;
  Eigen::VectorXd wanted_, tolerance_;
};

}  // namespace

MeasureTarget parse_target(const std::string& text, const TapeMeasure& tape) {
  const auto equals = text.find('=');
  if (equals == std::string::npos)
    throw UsageError(
        fmt::format("--measure {}: expected NAME=VALUE, as in waist_girth=74cm", text));
  const int k = tape.table().at(text.substr(0, equals));
  return {k, tape.parse(k, std::string_view(text).substr(equals + 1), tape.measure(k).id)};
}

std::vector<int> measures_of(std::span<const MeasureTarget> targets) {
  std::vector<int> out;
  for (const MeasureTarget& target : targets) out.push_back(target.measure);
  return out;
}

// Set so that fewer than one in a hundred people of the survey is refused, whichever of their
// measures are asked; people's measures have heavier tails than the normal law, the more so the
// more are asked. Few measures are not held against each other so closely: tall women of little
// weight (a body mass index of 17 at 1.79 m) and short, broad men are rare, but they are people.
double conflict_limit(int count) {
  return 3.45 + 0.017 * count + 3.53 * std::exp(-1.6 * (count - 1));
}

std::vector<Conflict> find_conflicts(const ShapeSpace& space,
                                     std::span<const MeasureTarget> targets) {
  std::vector<Conflict> out;
  const Eigen::MatrixXd law = law_of(space, targets);
  std::vector<int> open(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) open[i] = int(i);
  const auto refused = [&](int i, const std::vector<int>& others) {
    return std::abs(residual(space, law, targets, i, others).away) /
           conflict_limit(int(others.size()) + 1);
  };
  while (!open.empty()) {
    Conflict conflict;
    double worst = 1;
    for (int i : open) {
      const double share = refused(i, without(open, i));
      if (share > worst) worst = share, conflict.blamed = i;
    }
    if (conflict.blamed < 0) break;
    std::erase(open, conflict.blamed);
    const Residual r = residual(space, law, targets, conflict.blamed, open);
    const double room = conflict_limit(int(open.size()) + 1) * r.sd;
    conflict.away = r.away;
    conflict.low = r.expected - room;
    conflict.high = r.expected + room;
    conflict.others = open;
    for (bool smaller = true; smaller;) {
      smaller = false;
      double most = 1;
      int let_go = -1;
      for (int i : conflict.others) {
        const double share = refused(conflict.blamed, without(conflict.others, i));
        if (share > most) most = share, let_go = i;
      }
      if (let_go >= 0) std::erase(conflict.others, let_go), smaller = true;
    }
    out.push_back(std::move(conflict));
  }
  return out;
}

SolvedBody solve_measures(const TapeMeasure& tape, const ShapeSpace& space,
                          std::span<const MeasureTarget> targets, const SolveOptions& options,
                          const Eigen::VectorXd* start) {
  std::set<int> seen;
  for (const MeasureTarget& target : targets)
    if (!seen.insert(target.measure).second)
      throw UsageError(
          fmt::format("measure {} is asked for twice", tape.measure(target.measure).id));
  SolvedBody out;
  std::vector<MeasureTarget> possible(targets.begin(), targets.end());
  if (!options.allow_unusual) out.conflicts = find_conflicts(space, targets);
  for (const Conflict& conflict : out.conflicts) {
    MeasureTarget& target = possible[conflict.blamed];
    target.value = std::clamp(target.value, conflict.low, conflict.high);
  }
  out.z = start != nullptr ? *start : Eigen::VectorXd::Zero(space.basis.cols());
  Solver(tape, space, possible, options).solve(out);
  out.met = out.met && out.conflicts.empty();
  out.points.col(1).array() -= out.points.col(1).minCoeff();
  if (!out.met || options.allow_unusual) try {
      check_human(tape, space, out.points);
    } catch (const UnfitError& error) {  // the first reason is what was asked
      if (out.conflicts.empty()) throw;
      throw UnfitError(fmt::format("no body has these measures:\n  {}\n{}",
                                   describe(out.conflicts.front(), tape, targets), error.what()));
    }
  for (const MeasureTarget& target : targets)
    out.achieved.push_back(tape.take(target.measure, out.points));
  return out;
}

double deviation(const ShapeSpace& space, std::span<const MeasureTarget> targets,
                 const MeasureTarget& measured) {
  std::vector<MeasureTarget> all(targets.begin(), targets.end());
  std::vector<int> others;
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (targets[i].measure != measured.measure) others.push_back(int(i));
  all.push_back(measured);
  return residual(space, law_of(space, targets), all, int(targets.size()), others).away;
}

void check_human(const TapeMeasure& tape, const ShapeSpace& space, const Points& skin) {
  constexpr double kLeast = 0.3, kMost = 3.5;  // of what people have on average
  constexpr double kLeastMass = 0.15, kMostMass = 8;
  for (int k = 0; k < tape.count(); ++k) {
    const MeasureKind kind = tape.measure(k).kind;
    const bool mass = kind == MeasureKind::mass, round = kind == MeasureKind::girth;
    if (!mass && !round && tape.measure(k).id != "stature") continue;
    const double share = tape.take(k, skin) / space.law_mean[k];
    if (share >= (mass ? kLeastMass : kLeast) && share <= (mass ? kMostMass : kMost)) continue;
    throw UnfitError(
        fmt::format("no body has these measures: its {} would be {:.2f} times the average; ask for "
                    "measures that people have",
                    tape.measure(k).id, share));
  }
}

std::string describe(const Conflict& conflict, const TapeMeasure& tape,
                     std::span<const MeasureTarget> targets) {
  const auto text = [&](int i) {
    const MeasureTarget& target = targets[i];
    return fmt::format("{} {:.3f} {}", tape.measure(target.measure).id, target.value,
                       is_mass(tape, target) ? "kg" : "m");
  };
  std::string others;
  for (std::size_t i = 0; i < conflict.others.size(); ++i)
    others += (i == 0                            ? ""
               : i + 1 == conflict.others.size() ? " and "
                                                 : ", ") +
              text(conflict.others[i]);
  return fmt::format("{} {}; from {:.3f} to {:.3f} {} is possible{}", text(conflict.blamed),
                     others.empty() ? "lies outside what people measure" : "contradicts " + others,
                     std::max(0.0, conflict.low), conflict.high,
                     is_mass(tape, targets[conflict.blamed]) ? "kg" : "m",
                     targets.size() > 1 ? " with the other measures asked" : "");
}

}  // namespace ecorche::inline v1
