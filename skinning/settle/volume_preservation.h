// Keeps the volume of arms and legs, of the flesh about elbows and knees, of the shoulders, and of
// the trunk: what a bend or the sheet's tension takes away comes back as a swelling of the flesh.
// Private to the room. The swelling is along the normals and in proportion to what lies between
// skin and bone, less where the skin bends sharply (swelling_limits.h), one step a region, which
// the smallness of the change allows; folds are left out.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/bind/bind.h"
#include "skinning/settle/membrane.h"

namespace ecorche {

struct VolumeRegion {
  int within = -1;     // region that it is a part of
  bool hinge = false;  // the flesh about an elbow or a knee
  // joint: apex of the cones over the triangles, so that a cut near it needs no lid
  int origin = 0;
  std::vector<int> corners;  // 3 a triangle
  std::vector<float> share;  // a triangle: how much of it is the region's
  std::vector<std::vector<std::array<int, 2>>>
      rims;           // edges of cuts that are closed by fans about their middles
  double volume = 0;  // rest, m^3
  std::vector<int> vertices;
  std::vector<float> swelling, area;  // a vertex: m a unit; m^2 at rest
};

struct LimbVolumes {
  std::vector<VolumeRegion>
      // the whole body first, to which the trunk swells; then arms and legs, each followed by its
      // hinge; then the shoulders with their girdles
          regions;
};

// `positions`: #V x 4, rest. `tissue`: m, #V.
LimbVolumes make_limb_volumes(const Skeleton& skeleton, std::span<const float> positions,
                              std::span<const int> triangles,
                              std::span<const std::array<Influence, 4>> joint_weights,
                              std::span<const double> tissue);

// 1 where flesh is free to swell, falling to 0 in folds, where it would only press into itself. #V;
// `working` is memory of the same size.
void find_hollows(const Membrane& rings, std::span<const float> positions,
                  std::span<const float> normals, std::vector<float>& open,
                  std::vector<float>& working);

// Whether the flesh about elbows and knees keeps a volume of its own, or only its limb does.
enum class Hinges { free, kept };

// Moves `positions` (#V x 4) along `normals`, by how far each vertex is open. Allocates nothing.
void keep_volumes(const LimbVolumes& volumes, std::span<const Transform> X_WJ,
                  std::span<const float> open, std::span<const float> normals,
                  std::span<float> positions, Hinges hinges = Hinges::kept);

}  // namespace ecorche
