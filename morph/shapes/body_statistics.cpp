#include "morph/shapes/body_statistics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/eigenvectors.h"
#include "anatomy/compute/linear_systems.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kMostComponents = 50;

// On the floor, its middle over the origin; as one column, rows in order.
Eigen::VectorXd placed(const Points& skin, Eigen::Index rows) {
  Points own = skin.topRows(rows);
  const Eigen::RowVector3d middle = own.colwise().mean();
  own.rowwise() -= Eigen::RowVector3d(middle.x(), own.col(1).minCoeff(), middle.z());
  return Eigen::Map<const Eigen::VectorXd>(own.data(), own.size());
}

Points as_points(const Eigen::VectorXd& column) {
  return Eigen::Map<const Points>(column.data(), column.size() / 3, 3);
}

Eigen::VectorXd flat(const Points& points) {
  return Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
}

// B = X^T Y^+ for rows X (#people x a) and Y (#people x b): each column of X as a linear function
// of Y, a x b.
Eigen::MatrixXd linear_map(const Eigen::MatrixXd& X, const Eigen::MatrixXd& Y) {
  Eigen::MatrixXd out(X.cols(), Y.cols());
  for (Eigen::Index k = 0; k < X.cols(); ++k) out.row(k) = solve_least_squares(Y, X.col(k));
  return out;
}

// What a linear function of Y misses in each person when the person is not among those that it was
// fitted to: residual / (1 - leverage), root mean square.
Eigen::VectorXd left_out_errors(const Eigen::MatrixXd& X, const Eigen::MatrixXd& Y,
                                const Eigen::MatrixXd& map) {
  const Eigen::MatrixXd miss = X - Y * map.transpose();
  const Eigen::MatrixXd inverse = solve_ldlt_columns(Y.transpose() * Y, Y.transpose());
  Eigen::VectorXd out = Eigen::VectorXd::Zero(X.cols());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const double free = std::max(0.05, 1 - Y.row(i).dot(inverse.col(i)));
    out += (miss.row(i).transpose() / free).cwiseAbs2();
  }
  return (out / double(X.rows())).cwiseSqrt();
}

// Components that estimate attributes: more of them would follow single people.
Eigen::Index estimators(const BodyStatistics& statistics) {
  constexpr int kPeopleEach = 6;
  return std::clamp<Eigen::Index>(statistics.people / kPeopleEach, 1, statistics.deviation.size());
}

}  // namespace

BodyStatistics learn_statistics(Sex sex, std::span<const StatisticPerson> people) {
  constexpr int kFewest = 20;
  const Eigen::Index n = people.size();
  if (n < kFewest) throw std::invalid_argument("statistics of fewer than 20 people");
  const Eigen::Index rows = people[0].skin.rows();
  Eigen::MatrixXd S(3 * rows, n);
  Eigen::MatrixXd attributes(n, BodyStatistics::kAttributes + 1);
  for (Eigen::Index j = 0; j < n; ++j) {
    const StatisticPerson& person = people[j];
    if (person.skin.rows() < rows) throw std::invalid_argument("bodies with other vertices");
    S.col(j) = placed(person.skin, rows);
    attributes.row(j) << person.age, person.mass, person.stature, 1;
  }
  BodyStatistics out;
  out.sex = sex;
  out.people = int(n);
  const Eigen::VectorXd mean = S.rowwise().mean();
  out.mean = as_points(mean);
  S.colwise() -= mean;
  const SymmetricEigen<Eigen::Dynamic> gram =
      symmetric_eigen<Eigen::Dynamic>(S.transpose() * S / double(n - 1));
  const double all = gram.values.cwiseMax(0).sum();
  const Eigen::Index K = std::min<Eigen::Index>(kMostComponents, n - 1);
  out.deviation = gram.values.tail(K).reverse().cwiseMax(1e-12).cwiseSqrt();
  out.explained.resize(K);
  double sum = 0;
  for (Eigen::Index k = 0; k < K; ++k)
    out.explained[k] = (sum += out.deviation[k] * out.deviation[k]) / all;
  const Eigen::MatrixXd U = S * gram.vectors.rightCols(K).rowwise().reverse() *
                            (out.deviation * std::sqrt(double(n - 1))).cwiseInverse().asDiagonal();
  out.components = U.cast<float>();

  const Eigen::MatrixXd scores = S.transpose() * U;  // #people x K
  const Eigen::Index first = std::min<Eigen::Index>(BodyStatistics::kScores, K);
  out.M = linear_map(scores.leftCols(first), attributes);
  const Eigen::Index used = estimators(out);
  Eigen::MatrixXd known(n, used + 1);
  known << scores.leftCols(used), Eigen::VectorXd::Ones(n);
  const Eigen::MatrixXd told = attributes.leftCols(BodyStatistics::kAttributes);
  out.back = linear_map(told, known);
  out.attribute_error = left_out_errors(told, known, out.back);
  out.attribute_mean = told.colwise().mean();
  out.attribute_deviation =
      ((told.rowwise() - out.attribute_mean.transpose()).colwise().squaredNorm() / double(n - 1))
          .cwiseSqrt();
  return out;
}

