// A mesh of one's own, of a bone or a muscle, in metres and upright.
#pragma once

#include <string>

#include "anatomy/types.h"
#include "app/edit/document/arguments.h"

namespace ecorche {

// unit: m, cm, mm or in; up: y or z; empty: as the file says, else m and y. Its triangles face
// outwards. Throws InputError as read_mesh_file, and for what is too fine, or as small or large as
// no bone is.
TriMesh read_own_mesh(const std::string& file, const std::string& unit, const std::string& up);

// The arguments that say so.
void unit_and_up(Arguments& a, std::string& unit, std::string& up);

}  // namespace ecorche
