// The pose that brings a figure's markers nearest to where they were seen.
#pragma once

#include <vector>

#include "skinning/markers/lay_markers.h"
#include "skinning/markers/marker_figure.h"

namespace ecorche::inline v1 {

// A figure and the markers on it.
struct MarkerModel {
  MarkerFigure figure;
  std::vector<BodyMarker> markers;
  std::vector<Vec3> offsets;  // #markers: beyond BodyMarker::local, in the joint's frame, m
};

// Seen places are #markers x 3, m, y up; NaN where a marker was not seen.
struct PoseOptions {
  double noise = 0.008;   // m, standard deviation of a seen place
  bool loose = false;     // markers may lie off their places by BodyMarker::spread
  double outlier = 0.06;  // m, from here on a place is believed less and less
  double hold = 0;        // of the pose before, 1 / rad^2
  int rounds = 12;
};

// Normal equations of one frame: cost = 1/2 sum of squares. Shared unknowns are the sizes, then
// three for each marker's offset.
struct PoseSystem {
  Eigen::MatrixXd H;  // #coordinates square, lower half
  Eigen::VectorXd g;
  Eigen::MatrixXd mixed;   // #coordinates x #shared
  Eigen::MatrixXd shared;  // #shared square, lower half
  Eigen::VectorXd shared_g;
  double cost = 0;
};

// `before`: the pose that is held to, or null. with_shared: also by sizes and offsets.
void assemble_pose(const MarkerModel& model, const Points& seen, const PoseOptions& options,
                   const FigurePose* before, const FigurePose& at, bool with_shared,
                   PoseSystem& out);

// Levenberg and Marquardt's iteration from `at`; the cost that is left.
double solve_pose(const MarkerModel& model, const Points& seen, const PoseOptions& options,
                  const FigurePose* before, FigurePose& at);

// The figure at attention, turned and moved as a whole to the seen markers (Kabsch 1976,
// 10.1107/S0567739476001873).
FigurePose place_upright(const MarkerModel& model, const Points& seen);

// Root of the mean square distance of the seen markers, m; 0 if none is seen.
double pose_residual(const MarkerModel& model, const Points& seen, const FigurePose& at);

}  // namespace ecorche::inline v1
