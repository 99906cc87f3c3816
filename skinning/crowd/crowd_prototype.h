// What the people of a crowd share: triangles, names, skin weights of bones and muscles.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "anatomy/character.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// Number of the format of crowds.
inline constexpr int kCrowdSchema = 2;

struct CrowdPrototype {
  struct Part {
    std::string name;
    int vertex_begin = 0, vertex_end = 0;
  };
  struct Layer {
    std::string name;  // skin, bones, muscles
    Triangles F;
    std::size_t vertices = 0;
    std::vector<std::array<Influence, 4>>
        influences;           // #vertices; empty for the skin, which has each person's own
    std::vector<Part> parts;  // one a bone or muscle
  };
  Skeleton skeleton;  // names, parents
  std::vector<Layer> layers;
};

enum class CrowdLayers { skin_alone, all };

// Of the template in its own body. Throws LimitError for more than 256 joints.
CrowdPrototype make_crowd_prototype(const Character& character,
                                    CrowdLayers layers = CrowdLayers::all);

// One mesh for each layer: skin, bones, muscles; or the skin alone.
std::vector<TriMesh> crowd_meshes(const Character& character, CrowdLayers layers);

}  // namespace ecorche::inline v1
