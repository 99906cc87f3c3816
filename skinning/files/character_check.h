// Plausibility checks of characters read from files, so that no vertex is moved out of a body's
// range.
#pragma once

#include <string>

#include "anatomy/character.h"

namespace ecorche::inline v1 {

// Throws InputError "WHERE: reason" for axes that are no right-handed frame, limits that fall or go
// beyond half a turn, a zero outside of them, or a position more than 10 m away.
void check_joint(const Joint& joint, const std::string& where);

// Throws InputError for an age or mass that nobody has, a skin without triangles, vertices or
// landmarks more than 10 m away.
void check_body(const Body& body, const std::string& file);

// Throws InputError "FILE: part: reason" for the first implausible value: positions more than 10
// m from the origin, a strip without length, fractions outside 0 .. 1, radii and volumes of a
// giant; LimitError for more muscles or sections than limits.h states. Includes validate().
void check_character(const Character& character, const std::string& file);

}  // namespace ecorche::inline v1
