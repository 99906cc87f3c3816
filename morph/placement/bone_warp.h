// How one group of bones is carried from its rest in one body to its place in another.
//
// A bone is not scaled evenly: its ends keep their proportions (joint surfaces stay round and
// congruent) and the shaft takes up the difference in length. Widths may taper along the bone, a
// shaft may bow, and the rib cage may flare: few, smooth ways of being different, so that a bone
// stays a bone.
#pragma once

#include <array>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct BoneMap {
  // The ways in which a map can be corrected. Shift and turn act in the world (metres, radians) and
  // are folded into `target_origin` and `target_frame`; the others are stored in `shape`
  // (logarithms of scales, or metres).
  enum Way {
    shift_x,
    shift_y,
    shift_z,
    turn_x,
    turn_y,
    turn_z,
    log_length,
    log_width_x,
    log_width_z,  // scales along y, x, z of the local frame
    taper_x,
    taper_z,  // change of the log width from the near to the far end
    flare_x,
    flare_z,  // and its second-order change: wide in the middle (-) or at both ends (+)
    bow_x,
    bow_z,    // sideways bend of the middle, m
    shear_z,  // slide along z from the near to the far end, m
    tuck_z,   // the near end's front drawn in, m
    tilt_near,
    tilt_far,  // slope of a joint surface from side to side: ends sheared along y by x
    way_count
  };

  Vec3 origin = Vec3::Zero();     // in the source
  Mat3 frame = Mat3::Identity();  // columns: x, y = long axis from near to far end, z; orthonormal
  double length = 0;              // source distance near to far end, m; the scale of t = y / length
  bool shaft = false;             // the ends keep their proportions
  double depth = 1;               // extent in front that `tuck_z` fades in over, m

  Vec3 target_origin = Vec3::Zero();
  Mat3 target_frame = Mat3::Identity();
  std::array<double, way_count> shape{};  // entries below log_length stay zero

  Vec3 operator()(const Vec3& x) const;

  // Moves along one way by `step` (small for turns: they are applied from the left, in the world,
  // about target_origin).
  void move(Way way, double step);
};

// The map's derivative along `way` at x, by central differences of its closed form.
Vec3 derivative(const BoneMap& map, BoneMap::Way way, const Vec3& x);

}  // namespace ecorche::inline v1
