// Harmonic weights in a body's lattice: each node's shares in sources (joints' bones, patches of
// skin), 1 where the source is, between them the mean of the neighbours'. Few shares a node: the
// largest.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "skinning/interior/body_lattice.h"

namespace ecorche::inline v1 {

struct SourceWeights {
  static constexpr int kMost = 12;
  std::array<short, kMost> source{};
  std::array<float, kMost> weight{};
  int count = 0;
};

// `fixed`: #nodes, weights of the nodes that sources hold, none elsewhere. Nodes that no source
// reaches have none. `start`: of a coarser lattice, a first guess, or empty.
std::vector<SourceWeights> harmonic_weights(const BodyLattice& lattice,
                                            std::span<const SourceWeights> fixed, int sources,
                                            std::span<const SourceWeights> start, int rounds);

// The largest of any number of weights, scaled so that they add up to 1.
SourceWeights largest_weights(std::span<const std::pair<int, double>> weights);

// Mean of the shares' weights.
SourceWeights mix_weights(std::span<const LatticeShare> shares,
                          std::span<const SourceWeights> weights);

}  // namespace ecorche::inline v1
