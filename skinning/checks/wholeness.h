// Whether muscles stay whole in a pose: what an eye would call a crease, a needle, a hole, a kink.
//
// All figures compare the drawn surface with itself at rest, where they are nought (stretch: 1):
// - creased: share of the edges' length where the surface turns by 45 degrees more than at rest;
// - needles: vertices that stand off the mean of their neighbours by 10 mm more than at rest;
// - daylight: area that at rest lay in a muscle or bone or had one within 5 mm along its normal,
//   and now has nothing within 10 mm;
// - buried: area over which at rest nothing lay within 20 mm, and which now lies in another muscle
//   or bone, as where a superficial muscle sinks into one below it;
// - stretch: the 99th percentile of the edges' lengths over those at rest;
// - kink: the most that a tendon turns in a centimetre beyond its turn at rest;
// - end off: how far an end on a bone lies from where that bone brings it.
#pragma once

#include <span>
#include <vector>

#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/surface_edges.h"
#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

// Of one muscle in one pose.
struct MuscleWholeness {
  double edge_length = 0, creased_length = 0;  // m
  int needles = 0;
  double daylight = 0, buried = 0;  // m^2
  double stretch = 1;
  double kink = 0;     // rad/m
  double end_off = 0;  // m
};

// The end of a strip on the bones of one joint.
struct StripEnd {
  int muscle = 0, slice = 0, joint = 0;
  Vec3 center = Vec3::Zero();  // of the slice, in the joint's frame
};

// Muscles at rest, as measure_wholeness() compares poses with them.
struct RestSurface {
  std::vector<SurfaceEdge> edges;    // ascending by muscle
  std::vector<double> standing_off;  // #V, m
  std::vector<double> cover;         // #V, m to what lay over it; 0 within it, infinite: nothing
  std::vector<double> tendon_turns;  // #slices, rad/m; below 0: not in a tendon
  std::vector<StripEnd> ends;
};

// `surface`: of the anatomy. `ranges`: the strips of `rest`. `flesh`: the muscles' vertices and
// faces first, as in `surface`, then bones.
RestSurface make_rest_surface(const Anatomy& anatomy, const MuscleSurface& surface,
                              std::span<const SliceRange> ranges, const PosedAnatomy& rest,
                              const TriMesh& flesh);

// One a muscle.
std::vector<MuscleWholeness> measure_wholeness(const RestSurface& rest,
                                               const MuscleSurface& surface,
                                               std::span<const SliceRange> ranges,
                                               const PosedAnatomy& posed, const TriMesh& flesh);

}  // namespace ecorche::inline v1
