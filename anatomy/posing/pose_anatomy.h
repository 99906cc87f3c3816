// Anatomy + pose -> posed slices, every muscle at its rest volume.
//
// Line: a spline through the posed path points of a strip (action_line.h), which keep their order
// where a closing joint would carry one past another, pushed out of its wraps (wrapping.h). Frames
// are rotation-minimising; the insertion's rotation about the line, relative to rest, is spread
// along the strip, three times as much a metre along tendons as along bellies.
//
// Sections: slices stay where the bones put them, and the muscle's substance slides through them.
// When the line shortens, tendons take a tenth of the strain and the belly the rest, and each slice
// gets the half axes of the substance that lies there now. Its outline, formed by its neighbours,
// stays with the slice.
//
// Activation: the belly stretches its tendon and shortens (tendon_compliance.h); volume moves from
// its ends to its middle, whose section grows by 13 % at most; flat sections turn rounder by up to
// a third of the way in logarithms. Both go with the root of the activation: most of the bulge
// comes with the first third of the activation.
//
// Volume: the belly is scaled by one factor, sheets in thickness only, to exactly the strip's rest
// volume (restore_volume.h).
//
// Everything is a function of the pose alone, without history. Contact between muscles is a later
// stage (contact/muscle_contact.h).
#pragma once

#include <span>

#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/posing_table.h"

namespace ecorche::inline v1 {

// `out` is resized once and then reused: no allocation from the second call on. The same bytes at
// any number of threads; threads > 1 are used only where they pay. Precondition: `skeleton` has the
// joints of the table's anatomy. `activation`: one value a muscle, 0 relaxed .. 1 (what is outside
// counts as the end it has passed, what is no number as 0); empty: all relaxed. Throws
// std::invalid_argument for another number of values.
void pose_anatomy(const PosingTable& table, const Skeleton& skeleton, const Pose& pose,
                  PosedAnatomy& out, int threads = 1, std::span<const double> activation = {});

// Volume of one posed strip or muscle by tube_volume, m^3.
double strip_volume(const PosedAnatomy& posed, const SliceRange& range);
double muscle_volume(const PosedAnatomy& posed, std::span<const SliceRange> ranges, int muscle);

}  // namespace ecorche::inline v1
