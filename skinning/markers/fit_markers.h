// A take of markers as a motion of our skeleton at the person's own size.
//
// Up is measured on the markers, sizes and offsets over frames spread through the take
// (marker_calibration.h), then each frame is solved from the one before. Gaps of a marker are
// bridged: while it is not seen it is taken to be where it lay on its segment before and after.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "skinning/markers/lay_markers.h"
#include "skinning/markers/marker_figure.h"
#include "skinning/motion_files/marker_take.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct MarkerFitOptions {
  std::optional<char> up;  // 'x', 'y' or 'z' of the file, instead of what the markers say
  bool sizes = true;       // false: the person is as large as the skeleton, markers lie in place
};

struct MarkerResidual {
  std::string marker, place;
  double rms = 0, worst = 0;  // m
  int worst_frame = 0;        // from 0
  int gaps = 0, longest = 0;  // frames in which it is not seen; the longest run of them
  double offset = 0;          // m, of the marker from its place
};

struct MarkerFit {
  MotionClip clip;      // joints of the skeleton, of the person's size; m, y up
  Motion motion;        // the same on `figure`
  MarkerFigure figure;  // with the person's sizes
  std::vector<MarkerResidual> markers;
  double rms = 0, worst = 0;  // m, over markers and frames
  std::string worst_marker;
  int worst_frame = 0;
  int blind = 0;  // frames with too few markers, gone through from neighbour to neighbour
  char up = 'y';
};

// Throws UnfitError where the markers do not tell a body's pose: fewer than ten that are known, or
// none on the pelvis or on a leg; UsageError for an up axis along which the body does not stand.
MarkerFit fit_markers(const MarkerTake& take, const std::vector<BodyMarker>& markers,
                      const Skeleton& skeleton, const MarkerFitOptions& options = {});

}  // namespace ecorche::inline v1
