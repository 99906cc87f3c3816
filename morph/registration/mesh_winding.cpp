#include "morph/registration/mesh_winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/compute/sphere_directions.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/registration/scan_points.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kRays = 24;
constexpr double kJustOff = 2e-4, kOverNoise = 0.004;  // m, where rays begin

struct HalfEdge {
  int low, high, face;
  bool rising;
  auto order() const { return std::tuple(low, high, face); }
};

// Which faces must turn for neighbours to be wound alike, and the piece of each.
void alike(const Triangles& F, std::vector<char>& turn, std::vector<int>& piece, int& pieces) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * F.rows());
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int c = 0; c < 3; ++c) {
      const int a = F(f, c), b = F(f, (c + 1) % 3);
      edges.push_back({std::min(a, b), std::max(a, b), int(f), a < b});
    }
  std::ranges::sort(edges, {}, &HalfEdge::order);
  // neighbour over each side: face and whether it is wound the other way
  std::vector<std::array<int, 3>> next(F.rows(), {-1, -1, -1});
  std::vector<std::array<char, 3>> other(F.rows(), {0, 0, 0});
  std::vector<int> filled(F.rows(), 0);
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last].low == edges[first].low &&
           edges[last].high == edges[first].high)
      ++last;
    if (last - first != 2) continue;
    const HalfEdge &a = edges[first], &b = edges[first + 1];
    for (const auto& [from, to] : {std::pair(a.face, b.face), std::pair(b.face, a.face)}) {
      other[from][filled[from]] = a.rising == b.rising ? 1 : 0;
      next[from][filled[from]++] = to;
    }
  }
  turn.assign(F.rows(), 0);
  piece.assign(F.rows(), -1);
  pieces = 0;
  std::vector<int> stack;
  for (Eigen::Index seed = 0; seed < F.rows(); ++seed) {
    if (piece[seed] >= 0) continue;
    piece[seed] = pieces;
    stack.push_back(int(seed));
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int c = 0; c < filled[f]; ++c) {
        const int g = next[f][c];
        if (piece[g] >= 0) continue;
        piece[g] = pieces;
        turn[g] = char(turn[f] ^ other[f][c]);
        stack.push_back(g);
      }
    }
    ++pieces;
  }
}

// Share of rays on one side of a point that meet nothing.
double open_share(const SkinRays& rays, const std::vector<Vec3>& directions, const Vec3& p,
                  const Vec3& n, double off) {
  constexpr double kGrazing = 0.1;
  int open = 0, all = 0;
  for (const Vec3& d : directions) {
    if (d.dot(n) < kGrazing) continue;
    ++all;
    if (rays.first_hit(p + off * n, d).triangle < 0) ++open;
  }
  return all == 0 ? 0 : double(open) / all;
}

}  // namespace

WindingReport wind_outwards(Scan& scan) {
  WindingReport report;
  std::vector<char> turn;
  std::vector<int> piece;
  int pieces = 0;
  alike(scan.F, turn, piece, pieces);
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f)
    if (turn[f] != 0) std::swap(scan.F(f, 1), scan.F(f, 2));

  // Faces by turns, up to some thousands: small pieces all of theirs, large ones a share.
  constexpr int kLooks = 6000;
  std::vector<int> size(pieces, 0);
  for (const int p : piece) ++size[p];
  const double share = std::min(1.0, double(kLooks) / double(scan.F.rows()));
  std::vector<double> looked(pieces, 0.0);
  std::vector<int> looks;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    const double step = std::min(1.0, std::max(share, 12.0 / size[piece[f]]));
    looked[piece[f]] += step;
    if (looked[piece[f]] < 1 && step < 1) continue;
    looked[piece[f]] -= 1;
    looks.push_back(int(f));
  }
  const SkinRays rays({scan.points, scan.F}, RayBuild::quick);
  const std::vector<Vec3> directions = sphere_directions(2 * kRays);
  std::vector<double> outward(looks.size(), 0.0), size_of(looks.size(), 0.0);
  constexpr std::size_t kGrain = 200;
  parallel_for_ranges(looks.size(), kGrain, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto f = scan.F.row(looks[k]);
      const Vec3 a = scan.points.row(f[0]), b = scan.points.row(f[1]), c = scan.points.row(f[2]);
      const Vec3 cross = (b - a).cross(c - a);
      const double area = cross.norm();
      if (area <= 0) continue;
      const Vec3 n = cross / area, middle = (a + b + c) / 3;
      size_of[k] = area;
      outward[k] = area * (open_share(rays, directions, middle, n, kJustOff) -
                           open_share(rays, directions, middle, -n, kJustOff));
    }
  });
  // A sheet that is seen from both sides stays as it was wound.
  constexpr double kSheet = 0.25;
  std::vector<double> sum(pieces, 0.0), seen(pieces, 0.0);
  std::vector<int> wound(pieces, 0);
  for (std::size_t k = 0; k < looks.size(); ++k) {
    sum[piece[looks[k]]] += outward[k];
    seen[piece[looks[k]]] += size_of[k];
  }
  for (std::size_t f = 0; f < piece.size(); ++f) wound[piece[f]] += turn[f] != 0 ? -1 : 1;
  for (int p = 0; p < pieces; ++p)
    if (std::abs(sum[p]) < kSheet * seen[p]) sum[p] = wound[p];
  Eigen::Index turned = 0;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    const bool about = sum[piece[f]] < 0;
    if (about) std::swap(scan.F(f, 1), scan.F(f, 2));
    turned += about != (turn[f] != 0) ? 1 : 0;
  }
  report.turned = int(turned);
  report.inside_out = 2 * turned > scan.F.rows();
  if (turned > 0) measure_faces(scan);
  return report;
}

std::vector<char> without_insides(const Scan& scan) {
  constexpr double kOpen = 1.5 / kRays, kMatters = 0.15;
  TriMesh body{scan.points, scan.F};
  Eigen::Index faces = 0;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f)
    if (scan.covering[scan.F(f, 0)] == 0) body.F.row(faces++) = scan.F.row(f);
  std::vector<char> keep(scan.points.rows(), 1);
  if (faces == 0) return keep;
  body.F.conservativeResize(faces, 3);
  const SkinRays rays(body);
  const std::vector<Vec3> directions = sphere_directions(2 * kRays);
  const auto look_at = [&](const std::vector<int>& points) {
    constexpr std::size_t kGrain = 200;
    parallel_for_ranges(points.size(), kGrain, Threads::all,
                        [&](std::size_t first, std::size_t last) {
                          for (std::size_t k = first; k < last; ++k) {
                            const int i = points[k];
                            if (scan.covering[i] == 0)
                              keep[i] = open_share(rays, directions, scan.points.row(i),
                                                   scan.normals.row(i), kOverNoise) > kOpen;
                          }
                        });
  };
  constexpr int kSample = 3000;
  const std::vector<int> sample = spread_points(scan, kSample);
  look_at(sample);
  const auto inside = std::ranges::count_if(sample, [&](int i) { return keep[i] == 0; });
  if (double(inside) < kMatters * double(sample.size())) return std::vector<char>(keep.size(), 1);
  std::vector<int> all(keep.size());
  std::iota(all.begin(), all.end(), 0);
  look_at(all);
  return keep;
}

}  // namespace ecorche::inline v1
