// One muscle as a text file that other projects, and data/muscles, can take.
#pragma once

#include <filesystem>
#include <string>

#include "app/edit/document/document.h"

namespace ecorche {

// The muscle's block, after the wraps that it slides over and that are not as in `built_in`; where
// the right side differs, a second block with _r at its name.
std::string muscle_file_text(const Document& document, const Document& built_in, int entry);

// The document with the wraps and the muscle of such a file; those of the same names are replaced.
// Throws InputError for a file that cannot be read or is no such text.
Document read_muscle_file(const Document& document, const Document& built_in,
                          const std::filesystem::path& file);

}  // namespace ecorche
