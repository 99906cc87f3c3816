#include "morph/shapes/shape_space.h"

#include <cmath>

#include <fmt/format.h>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "morph/shapes/length_functions.h"
#include "morph/shapes/region_functions.h"
#include "morph/shapes/shape_examples.h"

namespace ecorche::inline v1 {
namespace {

// Of the examples' variance, nearly all of which is stature: what is left out is 0.3 mm a
// coordinate. Less detail (99.9 %) would leave it to local shapes to imitate examples, and a body
// would not come back from its own measures.
constexpr double kLeftOut = 1e-5;

// Directions of the examples that carry all but `rest` of their variance, a standard deviation
// each.
Eigen::MatrixXd example_directions(const Eigen::MatrixXd& examples, const Eigen::VectorXd& mean,
                                   double rest, int& for_99) {
  const Eigen::MatrixXd apart =
      (examples.colwise() - mean) / std::sqrt(double(examples.cols() - 1));
  const SymmetricEigen<Eigen::Dynamic> gram =
      symmetric_eigen<Eigen::Dynamic>(apart.transpose() * apart);
  const double total = gram.values.sum();
  double left = total;
  int used = 0;
  for_99 = 0;
  while (used < examples.cols() && left > rest * total) {
    left -= gram.values[examples.cols() - 1 - used++];
    if (for_99 == 0 && left <= 0.01 * total) for_99 = used;
  }
  return apart * gram.vectors.rightCols(used).rowwise().reverse();
}

// What the prior says of the survey's measures: their values at coefficients w and their
// derivatives.
void measure_rows(const TapeMeasure& tape, const Survey& survey, const ShapeSpace& space,
                  const Eigen::VectorXd& w, Eigen::VectorXd& value, Eigen::MatrixXd& J) {
  const Points V = space_points(space, w);
  const Eigen::Index rows = survey.measures.size();
  value.resize(rows);
  J.resize(rows, w.size());
  MeasureGradient gradient;
  for (Eigen::Index r = 0; r < rows; ++r) {
    const int k = survey.measures[r];
    value[r] = tape.take(k, V, &gradient);
    if (!std::isfinite(value[r]))
      throw UnfitError(
          fmt::format("measure '{}' cannot be taken on the mean body", tape.measure(k).id));
    J.row(r) = space_gradient(space, gradient);
  }
}

// Share of its spread to which each measure follows the survey: less would bend bodies to follow
// differences of definition.
constexpr double kSurveyNoise = 0.08;

// Mean and covariance factor of the coefficients once the measures follow the survey's law: w given
// m is Gaussian, m is the survey's.
void follow_survey(const TapeMeasure& tape, const Survey& survey, const ShapeSpace& prior,
                   Eigen::Index regions, Eigen::VectorXd& mean, Eigen::MatrixXd& factor) {
  const Eigen::Index K = prior.basis.cols(), M = survey.mean.size();
  Eigen::VectorXd value, slack2(M), noise2(M);
  Eigen::MatrixXd J;
  for (Eigen::Index r = 0; r < M; ++r) {
    const Measure& m = tape.measure(survey.measures[r]);
    slack2[r] = std::max(1e-8, m.survey_slack * m.survey_slack);
    noise2[r] = std::pow(kSurveyNoise * survey.sd[r], 2);
  }
  mean = Eigen::VectorXd::Zero(K);
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    measure_rows(tape, survey, prior, mean, value, J);
    J.rightCols(regions).setZero();  // the mean body is made of whole shapes alone
    const Eigen::MatrixXd A = J * J.transpose() + Eigen::MatrixXd(slack2.asDiagonal());
    mean = J.transpose() * solve_ldlt<Eigen::Dynamic>(A, survey.mean - value + J * mean);
  }
  measure_rows(tape, survey, prior, mean, value, J);
  const Eigen::MatrixXd A = J * J.transpose() + Eigen::MatrixXd(noise2.asDiagonal());
  const Eigen::MatrixXd gain = solve_ldlt_columns(A, J).transpose();
  const Eigen::MatrixXd law = survey.sd.asDiagonal() * survey.correlation * survey.sd.asDiagonal();
  const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(K, K) - gain * J;
  const Eigen::MatrixXd covariance =
      left * left.transpose() +
      gain * (law + Eigen::MatrixXd(noise2.asDiagonal())) * gain.transpose();
  const SymmetricEigen<Eigen::Dynamic> eigen =
      symmetric_eigen<Eigen::Dynamic>(0.5 * (covariance + covariance.transpose()));
  factor = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

// The direction in which people of one stature get heavier, as far as civilians differ more than
// soldiers: what other measures are, given stature and mass, stays as it is.
void widen_law(const TapeMeasure& tape, ShapeSpace& space) {
  // The upper tail of the body mass index, kg/m^2: a 99th percentile of 48 in men and 53 in women,
  // means of 28 (NHANES 2009-2012).
  constexpr double kCivilians = 7.5;
  const Eigen::MatrixXd& law = space.law_covariance;
  const int tall = tape.table().at("stature"), heavy = tape.table().at("weight");
  const Eigen::VectorXd with =
      law.col(heavy) - law.col(tall) * (law(tall, heavy) / law(tall, tall));
  const double soldiers2 = with[heavy], height = space.law_mean[tall];
  const double more2 = std::pow(kCivilians * height * height, 2) - soldiers2;
  space.heavier = with * (std::sqrt(std::max(0.0, more2)) / soldiers2);
}

// The survey's law, completed by what the space says of the measures that no survey has. Where a
// tape's and a mesh's definition differ on the mean body, the law stands between them and allows
// for both.
void complete_law(const TapeMeasure& tape, const Survey& survey, ShapeSpace& space) {
  constexpr double kNoise = 0.12, kUnknownNoise = 0.6;  // of each spread
  const Eigen::Index n = tape.count();
  space.law_mean.resize(n);
  Eigen::MatrixXd J(n, space.basis.cols());
  MeasureGradient gradient;
  for (Eigen::Index k = 0; k < n; ++k) {
    space.law_mean[k] = tape.take(int(k), space.mean, &gradient);
    J.row(k) = space_gradient(space, gradient);
  }
  space.law_covariance = J * J.transpose();
  Eigen::VectorXd noise = kUnknownNoise * space.law_covariance.diagonal().cwiseSqrt();
  const auto number = [&survey](Eigen::Index r) { return survey.measures[r]; };
  for (Eigen::Index r = 0; r < survey.mean.size(); ++r) {
    const double apart = survey.mean[r] - space.law_mean[number(r)];
    space.law_mean[number(r)] += 0.5 * apart;
    noise[number(r)] = kNoise * survey.sd[r] + 0.5 * std::abs(apart);
    for (Eigen::Index c = 0; c < survey.mean.size(); ++c)
      space.law_covariance(number(r), number(c)) =
          survey.correlation(r, c) * survey.sd[r] * survey.sd[c];
  }
  // Two sources side by side need not make a covariance; the nearest one after scaling is.
  const Eigen::VectorXd sd = space.law_covariance.diagonal().cwiseSqrt(),
                        inverse = sd.cwiseInverse();
  const SymmetricEigen<Eigen::Dynamic> eigen = symmetric_eigen<Eigen::Dynamic>(
      inverse.asDiagonal() * space.law_covariance * inverse.asDiagonal());
  const Eigen::MatrixXd correlation =
      eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
  space.law_covariance = sd.asDiagonal() * correlation * sd.asDiagonal();
  widen_law(tape, space);
  space.law_covariance.diagonal() += noise.cwiseAbs2();
}

// Turns the coefficients so that the basis is orthogonal and falls in size.
void order_basis(ShapeSpace& space) {
  const Eigen::MatrixXd B = space.basis.cast<double>();
  const SymmetricEigen<Eigen::Dynamic> gram = symmetric_eigen<Eigen::Dynamic>(B.transpose() * B);
  const Eigen::MatrixXd turn = gram.vectors.rowwise().reverse();
  space.basis = (B * turn).cast<float>();
  const Eigen::VectorXd variance = gram.values.reverse().cwiseMax(0);
  space.spread = (3.0 * variance / double(B.rows())).cwiseSqrt();
  double sum = 0;
  space.components = 0;
  while (space.components < variance.size() && sum < 0.99 * variance.sum())
    sum += variance[space.components++];
}

}  // namespace

Survey read_survey(const MeasureTable& table, Sex sex, const std::filesystem::path& folder) {
  const Table rows(folder / (sex == Sex::male ? "survey_male.csv" : "survey_female.csv"));
  Survey out;
  std::vector<int> row_of;
  for (std::size_t k = 0; k < table.measures.size(); ++k) {
    for (int row = 0; row < rows.rows(); ++row) {
      if (table.measures[k].survey_field.empty() ||
          rows.text(row, "field") != table.measures[k].survey_field)
        continue;
      out.measures.push_back(int(k));
      row_of.push_back(row);
    }
  }
  const Eigen::Index n = row_of.size();
  out.mean.resize(n);
  out.sd.resize(n);
  out.correlation.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int row = row_of[i];
    const Measure& m = table.measures[out.measures[i]];
    out.mean[i] = rows.number(row, "mean") + m.survey_shift;
    out.sd[i] = rows.number(row, "sd");
    for (Eigen::Index j = 0; j < n; ++j)
      out.correlation(i, j) = rows.number(row, rows.text(row_of[j], "field"));
  }
  return out;
}

