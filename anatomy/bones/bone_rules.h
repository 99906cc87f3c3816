// The rules of data/bones.csv that single out a bone among the components of a mesh.
#pragma once

#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// The components that the rule leaves, joined into one mesh. Grammar: head of data/bones.csv.
// Components are in metres, in the frame of their file. Throws InputError "where: ..." for a rule
// that cannot be read or that leaves nothing.
TriMesh select_bone(const std::vector<TriMesh>& components, const std::string& rule,
                    const std::string& where);

}  // namespace ecorche::inline v1
