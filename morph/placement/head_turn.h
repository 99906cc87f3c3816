// A head that is held aside: people hold it neither straight nor over the middle of their feet,
// while groups of bones of the middle are placed as their own mirror images.
//
// The skin is straightened first, the bones are placed, and then turned with the head. The turn
// fades over the neck.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct HeadTurn {
  double low = 0, high = 0;      // m, heights between which it fades; none where they are equal
  Vec3 centre = Vec3::Zero();    // on the plane of symmetry
  Vec3 rotation = Vec3::Zero();  // rotation vector, rad
  double shift = 0;              // along x, m

  Vec3 operator()(const Vec3& x) const;
};

// How the head of a skin (#skin x 3) lies with respect to the plane x = `plane`: the rigid motion
// that takes its mirror image to itself, halved. `head`: vertices of the head, whose partners
// (`mirror`) are among them; low, high: the neck's ends.
HeadTurn find_head_turn(const Points& skin, const std::vector<int>& mirror,
                        const std::vector<int>& head, double plane, double low, double high);

// The skin whose head is held straight: what the turn takes to `skin`.
Points straightened(const HeadTurn& turn, const Points& skin);

}  // namespace ecorche::inline v1
