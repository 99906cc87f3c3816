// Points of bones that can be felt under the skin, and how deep people have them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "morph/fit/fit_anatomy.h"

namespace ecorche {

// Those that leave their bracket (is_off), the furthest first.
std::vector<LandmarkDepth> points_off(std::span<const LandmarkDepth> points);

// "greater trochanter: 41 mm under the skin, people have 12 to 27".
std::string point_text(const LandmarkDepth& point);

}  // namespace ecorche
