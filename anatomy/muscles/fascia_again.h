// Sheets of fascia after a few muscles have changed: most of them are carried as they were.
#pragma once

#include "anatomy/muscles/fascia_surface.h"

namespace ecorche::inline v1 {

// A body's sheets, of which many are shared.
struct FasciaBefore {
  const Anatomy* anatomy = nullptr;
  const FasciaSurface* surface = nullptr;  // null: there are none
};

// The same as make_fascia_surface(anatomy), to the last bit. What lies beside no muscle that has
// changed, or was there before, is taken over where bones and joints are the same.
FasciaSurface make_fascia_again(const Anatomy& anatomy, const FasciaBefore& before);

}  // namespace ecorche::inline v1
