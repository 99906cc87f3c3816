// Writes one person of a crowd.
#pragma once

#include <array>
#include <filesystem>
#include <span>

#include "anatomy/character.h"
#include "skinning/binding.h"
#include "skinning/crowd/crowd_prototype.h"

namespace ecorche::inline v1 {

// Writes what is a person's own: the file that write_crowd puts together or refers to. `weights`:
// of the skin, as Binding::joint_weights. Throws OutputError, UnfitError for a character that is
// not of the prototype's template, std::invalid_argument for weights of another skin.
void write_crowd_person(const std::filesystem::path& file, const CrowdPrototype& prototype,
                        const Character& character,
                        std::span<const std::array<Influence, 4>> weights);

}  // namespace ecorche::inline v1
