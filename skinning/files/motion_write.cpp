#include "skinning/files/motion_write.h"

#include <stdexcept>

#include "anatomy/files/atomic_file.h"
#include "skinning/files/glb_builder.h"

namespace ecorche::inline v1 {

void write_motion_glb(const std::filesystem::path& file, const Skeleton& skeleton,
                      const Motion& motion, const std::string& name) {
  if (motion.frames.empty() || !(motion.fps > 0))
    throw std::invalid_argument("a motion without frames or rate cannot be written");
  for (const Pose& pose : motion.frames)
    if (pose.rotations.size() != skeleton.joints.size())
      throw std::invalid_argument("the motion belongs to another skeleton");
  gltf::GlbBuilder glb;
  gltf::add_joints(glb, skeleton);
  gltf::add_motion(glb, skeleton, motion, name);
  glb.scene().name = name;
  AtomicFile out(file);
  if (!glb.write(out.stream())) out.fail();
  out.commit();
}

}  // namespace ecorche::inline v1
