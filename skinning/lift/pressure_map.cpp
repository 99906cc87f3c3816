#include "skinning/lift/pressure_map.h"

namespace ecorche::inline v1 {
namespace {

void add_vertex(double pressure, double smooth, double area, int vertex, PressureFigures& out) {
  if (area <= 0) return;
  out.force += pressure * area;
  out.area += area;
  if (smooth > kCapillaryPressure) out.area_capillary += area;
  if (smooth > kHighPressure) out.area_high += area;
  if (smooth > out.peak) {
    out.peak = smooth;
    out.peak_vertex = vertex;
  }
}

void finish_figures(PressureFigures& out) {
  if (out.area > 0) out.mean = out.force / out.area;
}

}  // namespace

std::vector<double> smooth_pressure(const Triangles& F, std::span<const double> pressure,
                                    std::span<const double> area) {
  std::vector<double> force(pressure.size(), 0), around(pressure.size(), 0);
  // Each neighbour counts once a triangle, the vertex itself as often.
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) {
        const std::size_t i = std::size_t(F(f, k)), j = std::size_t(F(f, l));
        force[i] += pressure[j] * area[j];
        around[i] += area[j];
      }
  std::vector<double> out(pressure.size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (area[i] > 0) out[i] = force[i] / around[i];
  return out;
}

PressureMap measure_pressure(const Patient& patient, std::span<const double> pressure,
                             std::span<const double> area) {
  PressureMap out;
  out.regions.resize(patient.regions.size());
  const std::vector<double> smooth = smooth_pressure(patient.skin.F, pressure, area);
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    add_vertex(pressure[i], smooth[i], area[i], int(i), out.whole);
    add_vertex(pressure[i], smooth[i], area[i], int(i),
               out.regions[std::size_t(patient.region[i])]);
  }
  finish_figures(out.whole);
  for (PressureFigures& each : out.regions) finish_figures(each);
  return out;
}

}  // namespace ecorche::inline v1