Eigen::VectorXd scores_of(const BodyStatistics& statistics, const Points& skin) {
  const Eigen::VectorXd apart = placed(skin, statistics.mean.rows()) - flat(statistics.mean);
  const Eigen::VectorXd w =
      (statistics.components.transpose() * apart.cast<float>()).cast<double>();
  return w.cwiseQuotient(statistics.deviation);
}

Aim score_aim(const BodyStatistics& statistics, int component, double wanted) {
  constexpr double kTolerance = 0.01;
  const Eigen::Index n = statistics.mean.rows();
  const Eigen::VectorXd direction =
      statistics.components.col(component).cast<double>() / statistics.deviation[component];
  const Points by = as_points(direction);
  const Eigen::RowVector3d sum = by.colwise().sum();
  const double rest = direction.dot(flat(statistics.mean));
  return {[by, direction, sum, rest, n](const Points& V, MeasureGradient* gradient) {
            if (gradient != nullptr) {
              // The body is put on the floor and over the origin before it is compared.
              for (Eigen::Index i = 0; i < n; ++i)
                gradient->emplace_back(int(i), by.row(i).transpose() - Vec3(sum.x() / double(n), 0,
                                                                            sum.z() / double(n)));
              int lowest = 0;
              V.topRows(n).col(1).minCoeff(&lowest);
              gradient->emplace_back(lowest, Vec3(0, -sum.y(), 0));
            }
            return direction.dot(placed(V, n)) - rest;
          },
          wanted, kTolerance};
}

Points skin_of_scores(const BodyStatistics& statistics, const Eigen::VectorXd& scores) {
  const Eigen::Index k = scores.size();
  const Eigen::VectorXf w = scores.cwiseProduct(statistics.deviation.head(k)).cast<float>();
  const Eigen::VectorXf apart = statistics.components.leftCols(k) * w;
  Points out = statistics.mean + as_points(apart.cast<double>());
  out.col(1).array() -= out.col(1).minCoeff();
  return out;
}

Eigen::VectorXd scores_of_attributes(const BodyStatistics& statistics, double age, double mass,
                                     double stature) {
  const Eigen::Vector4d a(age, mass, stature, 1);
  const Eigen::VectorXd w = statistics.M * a;
  return w.cwiseQuotient(statistics.deviation.head(w.size()));
}

Points change_attributes(const BodyStatistics& statistics, const Points& skin,
                         const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::VectorXd w = statistics.M.leftCols(BodyStatistics::kAttributes) * (to - from);
  const Eigen::VectorXf apart = statistics.components.leftCols(w.size()) * w.cast<float>();
  Points out = skin.topRows(statistics.mean.rows()) + as_points(apart.cast<double>());
  out.col(1).array() -= out.col(1).minCoeff();
  return out;
}

std::array<AxisItem, 5> axis_items(const BodyPackage& package, const TapeMeasure& tape) {
  const auto vertex = [&](const char* id) {
    const std::vector<SkinLandmark>& all = tape.table().landmarks;
    const auto at = std::ranges::find(all, id, &SkinLandmark::id);
    if (at == all.end()) throw std::invalid_argument(fmt::format("no landmark '{}'", id));
    return at->vertex;
  };
  const int shoulder = vertex("acromion"), hip = vertex("iliocristale");
  return {{{"height", 1, -1, vertex("vertex")},
           {"shoulder_width", 0, package.mirror[shoulder], shoulder},
           {"waist_width", 0, package.mirror[hip], hip},
           {"waist_thickness", 2, vertex("omphalion_back"), vertex("omphalion")},
           {"crotch_height", 1, -1, vertex("crotch")}}};
}

double take_item(const AxisItem& item, const Points& skin) {
  const double from = item.from >= 0 ? skin(item.from, item.axis) : skin.col(item.axis).minCoeff();
  return skin(item.to, item.axis) - from;
}

