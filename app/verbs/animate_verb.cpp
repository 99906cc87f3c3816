#include "app/verbs/animate_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/files/actor.h"
#include "app/files/character_file.h"
#include "app/files/motion_figures.h"
#include "app/files/motion_tables.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/files/vertex_caches.h"
#include "app/options/activation_options.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/progress.h"
#include "app/ragdoll/character_ragdoll.h"
#include "app/verbs/animate_crowd.h"
#include "skinning/checks/motion_survey.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/files/clip_shapes.h"
#include "skinning/motion/activation.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct AnimateOptions {
  fs::path character, motion, weights;
  std::vector<fs::path> outputs;
  std::string activation = "none", skin = "ecorche";
  bool dynamics = false;
  std::optional<double> definition;
  Detail detail = Detail::full;
  CacheOptions cache;
  std::vector<std::string> tables, passive;
  double stagger = 0;
  MotionOptions retarget;
};

void report_shapes(const ClipShapes& shapes, Report& report) {
  double muscles = 0;
  for (const MeshShapes& muscle : shapes.muscles) muscles = std::max(muscles, muscle.max_error);
  report.set("glb.muscle_error_max", muscles);
  report.set("glb.skin_error_max", shapes.skin.max_error);
}

// All outputs in one pass over the motion.
MotionQuality write_outputs(const AnimateOptions& options, const Actor& actor, const Motion& motion,
                            const Activations& activations, const Common& common, Report& report) {
  const StageTimer timer(report, "frames");
  std::vector<fs::path> cached, characters;
  std::vector<TableRequest> wanted = table_requests(options.tables);
  for (const fs::path& file : options.outputs) {
    if (is_cache(file))
      cached.push_back(file);
    else if (is_table(file))
      wanted.push_back(table_request(file));
    else
      characters.push_back(file);
  }
  CacheOptions cache = options.cache;
  cache.detail = options.detail;
  VertexCaches caches(common.assets, cached, actor, motion, cache);
  MotionTables tables(common.assets, std::move(wanted), actor, motion, activations);
  std::optional<ClipRecorder> recorder;
  if (!characters.empty()) recorder.emplace(actor.character, actor.binding);
  MotionRun pass{activations, options.dynamics};
  Progress progress(common, "frames", int(motion.frames.size()));
  pass.take = [&](int f, const CharacterState& frame) {
    caches.add(frame);
    tables.add(frame);
    if (recorder) recorder->add(frame.posed, frame.skin);
    progress.at(f + 1);
  };
  const MotionQuality quality = play_motion(actor, motion, pass);
  if (recorder) {  // once it is known that nothing is flung away
    const ClipShapes shapes = recorder->finish();
    for (const fs::path& file : characters)
      write_character_file(common.assets, file, actor.character, actor.binding, options.detail,
                           &motion, &shapes);
    report_shapes(shapes, report);
  }
  caches.finish();
  tables.write();
  return quality;
}

// What shapes muscles and skin is not seen in joints.
void check_shaping(const AnimateOptions& options) {
  const auto shows_joints = [](const fs::path& output) { return output.extension() == ".mot"; };
  if (!options.tables.empty() ||
      !std::all_of(options.outputs.begin(), options.outputs.end(), shows_joints))
    return;
  const char* given = options.activation != "none" ? "--activation"
                      : options.dynamics           ? "--dynamics"
                      : options.skin != "ecorche"  ? "--skin"
                                                   : nullptr;
  if (given)
    throw UsageError(
        fmt::format("{}: {} has angles of joints, which cannot show it; add a character ({}) or a "
                    "vertex cache (.pc2), or leave it out",
                    given, options.outputs[0].string(),
                    fs::path(options.outputs[0]).replace_extension(".glb").string()));
}

void check_outputs(const AnimateOptions& options, const Common& common) {
  if (options.outputs.empty() && options.tables.empty())
    throw UsageError("nothing to write: name a file by -o, or a table by --table WHAT=FILE");
  std::vector<fs::path> files;
  bool cache = false;
  for (const fs::path& output : options.outputs) {
    require_ending(output, {".glb", ".pc2", ".mdd", ".obj", ".mot", ".trc"});
    const bool sequence = output.extension() == ".obj";
    if (sequence && output.filename().string().find('%') == std::string::npos)
      throw UsageError(fmt::format(
          "{}: an OBJ file holds one frame; name a sequence, like DIR/%04d.obj", output.string()));
    cache |= is_cache(output);
    for (const fs::path& file :
         is_cache(output) ? cache_files(output, options.cache) : std::vector{output})
      if (!sequence) files.push_back(file);
  }
  if (!options.cache.layers.empty() && !cache)
    throw UsageError("--layers: for vertex caches (.pc2, .mdd, DIR/%04d.obj); none is asked for");
  for (const TableRequest& table : table_requests(options.tables)) files.push_back(table.file);
  // "none" and "auto" are not files.
  check_outputs(common, std::move(files),
                {options.character, options.motion, options.weights, options.activation,
                 options.retarget.map_file});
}

