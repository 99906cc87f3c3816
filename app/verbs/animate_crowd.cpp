#include "app/verbs/animate_crowd.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "anatomy/bones/own_joints.h"
#include "anatomy/files/input_file.h"
#include "app/progress.h"
#include "skinning/crowd/crowd_motion.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/motion_files/read_motion.h"

namespace ecorche {

void animate_crowd(const std::filesystem::path& crowd, const std::filesystem::path& motion,
                   const std::filesystem::path& output, const MotionOptions& options,
                   double stagger, const Common& common, Report& report) {
  const MotionClip source = read_motion(motion, to_read_options(options));
  const Crowd people = open_crowd(crowd);
  int frames = 0;
  Progress progress(common, "people", int(people.people.size()));
  double slide = 0, penetration = 0, fps = 0;
  std::set<std::string> warnings;  // the same for most people
  const auto move = [&](const CrowdPerson& person) {
    require_own_joints(common.assets.tables, person.skeleton, printable(crowd.string()));
    RetargetOptions own = to_retarget_options(options);
    measure_body(person.skeleton, person.body.skin.V, own);
    RetargetReport found;
    Motion out = retarget(source, person.skeleton, own, found);
    slide = std::max(slide, found.slide_p95),
    penetration = std::max(penetration, found.penetration);
    frames = int(out.frames.size()), fps = out.fps;
    warnings.insert(found.warnings.begin(), found.warnings.end());
    progress.step();
    return out;
  };
  {
    const StageTimer timer(report, "people");
    write_crowd_motion(output, people, {printable(motion.stem().string()), stagger}, move);
  }
  for (const std::string& warning : warnings) {
    note(common, "warning: " + warning);
    report.append_text("motion.warnings", warning);
  }
  const int count = people.people.size();
  report.set("motion.people", count);
  report.set("motion.frames", frames);
  report.set("motion.fps", fps);
  report.set("motion.foot_slide_p95", slide);
  report.set("motion.penetration", penetration);
  note(common,
       fmt::format("{}: {} people, {} frames at {:.4g} fps", output.string(), count, frames, fps));
}

}  // namespace ecorche
