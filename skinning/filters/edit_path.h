// The way that a figure takes over the ground, changed: after Gleicher 2001, "Motion path editing"
// (10.1145/364338.364400).
//
// The way is the root's, smoothed over 0.8 s, by its length. Every frame keeps its place beside the
// way and its turn against it; lengths of steps stay.
#pragma once

#include <string>
#include <vector>

#include "skinning/filters/filtered_motion.h"

namespace ecorche::inline v1 {

// Straight on as it begins. `name`: of the motion's file. Throws UnfitError for a figure that goes
// less than 0.3 m, as the other two.
void straighten_path(const std::string& name, FilteredMotion& filtered);

// Bent evenly, by `angle` (rad, to the left) from beginning to end.
void bend_path(const std::string& name, double angle, FilteredMotion& filtered);

// Along a curve through `points` (x, z in m, two at least, each 1 cm at least from the one before),
// from the first one; straight on after the last one.
void follow_points(const std::string& name, const std::vector<Eigen::Vector2d>& points,
                   FilteredMotion& filtered);

// The whole motion turned about the vertical through its first root, rad, to the left.
void turn_motion(double angle, FilteredMotion& filtered);

}  // namespace ecorche::inline v1
