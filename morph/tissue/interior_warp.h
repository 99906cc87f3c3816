// Smooth maps of the inside of one body into another, by what skin and bones do.
//
//   harmonic   displacements solve Laplace's equation in the soft tissue, exact at its nodes on
//   skin and bones (Anatomy Transfer:
//              Ali-Hamadi et al. 2013, 10.1145/2508363.2508415); linear finite elements on a
//              TissueMesh
//   rbf        |r|^3 and an affine part through samples of skin and bones: no mesh, twice
//   differentiable
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "morph/tissue/tissue_mesh.h"

namespace ecorche::inline v1 {

// What carries the flesh between bones and skin when a template is fitted into a body:
//   bones    the bones that it rides on, and nothing else
//   tetgen   a harmonic warp in tetrahedra that keep the skin's vertices
//   lattice  the same in a lattice of cubes
//   rbf      radial functions through samples of skin and bones
enum class Interior { bones, tetgen, lattice, rbf };

// Two bodies in correspondence: skins with the same vertices, bones with the same meshes in the
// same order.
struct BodyPair {
  const Points* skin_before = nullptr;
  const Points* skin_after = nullptr;
  const std::vector<Bone>* bones_before = nullptr;
  const std::vector<Bone>* bones_after = nullptr;
};

using InteriorMap = std::function<Vec3(const Vec3&)>;

// The system of a mesh, factored: it depends on the template alone, so that many bodies share it.
// Copies share their data.
class HarmonicSolver {
 public:
  // Throws UnfitError when the mesh has no anchors or its system cannot be factored. The mesh is
  // copied.
  explicit HarmonicSolver(TissueMesh mesh);
  const TissueMesh& mesh() const;
  // Where the nodes go, #V x 3. Throws std::invalid_argument when the pair does not have the
  // anchors' vertices.
  Points move_nodes(const BodyPair& pair) const;
  // The map that takes the mesh's nodes to `nodes`. Points outside the mesh go with the nearest
  // tetrahedron. Keeps its own data.
  InteriorMap map_to(Points nodes) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

struct RbfOptions {
  int skin_points = 900, bone_points = 700;
};
// Throws UnfitError when the samples do not determine it.
InteriorMap rbf_map(const BodyPair& pair, const RbfOptions& options = {});

}  // namespace ecorche::inline v1
