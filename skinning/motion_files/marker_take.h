// Markers of a capture, as every file of markers is read: the input of skinning/markers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "anatomy/types.h"
#include "skinning/motion_files/clip_times.h"

namespace ecorche::inline v1 {

inline constexpr std::size_t kMostMarkers = 4096;  // of a take

// Places are in metres, in the file's own axes; a marker that was not seen is NaN.
struct MarkerTake {
  std::string name;                  // of the file, for messages
  std::vector<std::string> markers;  // unique, UTF-8
  double fps = 100;
  double start = 0;            // s, of the first frame by the file's own clock
  std::vector<Points> frames;  // #frames, each #markers x 3
  std::vector<std::string> warnings;
};

// Readers end with this. Takes (0, 0, 0), which programs write for a marker that was not seen, as
// not seen; corrects a unit in which the markers are no person's size (`unit`: what the file said,
// for messages); leaves out markers that are never seen. Throws UnfitError for a take without
// frames or without markers that are seen.
void finish_take(const std::string& unit, MarkerTake& take);

// Metres of a unit's name: mm, cm, dm, m, in, inch, inches, ft; 0 for another.
double metres_of_unit(const std::string& unit);

// Keeps the range. Throws UsageError, in the name of the file, where the take has none of it.
void cut_take(const ClipRange& range, MarkerTake& take);

}  // namespace ecorche::inline v1
