#include "morph/shapes/body_model.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "morph/shapes/muscularity.h"
#include "morph/shapes/shape_age.h"
#include "morph/shapes/shape_space_cache.h"

namespace ecorche::inline v1 {
namespace {

std::vector<MeasureTarget> targets_of(const TapeMeasure& tape, const BodySpec& spec) {
  std::vector<MeasureTarget> out;
  if (spec.height) out.push_back({tape.table().at("stature"), *spec.height});
  if (spec.mass) out.push_back({tape.table().at("weight"), *spec.mass});
  out.insert(out.end(), spec.measures.begin(), spec.measures.end());
  for (const MeasureTarget& target : out)
    if (!(std::isfinite(target.value) && target.value > 0))
      throw UnfitError(fmt::format("{} {}: a measure is a number above 0",
                                   tape.measure(target.measure).id, target.value));
  return out;
}

// What of the targets was not met, where the reason is not a conflict.
void judge(const TapeMeasure& tape, MadeBody& made) {
  for (const Conflict& conflict : made.solved.conflicts)
    made.why.push_back(describe(conflict, tape, made.targets));
  for (std::size_t i = 0; i < made.targets.size(); ++i) {
    const Measure& m = tape.measure(made.targets[i].measure);
    const double wanted = made.targets[i].value, miss = std::abs(made.solved.achieved[i] - wanted);
    made.worst_miss = std::max(made.worst_miss, miss / m.tolerance);
    if (miss > m.tolerance && made.solved.conflicts.empty())
      made.why.push_back(
          fmt::format("{} asked {:.3f}, nearest {:.3f}", m.id, wanted, made.solved.achieved[i]));
  }
  made.met = made.why.empty();
}

}  // namespace

BodyModel::BodyModel(const Assets& assets) : BodyModel(read_body_package(assets)) {}

BodyModel::BodyModel(BodyPackage package)
    : package_(std::move(package)),
      tape_(package_, read_measure_table(package_, package_.tables / "body")) {}

const ShapeSpace& BodyModel::adults(Sex sex) const {
  const int i = sex == Sex::male ? 0 : 1;
  std::call_once(read_[i], [&] { spaces_[i] = read_shape_space(package_, tape_, sex); });
  return spaces_[i];
}

ShapeSpace BodyModel::people(Sex sex, std::optional<double> age) const {
  ShapeSpace out = adults(sex);
  if (age) move_to_age(package_, tape_, *age, out);
  return out;
}

MadeBody most_probable_body(const BodyModel& model, const BodySpec& spec,
                            const SolveOptions& options) {
  const TapeMeasure& tape = model.tape();
  MadeBody made;
  made.targets = targets_of(tape, spec);
  std::optional<ShapeSpace> of_age;
  if (spec.age) of_age = model.people(spec.sex, spec.age);
  const ShapeSpace& space = of_age ? *of_age : model.adults(spec.sex);
  made.solved = solve_measures(tape, space, made.targets, options);
  const double deviations = spec.muscle ? muscle_deviations(*spec.muscle) : 0;
  if (deviations != 0) {
    SolveOptions muscular = options;
    const Eigen::VectorXd start = made.solved.z;
    muscular.also.push_back(muscle_aim(tape, space, made.targets, made.solved.points, deviations));
    made.solved = solve_measures(tape, space, made.targets, muscular, &start);
    if (made.solved.conflicts.empty() && !made.solved.met)
      made.why.push_back(fmt::format(
          "muscle {}: not with the other measures asked; nearer to 0.5 is possible", *spec.muscle));
  }
  judge(tape, made);

  const BodyPackage& package = model.package();
  made.body.skin = skin_mesh(package, made.solved.points);
  made.body.name = spec.name;
  made.body.sex = spec.sex;
  made.body.age = spec.age.value_or(kSurveyAge);
  made.body.mass = kBodyDensity * skin_volume(package, made.solved.points);
  return made;
}

Body make_body(const BodyModel& model, const BodySpec& spec) {
  MadeBody made = most_probable_body(model, spec);
  if (made.met) return std::move(made.body);
  std::string why;
  for (const std::string& reason : made.why) why += "\n  " + reason;
  throw UnfitError("no body has these measures:" + why);
}

Body make_body(const BodyPackage& package, const BodySpec& spec) {
  return make_body(BodyModel(package), spec);
}

}  // namespace ecorche::inline v1
