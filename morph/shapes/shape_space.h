// The space of human shapes that measures are met in: a mean and orthogonal ways to differ from it,
// for one sex.
//
// Examples drawn from the body package (ages 18 to 90, thin to obese, weak to muscular, all
// proportions and origins) give the ways bodies vary together (PCA, as in Seo and Magnenat-Thalmann
// 2004); the package's local shapes and smooth functions of regions (Kasap and Magnenat-Thalmann
// 2007) let single parts vary as well. The whole is then weighted so that the means, spreads and
// correlations of the measures are those of a survey: the Gaussian update of least change
// (Jeffrey's rule) of the prior x = mean + basis z, z ~ N(0, 1), by the survey's law of the
// measures. Faces, hands and feet only change as wholes.
//
// Every direction is symmetric from left to right. Metres.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "morph/measures/tape_measure.h"
#include "morph/shapes/body.h"

namespace ecorche::inline v1 {

using ShapeBasis = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// What a survey says about the measures. Metres, kilograms.
struct Survey {
  std::vector<int> measures;  // numbers in the tape's table
  Eigen::VectorXd mean, sd;   // the survey's, with the table's shift
  Eigen::MatrixXd correlation;
  int people = 0;
};

// Reads data/body/survey_male.csv or survey_female.csv. Throws InputError.
Survey read_survey(const MeasureTable& table, Sex sex, const std::filesystem::path& folder);

struct ShapeSpaceOptions {
  int examples = 400;
};

struct ShapeSpace {
  Sex sex = Sex::male;
  Points mean;  // #skin x 3
  ShapeBasis
      basis;  // 3 #skin x K, per standard deviation, in falling order of size; x = mean + basis z
  Eigen::VectorXd spread;      // K: root mean square displacement a standard deviation brings, m
  int components = 0;          // how many of the basis give 99 % of the variance
  int example_components = 0;  // how many components 99 % of the examples' own variance needed
  // How the tape's measures vary together between people: the survey's figures, and those of the
  // space where it has none.
  Eigen::VectorXd law_mean;  // #measures, m; kg
  // #measures x #measures, with a little noise for the difference of definitions
  Eigen::MatrixXd law_covariance;
  // What more of fat brings than soldiers have, one usual deviation of it among civilians: people
  // heavier than the mean vary by law_covariance + heavier heavier^T.
  Eigen::VectorXd heavier;  // #measures
};

// Throws InputError for damaged tables or targets. Takes seconds; read_shape_space keeps the
// result.
ShapeSpace build_shape_space(const BodyPackage& package, const TapeMeasure& tape, Sex sex,
                             const ShapeSpaceOptions& options = {});

// The skin of coefficients, not yet put on the floor. #skin x 3
Points space_points(const ShapeSpace& space, const Eigen::VectorXd& z);

// d(measure) / d(z) from d(measure) / d(vertices).
Eigen::VectorXd space_gradient(const ShapeSpace& space, const MeasureGradient& gradient);

}  // namespace ecorche::inline v1
