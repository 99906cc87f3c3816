#include "skinning/interior/pressure_projection.h"

#include <oneapi/tbb/parallel_for.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <utility>

namespace ecorche::inline v1 {

// Unknowns are numbered for little fill-in, so that solving neither permutes nor allocates.
struct PressureTable::Factor {
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      solver;
};

namespace {

// How freely tissue flows through the skin, 0: not at all, 1: as in open air. More: muscles come
// out of the skin; less: they are pressed into each other where a limb bends.
constexpr double kOpenness = 0.3;
constexpr double kMostGrowth = 0.5, kMostLoss = 0.4;  // of a cell's volume in one round
constexpr double kLeastVolume = 0.2;                  // of a cell that is pressed flat or over

// Falls of pressure along the links of each cell, which drive its growth.
Eigen::SparseMatrix<double> pressure_equations(const BodyLattice& lattice,
                                               std::span<const int> unknown, int unknowns) {
  std::vector<Eigen::Triplet<double>> terms;
  for (int i = 0; i < lattice.nodes(); ++i) {
    const int row = unknown[i];
    if (row < 0) continue;
    double own = 1e-6;  // of tissue that bone encloses
    for (const int other : lattice.links[i]) {
      if (other < 0) {
        own += 2 * kOpenness;  // half a cell away
      } else if (unknown[other] >= 0) {
        own += 1;
        terms.emplace_back(row, unknown[other], -1.0);
      }
    }
    terms.emplace_back(row, row, own);
  }
  Eigen::SparseMatrix<double> out(unknowns, unknowns);
  out.setFromTriplets(terms.begin(), terms.end());
  return out;
}

}  // namespace

double cell_volume(const BodyLattice& lattice, std::span<const Vec3> at, const Mat3& turn, int i) {
  Mat3 stretch;
  for (int axis = 0; axis < 3; ++axis) {
    const int ahead = lattice.links[i][2 * axis], behind = lattice.links[i][2 * axis + 1];
    const int cells = (ahead >= 0) + (behind >= 0);
    if (cells == 0)
      stretch.col(axis) = turn.col(axis);
    else
      stretch.col(axis) =
          (at[ahead >= 0 ? ahead : i] - at[behind >= 0 ? behind : i]) / (cells * lattice.spacing);
  }
  return stretch.determinant();
}

PressureTable make_pressure_table(BodyLattice lattice, std::span<const char> bone,
                                  std::vector<double> kept) {
  PressureTable out;
  out.kept = std::move(kept);
  out.unknown.assign(lattice.nodes(), -1);
  for (int i = 0; i < lattice.nodes(); ++i)
    if (!bone[i]) out.unknown[i] = out.unknowns++;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pressure_equations(lattice, out.unknown, out.unknowns), order);
  order = order.inverse().eval();
  for (int& unknown : out.unknown)
    if (unknown >= 0) unknown = order.indices()[unknown];
  auto factor = std::make_shared<PressureTable::Factor>();
  factor->solver.compute(pressure_equations(lattice, out.unknown, out.unknowns));
  out.factor = std::move(factor);
  out.lattice = std::move(lattice);
  return out;
}

void restore_cell_volumes(const PressureTable& table, std::span<const Mat3> turns, int rounds,
                          std::span<Vec3> positions, PressureWorkspace& workspace) {
  const BodyLattice& lattice = table.lattice;
  const int nodes = lattice.nodes();
  if (table.unknowns == 0) return;
  workspace.source.resize(table.unknowns);
  workspace.pressure.resize(table.unknowns);
  workspace.steps.assign(nodes, Vec3::Zero());
  for (int round = 0; round < rounds; ++round) {
    tbb::parallel_for(0, nodes, [&](int i) {
      if (table.unknown[i] < 0) return;
      const double volume = cell_volume(lattice, positions, turns[i], i);
      workspace.source[table.unknown[i]] =
          table.kept[i] *
          std::clamp(1 / std::max(volume, kLeastVolume) - 1, -kMostLoss, kMostGrowth);
    });
    using Values = Eigen::Map<Eigen::VectorXd>;
    Values(workspace.pressure.data(), table.unknowns) =
        table.factor->solver.solve(Values(workspace.source.data(), table.unknowns));
    // The step in every link is the fall of pressure along it; the equations' pressure is in cells.
    tbb::parallel_for(0, nodes, [&](int i) {
      const int own = table.unknown[i];
      if (own < 0) return;
      Vec3 step = Vec3::Zero();
      for (int k = 0; k < 6; ++k) {
        const int other = lattice.links[i][k];
        double fall = 0;
        if (other < 0)
          fall = 2 * kOpenness * workspace.pressure[own];
        else if (table.unknown[other] >= 0)
          fall = workspace.pressure[own] - workspace.pressure[table.unknown[other]];
        step[k / 2] += (k % 2 == 0 ? 0.5 : -0.5) * fall;
      }
      workspace.steps[i] = lattice.spacing * (turns[i] * step);
    });
    for (int i = 0; i < nodes; ++i) positions[i] += workspace.steps[i];
  }
}

}  // namespace ecorche::inline v1
