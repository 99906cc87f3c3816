#include "morph/shapes/shape_age.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "morph/shapes/shape_examples.h"
#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kYoungest = 1, kOldest = 90;  // years
constexpr double kPackageYoung = 0.5;          // the package's age slider of its grown bodies

// The package's average body at a place of its age slider, on the floor.
Points average_at(const BodyPackage& package, Sex sex, double slider) {
  Macros macros;
  macros.male = sex == Sex::male ? 1 : 0;
  macros.age = slider;
  Points skin = shape_points(package, macros).topRows(package.skin_size);
  skin.col(1).array() -= skin.col(1).minCoeff();
  return skin;
}

// Where the package's average child has grown to `share` of its adult stature: its shapes go by
// maturity, and their years by a rule of their own.
double slider_of_share(const BodyPackage& package, Sex sex, double share) {
  const double grown = stature(package, average_at(package, sex, kPackageYoung));
  double low = 0, high = kPackageYoung;
  constexpr int kHalvings = 24;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    const bool small = stature(package, average_at(package, sex, middle)) < share * grown;
    (small ? low : high) = middle;
  }
  return high;
}

Points average_of_age(const BodyPackage& package, Sex sex, double years, double share) {
  const bool child = years < kGrownAge && share < 1;
  const double slider =
      child ? slider_of_share(package, sex, share) : std::max(kPackageYoung, age_slider(years));
  return average_at(package, sex, slider);
}

Points symmetric(const BodyPackage& package, const Points& offset) {
  Eigen::MatrixXd column = Eigen::Map<const Eigen::VectorXd>(offset.data(), offset.size());
  make_symmetric(package, column);
  return Eigen::Map<const Points>(column.data(), offset.rows(), 3);
}

// Bones of grown people keep their lengths: the old are shorter by their trunks, and as far as
// their generation was.
constexpr const char* kBoneLengths[] = {"acromion_radiale_length", "radiale_stylion_length",
                                        "hand_length", "foot_length", "crotch_height"};

// The mean of the space, brought to what people of the age have. `bones`: lengths that they keep.
Points with_growth(const TapeMeasure& tape, const ShapeSpace& space, const Growth& growth,
                   const std::vector<MeasureTarget>& bones) {
  const MeasureTable& table = tape.table();
  std::vector<MeasureTarget> targets{{table.at("stature"), growth.stature},
                                     {table.at("weight"), growth.mass},
                                     {table.at("head_girth"), growth.head_girth}};
  if (growth.neck_girth) targets.push_back({table.at("neck_girth"), *growth.neck_girth});
  if (growth.crotch_height) targets.push_back({table.at("crotch_height"), *growth.crotch_height});
  targets.insert(targets.end(), bones.begin(), bones.end());
  SolveOptions any;
  any.allow_unusual = true;
  return solve_measures(tape, space, targets, any).points;
}

Growth growth_row(const Table& table, int row) {
  const auto length = [&](const char* column) { return 0.01 * table.number(row, column); };
  const auto if_given = [&](const char* column) {
    return table.text(row, column).empty() ? std::nullopt : std::optional(length(column));
  };
  return {length("stature_cm"), table.number(row, "mass_kg"), length("head_cm"),
          if_given("neck_cm"), if_given("crotch_cm")};
}

}  // namespace

Growth growth_at(const std::filesystem::path& tables, Sex sex, double years) {
  const Table table(tables / "body" / "growth.csv");
  const char* name = sex == Sex::male ? "male" : "female";
  Growth before, after;
  double from = -1, to = -1;
  for (int row = 0; row < table.rows(); ++row) {
    if (table.text(row, "sex") != name) continue;
    const double age = table.number(row, "age");
    if (age <= to)
      throw InputError(fmt::format("{}: ages must rise within a sex", table.where(row)));
    before = after, from = to;
    after = growth_row(table, row);
    to = age;
    if (from < 0) before = after;
    if (to >= years) break;
  }
  if (to < 0) throw InputError(fmt::format("growth.csv: no row of sex '{}'", name));
  const double t = from < 0 ? 1 : std::clamp((years - from) / (to - from), 0.0, 1.0);
  const auto between = [t](double a, double b) { return (1 - t) * a + t * b; };
  const auto if_both = [&](std::optional<double> a, std::optional<double> b) {
    return a && b ? std::optional(between(*a, *b)) : std::nullopt;
  };
  return {between(before.stature, after.stature), between(before.mass, after.mass),
          between(before.head_girth, after.head_girth),
          if_both(before.neck_girth, after.neck_girth),
          if_both(before.crotch_height, after.crotch_height)};
}

void move_to_age(const BodyPackage& package, const TapeMeasure& tape, double years,
                 ShapeSpace& space) {
  if (!(years >= kYoungest && years <= kOldest))
    throw UnfitError(
        fmt::format("age {} years: from {} to {} is possible", years, kYoungest, kOldest));
  const Growth now = growth_at(package.tables, space.sex, years),
               grown = growth_at(package.tables, space.sex, kSurveyAge);
  const double size = now.stature / grown.stature;
  const std::vector<double> before = tape.take_all(space.mean);
  std::vector<MeasureTarget> bones;
  for (const char* id : kBoneLengths)
    if (const int k = tape.table().at(id); years > kGrownAge)
      bones.push_back({k, std::sqrt(size) * tape.take(k, space.mean)});
  const Points survey = average_of_age(package, space.sex, kSurveyAge, 1);
  const Points average = average_of_age(package, space.sex, years, size);
  space.mean = size * (space.mean + symmetric(package, average / size - survey));
  space.basis *= float(size);
  space.spread *= size;

  Eigen::VectorXd factor(space.law_mean.size()), apart = factor;
  for (Eigen::Index k = 0; k < factor.size(); ++k) {
    const bool mass = tape.measure(int(k)).kind == MeasureKind::mass;
    factor[k] = mass ? now.mass / grown.mass : size;
    apart[k] = factor[k] * (space.law_mean[k] - before[k]);
  }
  const auto measured = [&] {
    const std::vector<double> values = tape.take_all(space.mean);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), apart.size()));
  };
  space.law_covariance = factor.asDiagonal() * space.law_covariance * factor.asDiagonal();
  space.heavier = factor.cwiseProduct(space.heavier);
  space.law_mean = measured() + apart;
  space.mean = with_growth(tape, space, now, bones);
  space.law_mean = measured() + apart;
}

}  // namespace ecorche::inline v1
