// Statistics of bodies: principal components of skins, what age, mass and stature say of them, and
// where a given body lies among people.
//
// After "Statistical Human Body Shape Model including Elderly People" (the statistics paper):
// components of the skins' covariance without scaling, s = m + U w (their eq. 4 and 5); attributes
// a = (age, mass, stature, 1) mapped to scores by M = P A^+; five lengths along the axes imposed in
// closed form (eq. 6 and 7). Their eq. 7 leaves the basis out: here e = G (U w + m) is solved for
// the scores of least Mahalanobis distance, of which there are more than equations.
//
// Lengths in metres, masses in kilograms, ages in years. Skins stand in the base mesh's A-pose.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {

// A person whom statistics know: drawn from a shape space, or registered.
struct StatisticPerson {
  Points skin;  // #skin x 3
  double age = 0, mass = 0, stature = 0;
};

struct BodyStatistics {
  // Scores that stand for a body: the paper's ten, of some 92 % of the variance.
  static constexpr int kScores = 10;
  static constexpr int kAttributes = 3;  // age, mass, stature

  Sex sex = Sex::male;
  int people = 0;
  Points mean;                // #skin x 3, soles on y = 0, its middle over x = z = 0
  ShapeBasis components;      // 3 #skin x K, orthonormal, in falling order of variance; K <= 50
  Eigen::VectorXd deviation;  // K: standard deviation of the scores w, m
  Eigen::VectorXd explained;  // K: share of the variance that components 0 .. k have together
  Eigen::MatrixXd M;          // kScores x (kAttributes + 1): scores w of attributes (.., 1)
  // Attributes of scores: least squares the other way round.
  Eigen::MatrixXd back;                 // kAttributes x (K + 1)
  Eigen::VectorXd attribute_mean;       // kAttributes
  Eigen::VectorXd attribute_deviation;  // of the people
  Eigen::VectorXd attribute_error;      // root mean square, each person left out of the fit
};

// Precondition: at least 20 people with the same vertices (std::invalid_argument). Registered
// bodies and drawn ones count alike.
BodyStatistics learn_statistics(Sex sex, std::span<const StatisticPerson> people);

// Scores of a skin, in standard deviations: all K. Precondition: at least #skin rows.
Eigen::VectorXd scores_of(const BodyStatistics& statistics, const Points& skin);

// A score as something a body is to have. The statistics must outlive it.
Aim score_aim(const BodyStatistics& statistics, int component, double wanted);

// The skin of the first scores (standard deviations), soles on y = 0. #skin x 3
Points skin_of_scores(const BodyStatistics& statistics, const Eigen::VectorXd& scores);

// Scores (kScores, standard deviations) of people of that age, mass and stature: M a.
Eigen::VectorXd scores_of_attributes(const BodyStatistics& statistics, double age, double mass,
                                     double stature);

// The body `skin` at another age, mass and stature: M (a' - a) added, what is its own kept.
Points change_attributes(const BodyStatistics& statistics, const Points& skin,
                         const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// One of the paper's measurement items: the distance of two points along an axis.
struct AxisItem {
  std::string name;
  int axis = 0;           // 0 to the left, 1 up, 2 ahead
  int from = -1, to = 0;  // vertices: x(to) - x(from); from -1: the floor
};

// Height, shoulder width, waist width, waist thickness, crotch height.
std::array<AxisItem, 5> axis_items(const BodyPackage& package, const TapeMeasure& tape);

double take_item(const AxisItem& item, const Points& skin);

// The item as something a body is to have, for solve_measures.
Aim item_aim(const AxisItem& item, double wanted);

struct ItemValue {
  AxisItem item;
  double value = 0;
};

// The most probable scores (kScores, standard deviations) with the values, in closed form: w = L
// (G U L)^+ (e - G m), L the deviations. The floor is where the mean body's is.
Eigen::VectorXd scores_of_items(const BodyStatistics& statistics, std::span<const ItemValue> items);

// Where a body lies among people.
struct BodyDescription {
  Eigen::VectorXd scores;              // kScores, standard deviations
  double distance = 0;                 // Mahalanobis, of the scores
  double percentile = 0;               // share of people who are nearer to the mean, 0 .. 100
  double left_mean = 0, left_max = 0;  // m: of the skin that the ten scores do not give, a vertex
  double age = 0, mass = 0, stature = 0;                    // estimates from the scores
  double age_error = 0, mass_error = 0, stature_error = 0;  // standard deviations of these
};

BodyDescription describe_body(const BodyStatistics& statistics, const Points& skin);

// Lines for people: "more usual than 63 of 100 people; ...".
std::vector<std::string> describe(const BodyDescription& description);

// Share of chi-square values with that even number of degrees of freedom that are smaller.
double chi_square_share(double value, int degrees);

}  // namespace ecorche::inline v1
