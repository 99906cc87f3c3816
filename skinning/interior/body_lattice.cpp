#include "skinning/interior/body_lattice.h"

#include <oneapi/tbb/parallel_for.h>

#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr std::array<std::array<int, 3>, 6> kWays{
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

bool parted(const SkinRays& skin, const Vec3& a, const Vec3& b) {
  const double length = (b - a).norm();
  return length > 0 && skin.first_hit(a, (b - a) / length, length).triangle >= 0;
}

// Marks the cells of a column, along y, whose centres the skin encloses as seen from one end.
void mark_column(const SkinRays& skin, const BodyLattice& lattice, int x, int z, bool upwards,
                 std::vector<char>& inside) {
  const double height = lattice.size[1] * lattice.spacing;
  Vec3 origin = lattice.corner + lattice.spacing * Vec3(x + 0.5, 0, z + 0.5);
  if (!upwards) origin.y() += height;
  const Vec3 direction(0, upwards ? 1 : -1, 0);
  int depth = 0;
  double from = 0;
  while (true) {
    const RayHit hit = skin.first_hit(origin, direction, height, from);
    const double to = hit.triangle < 0 ? height : double(hit.distance);
    if (depth > 0)
      for (int y = int(std::ceil(from / lattice.spacing - 0.5));
           y < lattice.size[1] && (y + 0.5) * lattice.spacing <= to; ++y) {
        const int cell = upwards ? y : lattice.size[1] - 1 - y;
        inside[(std::size_t(x) * lattice.size[1] + cell) * lattice.size[2] + z] = 1;
      }
    if (hit.triangle < 0) return;
    depth += hit.facing < 0 ? 1 : -1;
    from = to + 1e-5;
  }
}

}  // namespace

int BodyLattice::node(const Eigen::Array3i& cell) const {
  if ((cell < 0).any() || (cell >= size).any()) return -1;
  return node_of[(std::size_t(cell[0]) * size[1] + cell[1]) * size[2] + cell[2]];
}

BodyLattice make_body_lattice(const SkinRays& skin, double spacing) {
  BodyLattice out;
  out.spacing = spacing;
  const Points& V = skin.mesh().V;
  out.corner = V.colwise().minCoeff().transpose() - Vec3::Constant(spacing);
  const Vec3 extent = V.colwise().maxCoeff().transpose() - out.corner;
  out.size = (extent.array() / spacing).ceil().cast<int>() + 1;
  std::vector<char> inside(std::size_t(out.size[0]) * out.size[1] * out.size[2], 0);
  tbb::parallel_for(0, out.size[0], [&](int x) {
    for (int z = 0; z < out.size[2]; ++z)
      for (const bool upwards : {true, false}) mark_column(skin, out, x, z, upwards, inside);
  });
  out.node_of.assign(inside.size(), -1);
  std::vector<Eigen::Array3i> cells;
  for (int x = 0; x < out.size[0]; ++x)
    for (int y = 0; y < out.size[1]; ++y)
      for (int z = 0; z < out.size[2]; ++z) {
        const std::size_t i = (std::size_t(x) * out.size[1] + y) * out.size[2] + z;
        if (!inside[i]) continue;
        out.node_of[i] = int(out.points.size());
        out.points.push_back(out.corner + spacing * Vec3(x + 0.5, y + 0.5, z + 0.5));
        cells.emplace_back(x, y, z);
      }
  out.links.resize(out.points.size());
  tbb::parallel_for(std::size_t{0}, out.points.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < kWays.size(); ++k) {
      const int other = out.node(cells[i] + Eigen::Array3i(kWays[k][0], kWays[k][1], kWays[k][2]));
      const bool linked = other >= 0 && !parted(skin, out.points[std::min(int(i), other)],
                                                out.points[std::max(int(i), other)]);
      out.links[i][k] = linked ? other : -1;
    }
  });
  return out;
}

std::vector<LatticeShare> lattice_shares(const BodyLattice& lattice, const SkinRays& skin,
                                         const Vec3& p, int reach) {
  const Vec3 at = (p - lattice.corner) / lattice.spacing - Vec3::Constant(0.5);
  const Eigen::Array3i low = at.array().floor().cast<int>();
  std::vector<LatticeShare> out;
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const Eigen::Array3i corner(c & 1, c >> 1 & 1, c >> 2);
    const int node = lattice.node(low + corner);
    if (node < 0) continue;
    double weight = 1;
    for (int k = 0; k < 3; ++k) {
      const double share = at[k] - low[k];
      weight *= corner[k] ? share : 1 - share;
    }
    if (!(weight > 1e-6) || parted(skin, p, lattice.points[node])) continue;
    out.push_back({node, weight});
    sum += weight;
  }
  if (sum > 0.02) {
    for (LatticeShare& share : out) share.weight /= sum;
    return out;
  }
  out.clear();
  int nearest = -1;
  double least = 1e30;
  const Eigen::Array3i cell = lattice.cell(p);
  for (int r = 1; r <= reach && nearest < 0; ++r)
    for (int x = -r; x <= r; ++x)
      for (int y = -r; y <= r; ++y)
        for (int z = -r; z <= r; ++z) {
          const int node = lattice.node(cell + Eigen::Array3i(x, y, z));
          if (node < 0) continue;
          const double d = (lattice.points[node] - p).squaredNorm();
          if (d < least) least = d, nearest = node;
        }
  if (nearest >= 0) out.push_back({nearest, 1.0});
  return out;
}

}  // namespace ecorche::inline v1
