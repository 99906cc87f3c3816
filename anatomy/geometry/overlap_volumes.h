// Which solids share space: volumes of closed meshes and of what they have in common, and what lies
// inside what.
//
// The solids are seen along parallel lines in +z on a square grid. Along a line each solid is where
// its winding number is not zero, so that tubes that cross themselves count once; volumes are sums
// of lengths times the cell's area. Every triangle is met exactly once by a line through it: edges
// and corners belong to one side by a half-open rule, so that closed meshes have no leaks.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Solid {
  enum class Kind { skin, bone, muscle };
  Kind kind = Kind::muscle;
  const Points* V = nullptr;
  const Triangles* F = nullptr;
  int face_begin = 0, face_end = 0;  // its triangles, outward
};

struct SharedVolume {
  int a = 0, b = 0;   // solids, a < b
  double volume = 0;  // m^3
};

struct SolidVolumes {
  std::vector<double> volume;  // #solids, m^3
  std::vector<double>
      in_muscle;  // #solids, of a muscle: what lies in other muscles too; of a bone: 0
  std::vector<double> in_bone;  // #solids, of a muscle: what lies in bones
  std::vector<double>
      outside;  // #solids, of muscles and bones: what lies outside every skin; 0 without skin
  double muscles = 0;               // union of all muscles, m^3
  double muscle_excess = 0;         // sum of the muscles' volumes less their union
  double muscle_bone = 0;           // what is muscle and bone at once
  std::vector<SharedVolume> pairs;  // muscles with muscles and with bones, largest first
  // where a line enters a solid more or less often than it leaves it: not counted there
  long long open_columns = 0;

  double muscle_overlap_share() const {
    return muscles + muscle_excess > 0 ? muscle_excess / (muscles + muscle_excess) : 0;
  }
  double bone_overlap_share() const {
    return muscles > 0 ? muscle_bone / (muscles + muscle_excess) : 0;
  }
};

// Lines every `spacing` metres in x and y. Throws std::invalid_argument for a spacing not above 0,
// faces out of range or coordinates that are not finite; LimitError where the grid would have more
// than 2^26 cells.
SolidVolumes measure_solids(std::span<const Solid> solids, double spacing);

// Winding numbers of points about a mesh: 0 outside, 1 inside, more where it overlaps itself.
// #points
std::vector<int> winding_numbers(const TriMesh& mesh, const Points& points);

}  // namespace ecorche::inline v1
