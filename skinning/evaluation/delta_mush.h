// Delta mush: any cheap deformation, smoothed, with the detail that smoothing took from the rest
// shape put back in local frames (Mancewicz, Derksen, Rijpkema & Wilson
// 2014, 10.1145/2633374.2633376). A baseline.
#pragma once

#include <array>
#include <vector>

#include "anatomy/types.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct MushOptions {
  int iterations = 10;  // the usual settings of the programs that offer it
  float step = 0.5f;    // share of the way to the mean of the neighbours, an iteration
};

struct MushTables {
  MushOptions options;
  std::vector<int> triangles;         // 3 #F
  std::vector<int> start, neighbour;  // #V + 1; neighbours of vertex i are start[i] .. start[i + 1]
  std::vector<float>
      tangent_weight;  // a neighbour: a fixed mix of the edges that gives the tangent
  std::vector<std::array<float, 3>>
      detail;  // #V, tangent, bitangent, normal: what smoothing took away
};

// Working memory of deform_mush(); its content means nothing between frames.
struct MushWorkspace {
  std::vector<float> smooth, next, normals;
};

// `rest`: four floats a vertex, as deform_mush() will be given them in the rest pose, so that they
// come back exactly.
MushTables make_mush(const TriMesh& mesh, const std::vector<float>& rest,
                     const MushOptions& options = {});

// `skin` holds a deformed skin (linear blend as a rule) and gets the mushed one, with normals.
// Precondition: #V x 4 positions.
void deform_mush(const MushTables& tables, MushWorkspace& workspace, SkinFrame& skin);

}  // namespace ecorche::inline v1
