// A motion for all people of a crowd.
#pragma once

#include <filesystem>

#include "app/options/motion_options.h"
#include "app/verb.h"

namespace ecorche {

// Retargets the motion (.bvh) to each person's own skeleton and writes the crowd with one
// animation, named as the motion's file, in which each person begins `stagger` seconds after the
// one before. The worst of all people's feet goes to the report under `motion`. Throws as read_bvh,
// retarget, open_crowd and write_crowd_motion.
void animate_crowd(const std::filesystem::path& crowd, const std::filesystem::path& motion,
                   const std::filesystem::path& output, const MotionOptions& options,
                   double stagger, const Common& common, Report& report);

}  // namespace ecorche
