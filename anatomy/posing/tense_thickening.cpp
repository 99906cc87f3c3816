#include "anatomy/posing/tense_thickening.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/slice_outline.h"
#include "anatomy/posing/activation_bulge.h"

namespace ecorche::inline v1 {
namespace {

// Share of the way (in logarithms) from a flat section to a round one.
constexpr double kFullRounding = 0.3;

// Flatness along its thickness that is added to a section's own. Larger: sections that lie aslant
// thicken along their axes; smaller: the direction of round ones is left to chance.
constexpr double kTowardsThickness = 0.01;
constexpr int kEvenRounds = 1;  // along a strip

// Second moments of a section's area about its centroid, over the area, m^2. The radii alone do
// not tell how flat it is: muscles that were packed among others are flat by their outlines.
Eigen::Matrix2d spread(const Ellipse& section) {
  double area = 0;
  Vec2 first = Vec2::Zero();  // moments, about the section's centre
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  const auto corner = [&](std::size_t k) -> Vec2 {
    return double(section.outline[k]) * section.radii.cwiseProduct(outline_directions()[k]);
  };
  for (std::size_t k = 0; k < kOutlinePoints; ++k) {
    const Vec2 p = corner(k), q = corner((k + 1) % kOutlinePoints);
    const double fan = p.x() * q.y() - p.y() * q.x();
    area += fan / 2;
    first += fan / 6 * (p + q);
    const Vec2 sum = p + q;
    second += fan / 24 * (p * p.transpose() + q * q.transpose() + sum * sum.transpose());
  }
  if (!(area > 0)) return Eigen::Matrix2d::Zero();
  first /= area;
  return second / area - first * first.transpose();
}

// How much wider than thick a section is, m^2, at twice the angle of the direction in which it is
// thin.
Vec2 thinness(const Ellipse& section) {
  const Eigen::Matrix2d moments = spread(section);
  return Vec2(moments(1, 1) - moments(0, 0) - kTowardsThickness * moments.trace(),
              -2 * moments(0, 1));
}

// Spread of a section's area across a direction over that along it.
double flatness(const Ellipse& section, const Vec2& direction) {
  const Eigen::Matrix2d moments = spread(section);
  const Vec2 across(-direction.y(), direction.x());
  const double along = direction.dot(moments * direction);
  return along > 0 ? std::sqrt(across.dot(moments * across) / along) : 1;
}

}  // namespace

std::vector<Vec2> thickening_directions(const Muscle& muscle, std::span<const Ellipse> sections) {
  if (muscle.sheet) return std::vector<Vec2>(sections.size(), Vec2::UnitY());
  std::vector<Vec2> doubled;
  for (const Ellipse& section : sections) doubled.push_back(thinness(section));
  for (int round = 0; round < kEvenRounds; ++round) {
    const std::vector<Vec2> before = doubled;
    for (std::size_t k = 1; k + 1 < doubled.size(); ++k)
      doubled[k] = 0.25 * (before[k - 1] + before[k + 1]) + 0.5 * before[k];
  }
  std::vector<Vec2> out;
  for (const Vec2& twice : doubled) {
    const double angle = 0.5 * std::atan2(twice.y(), twice.x());
    out.emplace_back(std::cos(angle), std::sin(angle));
  }
  return out;
}

double tense_thickening(const Muscle& muscle, const Ellipse& section, const Vec2& direction,
                        double place) {
  if (muscle.tense_thickness > 0) {
    const double grown = gathered(Double4::Ones(), Double4::Constant(place))[0];
    const double middle = std::max(0.0, 1 - place * place);
    return (1 + middle * (muscle.tense_thickness - 1)) / (muscle.sheet ? grown : std::sqrt(grown)) -
           1;
  }
  return muscle.sheet ? 0 : std::pow(flatness(section, direction), 0.5 * kFullRounding) - 1;
}

}  // namespace ecorche::inline v1
