// The largest isometric force of a muscle from its size.
#pragma once

namespace ecorche::inline v1 {

// Pa, per area of all fibres; as in the common gait models
inline constexpr double kMuscleStress = 0.6e6;

// N. volume in m^3, fibre length (optimal) in m.
inline double isometric_force(double volume, double fibre_length) {
  return fibre_length > 0 ? kMuscleStress * volume / fibre_length : 0;
}

}  // namespace ecorche::inline v1
