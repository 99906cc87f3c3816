// What shows through a body's skin at rest, as maps on its texture.
#pragma once

#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "app/report.h"
#include "skinning/bake/skin_maps.h"

namespace ecorche {

// `size`: texels a side. Throws UnfitError for a skin that is not the body package's, and a
// definition of 0.
SkinMaps relief_maps(const Assets& assets, Character character, double definition, int size,
                     Report& report);

}  // namespace ecorche
