// The size of the person under markers, and where the markers were stuck.
//
// Over some frames of a take, poses, sizes of segments and offsets of markers are solved together,
// with priors of how sizes of people's parts go together and how well a place is found under the
// skin (the two levels of Werling et al. 2023, 10.1371/journal.pone.0295152, and the offsets of Wu
// et al. 2013, "STAC: Simultaneous tracking and calibration", as one least-squares problem). Poses
// are eliminated frame by frame.
#pragma once

#include <vector>

#include "skinning/markers/marker_pose.h"

namespace ecorche::inline v1 {

// Sets sizes and offsets of the model. `frames`: seen places of frames that differ; `poses` of
// them, input and output.
void calibrate_markers(const std::vector<Points>& frames, MarkerModel& model,
                       std::vector<FigurePose>& poses);

}  // namespace ecorche::inline v1
