// An anatomy compiled for posing: made once a character, read every frame.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/wrap_note.h"

namespace ecorche::inline v1 {

struct PosingData;  // posing_data.h

// Copies share the same read-only data.
struct PosingTable {
  std::shared_ptr<const PosingData> data;

  int strips() const;
  int slices() const;
};

// Throws std::invalid_argument if `anatomy` is not valid, a strip has fewer than two or more than
// kMaxStripSlices slices or more than kMaxPathPoints path points. Wraps never move the rest line:
// where it lies inside of one, it may stay as deep.
PosingTable make_posing_table(const Anatomy& anatomy);

// Wraps that the rest line enters, and wraps that it does not come near.
std::vector<WrapNote> wrap_notes(const PosingTable& table);

}  // namespace ecorche::inline v1
