// Whether a character's numbers can be those of a body, so that nothing that is made of it is flung
// to where no body is.
#pragma once

#include <string>

#include "skinning/files/character_io.h"

namespace ecorche {

// Throws InputError "WHERE: reason" for axes that are no right-handed frame, limits that fall or go
// beyond half a turn, a zero outside of them, or a place more than 10 m away.
void check_joint(const Joint& joint, const std::string& where);

// Throws InputError for an age or mass that nobody has, a skin without triangles, vertices or
// landmarks more than 10 m away.
void check_body(const Body& body, const std::string& file);

// Throws InputError "FILE: part: reason" for the first value that no body has: places more than 10
// m from the origin, a strip without length, shares outside 0 .. 1, radii and volumes of a giant;
// LimitError for more muscles or sections than limits.h states. What validate() asks is asked, too.
void check_character(const Character& character, const std::string& file);

}  // namespace ecorche
