#include "morph/shapes/tell_sex.h"

#include <cmath>
#include <vector>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

MeasureLaw law_of(const ShapeSpace& space) {
  return {space.law_mean, space.law_covariance + space.heavier * space.heavier.transpose()};
}

// Up to a constant that both sexes share.
double log_density(const MeasureLaw& law, const std::vector<int>& measures,
                   const Eigen::VectorXd& values) {
  const Eigen::VectorXd apart = values - law.mean(measures);
  const CholeskyFactor factor(law.covariance(measures, measures));
  return -0.5 * (apart.dot(factor.solve(apart)) + factor.log_determinant());
}

}  // namespace

SexLaws make_sex_laws(const BodyModel& model) {
  return {model.tape(), {law_of(model.adults(Sex::male)), law_of(model.adults(Sex::female))}};
}

double male_log_odds(const SexLaws& laws, const Points& skin) {
  const std::vector<double> all = laws.tape.take_all(skin);
  std::vector<int> measures;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (std::isfinite(all[k]) && !laws.tape.measure(int(k)).survey_field.empty())
      measures.push_back(int(k));
  Eigen::VectorXd values(Eigen::Index(measures.size()));
  for (std::size_t i = 0; i < measures.size(); ++i)
    values[Eigen::Index(i)] = all[std::size_t(measures[i])];
  return log_density(laws.laws[0], measures, values) - log_density(laws.laws[1], measures, values);
}

Sex told_sex(const SexLaws& laws, const Points& skin) {
  return male_log_odds(laws, skin) > 0 ? Sex::male : Sex::female;
}

}  // namespace ecorche::inline v1
