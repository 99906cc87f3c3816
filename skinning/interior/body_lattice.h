// Cells of a body's inside: nodes at the centres of cubes within the skin, linked to neighbours
// that the skin does not part them from. Thighs that touch are as far apart as their way through
// the hips.
#pragma once

#include <array>
#include <vector>

#include "anatomy/queries/ray_caster.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct BodyLattice {
  Vec3 corner = Vec3::Zero();  // of the first cell
  double spacing = 0;          // m
  Eigen::Array3i size = Eigen::Array3i::Zero();
  std::vector<int> node_of;               // #cells, or -1
  std::vector<std::array<int, 6>> links;  // #nodes, neighbours or -1
  std::vector<Vec3> points;               // #nodes

  int nodes() const { return int(points.size()); }
  Eigen::Array3i cell(const Vec3& p) const {
    return ((p - corner).array() / spacing).floor().cast<int>();
  }
  // The node of a cell, or -1.
  int node(const Eigen::Array3i& cell) const;
};

// A node and its share in a place.
struct LatticeShare {
  int node = 0;
  double weight = 0;
};

// `skin`: a skin that is closed but for small openings.
BodyLattice make_body_lattice(const SkinRays& skin, double spacing);

// Trilinear shares of the nodes about `p` that the skin does not part from it; of a point outside,
// the nearest node. Empty: there is none within `reach` cells.
std::vector<LatticeShare> lattice_shares(const BodyLattice& lattice, const SkinRays& skin,
                                         const Vec3& p, int reach = 8);

}  // namespace ecorche::inline v1
