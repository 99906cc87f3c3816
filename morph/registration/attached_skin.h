// A stranger's mesh hung on the base mesh that was registered with it, and brought to its rest
// pose.
//
// The mesh may have any topology and any number of pieces; what lies off the body (clothes, hair)
// follows the base mesh by a mean over what is nearest, wider with the distance, so that it does
// not tear where the nearest place jumps.
#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/types.h"
#include "morph/registration/registration.h"

namespace ecorche::inline v1 {

// In the world of Registration::posed.
struct StandingMesh {
  TriMesh mesh;
  // #V: number of the piece that moves as one (eyes, teeth, what is held), -1: it bends with the
  // body. Empty: all of it does.
  std::vector<int> rigid;
  // #V: the part that the vertex is of, where the mesh's own rig tells it. It then hangs on that
  // part or those that join it, however near others are: hands that are held together stay two.
  // Empty: nothing is told.
  std::vector<std::optional<VertexPart>> parts{};
};

struct AttachedSkin {
  // #V x #skin: vertices by base vertices; rows are positive and sum to 1; those of a rigid piece
  // are equal.
  Eigen::SparseMatrix<double, Eigen::RowMajor> map;
  Points rest;                   // #V x 3, in the base mesh's rest pose
  std::vector<double> distance;  // #V m, from the registered surface as the mesh stands
};

// `parts`: of the base mesh's vertices (body_rig.h), so that a place on an arm is not taken for one
// of the trunk beside it. Where most vertices whose part is told lie at the base mesh's other side,
// the mesh's sides are not ours, and what it tells is left aside. Throws UnfitError for a mesh
// without vertices, or of which more than half lies further than a metre from the body.
// Precondition: finite coordinates, triangles in range.
AttachedSkin attach_skin(const Registration& registration, const Triangles& base_triangles,
                         const std::vector<VertexPart>& parts, const StandingMesh& mesh);

// Vertices at rest moved to where the registered body stands, by the map that attach_skin went back
// by: of AttachedSkin::rest, the mesh as it came, to rounding.
Points stand_again(const Registration& registration,
                   const Eigen::SparseMatrix<double, Eigen::RowMajor>& map, const Points& rest);

}  // namespace ecorche::inline v1