ShapeSpace build_shape_space(const BodyPackage& package, const TapeMeasure& tape, Sex sex,
                             const ShapeSpaceOptions& options) {
  const std::filesystem::path folder = package.tables / "body";
  const Eigen::Index n = package.skin_size;
  ShapeSpace space;
  space.sex = sex;
  const Eigen::MatrixXd examples = shape_examples(package, sex, options.examples);
  const Eigen::VectorXd mean = examples.rowwise().mean();
  space.mean = Eigen::Map<const Points>(mean.data(), n, 3);
  const Eigen::MatrixXd global =
      example_directions(examples, mean, kLeftOut, space.example_components);
  Eigen::MatrixXd local(3 * n, 0);
  for (const Eigen::MatrixXd& more :
       {local_shapes(package, sex, folder),
        length_functions(package, tape.table(), space.mean, folder)}) {
    local.conservativeResize(Eigen::NoChange, local.cols() + more.cols());
    local.rightCols(more.cols()) = more;
  }
  const std::vector<RegionFunction> regions = region_functions(package, tape, space.mean, folder);
  const Eigen::Index region_count = regions.size();
  space.basis.resize(3 * n, global.cols() + local.cols() + region_count);
  space.basis.leftCols(global.cols()) = global.cast<float>();
  space.basis.middleCols(global.cols(), local.cols()) = local.cast<float>();
  for (Eigen::Index r = 0; r < region_count; ++r)
    space.basis.rightCols(region_count).col(r) =
        Eigen::Map<const Eigen::VectorXd>(regions[r].offsets.data(), 3 * n).cast<float>();

  Eigen::VectorXd shift;
  Eigen::MatrixXd factor;
  const Survey survey = read_survey(tape.table(), sex, folder);
  follow_survey(tape, survey, space, region_count, shift, factor);
  space.mean = space_points(space, shift);
  space.basis = (space.basis * factor.cast<float>()).eval();
  order_basis(space);
  complete_law(tape, survey, space);
  return space;
}

Points space_points(const ShapeSpace& space, const Eigen::VectorXd& z) {
  const Eigen::VectorXf d = space.basis * z.cast<float>();
  return space.mean + Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                          d.data(), space.mean.rows(), 3)
                          .cast<double>();
}

Eigen::VectorXd space_gradient(const ShapeSpace& space, const MeasureGradient& gradient) {
  Eigen::VectorXf out = Eigen::VectorXf::Zero(space.basis.cols());
  for (const auto& [vertex, g] : gradient) {
    for (int axis = 0; axis < 3; ++axis)
      if (g[axis] != 0) out += float(g[axis]) * space.basis.row(3 * vertex + axis).transpose();
  }
  return out.cast<double>();
}

}  // namespace ecorche::inline v1
