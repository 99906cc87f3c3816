#include "anatomy/authoring/muscle_ends.h"

// Where a muscle's mesh begins and ends, when nobody has marked it.

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/edge_paths.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

using Ends = std::pair<Vec3, Vec3>;

constexpr int kBands = 20;  // of surface between two ends
constexpr int kReach = 3;   // bands over which a line's direction at its end is taken
constexpr double kVolumeCounts = 5;
constexpr double kGood = 0.002;  // misfit over the mesh's size: no other ends are looked for

// Ends moved out along the muscle's middle line until no surface lies beyond them: a blunt or
// slanting end is cut through from side to side, and the line does not start from its corner.
Ends stretched(const TriMesh& mesh, const Ends& ends) {
  const std::vector<Vec3> middles = middle_line(mesh, ends.first, ends.second, kBands);
  const int n = middles.size();
  if (n < 2 * kReach) return ends;
  const double half = 0.5 * (ends.first - ends.second).norm();
  const auto beyond = [&](const Vec3& from, const Vec3& inside) {
    const Vec3 out = (from - inside).normalized();
    double most = 0;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      const Vec3 d = mesh.V.row(i).transpose() - from;
      if (d.norm() < half) most = std::max(most, d.dot(out));
    }
    return Vec3(from + most * out);
  };
  return {beyond(middles.front(), middles[kReach]),
          beyond(middles[n - 1], middles[n - 1 - kReach])};
}

// Middles of what lies outermost along a direction, at both ends.
Ends along_axis(const TriMesh& mesh, const Vec3& axis) {
  const Eigen::VectorXd places = mesh.V * axis;
  const double low = places.minCoeff(), high = places.maxCoeff(), rim = 0.04 * (high - low);
  const auto middle = [&](double from, double to, double at) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (Eigen::Index i = 0; i < places.size(); ++i)
      if (places[i] >= from && places[i] <= to) sum += mesh.V.row(i).transpose(), ++count;
    const Vec3 mean = sum / count;
    return Vec3(mean + (at - mean.dot(axis)) * axis);
  };
  const Vec3 a = middle(low, low + rim, low), b = middle(high - rim, high, high);
  return axis.y() > 0 ? Ends{b, a} : Ends{a, b};
}

// How far a loft is off, as a length: surfaces apart, and the volume that is missing spread over
// the surface. The latter counts more, for no choice of outlines mends it.
double misfit(const Resampled& found, double area) {
  const ResampleReport& r = found.report;
  return r.mean_distance() + kVolumeCounts * std::abs(r.loft_volume - r.mesh_volume) / area;
}

}  // namespace

Resampled resample_muscle(const TriMesh& mesh, const ResampleOptions& options) {
  const TriMesh whole = welded(mesh);
  const Points centred = whole.V.rowwise() - whole.V.colwise().mean();
  const SymmetricEigen<3> axes = symmetric_eigen<3>(centred.transpose() * centred);
  const Ends furthest = furthest_ends(mesh);
  std::vector<Ends> tried{stretched(whole, furthest), furthest};
  for (const int k : {2, 1}) {
    tried.push_back(along_axis(whole, axes.vectors.col(k)));
    tried.push_back(stretched(whole, tried.back()));
  }
  const double area = mesh_area(whole),
               size = (whole.V.colwise().maxCoeff() - whole.V.colwise().minCoeff()).norm();
  std::optional<Resampled> best;
  std::exception_ptr failure;
  for (const auto& [origin, insertion] : tried) {
    try {
      Resampled now = resample_muscle(mesh, origin, insertion, options);
      const double off = misfit(now, area);
      if (!best || off < misfit(*best, area)) best = std::move(now);
      if (off <= kGood * size) break;
    } catch (const UnfitError&) {
      failure = std::current_exception();
    }
  }
  if (!best) std::rethrow_exception(failure);
  return *std::move(best);
}

std::pair<Vec3, Vec3> furthest_ends(const TriMesh& mesh) {
  const TriMesh whole = welded(mesh);
  const auto furthest = [&](int from) {
    const auto distances = edge_distances(whole, from);
    int best = from;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (std::isfinite(distances[i]) && distances[i] > distances[best]) best = int(i);
    }
    return best;
  };
  // From the corner of the largest piece: that which reaches the most vertices.
  int start = whole.F.rows() > 0 ? whole.F(0, 0) : 0, most = 0;
  std::vector<bool> seen(whole.V.rows(), false);
  for (int i = 0; i < whole.V.rows(); ++i) {
    if (seen[i]) continue;
    const auto distances = edge_distances(whole, i);
    int reached = 0;
    for (std::size_t j = 0; j < distances.size(); ++j) {
      if (!std::isfinite(distances[j])) continue;
      seen[j] = true;
      ++reached;
    }
    if (reached > most) most = reached, start = i;
  }
  const int a = furthest(furthest(start)), b = furthest(a);
  const auto high = whole.V(a, 1) >= whole.V(b, 1);
  return {whole.V.row(high ? a : b), whole.V.row(high ? b : a)};
}

}  // namespace ecorche::inline v1