// People of a crowd are animated by their joints alone.
int run_crowd(const AnimateOptions& options, const Common& common, Report& report) {
  if (options.outputs.size() != 1 || options.outputs[0].extension() != ".glb" ||
      options.skin != "ecorche" || options.activation != "none" || options.dynamics ||
      !options.weights.empty() || !options.tables.empty() || !options.cache.layers.empty() ||
      !options.passive.empty() || options.detail != Detail::full)
    throw UsageError(
        fmt::format("{}: a crowd moves by its joints, into one .glb, without --skin, --weights, "
                    "--activation, --dynamics and --passive; those are for one "
                    "person of it, {}#NAME",
                    options.character.string(), options.character.string()));
  animate_crowd(options.character, options.motion, options.outputs[0], options.retarget,
                options.stagger, common, report);
  return 0;
}

int run_animate(const AnimateOptions& options, const Common& common, Report& report) {
  check_outputs(options, common);
  if (is_crowd(options.character)) return run_crowd(options, common, report);
  check_shaping(options);
  if (options.stagger > 0)
    throw UsageError("--stagger: for crowds, whose people then begin one after the other");
  require_settling(options.dynamics, options.skin);
  Character character = open_character(options.character, common, report);
  require_coordinates(table_requests(options.tables), character.anatomy.skeleton);
  require_limp_joints(character.anatomy.skeleton, options.passive);
  Activations table = read_activation_table(common.assets, options.activation, character.anatomy);
  auto [actor, motion] = open_moved_actor(
      options.motion, std::move(character),
      {.weights = options.weights, .definition = to_definition(options.definition, options.skin)},
      options.retarget, common, report);
  choose_skin(common.assets, actor, options.skin);
  if (!options.passive.empty())
    motion = with_limp_joints(options.character.string(), actor.character, actor.binding,
                              options.passive, motion, common, report);
  const Activations activations =
      open_activations(options.activation, std::move(table), actor, motion, report);
  const MotionQuality quality = write_outputs(options, actor, motion, activations, common, report);
  for (const fs::path& output : options.outputs)
    for (const fs::path& file :
         is_cache(output) ? cache_files(output, options.cache) : std::vector{output})
      if (file.extension() != ".mtl")
        note(common, fmt::format("{}: {} frames at {:.4g} fps", file.string(), motion.frames.size(),
                                 motion.fps));
  report.set("skin_vertices", actor.binding.vertex_count);
  report.set("skin", options.skin);
  report_quality(quality, "quality", report);
  if (!common.report_file.empty()) compare_skins(common.assets, actor, motion, report);
  return 0;
}

}  // namespace

void add_animate_verb(VerbRegistry& registry) {
  auto options = std::make_shared<AnimateOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "animate", "Move a character by a motion and write it out",
      "ecorche animate anna-anatomy.glb walk.bvh -o anna-walks.glb -o anna-walks.pc2 --activation "
      "auto\n"
      "  ecorche animate anna-anatomy.glb walk.bvh -o anna-limps.glb --passive shoulder_l",
      [options](const Common& common, Report& report) {
        return run_animate(*options, common, report);
      });
  verb->add_option("character", options->character,
                   "Character written by `ecorche fit`, CROWD.glb#NAME, or a whole crowd")
      ->required();
  verb->add_option("motion", options->motion, kMotionFilesHelp)->required();
  verb->add_option(
          "-o,--output", options->outputs,
          "File to write; may be given several times: .glb (the character, for any viewer); "
          "every vertex, exact: .pc2, .mdd, DIR/%04d.obj; joint angles: .mot; skin "
          "markers: .trc")
      ->allow_extra_args(false);
  verb->add_option("--stagger", options->stagger,
                   "Of a crowd: seconds by which each person begins later than the one before")
      ->check(between(0.0, 3600.0));
  add_skin_option(*verb, options->skin);
  add_weights_option(*verb, options->weights);
  add_activation_option(*verb, options->activation);
  add_detail_option(*verb, options->detail);
  add_cache_options(*verb, options->cache);
  add_table_option(*verb, options->tables);
  add_dynamics_option(*verb, options->dynamics);
  verb->add_option(
          "--passive", options->passive,
          "A joint that goes limp, with all below it: it swings as a damped pendulum, "
          "within its limits, driven by the rest of the motion; may be given several times")
      ->allow_extra_args(false);
  add_definition_option(*verb, options->definition);
  add_motion_options(*verb, options->retarget);
  add_range_options(*verb, options->retarget);
}

}  // namespace ecorche
