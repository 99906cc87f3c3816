#include "morph/shapes/modify_body.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "anatomy/compute/cholesky.h"
#include "anatomy/errors.h"
#include "morph/shapes/muscularity.h"
#include "morph/shapes/shape_age.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kInch = 0.0254;

// value = f(measures): adds d f / d measure times the measure's gradient.
double with_gradient(const TapeMeasure& tape, const char* id, double by, const Points& skin,
                     MeasureGradient* out) {
  MeasureGradient part;
  const double value = tape.take(tape.table().at(id), skin, &part);
  for (const auto& [vertex, g] : part) out->emplace_back(vertex, by * g);
  return value;
}

constexpr const char* kKept[] = {"stature", "crotch_height", "arm_length_outseam"};

// Whether the person stays as long as they are: who grows up or is made a child does not.
bool keeps_lengths(const BodyChange& change) {
  const bool grows = change.age && change.age->first != change.age->second &&
                     std::min(change.age->first, change.age->second) < kGrownAge;
  return change.keep_lengths && !grows;
}

bool keeps_mass(const TapeMeasure& tape, const BodyChange& change) {
  const int weight = tape.table().at("weight");
  return change.muscle != 0 && !change.fat &&
         std::ranges::none_of(change.measures, [weight](const MeasureTarget& target) {
           return target.measure == weight;
         });
}

// What is asked and what stays, as targets.
std::vector<MeasureTarget> facts(const TapeMeasure& tape, const Points& skin,
                                 const BodyChange& change) {
  std::vector<MeasureTarget> out = change.measures;
  const auto keep = [&](const char* id) {
    const int k = tape.table().at(id);
    if (std::ranges::none_of(out, [k](const MeasureTarget& target) { return target.measure == k; }))
      out.push_back({k, tape.take(k, skin)});
  };
  if (keeps_lengths(change))
    for (const char* id : kKept) keep(id);
  if (keeps_mass(tape, change)) keep("weight");
  return out;
}

std::vector<Aim> aims(const TapeMeasure& tape, const ShapeSpace& space, const Points& skin,
                      const BodyChange& change) {
  constexpr double kLength = 0.0002, kMass = 0.02, kFat = 0.02, kRatio = 0.0002;
  std::vector<Aim> out;
  std::set<int> seen;
  const auto add = [&](int k, double wanted) {
    const double tolerance = tape.measure(k).kind == MeasureKind::mass ? kMass : kLength;
    out.push_back({[&tape, k](const Points& V, MeasureGradient* g) { return tape.take(k, V, g); },
                   wanted, tolerance});
  };
  for (const MeasureTarget& target : change.measures)
    if (!seen.insert(target.measure).second)
      throw UsageError(
          fmt::format("measure {} is asked for twice", tape.measure(target.measure).id));
  for (const MeasureTarget& target : facts(tape, skin, change)) add(target.measure, target.value);
  if (change.fat)
    out.push_back(
        {[&](const Points& V, MeasureGradient* g) { return fat_percentage(tape, space.sex, V, g); },
         *change.fat, kFat});
  if (change.hip_waist)
    out.push_back({[&](const Points& V, MeasureGradient* g) { return hip_waist_ratio(tape, V, g); },
                   *change.hip_waist, kRatio});
  out.insert(out.end(), change.also.begin(), change.also.end());
  return out;
}

}  // namespace

double fat_percentage(const TapeMeasure& tape, Sex sex, const Points& skin,
                      MeasureGradient* gradient) {
  const auto take = [&](const char* id) { return tape.take(tape.table().at(id), skin) / kInch; };
  const bool male = sex == Sex::male;
  const double round = take("waist_girth") - take("neck_girth") + (male ? 0 : take("hip_girth")),
               height = take("stature");
  const double by_round = male ? 86.010 : 163.205, by_height = male ? -70.041 : -97.684;
  if (gradient != nullptr) {
    const double g = by_round / (std::log(10.0) * round * kInch);
    with_gradient(tape, "waist_girth", g, skin, gradient);
    with_gradient(tape, "neck_girth", -g, skin, gradient);
    if (!male) with_gradient(tape, "hip_girth", g, skin, gradient);
    with_gradient(tape, "stature", by_height / (std::log(10.0) * height * kInch), skin, gradient);
  }
  return by_round * std::log10(round) + by_height * std::log10(height) + (male ? 36.76 : -78.387);
}

double hip_waist_ratio(const TapeMeasure& tape, const Points& skin, MeasureGradient* gradient) {
  const double hip = tape.take(tape.table().at("hip_girth"), skin),
               waist = tape.take(tape.table().at("waist_girth"), skin);
  if (gradient != nullptr) {
    with_gradient(tape, "hip_girth", 1 / waist, skin, gradient);
    with_gradient(tape, "waist_girth", -hip / (waist * waist), skin, gradient);
  }
  return hip / waist;
}

void check_change(const TapeMeasure& tape, const ShapeSpace& space, const Points& skin,
                  const BodyChange& change) {
  const std::vector<MeasureTarget> targets = facts(tape, skin, change);
  const auto asked = [&](int i) { return std::size_t(i) < change.measures.size(); };
  std::string why;
  for (const Conflict& conflict : find_conflicts(space, targets))
    if (asked(conflict.blamed) || std::ranges::any_of(conflict.others, asked))
      why += "\n  " + describe(conflict, tape, targets);
  if (!why.empty()) throw UnfitError("no body has these measures:" + why);
}

ChangedBody change_body(const BodyPackage& package, const TapeMeasure& tape,
                        const ShapeSpace& adults, const Points& skin, const BodyChange& change) {
  Points start = skin.topRows(adults.mean.rows());
  ShapeSpace own, later;
  if (change.age) {
    own = adults;
    move_to_age(package, tape, change.age->first, own);
  }
  const bool ages = change.age && change.age->first != change.age->second;
  if (ages) {
    later = adults;
    move_to_age(package, tape, change.age->second, later);
  }
  const ShapeSpace &before = change.age ? own : adults, &space = ages ? later : before;
  // lengths as they are before anything is changed
  std::vector<Aim> wanted = aims(tape, space, start, change);
  start =
      space.mean + change.exaggeration * space.spread[0] / before.spread[0] * (start - before.mean);
  if (change.muscle != 0) {
    const std::vector<MeasureTarget> given = facts(tape, start, change);
    wanted.push_back(muscle_aim(tape, space, given, start, kMostMuscular * change.muscle));
  }

  const Eigen::Index n = wanted.size();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(space.basis.cols()), miss(n);
  Eigen::MatrixXd J(n, step.size());
  ChangedBody out;
  out.points = start;
  constexpr int kRounds = 15;
  MeasureGradient gradient;
  for (out.rounds = 0; out.rounds <= kRounds; ++out.rounds) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Aim& aim = wanted[i];
      gradient.clear();
      miss[i] = (aim.wanted - aim.value(out.points, &gradient)) / aim.tolerance;
      J.row(i) = space_gradient(space, gradient) / aim.tolerance;
    }
    out.met = n == 0 || miss.cwiseAbs().maxCoeff() < 1;
    if (out.met || out.rounds == kRounds) break;
    Eigen::MatrixXd A = J * J.transpose();
    A.diagonal().array() += 1e-11 * A.trace() / double(n);
    step = J.transpose() * solve_ldlt<Eigen::Dynamic>(A, miss + J * step);
    out.points = start + (space_points(space, step) - space.mean);
  }
  out.points.col(1).array() -= out.points.col(1).minCoeff();
  return out;
}

}  // namespace ecorche::inline v1
