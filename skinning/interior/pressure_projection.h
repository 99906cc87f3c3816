// Cells of a deformed lattice back to their rest volumes, as fluids are kept incompressible:
// pressure projection (Chorin 1968, 10.1090/S0025-5718-1968-0242392-2). Tissue flows from where it
// is pressed to where it is stretched, along bone and not into it, and out to the skin where that
// is nearer.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "skinning/interior/body_lattice.h"

namespace ecorche::inline v1 {

// Constant after it is made.
struct PressureTable {
  struct Factor;
  BodyLattice lattice;
  std::vector<int> unknown;  // #nodes: of the equations, or -1 in bone
  int unknowns = 0;
  std::vector<double> kept;  // #nodes, 0 .. 1: how much of a change of volume is taken back
  std::shared_ptr<const Factor> factor;
};

// Memory of restore_cell_volumes(). Its content has no meaning between calls.
struct PressureWorkspace {
  std::vector<double> source, pressure;
  std::vector<Vec3> steps;
};

// The volume of a cell against rest, from where its neighbours are; `turn`: for ways without any.
double cell_volume(const BodyLattice& lattice, std::span<const Vec3> positions, const Mat3& turn,
                   int node);

// `bone`: #nodes, those that do not move. `kept`: as in the table.
PressureTable make_pressure_table(BodyLattice lattice, std::span<const char> bone,
                                  std::vector<double> kept);

// `positions`, `turns`: #nodes, where the deformation has brought them and how it has turned them.
// Moves them, `rounds` times: each takes back what the first order tells. The same bytes at any
// number of threads.
void restore_cell_volumes(const PressureTable& table, std::span<const Mat3> turns, int rounds,
                          std::span<Vec3> positions, PressureWorkspace& workspace);

}  // namespace ecorche::inline v1
