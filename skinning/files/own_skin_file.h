// Private to the writer and the reader of characters: those with a skin of their own
// (character_format.h).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "anatomy/character.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "skinning/binding.h"
#include "skinning/files/glb_builder.h"
#include "skinning/files/gltf_values.h"

namespace ecorche::inline v1::gltf {

// Adds what the character's own skin needs to a file that holds its joints, bones and muscles, and
// puts the joints into the pose in which the source stands. Returns the object `own` of the scene's
// extras. Call it before motions are added. Throws as read_source_rig, std::invalid_argument for a
// skin of another source.
tinygltf::Value add_own_skin(GlbBuilder& glb, const Character& character, const Binding& binding);

// The file that `ours` and the source make together: the source's parts first, with their indices
// and bytes, then ours; its pieces move by our joints. Throws InputError, LimitError.
std::string join_own_skin(const std::string& ours, const OwnSkin& own);

// The own skin of a file, by the object `own`; fills body.skin too. Throws InputError that names
// the file.
OwnSkin read_own_skin(const GltfFile& file, std::string_view bytes, const GltfFile::Json& own,
                      std::size_t joints, Body& body);

// The base mesh of such a file alone.
TriMesh read_own_base(const GltfFile& file, const GltfFile::Json& own);

}  // namespace ecorche::inline v1::gltf
