// Figures of a pressure map on the skin, whole and by region of the body.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "skinning/lift/patient.h"

namespace ecorche::inline v1 {

// Mean pressure of capillaries and twice the diastolic of arterioles that maps of pressure are
// read by: 32 and 70 mmHg (Landis 1930; Kosiak 1961, shares recalled).
inline constexpr double kCapillaryPressure = 4.3e3, kHighPressure = 9.3e3;  // Pa

struct PressureFigures {
  // Pa, of the largest mean over a vertex and its neighbours, some 10 cm^2: what a cell of a
  // measuring mat sees
  double peak = 0;
  int peak_vertex = -1;
  double mean = 0;                           // Pa, over the area in contact
  double area = 0;                           // m^2 in contact
  double area_capillary = 0, area_high = 0;  // m^2 beyond the two pressures above
  double force = 0;                          // N, of the pressures alone
};

struct PressureMap {
  PressureFigures whole;
  std::vector<PressureFigures> regions;  // as Patient::regions
};

// Means over a vertex and its neighbours, weighted by the area in contact, Pa. #V
std::vector<double> smooth_pressure(const Triangles& F, std::span<const double> pressure,
                                    std::span<const double> area);

// `pressure` Pa and `area` in contact m^2, #V of the patient's skin.
PressureMap measure_pressure(const Patient& patient, std::span<const double> pressure,
                             std::span<const double> area);

}  // namespace ecorche::inline v1
