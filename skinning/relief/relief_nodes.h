// Points of a skin, evenly spread, that hold what varies slowly over it. Private to the library.
//
// Each vertex belongs to the node that is nearest along edges; a node's value is the mean over its
// vertices by their areas, a vertex's a Gaussian mean over its node and the nodes next to it.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/relief/skin_smoothing.h"

namespace ecorche::inline v1 {

constexpr double kNodeSpacing = 0.009;  // m, at most; kNodeEdges edges where those are shorter
constexpr double kNodeEdges = 2.2;
// m, standard deviations by which a value is smoothed on its way to the nodes and back.
constexpr double kToNodes = 0.0023, kFromNodes = 0.0055;

struct ReliefNodes {
  std::vector<int> vertex;   // #nodes, of the skin
  SurfaceGraph graph;        // of the nodes
  std::vector<char> wanted;  // #nodes
  SkinSmoothing to, from;
};

// Vertices for which `wanted` is 0 (#V) take part in nodes of their own; their values are 0.
ReliefNodes make_relief_nodes(const SurfaceGraph& skin, std::span<const char> wanted);

}  // namespace ecorche::inline v1
