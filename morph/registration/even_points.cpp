#include "morph/registration/even_points.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace ecorche::inline v1 {
namespace {

constexpr Eigen::Index kDense = 60000;  // points that a coarse surface is sampled with

// Points drawn evenly by area, in an order of which every beginning is even.
std::vector<int> even_order(const std::vector<float>& area, std::size_t count) {
  std::vector<double> sums(area.size());
  double sum = 0;
  for (std::size_t i = 0; i < area.size(); ++i) sums[i] = sum += area[i];
  std::vector<int> out;
  // Golden-ratio steps: every beginning of them is spread.
  double at = 0.5;
  for (std::size_t k = 0; k < count; ++k) {
    at = std::fmod(at + 0.6180339887498949, 1.0);
    const auto found = std::upper_bound(sums.begin(), sums.end(), at * sum);
    out.push_back(int(std::min<std::size_t>(std::size_t(found - sums.begin()), area.size() - 1)));
  }
  return out;
}

}  // namespace

EvenPoints even_points(const Scan& scan) {
  EvenPoints out;
  double total = 0;
  for (const float a : scan.area) total += a;
  out.spacing = std::sqrt(total / double(std::max<Eigen::Index>(1, scan.points.rows())));
  if (scan.F.rows() == 0 || scan.points.rows() >= kDense) {
    out.surface = {scan.points, scan.normals};
    out.area = scan.area;
    out.border = scan.border;
    out.covering = scan.covering;
    return out;
  }
  const double each = total / double(kDense);
  std::vector<Vec3> points, normals;
  double owed = 0.5;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    const int i = scan.F(f, 0), j = scan.F(f, 1), k = scan.F(f, 2);
    const Vec3 a = scan.points.row(i), b = scan.points.row(j), c = scan.points.row(k);
    owed += (b - a).cross(c - a).norm() / 2 / each;
    for (; owed >= 1; owed -= 1) {
      double u = unit(random), v = unit(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const double w = 1 - u - v;
      points.push_back(w * a + u * b + v * c);
      normals.push_back(
          (w * scan.normals.row(i) + u * scan.normals.row(j) + v * scan.normals.row(k))
              .transpose()
              .normalized());
      out.area.push_back(float(each));
      const auto corners = [&](const std::vector<char>& of) {
        return of.empty() ? 0 : of[std::size_t(i)] + of[std::size_t(j)] + of[std::size_t(k)];
      };
      out.border.push_back(char(corners(scan.border) >= 2));
      out.covering.push_back(char(corners(scan.covering) == 3));
    }
  }
  out.surface.points.resize(Eigen::Index(points.size()), 3);
  out.surface.normals.resize(Eigen::Index(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.surface.points.row(Eigen::Index(i)) = points[i].transpose();
    out.surface.normals.row(Eigen::Index(i)) = normals[i].transpose();
  }
  return out;
}

EvenPoints spread_points(const EvenPoints& points, std::size_t count) {
  const std::vector<int> few = even_order(points.area, std::min(count, points.area.size()));
  EvenPoints out;
  out.spacing = points.spacing;
  out.surface = {Points(Eigen::Index(few.size()), 3), Points(Eigen::Index(few.size()), 3)};
  const float more =
      float(double(points.area.size()) / double(std::max<std::size_t>(1, few.size())));
  for (std::size_t k = 0; k < few.size(); ++k) {
    out.surface.points.row(Eigen::Index(k)) = points.surface.points.row(few[k]);
    out.surface.normals.row(Eigen::Index(k)) = points.surface.normals.row(few[k]);
    out.area.push_back(more * points.area[std::size_t(few[k])]);
    if (!points.border.empty()) out.border.push_back(points.border[std::size_t(few[k])]);
    if (!points.covering.empty()) out.covering.push_back(points.covering[std::size_t(few[k])]);
  }
  return out;
}

}  // namespace ecorche::inline v1
