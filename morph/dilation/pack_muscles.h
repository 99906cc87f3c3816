// Neighbours among themselves: outlines of all sections, so that muscles touch where they meet, and
// fill what is left between them.
//
// From the centre of every section a ray goes out in each direction of its outline through the
// drawn muscles and bones. Where it meets another muscle before its own surface ends, the two are
// parted where their levels are equal (0 on the line of centres, 1 on the surface), which both see
// alike; before bone the section ends. Where there is room between it and its neighbour, the bone
// or the layer of fat, it grows: to the middle, or by more where it has less than its wanted volume
// and the neighbour has not. A few rounds, smoothed along and round the strip. Then the layer is
// looked at from its own side: where no muscle comes up to it, the one that lies next under it does
// (fill_gaps.h), points of outlines by up to a quarter of the layer into it, as facets lie lower
// than their corners. Several may come up into the same gap: after every two such rounds one
// follows in which all only give way, and what that leaves open the next ones fill. The last rounds
// only give way. Where they do, what is drawn between sections is looked at, too, and those on
// either side give way for it. Sections keep their ellipses: what is found are the outlines'
// factors.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fat/fat_layer.h"

namespace ecorche {

struct SharingLimits {
  int parting = 1, growing = 4, covering = 4,
      settling = 2;      // rounds; a covering one is two that come up and one that gives way
  double reach = 0.035;  // m: how far beyond its surface a section looks for room
  double settled_reach = 0.003;  // in the last rounds
  double gap = 0.35e-3;          // m, that a muscle keeps from its neighbour's half of the way
  double bone_gap = 0.4e-3;      // m
  double skin_gap = 0.5e-3;      // m, where the layer cannot be kept
  double most = 4;               // factors
  double least = 0.15;
};

struct SharingReport {
  long long rays = 0;
};

// `slices`: the sections of all muscles in order, as the strips hold them; both get their outlines.
// `wanted`: #muscles, volumes, m^3. `partners`: #muscles, for a muscle that is its partner's mirror
// image the partner's index, else -1. `rays`, `fat`: of the skin, closed. The same bytes at any
// number of threads.
SharingReport share_room(Anatomy& anatomy, std::span<Ellipse> slices,
                         std::span<const double> wanted, std::span<const int> partners,
                         const SkinRays& rays, const FatLayer& fat,
                         const SharingLimits& limits = {});

}  // namespace ecorche
