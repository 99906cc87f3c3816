// Is a written film whole? Its boxes are walked (ISO/IEC 14496-12), pictures are not decoded.
#pragma once

#include <filesystem>
#include <string>

namespace ecorche {

// The fault of an .mp4 file that should hold one track of `frames` pictures; empty if it is whole.
// Looked at: boxes that end where the file ends, and a table of as many samples that all have their
// bytes.
std::string film_fault(const std::filesystem::path& file, int frames);

}  // namespace ecorche
