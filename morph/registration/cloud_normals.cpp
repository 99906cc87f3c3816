#include "morph/registration/cloud_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <queue>
#include <tuple>
#include <unordered_map>

#include <Eigen/Eigenvalues>

#include "anatomy/compute/parallel_ranges.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kPointGrain = 2000;

// Two axes across a unit vector.
void tangent_axes(const Vec3& n, Vec3& u, Vec3& v) {
  u = n.unitOrthogonal();
  v = n.cross(u);
}

float median_spacing(const CloudNeighbours& near) {
  std::vector<float> spacing(near.index.size() / near.count);
  for (std::size_t i = 0; i < spacing.size(); ++i) spacing[i] = near.distances(int(i))[0];
  const auto middle = spacing.begin() + std::ptrdiff_t(spacing.size() / 2);
  std::ranges::nth_element(spacing, middle);
  return *middle;
}

std::uint64_t pixel_of(int x, int y) {
  return std::uint64_t(std::uint32_t(x)) << 32 | std::uint32_t(y);
}

// For and against a normal as it stands, by one direction's depth picture.
void vote(const Points& points, const Points& normals, const Vec3& towards, double pixel,
          std::vector<float>& sum, std::vector<float>& weight) {
  Vec3 u, v;
  tangent_axes(towards, u, v);
  const Eigen::Index n = points.rows();
  std::unordered_map<std::uint64_t, double> front;
  front.reserve(n / 4);
  std::vector<std::array<int, 2>> at(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 p = points.row(i);
    at[i] = {int(std::floor(p.dot(u) / pixel)), int(std::floor(p.dot(v) / pixel))};
    const auto [found, fresh] = front.try_emplace(pixel_of(at[i][0], at[i][1]), p.dot(towards));
    if (!fresh) found->second = std::max(found->second, p.dot(towards));
  }
  const double behind = 2 * pixel;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double depth = points.row(i).dot(towards);
    bool seen = true;
    for (int dx = -1; dx <= 1 && seen; ++dx) {
      for (int dy = -1; dy <= 1 && seen; ++dy) {
        const auto found = front.find(pixel_of(at[i][0] + dx, at[i][1] + dy));
        seen = found == front.end() || found->second < depth + behind;
      }
    }
    if (!seen) continue;
    const double facing = normals.row(i).dot(towards);
    sum[i] += float(facing);
    weight[i] += float(std::abs(facing));
  }
}

// Directions to the corners, edges and faces of a cube.
std::vector<Vec3> around() {
  std::vector<Vec3> out;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) out.push_back(Vec3(x, y, z).normalized());
  return out;
}

// Passes sides on from points that have one (`sided`) to all that hang together with them; fresh
// patches begin with their normal as it is. Returns the patch of each fresh point, -1 for others.
std::vector<int> spread_sides(const CloudNeighbours& near, std::vector<char>& sided,
                              Points& normals, int& patches) {
  struct Step {
    float turn;
    int from, to;
    bool operator>(const Step& other) const {
      return std::tie(turn, from, to) > std::tie(other.turn, other.from, other.to);
    }
  };
  const int n = int(sided.size());
  std::priority_queue<Step, std::vector<Step>, std::greater<>> steps;
  std::vector<int> patch(n, -1);
  const auto offer = [&](int i) {
    for (const int j : near.of(i))
      if (sided[j] == 0)
        steps.push({float(1 - std::abs(normals.row(i).dot(normals.row(j)))), i, j});
  };
  const auto follow = [&] {
    while (!steps.empty()) {
      const Step step = steps.top();
      steps.pop();
      if (sided[step.to] != 0) continue;
      sided[step.to] = 1;
      if (normals.row(step.to).dot(normals.row(step.from)) < 0) normals.row(step.to) *= -1;
      patch[step.to] = patch[step.from];
      offer(step.to);
    }
  };
  for (int i = 0; i < n; ++i)
    if (sided[i] != 0) offer(i);
  follow();
  patches = 0;
  for (int i = 0; i < n; ++i) {
    if (sided[i] != 0) continue;
    sided[i] = 1;
    patch[i] = patches++;
    offer(i);
    follow();
  }
  return patch;
}

// Fresh patches turn so that they bulge: the points around a point lie behind it.
void bulge_outwards(const Points& points, const std::vector<int>& patch, int patches,
                    Points& normals) {
  std::vector<Vec3> middle(patches, Vec3::Zero());
  std::vector<int> size(patches, 0);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (patch[i] < 0) continue;
    middle[patch[i]] += points.row(Eigen::Index(i)).transpose();
    ++size[patch[i]];
  }
  std::vector<double> outward(patches, 0.0);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (patch[i] < 0) continue;
    const Eigen::Index row = Eigen::Index(i);
    const Vec3 from = points.row(row).transpose() - middle[patch[i]] / size[patch[i]];
    outward[patch[i]] += from.dot(normals.row(row));
  }
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (patch[i] >= 0 && outward[patch[i]] < 0) normals.row(Eigen::Index(i)) *= -1;
}

}  // namespace

