// Reads characters and bodies from .glb files (character_format.h).
//
// Nothing outside the file itself is opened, and what the file says of images, materials and
// animations is not looked at.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/character.h"

namespace ecorche::inline v1 {

// Throws InputError for a file that is no character of ours (it names what is missing) or whose
// numbers no body has (character_check.h), UnfitError for one of a newer schema, LimitError.
// Positions come back in single precision (1e-7 m). `name` is what messages call the file.
Character read_character(const std::filesystem::path& file);
Character parse_character(std::string bytes, const std::string& name);

// The body of a file that write_body or write_character wrote. Throws as read_character.
Body read_body(const std::filesystem::path& file);
Body parse_body(std::string bytes, const std::string& name);

// Whether the file is a binary glTF that write_body or write_character may have written: by its
// first bytes and the mark in its text. Throws InputError for an unreadable file.
bool has_body_notes(const std::filesystem::path& file);

}  // namespace ecorche::inline v1
