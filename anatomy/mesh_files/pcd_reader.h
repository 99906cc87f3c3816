// PCD, clouds of points: ascii, binary, binary_compressed. Private to mesh_io, whose exceptions it
// throws.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// Whether a text opens as a PCD file does: with its comment or with its version.
bool is_pcd(std::string_view head);

// Appends parts and notes to `out`; `name` stands for the file in messages. Points that are not
// finite, as an organised cloud has for what its camera did not see, are left out. Source of the
// format: the Point Cloud Library's documentation, PCD 0.7.
void parse_pcd(std::string_view bytes, const std::string& name, const MeshReadOptions& options,
               MeshFile& out);

// LZF's bytes unpacked. Throws InputError that begins with `name` unless exactly `size` come out.
std::string lzf_unpacked(std::string_view packed, std::size_t size, const std::string& name);

}  // namespace ecorche::inline v1