Aim item_aim(const AxisItem& item, double wanted) {
  constexpr double kTolerance = 0.0002;
  return {[item](const Points& V, MeasureGradient* gradient) {
            if (gradient != nullptr) {
              Vec3 along = Vec3::Zero();
              along[item.axis] = 1;
              int from = item.from;
              if (from < 0) V.col(item.axis).minCoeff(&from);
              gradient->emplace_back(item.to, along);
              gradient->emplace_back(from, -along);
            }
            return take_item(item, V);
          },
          wanted, kTolerance};
}

Eigen::VectorXd scores_of_items(const BodyStatistics& statistics,
                                std::span<const ItemValue> items) {
  const Eigen::Index count = items.size();
  const Eigen::Index K =
      std::min<Eigen::Index>(BodyStatistics::kScores, statistics.deviation.size());
  Eigen::MatrixXd GU(count, K);
  Eigen::VectorXd rest(count);
  int floor = 0;
  statistics.mean.col(1).minCoeff(&floor);
  for (Eigen::Index i = 0; i < count; ++i) {
    const AxisItem& item = items[i].item;
    const int from = item.from >= 0 ? item.from : floor;
    const auto row = [&](int vertex) {
      return statistics.components.row(3 * vertex + item.axis).head(K).cast<double>();
    };
    GU.row(i) = (row(item.to) - row(from)).cwiseProduct(statistics.deviation.head(K).transpose());
    rest[i] =
        items[i].value - (statistics.mean(item.to, item.axis) - statistics.mean(from, item.axis));
  }
  return solve_least_norm(GU, rest);
}

double chi_square_share(double value, int degrees) {
  double term = std::exp(-value / 2), sum = 0;
  for (int k = 0; k < degrees / 2; ++k) {
    sum += term;
    term *= value / 2 / (k + 1);
  }
  return std::clamp(1 - sum, 0.0, 1.0);
}

BodyDescription describe_body(const BodyStatistics& statistics, const Points& skin) {
  BodyDescription out;
  const Eigen::VectorXd scores = scores_of(statistics, skin);
  const Eigen::Index first = std::min<Eigen::Index>(BodyStatistics::kScores, scores.size());
  out.scores = scores.head(first);
  out.distance = out.scores.norm();
  out.percentile = 100 * chi_square_share(out.scores.squaredNorm(), int(first));
  const Eigen::VectorXf w = out.scores.cwiseProduct(statistics.deviation.head(first)).cast<float>();
  const Eigen::VectorXf given = statistics.components.leftCols(first) * w;
  const Points left = as_points(placed(skin, statistics.mean.rows()) - flat(statistics.mean) -
                                given.cast<double>());
  const Eigen::VectorXd length = left.rowwise().norm();
  out.left_mean = length.mean();
  out.left_max = length.maxCoeff();
  const Eigen::Index used = statistics.back.cols() - 1;
  Eigen::VectorXd known(used + 1);
  known << scores.head(used).cwiseProduct(statistics.deviation.head(used)), 1;
  const Eigen::Vector3d attributes = statistics.back * known;
  out.age = attributes[0], out.mass = attributes[1], out.stature = attributes[2];
  out.age_error = statistics.attribute_error[0];
  out.mass_error = statistics.attribute_error[1];
  out.stature_error = statistics.attribute_error[2];
  return out;
}

std::vector<std::string> describe(const BodyDescription& d) {
  constexpr double kUnusual = 99.9;
  std::vector<std::string> out;
  out.push_back(
      fmt::format("{:.1f} standard deviations from the mean body: {:.1f} of 100 people "
                  "are nearer{}",
                  d.distance, d.percentile, d.percentile > kUnusual ? ", very unusual" : ""));
  out.push_back(
      fmt::format("age by its shape {:.0f} years (+-{:.0f}), mass {:.1f} kg (+-{:.1f}), "
                  "stature {:.3f} m (+-{:.3f})",
                  d.age, d.age_error, d.mass, d.mass_error, d.stature, d.stature_error));
  out.push_back(fmt::format("what ten components leave: {:.1f} mm on average, {:.1f} at most",
                            1000 * d.left_mean, 1000 * d.left_max));
  std::string scores = "scores:";
  for (const double score : d.scores) scores += fmt::format(" {:+.2f}", score);
  out.push_back(scores);
  return out;
}

}  // namespace ecorche::inline v1
