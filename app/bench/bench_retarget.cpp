#include "app/bench/bench_retarget.h"

#include <vector>

#include "app/bench/bench_timer.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"

namespace ecorche {

RetargetPace bench_retarget(const std::filesystem::path& file, const Character& character,
                            int rounds) {
  const Skeleton& skeleton = character.anatomy.skeleton;
  const MotionClip clip = read_motion(file, {});
  RetargetOptions options;
  measure_body(skeleton, character.body.skin.V, options);
  RetargetReport report;
  const Motion motion = retarget(clip, skeleton, options, report);
  std::vector<Transform> X_WJ;
  const std::vector<BenchCase> cases{
      {"retarget", [&] { retarget(clip, skeleton, options, report); }},
      {"kinematics", [&] {
         for (const Pose& pose : motion.frames) forward_kinematics(skeleton, pose, X_WJ);
       }}};
  const std::vector<double> times = least_cpu_times(cases, rounds);
  return {double(motion.frames.size()) / times[0], times[0] / times[1]};
}

}  // namespace ecorche
