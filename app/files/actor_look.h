// What an actor's pictures have beyond the shapes of skin and anatomy.
#pragma once

#include <vector>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/files/assets.h"
#include "app/files/actor.h"

namespace ecorche {

// As find_eyes(), for refined skins, too: by the base mesh at rest.
std::vector<Eyeball> actor_eyes(const Assets& assets, const Actor& actor);

// Colours of the skin's vertices, sRGB: `color`, a little blue and dark over veins that show. Empty
// where no vein does.
std::vector<Eigen::Vector3f> vein_colors(const Actor& actor, const Eigen::Vector3f& color);

}  // namespace ecorche
