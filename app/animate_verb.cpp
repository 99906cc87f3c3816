// ecorche animate: a motion on a character, as an animated .glb or a vertex cache.
#include <fmt/format.h>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "app/actor.h"
#include "app/motion_options.h"
#include "app/verb.h"
#include "skinning/pc2_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct AnimateOptions {
  fs::path character, motion;
  std::vector<fs::path> outputs;
  MotionOptions retarget;
};

void write_cache(const fs::path& file, const Actor& actor, const Motion& motion, const Common& common) {
  Pc2Writer writer(file, actor.binding.vertex_count);
  ActorFrame frame;
  const int total = static_cast<int>(motion.frames.size());
  for (int f = 0; f < total; ++f) {
    play(actor, motion.frames[f], frame);
    writer.add_frame(frame.skin.positions);
    progress(common, file.filename().string(), f + 1, total);
  }
  writer.finish();
}

int run(const AnimateOptions& options, const Common& common, Report& report) {
  for (const fs::path& output : options.outputs)
    if (output.extension() != ".glb" && output.extension() != ".pc2")
      throw UsageError(fmt::format("{}: unknown kind of output '{}'; .glb and .pc2 can be written", output.string(), output.extension().string()));
  for (const fs::path& output : options.outputs) check_output(output, {options.character, options.motion});
  const Actor actor = make_actor(read_character(options.character), report);
  const Motion motion = open_motion(options.motion, actor.character, to_retarget_options(options.retarget), common, report);
  for (const fs::path& output : options.outputs) {
    const StageTimer timer(report, "write_" + output.extension().string().substr(1));
    if (output.extension() == ".pc2") write_cache(output, actor, motion, common);
    else write_character(output, actor.character, actor.binding, &motion);
    note(common, fmt::format("{}: {} frames at {:.4g} fps", output.string(), motion.frames.size(), motion.fps));
  }
  report.set("skin_vertices", actor.binding.vertex_count);
  report_quality(survey_motion(actor, motion, nullptr), "quality", report);
  return 0;
}

}  // namespace

void add_animate_verb(VerbRegistry& registry) {
  auto options = std::make_shared<AnimateOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "animate", "Move a character by a motion (BVH) and write it out",
                            "ecorche animate anna.glb walk.bvh -o anna-walks.glb -o anna-walks.pc2",
                            [options](const Common& common, Report& report) { return run(*options, common, report); });
  verb->add_option("character", options->character, "Character written by `ecorche fit`")->required();
  verb->add_option("motion", options->motion, "Motion (.bvh)")->required();
  verb->add_option("-o,--output", options->outputs, "File to write; may be given several times: .glb (joints), .pc2 (every vertex, exact)")
      ->required();
  add_motion_options(*verb, options->retarget);
}

}  // namespace ecorche
