// What of the relief under a layer of fat and skin is seen on the skin. Private to the library.
//
// A soft layer passes a ripple of its underside on to its upper side the less, the shorter the
// ripple is: of a wavelength l the share exp(-2 pi h / l) comes through a thickness h, as of any
// field that is harmonic between the two. What is longer than kShape is left to the skin below
// (bulges of whole muscles), what is shorter than a mesh can hold is left away. The filter is a sum
// of Gaussian smoothings of the depth ("bands"), by weights that are fitted to that law.
#pragma once

#include <array>

namespace ecorche::inline v1 {

constexpr int kBands = 5;
// m, standard deviations of the bands' smoothings; the first is that of the mean by which the depth
// is measured, of planes, so that it keeps more than a smoothing would.
constexpr std::array<double, kBands> kBandWidths{0.0035, 0.0075, 0.014, 0.026, 0.048};
// m, standard deviation of the smoothing that counts as the shape beneath. Larger: bulges of whole
// muscles are shown twice, by skin and relief. Smaller: only furrows are left.
constexpr double kShape = kBandWidths[kBands - 1];

// Share of a ripple that comes through a layer and differs from the shape. Lengths in m, above 0.
double transmitted(double thickness, double wavelength);

// Share of a ripple that a band keeps; of wave numbers, 1/m.
double kept(int band, double wave_number);

// A weight a band, sum 0, so that their sum passes transmitted(), to some 0.05.
using BandWeights = std::array<float, kBands>;
BandWeights band_weights(double thickness);

}  // namespace ecorche::inline v1
