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

// m, fat and skin that lie over the body's muscles: what is left of the fat without that of the
// organs and marrow (essential fat, 3 % of the mass in men and 8 % in women), 80 % of it under the
// skin, of 920 kg/m^3, spread over the surface of Du Bois and Du Bois (1916), and 1.5 mm of skin.
double layer_of(Sex sex, double fat_share, double mass, double stature);

// The same of a skin on the base mesh by girths and height; 0 for another. `mass`: 0 where unknown,
// as of a scanned skin; then the mass of its volume counts.
double layer_of(const Assets& assets, Sex sex, double mass, const Points& base_skin);

}  // namespace ecorche
