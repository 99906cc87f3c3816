// The meshes of one file, as its reader hands them over.
#pragma once

#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct MeshPart {
  // of the glTF node; empty in OBJ and PLY, which give one part in the order of the file's vertices
  std::string name;
  TriMesh mesh;
};

struct MeshFile {
  std::vector<MeshPart> parts;
  std::vector<std::string> notes;  // repairs and what was not read, for people
};

}  // namespace ecorche::inline v1
