// Reads markers of a .trc file (Motion Analysis' Track Row Column), text by tabulators.
//
// Counts of its head are not believed where the table says otherwise, and blank cells are markers
// that were not seen.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "skinning/motion_files/marker_take.h"

namespace ecorche::inline v1 {

// Of two markers of a name the first is kept. `fps`: in place of the file's. Throws InputError
// "file:line: ..."; LimitError above limits::kMotionFrames and kMarkers; as finish_take.
MarkerTake parse_trc(std::string_view text, const std::string& name,
                     const std::optional<double>& fps);

}  // namespace ecorche::inline v1
