#include "skinning/motion_files/read_motion.h"

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/gltf_motion.h"

namespace ecorche::inline v1 {

MotionClip read_motion(const std::filesystem::path& file, const MotionReadOptions& options) {
  // FBX and C3D: one line each, by file.extension(), before this one.
  const std::filesystem::path kind = file.extension();
  if (kind == ".glb" || kind == ".gltf")
    return gltf_motion(read_input_file(file), printable(file.string()), {options.fps, options.take},
                       file.parent_path());
  if (!options.take.empty())
    throw UsageError(printable(file.string()) + ": --take: a .bvh has one motion; leave it out");
  return clip_from_bvh(read_bvh(file, {options.fps}));
}

}  // namespace ecorche::inline v1
