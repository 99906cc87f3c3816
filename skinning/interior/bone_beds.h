// Sheets glide over the bones that lie below them: the trapezius over the shoulder blade.
//
// The map of the inside brings a sheet that lies on soft carriers to where flesh would be, and a
// bone that turns far may come up through it. So the outer side of such a bone is kept as heights
// over a plane. Where a section comes to lie below it by more than it does at rest, it rises out of
// that plane, and what is about it along the strip and in the strips beside it as a
// membrane: lifts at least what is wanted, each elsewhere the mean of its neighbours.
#pragma once

#include <span>
#include <vector>

#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

// Heights of a bone's outer side on a grid of its plane.
struct BoneBed {
  int joint = 0;
  Vec3 corner = Vec3::Zero();    // of the grid, in `axes`, from the joint at rest, m
  Mat3 axes = Mat3::Identity();  // world at rest: the grid's two directions, outwards
  int columns = 0, rows = 0;
  // #rows x columns, m outwards from the corner; falling beyond the bone
  std::vector<float> heights;
};

// A muscle's strips that glide over a bed, and those of the sheets beside it, side by side. Strips
// that do not end on the bed's bone only follow.
struct BeddedSheet {
  int bed = 0;
  std::vector<SliceRange> strips;
  std::vector<int> begins{0};  // #strips + 1 into the sheet's sections, one after the other
  // of its sections, m, how far they would have to rise at rest; infinity: they only follow
  std::vector<float> rest;
};

struct BoneBeds {
  std::vector<BoneBed> beds;
  std::vector<BeddedSheet> sheets;
};

// Memory of lift_over_bones(). Its content has no meaning between calls.
struct BoneBedWorkspace {
  std::vector<float> wanted, lifts;  // of a sheet's sections
};

// Of muscles with points that glide (PathPoint::placing_joint). `slices`: of all strips at rest.
BoneBeds make_bone_beds(const Anatomy& anatomy, std::span<const Ellipse> slices);

// Raises the sections of sheets in a pose over the bones in it. Their ends stay. The rest pose
// stays as it is.
void lift_over_bones(const BoneBeds& beds, std::span<const Transform> X_WJ,
                     std::span<Ellipse> slices, BoneBedWorkspace& workspace);

}  // namespace ecorche::inline v1
