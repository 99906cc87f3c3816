#include "skinning/relief/layer_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

constexpr double kShortest = 0.010, kLongest = 0.30;  // m, wavelengths that are fitted
constexpr int kFitted = 60;                           // of them, evenly in logarithms
// Holds weights near zero where bands say the same, so that noise of the depth is not magnified.
constexpr double kRidge = 3e-3;

}  // namespace

double kept(int band, double wave_number) {
  const double first = kBandWidths[0] * wave_number, all = kBandWidths[band] * wave_number;
  return (1 + first * first) * std::exp(-0.5 * all * all);
}

double transmitted(double thickness, double wavelength) {
  const double wave_number = 2 * std::numbers::pi / wavelength;
  const double shape = kShape * wave_number;
  return std::exp(-thickness * wave_number) * (1 - std::exp(-0.5 * shape * shape));
}

BandWeights band_weights(double thickness) {
  // Unknowns: all but the last, which makes the sum zero.
  Eigen::Matrix<double, kFitted, kBands - 1> A;
  Eigen::Matrix<double, kFitted, 1> b;
  for (int i = 0; i < kFitted; ++i) {
    const double wavelength = kShortest * std::pow(kLongest / kShortest, double(i) / (kFitted - 1));
    const double wave_number = 2 * std::numbers::pi / wavelength;
    for (int k = 0; k + 1 < kBands; ++k)
      A(i, k) = kept(k, wave_number) - kept(kBands - 1, wave_number);
    b[i] = transmitted(thickness, wavelength);
  }
  Eigen::Matrix<double, kBands - 1, kBands - 1> normal = A.transpose() * A;
  normal.diagonal().array() += kRidge;
  const Eigen::Matrix<double, kBands - 1, 1> x = normal.ldlt().solve(A.transpose() * b);
  BandWeights out{};
  for (int k = 0; k + 1 < kBands; ++k) {
    out[k] = float(x[k]);
    out[kBands - 1] -= out[k];
  }
  return out;
}

}  // namespace ecorche::inline v1
