#include "morph/registration/scan_removal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <unordered_map>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "morph/registration/scan_points.h"

namespace ecorche::inline v1 {
namespace {

class Pieces {
 public:
  explicit Pieces(int n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) {
    a = of(a), b = of(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<double> mean_distances(const CloudNeighbours& near) {
  std::vector<double> mean(near.index.size() / near.count);
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const auto distances = near.distances(int(i));
    mean[i] = std::accumulate(distances.begin(), distances.end(), 0.0) / near.count;
  }
  return mean;
}

struct Plane {
  Vec3 normal = Vec3::UnitY();
  double offset = 0;  // normal . x = offset

  double height(const Vec3& p) const { return normal.dot(p) - offset; }
};

constexpr double kPlaneDepth = 0.008;  // m
constexpr double kPlaneFacing = 0.75;  // cosine

// Of a plane: its points in the largest piece, their area, and how wide that is across.
struct PlanePiece {
  std::vector<int> points;
  double area = 0, width = 0;
};

bool on_plane(const Scan& scan, const Plane& plane, int i, double depth) {
  return std::abs(plane.height(scan.points.row(i))) < depth &&
         scan.normals.row(i).dot(plane.normal) > kPlaneFacing;
}

// The plane that most of the area lies on, by tries at single points with their normals.
Plane largest_plane(const Scan& scan, const std::vector<int>& sample, std::mt19937& random,
                    double depth) {
  constexpr int kTries = 400;
  std::uniform_int_distribution<std::size_t> pick(0, sample.size() - 1);
  Plane best;
  double most = -1;
  for (int t = 0; t < kTries; ++t) {
    const int i = sample[pick(random)];
    Plane plane{scan.normals.row(i), scan.normals.row(i).dot(scan.points.row(i))};
    double area = 0;
    for (const int j : sample)
      if (on_plane(scan, plane, j, depth)) area += 1;
    if (area > most) most = area, best = plane;
  }
  // Least squares on its points.
  for (int round = 0; round < 3; ++round) {
    Vec3 mean = Vec3::Zero();
    double n = 0;
    for (const int j : sample) {
      if (!on_plane(scan, best, j, depth)) continue;
      mean += scan.points.row(j).transpose();
      n += 1;
    }
    if (n < 3) break;
    mean /= n;
    Mat3 spread = Mat3::Zero();
    for (const int j : sample) {
      if (!on_plane(scan, best, j, depth)) continue;
      const Vec3 d = scan.points.row(j).transpose() - mean;
      spread += d * d.transpose();
    }
    const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
    best.normal = normal.dot(best.normal) < 0 ? Vec3(-normal) : normal;
    best.offset = best.normal.dot(mean);
  }
  return best;
}

PlanePiece largest_piece(const Scan& scan, const CloudNeighbours& near, const Plane& plane,
                         const std::vector<char>& keep, double depth) {
  const int n = int(scan.points.rows());
  std::vector<char> on(n, 0);
  for (int i = 0; i < n; ++i) on[i] = keep[i] != 0 && on_plane(scan, plane, i, depth) ? 1 : 0;
  Pieces pieces(n);
  for (int i = 0; i < n; ++i) {
    if (on[i] == 0) continue;
    for (const int j : near.of(i))
      if (on[j] != 0) pieces.join(i, j);
  }
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f)
    for (int c = 0; c < 3; ++c) {
      const int a = scan.F(f, c), b = scan.F(f, (c + 1) % 3);
      if (on[a] != 0 && on[b] != 0) pieces.join(a, b);
    }
  std::vector<double> area(n, 0.0);
  for (int i = 0; i < n; ++i)
    if (on[i] != 0) area[pieces.of(i)] += scan.area[i];
  const int largest = int(std::ranges::max_element(area) - area.begin());
  PlanePiece out;
  out.area = area[largest];
  for (int i = 0; i < n; ++i)
    if (on[i] != 0 && pieces.of(i) == largest) out.points.push_back(i);
  if (out.points.size() < 3) return out;
  Vec3 mean = Vec3::Zero();
  for (const int i : out.points) mean += scan.points.row(i).transpose();
  mean /= double(out.points.size());
  Mat3 spread = Mat3::Zero();
  for (const int i : out.points) {
    const Vec3 d = scan.points.row(i).transpose() - mean;
    spread += d * d.transpose();
  }
  const Vec3 across = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(1);
  double low = 0, high = 0;
  for (const int i : out.points) {
    const double x = across.dot(scan.points.row(i).transpose() - mean);
    low = std::min(low, x), high = std::max(high, x);
  }
  out.width = high - low;
  return out;
}

// Joins what lies in one cell of that width or in neighbouring ones.
void join_over_gaps(const Points& points, double width, Pieces& pieces) {
  const auto key_of = [](const Eigen::Vector3i& c) {
    constexpr std::int64_t kHalf = 1 << 20;
    return std::uint64_t(c.x() + kHalf) << 42 | std::uint64_t(c.y() + kHalf) << 21 |
           std::uint64_t(c.z() + kHalf);
  };
  const auto cell_of = [&](Eigen::Index i) -> Eigen::Vector3i {
    constexpr double kFar = 1e6;
    const Vec3 cell = (points.row(i).transpose() / width).array().floor();
    return cell.cwiseMax(-kFar).cwiseMin(kFar).cast<int>();
  };
  std::unordered_map<std::uint64_t, int> first;
  first.reserve(points.rows() / 4);
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    pieces.join(first.try_emplace(key_of(cell_of(i)), int(i)).first->second, int(i));
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3i cell = cell_of(i);
    if (first.at(key_of(cell)) != int(i)) continue;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = first.find(key_of(cell + Eigen::Vector3i(x, y, z)));
          if (found != first.end()) pieces.join(int(i), found->second);
        }
  }
}

// Shares of the area that is left beyond a plane, on either side of it.
std::array<double, 2> sides(const Scan& scan, const Plane& plane, const std::vector<char>& keep,
                            double depth) {
  double above = 0, below = 0, all = 0;
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    if (keep[i] == 0) continue;
    const double height = plane.height(scan.points.row(i));
    if (height > depth) above += scan.area[i];
    if (height < -depth) below += scan.area[i];
    if (std::abs(height) > depth) all += scan.area[i];
  }
  all = std::max(all, 1e-12);
  return {above / all, below / all};
}

