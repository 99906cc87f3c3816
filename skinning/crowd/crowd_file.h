// A crowd: many people in one glTF file. What people of one template have in common is there once:
// triangles, names, skin weights of bones and muscles. A person adds positions, normals, the skin's
// weights, a skeleton and figures, some 3.4 MB instead of a character's 25.
//
// Scene: for each person skinned meshes `NAME/skin`, `NAME/bones`, `NAME/muscles` (or the skin
// alone), and a joint hierarchy under the node `NAME/middle`, a metre over the soles, under the
// node `NAME`, whose `extras` hold the figures; people stand in rows. Positions are 16-bit and
// normals 8-bit whole numbers (KHR_mesh_quantization): a vertex is good to some 0.03 mm. A person's
// bytes depend on the person alone, so a crowd can be made in parts and in any order. Reading is in
// crowd_read.h.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "skinning/crowd/crowd_prototype.h"

namespace ecorche::inline v1 {

struct CrowdMember {
  std::string name;                                        // unique in the crowd, without /
  std::filesystem::path file;                              // that write_crowd_person wrote
  std::vector<std::pair<std::string, double>> figures;     // into `extras`, in this order
  std::vector<std::pair<std::string, std::string>> notes;  // the same for words
};

// FILE.glb holds everything, up to 4 GiB; FILE.gltf refers to the people's files, which then lie in
// its folder, and to FILE.shared beside it. Throws OutputError, LimitError, InputError for a
// person's file of another prototype, UsageError for other endings and folders.
void write_crowd(const std::filesystem::path& file, const CrowdPrototype& prototype,
                 const std::vector<CrowdMember>& members);

}  // namespace ecorche::inline v1