Points plane_normals(const Points& points, const CloudNeighbours& near) {
  Points normals(points.rows(), 3);
  parallel_for_ranges(points.rows(), kPointGrain, Threads::all,
                      [&](std::size_t first, std::size_t last) {
                        for (std::size_t i = first; i < last; ++i) {
                          Vec3 mean = points.row(Eigen::Index(i));
                          for (const int j : near.of(int(i))) mean += points.row(j).transpose();
                          mean /= near.count + 1;
                          const Vec3 own = points.row(Eigen::Index(i)).transpose() - mean;
                          Mat3 spread = own * own.transpose();
                          for (const int j : near.of(int(i))) {
                            const Vec3 d = points.row(j).transpose() - mean;
                            spread += d * d.transpose();
                          }
                          Eigen::SelfAdjointEigenSolver<Mat3> eigen;
                          eigen.computeDirect(spread / std::max(spread.trace(), 1e-300));
                          normals.row(Eigen::Index(i)) = eigen.eigenvectors().col(0).transpose();
                        }
                      });
  return normals;
}

std::vector<float> cloud_areas(const CloudNeighbours& near) {
  const std::size_t n = near.index.size() / near.count;
  std::vector<float> area(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float reach = near.distances(int(i))[near.count - 1];
    area[i] = std::numbers::pi_v<float> * reach * reach / float(near.count);
  }
  return area;
}

std::vector<char> cloud_borders(const Points& points, const Points& normals,
                                const CloudNeighbours& near) {
  constexpr double kGap = 120 * kDegree;
  std::vector<char> border(points.rows(), 0);
  parallel_for_ranges(points.rows(), kPointGrain, Threads::all,
                      [&](std::size_t first, std::size_t last) {
                        std::vector<double> angles;
                        for (std::size_t i = first; i < last; ++i) {
                          const Eigen::Index row = Eigen::Index(i);
                          if (normals.row(row).squaredNorm() == 0) continue;
                          Vec3 u, v;
                          tangent_axes(normals.row(row), u, v);
                          angles.clear();
                          for (const int j : near.of(int(i))) {
                            const Vec3 d = points.row(j) - points.row(row);
                            angles.push_back(std::atan2(d.dot(v), d.dot(u)));
                          }
                          std::ranges::sort(angles);
                          double widest = angles.front() + 2 * std::numbers::pi - angles.back();
                          for (std::size_t k = 1; k < angles.size(); ++k)
                            widest = std::max(widest, angles[k] - angles[k - 1]);
                          border[i] = widest > kGap ? 1 : 0;
                        }
                      });
  return border;
}

std::optional<Vec3> depth_camera(const Points& points) {
  // As wide as two pixels of usual depth cameras, so that a surface fills its directions.
  constexpr double kDirection = 0.3 * kDegree, kBehind = 0.06, kShare = 0.08, kNearest = 0.25;
  std::unordered_map<std::uint64_t, std::pair<double, double>> depths;
  depths.reserve(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vec3 p = points.row(i);
    const double away = p.norm();
    if (away < kNearest) return {};
    const Vec3 d = p / away;
    int axis = 0;
    d.cwiseAbs().maxCoeff(&axis);
    const double w = d[axis], a = d[(axis + 1) % 3] / w, b = d[(axis + 2) % 3] / w;
    const int face = 2 * axis + (w < 0 ? 1 : 0);
    const std::uint64_t key = std::uint64_t(face) << 60 |
                              std::uint64_t((a + 2) / kDirection) << 30 |
                              std::uint64_t((b + 2) / kDirection);
    const auto [found, fresh] = depths.try_emplace(key, away, away);
    if (fresh) continue;
    found->second.first = std::min(found->second.first, away);
    found->second.second = std::max(found->second.second, away);
  }
  std::size_t behind = 0;
  for (const auto& [key, range] : depths) behind += range.second - range.first > kBehind ? 1 : 0;
  // Fewer than two points a direction say nothing.
  if (points.rows() < 2 * Eigen::Index(depths.size())) return {};
  if (double(behind) > kShare * double(depths.size())) return {};
  return Vec3(Vec3::Zero());
}

void orient_normals(const Points& points, const CloudNeighbours& near,
                    const std::optional<Vec3>& camera, Points& normals) {
  const Eigen::Index n = points.rows();
  if (camera) {
    for (Eigen::Index i = 0; i < n; ++i)
      if (normals.row(i).dot(camera->transpose() - points.row(i)) < 0) normals.row(i) *= -1;
    return;
  }
  constexpr float kAgreed = 0.6F, kSeen = 0.3F;
  const double pixel = std::max(1e-9, 2.5 * median_spacing(near));
  std::vector<float> sum(n, 0.0F), weight(n, 0.0F);
  for (const Vec3& towards : around()) vote(points, normals, towards, pixel, sum, weight);
  std::vector<char> sided(n, 0);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (weight[i] < kSeen || std::abs(sum[i]) < kAgreed * weight[i]) continue;
    sided[i] = 1;
    if (sum[i] < 0) normals.row(i) *= -1;
  }
  // A sheet that is seen from both sides has sides at its rim alone, by chance.
  const std::size_t told = std::size_t(std::ranges::count(sided, 1));
  if (3 * told < std::size_t(n)) std::ranges::fill(sided, 0);
  int patches = 0;
  const std::vector<int> patch = spread_sides(near, sided, normals, patches);
  bulge_outwards(points, patch, patches, normals);
}

}  // namespace ecorche::inline v1
