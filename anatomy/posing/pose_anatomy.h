// Anatomy + pose -> posed slices, every muscle at its rest volume.
//
// A strip's line is a spline through its posed path points (see action_line.h), which keep their
// order where a closing joint would carry one past another, pushed out of its wraps. Slices stay
// where the bones put them; the muscle's substance slides through them: when the line shortens,
// tendons keep their length but for a tenth, the belly takes up the rest, and each slice gets the
// half axes of the substance that lies there now; its outline, the shape that its neighbours give
// it, stays with the slice. Then the belly swells by one factor so that the strip's volume is
// exactly that of the rest pose. Sheets swell in thickness only. Effort adds what a muscle does
// though its joints hold still: the tendon gives, so that the belly is shorter
// (tendon_compliance.h); substance moves from the belly's ends to its middle (the section there
// grows by 13 % at most) and flat sections turn rounder by a third of the way in logarithms at
// most. Both go with the root of the activation: most of the bulge comes with the first third of
// the effort. Frames are rotation-minimising; the insertion's turn about the line, relative to
// rest, is spread along the strip, tendons three times softer than bellies. Everything is a
// function of the pose alone, without history.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche {

// The anatomy flattened for posing: built once a character, read every frame. Copies share the same
// read-only data.
struct PosingTable {
  struct Data;
  std::shared_ptr<const Data> data;

  int strips() const;
  int slices() const;
};

struct SliceRange {
  int muscle = 0, strip = 0;
  int begin = 0, end = 0;  // flat slice indices
};

struct PosedAnatomy {
  std::vector<Transform> X_WJ;  // #joints
  std::vector<Ellipse> slices;  // #all slices: muscles, strips, slices in order
  std::vector<float>
      belly;  // #all slices, 1 where belly lies now, 0 where tendon, smooth between (for colour)
  std::vector<double> lengths;  // #all strips, posed line lengths, m
  // #all strips, factor of the belly's radii (sheets: its square root of the thickness), 1 at rest
  std::vector<double> swelling;
  // #all strips, turn of the insertion about the line against the origin, relative to rest, rad
  std::vector<double> twists;
  // strips whose swelling met its limits 1/3 .. 2.5, so that their tendons swell or shrink, too
  int clamped = 0;
  int overtwisted = 0;  // strips with a twist of more than 100 deg; what is over is taken back
};

constexpr int kMaxStripSlices = 64;
constexpr int kMaxPathPoints = 32;

std::vector<SliceRange> slice_ranges(const Anatomy& anatomy);  // one a strip, in flat order

// Throws std::invalid_argument if `anatomy` is not valid, a strip has fewer than two or more than
// kMaxStripSlices slices or more than kMaxPathPoints path points. Wraps never move the rest line:
// where it lies inside of one, it may stay as deep. With contact, muscles that a pose presses into
// one another part (muscle_contact.h); to know which may meet, the anatomy is posed through its
// joints' ranges: some tenths of a second for a whole body.
enum class MuscleContact { no, yes };
PosingTable make_posing_table(const Anatomy& anatomy, MuscleContact contact = MuscleContact::no);

// What make_posing_table found about wraps, for reports: those that the rest line enters and those
// that it does not come near.
struct WrapNote {
  int muscle = 0, strip = 0, wrap = 0;
  // false: the line passes too far off, through the middle, or only its ends are near
  bool used = true;
  double depth = 0;  // how deep the rest line lies in the object, which stays allowed, m
};
std::vector<WrapNote> wrap_notes(const PosingTable& table);

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

}  // namespace ecorche
