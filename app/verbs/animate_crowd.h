// One motion retargeted to all people of a crowd.
#pragma once

#include <filesystem>

#include "app/common_options.h"
#include "app/options/motion_options.h"
#include "app/report.h"

namespace ecorche {

// Retargets the motion (.bvh) to each person's skeleton and writes the crowd with one animation,
// named after the motion's file. Each person starts `stagger` seconds after the one before. The
// largest foot slide and ground penetration of all people go to the report under `motion`. Throws
// as read_motion, retarget, open_crowd and write_crowd_motion.
void animate_crowd(const std::filesystem::path& crowd, const std::filesystem::path& motion,
                   const std::filesystem::path& output, const MotionOptions& options,
                   double stagger, const Common& common, Report& report);

}  // namespace ecorche
