// Planes through a triangle mesh, and distances to it. The mesh may be open, of several pieces, or
// cross itself.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Triangles of a mesh that a plane cuts, gathered into pieces that hang together or lie closer than
// a gap.
struct Section {
  std::vector<std::array<Vec3, 2>> cuts;    // segments in which the plane meets the piece
  std::vector<std::array<Vec3, 2>> others;  // and all other pieces
  Vec3 nearest = Vec3::Zero();              // the piece's point nearest to the point asked for
};

class MeshSections {
 public:
  // Throws UnfitError for a mesh without triangles of any area.
  explicit MeshSections(const TriMesh& mesh);
  ~MeshSections();

  // The piece of the cut through `point` across `normal` that lies nearest to the point; empty
  // where the plane misses the mesh. Pieces whose gap is smaller than `gap` count as one.
  Section section(const Vec3& point, const Vec3& normal, double gap) const;

  double distance(const Vec3& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Mean and largest distance from evenly spread points of a surface to another surface.
struct SurfaceDistance {
  double mean = 0;
  double max = 0;
};
SurfaceDistance surface_distance(const TriMesh& from, const MeshSections& to);

}  // namespace ecorche::inline v1
