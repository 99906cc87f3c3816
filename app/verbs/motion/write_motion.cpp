#include "app/verbs/motion/write_motion.h"

#include <fmt/format.h>

#include "anatomy/files/atomic_file.h"
#include "skinning/files/motion_write.h"
#include "skinning/motion_files/bvh_write.h"
#include "skinning/motion_files/fbx_write.h"

namespace ecorche {

void write_motion(const std::filesystem::path& output, const Skeleton& skeleton,
                  const Motion& motion, const std::string& take, const Common& common) {
  if (output.extension() == ".bvh")
    write_file_atomically(output, format_bvh(to_bvh(skeleton, motion)));
  else if (output.extension() == ".fbx")
    write_file_atomically(output, format_fbx(to_bvh(skeleton, motion), take));
  else
    write_motion_glb(output, skeleton, motion, take);
  note_written(output, motion, common);
}

void note_written(const std::filesystem::path& output, const Motion& motion, const Common& common) {
  note(common, fmt::format("{}: {} frames at {:.4g} fps", output.string(), motion.frames.size(),
                           motion.fps));
}

}  // namespace ecorche
