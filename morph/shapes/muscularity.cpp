#include "morph/shapes/muscularity.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/compute/cholesky.h"
#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

struct GirthTerm {
  const char* measure;
  double by;  // kg/m
};
constexpr GirthTerm kTerms[] = {{"upper_arm_girth_relaxed", 80},
                                {"forearm_girth", 50},
                                {"calf_girth", 40},
                                {"thigh_girth", 60},
                                {"neck_girth", 30},
                                {"chest_girth", 80},
                                {"waist_girth", -90}};

// Its terms in girths that are not wished for.
std::vector<Term> free_terms(const MeasureTable& table, std::span<const MeasureTarget> targets) {
  std::vector<Term> out;
  for (const GirthTerm& term : kTerms) {
    const int k = table.at(term.measure);
    const auto same = [k](const MeasureTarget& target) { return target.measure == k; };
    if (std::ranges::none_of(targets, same)) out.push_back({k, term.by});
  }
  return out;
}

// Of a sum of measures among people with the targets, by the law.
double spread_of(const ShapeSpace& space, const std::vector<Term>& terms,
                 std::span<const MeasureTarget> targets) {
  const Eigen::MatrixXd& law = space.law_covariance;
  Eigen::VectorXd by = Eigen::VectorXd::Zero(law.rows());
  for (const Term& term : terms) by[term.measure] = term.factor;
  const Eigen::VectorXd with = law * by;
  const std::vector<int> measures = measures_of(targets);
  const Eigen::MatrixXd C = law(measures, measures);
  const Eigen::VectorXd known = with(measures);
  const double said = targets.empty() ? 0 : known.dot(solve_llt(C, known));
  return std::sqrt(std::max(0.0, by.dot(with) - said));
}

double value_of(const TapeMeasure& tape, const std::vector<Term>& terms, const Points& skin,
                MeasureGradient* gradient) {
  double sum = 0;
  MeasureGradient part;
  for (const Term& term : terms) {
    sum += term.factor * tape.take(term.measure, skin, gradient != nullptr ? &part : nullptr);
    if (gradient == nullptr) continue;
    for (const auto& [vertex, g] : part) gradient->emplace_back(vertex, term.factor * g);
  }
  return sum;
}

}  // namespace

double muscle_deviations(double share) {
  if (!(share >= 0 && share <= 1))
    throw UnfitError(fmt::format("muscle {}: from 0 to 1 is possible", share));
  // Inverts the normal distribution by bisection.
  double low = -kMostMuscular, high = kMostMuscular;
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < share ? low : high) = middle;
  }
  return share == 0.5 ? 0 : 0.5 * (low + high);
}

Aim muscle_aim(const TapeMeasure& tape, const ShapeSpace& space,
               std::span<const MeasureTarget> targets, const Points& skin, double deviations) {
  const std::vector<Term> terms = free_terms(tape.table(), targets);
  if (terms.empty())
    throw UnfitError(
        "muscle: the girths asked for say how muscular the body is; leave one of them or the "
        "muscle out");
  Aim out;
  out.value = [&tape, terms](const Points& V, MeasureGradient* gradient) {
    return value_of(tape, terms, V, gradient);
  };
  out.wanted = value_of(tape, terms, skin, nullptr) + deviations * spread_of(space, terms, targets);
  out.tolerance = 0.02;
  return out;
}

}  // namespace ecorche::inline v1
