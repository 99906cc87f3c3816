// A crowd: many people in one glTF file. What people of one template have in common is there once:
// triangles, names, skin weights of bones and muscles. A person adds positions, normals, the skin's
// weights, a skeleton and figures, some 3.4 MB instead of a character's 25.
//
// Scene: for each person skinned meshes `NAME/skin`, `NAME/bones`, `NAME/muscles` (or the skin
// alone), and a joint hierarchy under the node `NAME/middle`, a metre over the soles, under the
// node `NAME`, whose `extras` hold the figures; people stand in rows. Positions are 16-bit and
// normals 8-bit whole numbers (KHR_mesh_quantization): a vertex is good to some 0.03 mm. A person's
// bytes depend on the person alone, so a crowd can be made bit by bit and in any order. Reading is
// in skinning/crowd/crowd_read.h.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "skinning/files/character_io.h"

namespace ecorche {

inline constexpr int kCrowdSchema = 2;

// What the people of a crowd share.
struct CrowdMould {
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
CrowdMould make_crowd_mould(const Character& character, CrowdLayers layers = CrowdLayers::all);

// Writes what is a person's own: the file that write_crowd puts together or refers to. `weights`:
// of the skin, as Binding::joint_weights. Throws OutputError, UnfitError for a character that is
// not of the mould's template, std::invalid_argument for weights of another skin.
void write_crowd_person(const std::filesystem::path& file, const CrowdMould& mould,
                        const Character& character,
                        std::span<const std::array<Influence, 4>> weights);

struct CrowdMember {
  std::string name;                                        // unique in the crowd, without /
  std::filesystem::path file;                              // that write_crowd_person wrote
  std::vector<std::pair<std::string, double>> figures;     // into `extras`, in this order
  std::vector<std::pair<std::string, std::string>> notes;  // the same for words
};

// FILE.glb holds everything, up to 4 GiB; FILE.gltf refers to the people's files, which then lie in
// its folder, and to FILE.shared beside it. Throws OutputError, LimitError, InputError for a
// person's file of another mould, UsageError for other endings and folders.
void write_crowd(const std::filesystem::path& file, const CrowdMould& mould,
                 const std::vector<CrowdMember>& members);

}  // namespace ecorche
