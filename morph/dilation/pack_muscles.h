// Packing of neighbouring muscles: outlines of all sections are set so that muscles touch where
// they meet, and fill the gaps between them.
//
// From the centre of every section a ray goes out in each direction of its outline through the
// drawn muscles and bones. Where it meets another muscle before its own surface ends, the two are
// separated where their levels are equal (0 on the line of centres, 1 on the surface), which is the
// same place for both; before bone the section ends. Where there is room between it and its
// neighbour, the bone or the layer of fat, it grows: to the middle, or further where it has less
// than its target volume and the neighbour has not. A few rounds, smoothed along and round the
// strip.
//
// Then gaps under the layer of fat are filled (fill_gaps.h): the muscle next under a gap grows into
// it, points of outlines by up to a quarter of the layer's thickness into the layer, since facets
// lie lower than their corners. Several muscles may grow into one gap: after every two such rounds
// one follows that only separates, and the next ones fill what it leaves open. The last rounds only
// separate; they also test what is drawn between sections, and press the sections on either side.
// Sections keep their ellipses: the results are the outlines' factors.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/dilation/dilation_record.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

struct PackingLimits {
  // Rounds that separate, grow, fill gaps (two that grow and one that separates), and separate at
  // the end. More: fewer gaps and overlaps, more time.
  int parting = 1, growing = 4, covering = 4, settling = 2;
  double reach = 0.035;          // m: how far beyond its surface a section looks for room
  double settled_reach = 0.003;  // in the last rounds
  double gap = 0.35e-3;          // m, that a muscle keeps from its neighbour's half of the way
  double bone_gap = 0.4e-3;      // m
  double skin_gap = 0.5e-3;      // m, where the layer cannot be kept
  double most = 4;               // factors
  double least = 0.15;
};

struct PackingReport {
  long long rays = 0;
};

// `slices`: the sections of all muscles in order, as the strips hold them; both get their outlines.
// `wanted`: #muscles, volumes, m^3. `partners`: #muscles, for a muscle that is its partner's mirror
// image the partner's index, else -1. `rays`, `fat`: of the skin, closed. The same bytes at any
// number of threads. Of `trace`, rounds are written and read.
PackingReport pack_muscles(Anatomy& anatomy, std::span<Ellipse> slices,
                           std::span<const double> wanted, std::span<const int> partners,
                           const SkinRays& rays, const FatLayer& fat,
                           const PackingLimits& limits = {}, const DilationTrace& trace = {});

}  // namespace ecorche::inline v1
