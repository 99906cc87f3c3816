#include "anatomy/posing/tense_thickening.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/slice_outline.h"
#include "anatomy/posing/activation_bulge.h"

namespace ecorche::inline v1 {
namespace {

// Share of the way (in logarithms) from a flat section to a round one.
constexpr double kFullRounding = 0.3;

// Spread of a section's area along its width over that along its thickness. The radii alone do not
// tell: muscles that were packed among others are flat by their outlines.
double flatness(const Ellipse& section) {
  double area = 0;
  Vec2 first = Vec2::Zero(), second = Vec2::Zero();  // moments, about the section's centre
  const auto corner = [&](std::size_t k) -> Vec2 {
    return double(section.outline[k]) * section.radii.cwiseProduct(outline_directions()[k]);
  };
  for (std::size_t k = 0; k < kOutlinePoints; ++k) {
    const Vec2 p = corner(k), q = corner((k + 1) % kOutlinePoints);
    const double fan = p.x() * q.y() - p.y() * q.x();
    area += fan / 2;
    first += fan / 6 * (p + q);
    second += fan / 12 * (p.cwiseAbs2() + q.cwiseAbs2() + p.cwiseProduct(q));
  }
  if (!(area > 0)) return 1;
  const Vec2 spread = second / area - (first / area).cwiseAbs2();
  return spread.minCoeff() > 0 ? std::sqrt(spread.x() / spread.y()) : 1;
}

}  // namespace

double tense_thickening(const Muscle& muscle, const Ellipse& section, double place) {
  if (muscle.tense_thickness > 0) {
    const double grown = gathered(Double4::Ones(), Double4::Constant(place))[0];
    const double middle = std::max(0.0, 1 - place * place);
    return (1 + middle * (muscle.tense_thickness - 1)) / (muscle.sheet ? grown : std::sqrt(grown)) -
           1;
  }
  return muscle.sheet ? 0 : std::pow(flatness(section), 0.5 * kFullRounding) - 1;
}

}  // namespace ecorche::inline v1
