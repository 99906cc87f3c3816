// Private to the writers of characters: the parts that full and light files share.
#pragma once

#include <filesystem>

#include <array>
#include <span>

#include "anatomy/character.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/binding.h"
#include "skinning/files/character_look.h"
#include "skinning/files/glb_builder.h"
#include "skinning/files/gltf_values.h"

namespace ecorche::inline v1::gltf {

// Throws std::invalid_argument where the parts are not of one character, UnfitError for anatomy
// that no reader would take (a body in which it crumpled), LimitError.
void check_parts(const Character& character, const Binding& binding, const Motion* motion,
                 const CharacterLook& look);

// The mesh node `skin`, split along the seams of its texture; returns its index. The caller may add
// attributes to the mesh's one primitive.
int add_skin(GlbBuilder& glb, const TriMesh& skin, std::span<const std::array<Influence, 4>> shares,
             const SkinTexture& texture);

// Names the scene after the body, puts `ecorche` with the schema and the body into its extras, and
// writes the file; with `own`, where there is one, joined to what it came in (own_skin_file.h).
void finish(GlbBuilder& glb, const Body& body, Object ecorche, AtomicFile& out,
            const OwnSkin* own = nullptr);

}  // namespace ecorche::inline v1::gltf