// Everything on the plane that faces its way; with `rim`, what lies behind it, too.
void take_plane(const Scan& scan, const Plane& plane, double depth, bool rim,
                std::vector<char>& keep) {
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    if (keep[i] == 0) continue;
    if (on_plane(scan, plane, int(i), depth) || (rim && -plane.height(scan.points.row(i)) > depth))
      keep[i] = 0;
  }
}

struct PieceFigures {
  double area = 0, seen = 0;  // seen: number of points
  Vec3 mean = Vec3::Zero();
  Mat3 spread = Mat3::Zero();
  Eigen::AlignedBox3d box;
};

// Least over largest spread: 0 a plane.
double roundness(const PieceFigures& piece) {
  const Mat3 about = piece.spread / piece.seen - piece.mean * piece.mean.transpose();
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(about).eigenvalues();
  return std::sqrt(std::max(0.0, values[0]) / std::max(values[2], 1e-12));
}

// How much a piece is like a person's main piece: its area, or its number of points where one
// camera saw it; nothing for boards and for rooms.
double person_score(const PieceFigures& piece, bool one_view) {
  constexpr double kBoard = 0.04, kRoom = 3.2;
  const double extent = piece.box.sizes().maxCoeff();
  double score = one_view ? piece.seen : piece.area;
  if (roundness(piece) < kBoard) score *= 0.05;
  if (extent > kRoom) score *= 0.05;
  return score;
}

}  // namespace

