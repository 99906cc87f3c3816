// How much of the anatomy a body's skin shows by itself.
#pragma once

#include "anatomy/anatomy.h"
#include "anatomy/files/assets.h"

namespace ecorche {

// 0 nothing .. 1 all that the fat lets through, by fat's share of the mass, 0 .. 1: nothing from
// 18 % in men and 25 % in women on, all from 8 and 15 % down, smoothly between. The American
// Council on Exercise counts 18 to 24 and 25 to 31 % as average, 6 to 13 and 14 to 20 % as
// athletes'; men who compete in body building have some 5 to 8 %, women 10 to 15 %.
double definition_of(Sex sex, double fat_share);

// The same by girths and height (fat_percentage in morph/shapes/modify_body.h), which tell muscle
// from fat where mass and height do not. 0 for a skin that is not on the base mesh. Throws
// InputError without the body package.
double definition_of(const Assets& assets, Sex sex, const Points& base_skin);

}  // namespace ecorche
