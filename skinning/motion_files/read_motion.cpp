#include "skinning/motion_files/read_motion.h"

#include "skinning/motion_files/bvh_read.h"

namespace ecorche::inline v1 {

MotionClip read_motion(const std::filesystem::path& file, const MotionReadOptions& options) {
  // FBX, C3D and glTF: one line each, by file.extension(), before this one.
  return clip_from_bvh(read_bvh(file, {options.fps}));
}

}  // namespace ecorche::inline v1
