// Bodies from eight measures by examples alone, as Seo and Magnenat-Thalmann 2004 make them: what a
// shape space is compared with.
//
// A body vector is the joints of a skeleton and what is left of the skin once the template has been
// carried by them. Principal components of both (99 % of the variance) are functions of the eight
// measures (scaled to orthogonal axes of unit spread), learned from examples: a joint synthesizer
// and a displacement synthesizer. Measures are met approximately.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "morph/measures/tape_measure.h"
#include "morph/shapes/body.h"
#include "morph/shapes/rbf_network.h"

namespace ecorche::inline v1 {

// The paper's, as ids of data/body/measures.csv: neck, bust, underbust, waist and hip girth,
// height, crotch and arm length.
inline constexpr std::array<const char*, 8> kPaperMeasures{
    "neck_base_girth", "chest_girth", "underbust_girth", "waist_girth",
    "hip_girth",       "stature",     "crotch_height",   "arm_length_outseam"};

// Components of one part of the body vector and their networks.
struct ComponentSynthesizer {
  Eigen::VectorXd mean;
  Eigen::MatrixXd basis;  // #values x #components, orthonormal
  std::vector<RadialNetwork> networks;
  Eigen::MatrixXd left_out;  // #examples x #components: each example's from the others
};

struct ExampleSynthesizer {
  Points skin;                  // the template's, #skin x 3
  VertexWeights weights;        // of its skeleton
  Eigen::VectorXd joints;       // heads and tails of its bones
  Eigen::VectorXd input_mean;   // 8, m
  Eigen::MatrixXd input_scale;  // 8 x 8: measures less their mean -> orthogonal axes of unit spread
  ComponentSynthesizer joint, displacement;
};

// From `count` examples of the body package; some seconds. The same count gives the same result.
ExampleSynthesizer learn_synthesizer(const BodyPackage& package, const TapeMeasure& tape, Sex sex,
                                     int count);

// The skin for the eight measures (m), soles on y = 0. #skin x 3
Points synthesize(const ExampleSynthesizer& synthesizer, const std::array<double, 8>& measures);

// One column of the paper's table 3: how an example's own girth comes back when it is made from the
// other examples.
struct LeftOut {
  std::string measure;
  double correlation = 0, mean_difference = 0, mean = 0;  // m; the difference as an absolute value
};
std::vector<LeftOut> cross_validate(const BodyPackage& package, const TapeMeasure& tape, Sex sex,
                                    const ExampleSynthesizer& synthesizer);

}  // namespace ecorche::inline v1
