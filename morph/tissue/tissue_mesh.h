// The soft tissue of a body as tetrahedra between its bones and its skin.
//
// Either by TetGen (Si 2015, 10.1145/2629697), which keeps the skin's own vertices, or as a lattice
// of cubes cut into six, which needs nothing but matches the skin only to half a cube. TetGen ends
// or hangs on bad input, so that it runs in a program of its own (ecorche-tetgen) with limits on
// time and memory; that program relaxes what of the skin intersects itself first.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// #T x 4, positive volume
using Tetrahedra = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;

// What a node hangs on.
struct TissueAnchor {
  enum class Kind { free, skin, bone };
  Kind kind = Kind::free;
  int bone = -1;                  // of Anatomy::bones
  std::array<int, 3> vertices{};  // of the skin; of the bone only the first counts
  Vec3 weights = Vec3::UnitX();
};

struct TissueMesh {
  Points V;  // #V x 3, m
  Tetrahedra T;
  std::vector<TissueAnchor> anchors;  // #V
  std::vector<char> in_bone;          // #T, by their middles
};

struct TissueOptions {
  double bone_spacing = 0.012;  // m between nodes on bones, about
  // TetGen: largest ratio of a tetrahedron's circumsphere to its shortest edge
  double quality = 1.8;
  double cube = 0.016;  // lattice: m
};

// `closed_skin`: closed, outward; vertices without triangles are left out. Bones inside it; nodes
// on them keep 3 mm from the skin. Throws UnfitError that says what to do when ecorche-tetgen is
// not there, ends badly or meets its limits (60 s, 4 GB).
TissueMesh tetgen_tissue(const TriMesh& closed_skin, const std::vector<Bone>& bones,
                         const TissueOptions& options = {});

// Throws LimitError for more than 2^24 cubes.
TissueMesh lattice_tissue(const TriMesh& closed_skin, const std::vector<Bone>& bones,
                          const TissueOptions& options = {});

// Volumes of tetrahedra, m^3; `moved` as TissueMesh::V, to count what a warp has turned over
// (negative).
std::vector<double> tissue_volumes(const TissueMesh& mesh, const Points& moved);

// Legacy VTK (ASCII): an unstructured grid whose cells have `part` 0 soft, 1 bone, and whose points
// have `anchor` 0 free, 1 skin, 2 bone. Throws OutputError.
void write_tissue_vtk(const std::filesystem::path& file, const TissueMesh& mesh);

}  // namespace ecorche::inline v1
