// Reads markers of a C3D file (https://www.c3d.org, "The C3D File Format, User Guide"), of
// processors of Intel, DEC and MIPS, with places as whole numbers or floats.
//
// Parameters may lie in any order, and their types are those that are found: programs write counts
// of frames as whole numbers or floats. Analog channels are passed over.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "skinning/motion_files/marker_take.h"

namespace ecorche::inline v1 {

// Whether bytes begin as a C3D file does.
bool is_c3d(std::string_view bytes);

// Markers with a residual below nought were not seen; frames that the file says and does not hold
// are told. `fps`: in place of the file's. Throws InputError "file: part: ..."; LimitError above
// limits::kMotionFrames and kMarkers; as finish_take.
MarkerTake parse_c3d(std::string_view bytes, const std::string& name,
                     const std::optional<double>& fps);

}  // namespace ecorche::inline v1
