// The fat of a layer made thicker or thinner, in all and around sites of the body.
#pragma once

#include <map>
#include <string>

#include "anatomy/types.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

// Times the fat that is there, by site of data/fat.csv without side: both sides.
using SiteFactors = std::map<std::string, double>;

// The skin keeps its thickness. A site's factor holds at the site and fades within some 15 cm along
// the surface, less where it faces another way, so that a belly does not thicken the back; where
// sites meet their factors are averaged. `skin`: that the layer was made for.
void scale_fat(double all, const SiteFactors& sites, const TriMesh& skin, FatLayer& layer);

}  // namespace ecorche::inline v1
