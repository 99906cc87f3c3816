// Isometric shortening of a muscle's belly: its active fibres stretch the tendon while the joints
// hold still.
//
// Fibre and tendon in quasi-static balance along the path (Thelen 2003, 10.1115/1.1531112; Millard
// et al. 2013, 10.1115/1.4023390), forces over the largest isometric one, l the fibre's length over
// its optimal one, e the tendon's strain:
//   (a fL(l) + fP(l)) cos(pennation) = fT(e),   path = fibre along the path + tendon,   fibre
//   across the path: constant fL = exp(-(l - 1)^2 / 0.45),   fP = (exp(4 (l - 1) / 0.6) - 1) / (e^4
//   - 1), fT: 0.33 (exp(3 e / toe) - 1) / (e^3 - 1) up to toe = 0.609 * 0.049, then a line of
//   slope 1.712 / 0.049.
// At rest, relaxed, the fibre has its optimal length and the tendon (all of the path that is not
// fibre, aponeuroses too) is just slack.
#pragma once

#include <array>

namespace ecorche::inline v1 {

struct MuscleTendon {
  double fibre = 0;      // optimal length, m
  double pennation = 0;  // at that length, rad
  double path = 0;       // length of the whole path at rest, m
};

// Shortening of fibres along the path, m, from relaxed to `activation` in [0, 1], the path being
// `path` long. Relaxed, tendons are slack or carry the passive fibre. Never negative.
double isometric_shortening(const MuscleTendon& muscle, double path, double activation);

// isometric_shortening() as a table over path length and the root of the activation, linear
// between: made once, read every frame.
class TendonCompliance {
 public:
  static constexpr int kLengths = 17, kActivations = 9;

  TendonCompliance() = default;  // a tendon that does not stretch
  // Nothing for fibre or path not above 0, or a pennation near a right angle. Fibres longer than 95
  // % of their path are taken as that long.
  explicit TendonCompliance(const MuscleTendon& muscle);

  // `root` = sqrt(activation), in [0, 1]; lengths outside the table take its ends.
  double at(double path, double root) const {
    const double x = bound((path - first_) * per_step_, kLengths - 1),
                 y = bound(root * (kActivations - 1), kActivations - 1);
    const int i = int(x) < kLengths - 1 ? int(x) : kLengths - 2;
    const int j = int(y) < kActivations - 1 ? int(y) : kActivations - 2;
    const double u = x - i, v = y - j;
    const float* low = &shortening_[unsigned(i * kActivations + j)];
    const float* high = low + kActivations;
    return (1 - u) * ((1 - v) * double(low[0]) + v * double(low[1])) +
           u * ((1 - v) * double(high[0]) + v * double(high[1]));
  }

 private:
  static double bound(double x, int most) { return x > 0 ? (x < most ? x : most) : 0; }

  double first_ = 0, per_step_ = 0;
  std::array<float, kLengths * kActivations> shortening_{};  // m
};

}  // namespace ecorche::inline v1