std::vector<char> without_outliers(const Points& points, const CloudNeighbours& near) {
  constexpr double kFarther = 2.5, kFar = 8;
  const std::size_t n = points.rows();
  const std::vector<double> apart = mean_distances(near);
  const double usual = median_of(apart);
  std::vector<char> keep(n);
  std::vector<double> theirs(near.count);
  for (std::size_t i = 0; i < n; ++i) {
    const auto others = near.of(int(i));
    for (int k = 0; k < near.count; ++k) theirs[k] = apart[others[k]];
    keep[i] = apart[i] <= kFarther * median_of(theirs) && apart[i] <= kFar * usual ? 1 : 0;
  }
  return keep;
}

int level_spikes(Scan& scan) {
  constexpr double kFine = 0.01, kLeast = 0.008, kTiny = 1e-6;
  const Eigen::Index n = scan.points.rows();
  // Rings as sums; edges inside the mesh count twice, which changes no mean.
  std::vector<Vec3> sum(n, Vec3::Zero());
  std::vector<double> across(n, 0.0);  // logarithms of edges that a vertex does not touch
  std::vector<int> faces(n, 0);
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const int v = scan.F(f, c), a = scan.F(f, (c + 1) % 3), b = scan.F(f, (c + 2) % 3);
      sum[v] += (scan.points.row(a) + scan.points.row(b)).transpose();
      across[v] += std::log((scan.points.row(a) - scan.points.row(b)).norm() + kTiny);
      ++faces[v];
    }
  }
  std::vector<char> spike(n, 0);
  int spikes = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (faces[i] == 0) continue;
    const double out = (scan.points.row(i).transpose() - sum[i] / (2 * faces[i])).norm();
    const double edge = std::exp(across[i] / faces[i]);
    if (out < kLeast || out < (edge < kFine ? 2 : 3) * edge) continue;
    spike[i] = 1;
    ++spikes;
  }
  if (spikes == 0) return 0;
  std::vector<Vec3> ring(n, Vec3::Zero());
  std::vector<int> size(n, 0);
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const int v = scan.F(f, c);
      if (spike[v] == 0) continue;
      for (const int w : {scan.F(f, (c + 1) % 3), scan.F(f, (c + 2) % 3)}) {
        if (spike[w] != 0) continue;
        ring[v] += scan.points.row(w).transpose();
        ++size[v];
      }
    }
  }
  for (Eigen::Index i = 0; i < n; ++i)
    if (size[i] > 0) scan.points.row(i) = ring[i].transpose() / size[i];
  return spikes;
}

std::vector<char> without_planes(Scan& scan, const CloudNeighbours& near) {
  constexpr int kSample = 6000, kPlanes = 12;
  constexpr double kFloorArea = 0.05, kFloorWidth = 0.2, kWallArea = 0.35, kOneSide = 0.25;
  constexpr double kOutline = 0.05;
  std::vector<char> keep(scan.points.rows(), 1);
  std::mt19937 random(1);
  double floor_area = 0, wall_area = 0;
  for (int p = 0; p < kPlanes; ++p) {
    Scan left = scan;
    left.F.resize(0, 3);
    std::vector<int> number;
    for (int i = 0; i < int(keep.size()); ++i)
      if (keep[i] != 0) number.push_back(i);
    keep_points(left, keep);
    std::vector<int> sample = spread_points(left, kSample);
    for (int& i : sample) i = number[i];
    if (sample.size() < 100) break;
    // Far points of depth cameras scatter more.
    const double depth = std::max(kPlaneDepth, scan.one_view ? 0.02 : 0.0);
    const Plane plane = largest_plane(scan, sample, random, depth);
    const PlanePiece piece = largest_piece(scan, near, plane, keep, depth);
    const auto [above, below] = sides(scan, plane, keep, depth);
    // Who stands on a floor is on the side that it faces; soles and a flat back face away from him.
    const bool stands =
        above > below && below < kOneSide && piece.area > kFloorArea && piece.width > kFloorWidth;
    if (!stands && piece.area < kWallArea) break;
    // What hangs below a floor's or pedestal's plane within its outline is its rim.
    bool rim = stands && below > 0;
    if (rim) {
      Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
      for (const int i : piece.points) {
        low = low.cwiseMin(scan.points.row(i).transpose());
        high = high.cwiseMax(scan.points.row(i).transpose());
      }
      for (Eigen::Index i = 0; i < scan.points.rows() && rim; ++i) {
        if (keep[i] == 0 || -plane.height(scan.points.row(i)) < depth) continue;
        const Vec3 at =
            scan.points.row(i).transpose() - plane.height(scan.points.row(i)) * plane.normal;
        rim = (at.array() > low.array() - kOutline).all() &&
              (at.array() < high.array() + kOutline).all();
      }
    }
    if (stands && !rim && below > 0.03 && piece.area < kWallArea) break;
    take_plane(scan, plane, depth, rim, keep);
    (stands ? floor_area : wall_area) += piece.area;
    if (stands && !scan.up && !scan.one_view) scan.up = plane.normal;
  }
  if (floor_area > 0)
    scan.notes.push_back(
        fmt::format("floor or pedestal taken away: {:.2f} m2 of plane", floor_area));
  if (wall_area > 0)
    scan.notes.push_back(fmt::format("walls taken away: {:.2f} m2 of plane", wall_area));
  return keep;
}

