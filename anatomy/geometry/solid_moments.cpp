#include "anatomy/geometry/solid_moments.h"

#include <array>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

void add_tetrahedron(const Vec3& o, const Vec3& a, const Vec3& b, const Vec3& c,
                     SolidMoments& out) {
  const double volume = (a - o).dot((b - o).cross(c - o)) / 6;
  const Vec3 sum = o + a + b + c;
  out.volume += volume;
  out.first += volume / 4 * sum;
  out.second += volume / 20 *
                (o * o.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose() +
                 sum * sum.transpose());
}

// The part of a triangle where the field is above 0: up to four corners.
int clipped_corners(const std::array<Vec3, 3>& p, const std::array<double, 3>& f,
                    std::array<Vec3, 4>& out) {
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (f[i] > 0) out[count++] = p[i];
    if ((f[i] > 0) != (f[next] > 0))
      out[count++] = p[i] + f[i] / (f[i] - f[next]) * (p[next] - p[i]);
  }
  return count;
}

}  // namespace

void add_moments(const SolidMoments& part, double factor, SolidMoments& sum) {
  sum.volume += factor * part.volume;
  sum.first += factor * part.first;
  sum.second += factor * part.second;
}

Mat3 central_inertia(const SolidMoments& solid) {
  const Mat3 central = solid.second - solid.first * solid.first.transpose() / solid.volume;
  return central.trace() * Mat3::Identity() - central;
}

SolidMoments solid_moments(const TriMesh& mesh, const Vec3& apex) {
  SolidMoments out;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    add_tetrahedron(apex, mesh.V.row(mesh.F(f, 0)), mesh.V.row(mesh.F(f, 1)),
                    mesh.V.row(mesh.F(f, 2)), out);
  return out;
}

SolidMoments solid_moments_above(const TriMesh& mesh, std::span<const double> field,
                                 const Vec3& apex) {
  SolidMoments out;
  std::array<Vec3, 4> corners;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    std::array<Vec3, 3> p;
    std::array<double, 3> heights{};
    for (int k = 0; k < 3; ++k) {
      p[k] = mesh.V.row(mesh.F(f, k));
      heights[k] = field[mesh.F(f, k)];
    }
    const int count = clipped_corners(p, heights, corners);
    for (int k = 2; k < count; ++k)
      add_tetrahedron(apex, corners[0], corners[k - 1], corners[k], out);
  }
  return out;
}

SolidMoments ellipsoid_moments(const Vec3& center, const Mat3& axes, const Vec3& radii) {
  SolidMoments out;
  out.volume = 4.0 / 3 * std::numbers::pi * radii.prod();
  out.first = out.volume * center;
  out.second =
      out.volume * (center * center.transpose() +
                    axes * Mat3((radii.cwiseProduct(radii) / 5).asDiagonal()) * axes.transpose());
  return out;
}

}  // namespace ecorche::inline v1
