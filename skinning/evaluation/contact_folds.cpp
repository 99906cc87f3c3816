#include "skinning/evaluation/contact_folds.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTouch = 0.005, kApart = 0.02, kBehind = 0.001;  // m

using Corners = std::array<Vec3, 3>;

Corners corners_of(const Points& V, const Triangles& F, Eigen::Index f) {
  return {Vec3(V.row(F(f, 0))), Vec3(V.row(F(f, 1))), Vec3(V.row(F(f, 2)))};
}

Vec3 middle(const Corners& c) { return (c[0] + c[1] + c[2]) / 3; }

Vec3 area(const Corners& c) { return (c[1] - c[0]).cross(c[2] - c[0]); }

// Normals of the triangles that share a corner with one, without its own; not of unit length.
class Surroundings {
 public:
  Surroundings(const Triangles& F, const Points& V)
      : F_(F), V_(V), begin_(std::size_t(V.rows()) + 1, 0) {
    for (Eigen::Index f = 0; f < F.rows(); ++f)
      for (int k = 0; k < 3; ++k) ++begin_[F(f, k) + 1];
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    about_.resize(3 * F.rows());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (Eigen::Index f = 0; f < F.rows(); ++f)
      for (int k = 0; k < 3; ++k) about_[next[F(f, k)]++] = int(f);
  }

  Vec3 normal(int triangle) const {
    std::vector<int> all;
    for (int k = 0; k < 3; ++k) {
      const std::size_t v = F_(triangle, k);
      all.insert(all.end(), about_.begin() + begin_[v], about_.begin() + begin_[v + 1]);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    Vec3 sum = Vec3::Zero();
    for (const int f : all)
      if (f != triangle) sum += area(corners_of(V_, F_, f)).normalized();
    return sum;
  }

 private:
  const Triangles& F_;
  const Points& V_;
  std::vector<int> begin_, about_;
};

}  // namespace

std::vector<char> in_contact_folds(const TriMesh& rest, const Points& V,
                                   std::span<const int> triangles) {
  std::vector<char> out(triangles.size(), 0);
  if (triangles.empty()) return out;
  const Triangles& F = rest.F;
  const Surroundings about(F, V);
  std::vector<Vec3> middles, rest_middles;
  std::vector<double> reach;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Corners c = corners_of(V, F, f);
    middles.push_back(middle(c));
    rest_middles.push_back(middle(corners_of(rest.V, F, f)));
    reach.push_back(kTouch +
                    std::max({(c[0] - middles.back()).norm(), (c[1] - middles.back()).norm(),
                              (c[2] - middles.back()).norm()}));
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::size_t own = triangles[i];
    const Vec3 normal = about.normal(triangles[i]), p = middles[own];
    for (std::size_t f = 0; f < middles.size() && !out[i]; ++f) {
      if ((middles[f] - p).squaredNorm() > reach[f] * reach[f] ||
          (rest_middles[f] - rest_middles[own]).norm() < kApart)
        continue;
      const Corners c = corners_of(V, F, Eigen::Index(f));
      const Vec3 facing = area(c).normalized();
      out[i] = facing.dot(normal) < 0 && (p - c[0]).dot(facing) >= -kBehind &&
               (nearest_in_triangle(p, c[0], c[1], c[2]) - p).norm() <= kTouch;
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