std::vector<char> without_islands(Scan& scan, const CloudNeighbours& near) {
  constexpr double kGap = 0.01, kLeast = 0.02, kReach = 0.25, kAlike = 2;
  const int n = int(scan.points.rows());
  Pieces pieces(n);
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    pieces.join(scan.F(f, 0), scan.F(f, 1));
    pieces.join(scan.F(f, 0), scan.F(f, 2));
  }
  join_over_gaps(scan.points, kGap, pieces);
  // However sparse, what is as dense as its neighbours hangs together with them.
  const std::vector<double> apart = mean_distances(near);
  for (int i = 0; i < n; ++i) {
    const auto others = near.of(i);
    const auto distances = near.distances(i);
    for (int k = 0; k < near.count; ++k)
      if (distances[k] < kAlike * std::min(apart[i], apart[others[k]])) pieces.join(i, others[k]);
  }
  std::vector<PieceFigures> figures(n);
  double all = 0;
  for (int i = 0; i < n; ++i) {
    PieceFigures& piece = figures[pieces.of(i)];
    const Vec3 p = scan.points.row(i);
    piece.area += scan.area[i];
    piece.seen += 1;
    piece.mean += p;
    piece.spread += p * p.transpose();
    piece.box.extend(p);
    all += scan.area[i];
  }
  int main = -1;
  double best = -1;
  for (int i = 0; i < n; ++i) {
    if (figures[i].seen < 1) continue;
    figures[i].mean /= figures[i].seen;
    const double score = person_score(figures[i], scan.one_view);
    if (score > best) best = score, main = i;
  }
  const double body = figures[main].area;
  int kept = 0, gone = 0;
  double lost = 0;
  std::vector<char> stays(n, 0);
  for (int i = 0; i < n; ++i) {
    const PieceFigures& piece = figures[i];
    if (piece.seen < 1) continue;
    const double away = figures[main].box.exteriorDistance(piece.mean);
    stays[i] =
        i == main || (piece.area > kLeast * body && away < kReach && piece.area < body) ? 1 : 0;
    (stays[i] != 0 ? kept : gone) += 1;
    if (stays[i] == 0) lost += piece.area;
  }
  if (gone > 0)
    scan.notes.push_back(fmt::format("{} island{} taken away, {:.1f} % of the area", gone,
                                     gone == 1 ? "" : "s", 100 * lost / all));
  std::vector<char> keep(n);
  for (int i = 0; i < n; ++i) keep[i] = stays[pieces.of(i)];
  return keep;
}

}  // namespace ecorche::inline v1
