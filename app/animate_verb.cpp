// ecorche animate: a motion on a character, as an animated .glb or a vertex cache.
#include <fmt/format.h>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "app/activation_options.h"
#include "app/actor.h"
#include "app/motion_options.h"
#include "app/verb.h"
#include "skinning/flesh_motion.h"
#include "skinning/mdd_io.h"
#include "skinning/obj_sequence.h"
#include "skinning/pc2_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct AnimateOptions {
  fs::path character, motion;
  std::vector<fs::path> outputs;
  std::string activation = "none", skin = "ecorche";
  bool dynamics = false;
  MotionOptions retarget;
};

// Every frame of the motion to a writer of vertex caches.
template <class Writer>
void write_frames(Writer& writer, const fs::path& file, const Actor& actor, const Motion& motion, const Activations& activations, bool dynamics,
                  const Common& common) {
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const FleshTables flesh = dynamics ? make_flesh_tables(actor.binding, skeleton) : FleshTables{};
  FleshState state;
  ActorFrame frame;
  std::vector<double> efforts;
  const int total = static_cast<int>(motion.frames.size());
  for (int f = 0; f < total; ++f) {
    activation_at(activations, f / motion.fps, efforts);
    if (!flesh.vertices.empty()) move_flesh(flesh, skeleton, motion, f / motion.fps, state);
    play(actor, motion.frames[f], frame, efforts, state.seen);
    writer.add_frame(frame.skin.positions);
    progress(common, file.filename().string(), f + 1, total);
  }
}

void write_output(const fs::path& file, const Actor& actor, const Motion& motion, const Activations& activations, bool dynamics,
                  const Common& common) {
  const fs::path kind = file.extension();
  if (kind == ".pc2") {
    Pc2Writer writer(file, actor.binding.vertex_count);
    write_frames(writer, file, actor, motion, activations, dynamics, common);
    writer.finish();
  } else if (kind == ".mdd") {
    MddWriter writer(file, actor.binding.vertex_count, static_cast<int>(motion.frames.size()), motion.fps);
    write_frames(writer, file, actor, motion, activations, dynamics, common);
    writer.finish();
  } else if (kind == ".obj") {
    ObjSequenceWriter writer(file, actor.character.body.skin.F);
    write_frames(writer, file, actor, motion, activations, dynamics, common);
  } else {
    write_character(file, actor.character, actor.binding, &motion);
  }
}

void check_outputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  for (const fs::path& output : outputs) {
    const std::string kind = output.extension().string();
    if (kind != ".glb" && kind != ".pc2" && kind != ".mdd" && kind != ".obj")
      throw UsageError(fmt::format("{}: unknown kind of output '{}'; .glb, .pc2, .mdd and DIR/%04d.obj can be written", output.string(), kind));
    if (kind == ".obj" && output.filename().string().find('%') == std::string::npos)
      throw UsageError(fmt::format("{}: an OBJ file holds one frame; name a sequence, like DIR/%04d.obj", output.string()));
    if (kind != ".obj") check_output(output, inputs);
  }
}

int run(const AnimateOptions& options, const Common& common, Report& report) {
  check_outputs(options.outputs, {options.character, options.motion});
  if (options.dynamics && options.skin != "ecorche") throw UsageError("--dynamics: only our own skin has flesh that lags; leave --skin out");
  Actor actor = make_actor(read_character(options.character), report);
  choose_skin(actor, options.skin);
  const Motion motion = open_motion(options.motion, actor.character, to_retarget_options(options.retarget), common, report);
  const Activations activations = open_activations(options.activation, actor, motion, report);
  for (const fs::path& output : options.outputs) {
    const StageTimer timer(report, "write_" + output.extension().string().substr(1));
    write_output(output, actor, motion, activations, options.dynamics, common);
    note(common, fmt::format("{}: {} frames at {:.4g} fps", output.string(), motion.frames.size(), motion.fps));
  }
  report.set("skin_vertices", actor.binding.vertex_count);
  report.set("skin", options.skin);
  report_quality(survey_motion(actor, motion, nullptr, activations), "quality", report);
  if (!common.report_file.empty()) compare_skins(actor, motion, report);
  return 0;
}

}  // namespace

void add_animate_verb(VerbRegistry& registry) {
  auto options = std::make_shared<AnimateOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "animate", "Move a character by a motion (BVH) and write it out",
                            "ecorche animate anna.glb walk.bvh -o anna-walks.glb -o anna-walks.pc2 --activation auto",
                            [options](const Common& common, Report& report) { return run(*options, common, report); });
  verb->add_option("character", options->character, "Character written by `ecorche fit`")->required();
  verb->add_option("motion", options->motion, "Motion (.bvh)")->required();
  verb->add_option("-o,--output", options->outputs, "File to write; may be given several times: .glb (joints); every vertex, exact: .pc2, .mdd, DIR/%04d.obj")
      ->required()
      ->allow_extra_args(false);
  add_skin_option(*verb, options->skin);
  verb->add_option("--activation", options->activation, kActivationHelp)->capture_default_str();
  verb->add_flag("--dynamics", options->dynamics, "Let loose flesh lag and settle, in vertex caches");
  add_motion_options(*verb, options->retarget);
}

}  // namespace ecorche
