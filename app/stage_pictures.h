// Still pictures of an anatomy for the report page.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/actor.h"
#include "viewer/renderer.h"
#include "viewer/scene.h"

namespace ecorche {

// Views side by side ("front", "left", "back", ...), each `width` x `height`, of the rest pose. Nothing is cut off.
Image picture_at_rest(Renderer& renderer, const Anatomy& anatomy, const TriMesh& skin, const Look& look, std::span<const std::string> views,
                      int width, int height);

// Moments of a motion side by side, as seen by a camera that looks at the figure from its right (-X): skin above, écorché below.
Image picture_of_moments(Renderer& renderer, const Actor& actor, const Motion& motion, std::span<const double> seconds, int width, int height);

}  // namespace ecorche
