// The last step of placing bones: what no group's map can do is done by a few smooth local pushes
// of its surface, so that no vertex is left outside the skin and palpable points lie as deep as
// tissue there is thick.
//
// A push moves the points about a place by a vector that fades as exp(-d^2 / radius^2). Its slope
// stays below one third, so that pushes one after the other never fold a bone.
#pragma once

#include <vector>

#include "anatomy/queries/signed_distance.h"
#include "morph/placement/bone_groups.h"

namespace ecorche::inline v1 {

struct LocalPush {
  Vec3 centre = Vec3::Zero();  // world, before the push
  Vec3 move = Vec3::Zero();    // m, at the centre
  double radius = 0;           // m
  bool twin = false;           // with its mirror image about the plane of symmetry
};

// Pushes of one group, in order. `plane`: x of the plane of symmetry.
Vec3 pushed(const std::vector<LocalPush>& pushes, double plane, const Vec3& x);

// A palpable point of a placed group and the tissue over it.
struct PalpablePoint {
  int part = 0;  // of the `parts` below
  Vec3 x = Vec3::Zero();
  double low = 0, high = 0;  // m below the skin
};

// The placed bones of one group on one side, or of a group of the middle on both.
struct SettledPart {
  std::vector<Points> bones;
  bool even = false;              // a group of the middle in an even skin
  std::vector<LocalPush> pushes;  // out
  int outside = 0;                // out: vertices that are left outside the skin
  double furthest = -1e300;       // out: largest signed distance, m
};

// Finds the pushes of all parts and moves their bones. Points whose depth is off by more than some
// centimetre are left alone: no skeleton is like that. Deterministic at any thread count.
void settle_bones(const SkinField& skin, double plane, const std::vector<PalpablePoint>& points,
                  std::vector<SettledPart>& parts);

// Pushes `below`, a cage about the vertical through its middle, inwards where bones over it come
// nearer than `clearance` (m) or through it: ribs below a shoulder blade that thin flesh presses on
// them. `plane`: x of the plane of symmetry.
void keep_below(const TriMesh& above, double plane, double clearance, SettledPart& below);

}  // namespace ecorche::inline v1
