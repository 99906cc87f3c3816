// Reads joint angles of OpenSim (.mot, .sto) as a motion of the figure that they are angles of.
//
// Coordinates are those of OpenSim's models of gait: gait2392 (Delp et al.
// 1990, 10.1109/10.102791), the full bodies of Hamner et al. 2010 (10.1016/j.jbiomech.2010.06.025)
// and Rajagopal et al. 2016 (10.1109/TBME.2016.2586891). The figure has these models' joints, axes
// and proportions. A table does not say how tall its subject is: the figure is scaled so that its
// soles stand at height nought.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct CoordinateTable {
  std::string name;  // of the file, for messages
  // of the coordinates, without time: "knee_angle_r" for /jointset/knee_r/knee_angle_r/value too;
  // speeds are left out
  std::vector<std::string> columns;
  std::vector<double> times;              // s, rising
  std::vector<std::vector<double>> rows;  // #times x #columns
  bool degrees = false;                   // inDegrees=yes, or a head of SIMM (datacolumns)
  std::vector<std::string> warnings;
};

// Throws InputError "file:line: ..."; LimitError for more than limits::kMotionFrames rows.
CoordinateTable parse_coordinates(std::string_view text, const std::string& name);

// Angles that are missing stay nought, and are told; the sense of a knee's angle, which models have
// either way, is that in which it bends further. Throws UnfitError for a table without angles of
// hips and knees.
MotionClip clip_from_coordinates(const CoordinateTable& table, const std::optional<double>& fps);

}  // namespace ecorche::inline v1
