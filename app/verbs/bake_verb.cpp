#include "app/verbs/bake_verb.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <set>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/files/relief_maps.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/progress.h"
#include "skinning/bake/bake.h"
#include "skinning/bake/bake_io.h"
#include "skinning/files/character_look.h"
#include "skinning/rigs/own_rig.h"
#include "viewer/image.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct BakeVerbOptions {
  fs::path character, output, weights;
  std::string rig = "auto";
  std::vector<fs::path> motions;
  MotionOptions retarget;
  BakeOptions bake;
  std::optional<double> definition;
  int maps = 0;  // texels a side; 0: none
};

constexpr double kAskedRms = 2e-3, kAskedMax = 6e-3;  // m

std::vector<BakedMotion> open_motions(const BakeVerbOptions& options, const Character& character,
                                      const Binding& binding, const Common& common,
                                      Report& report) {
  std::vector<BakedMotion> out;
  std::set<std::string> names;
  for (const fs::path& file : options.motions) {
    BakedMotion each;
    each.name = printable(file.stem().string());
    for (int k = 2; !names.insert(each.name).second; ++k)
      each.name = fmt::format("{}_{}", printable(file.stem().string()), k);
    each.motion = open_motion(file, character, binding, options.retarget, common, report);
    out.push_back(std::move(each));
  }
  return out;
}

void report_error(const BakeError& error, const std::string& prefix, Report& report) {
  report.set(prefix + ".frames", error.frames);
  report.set(prefix + ".mean", error.mean);
  report.set(prefix + ".rms", error.rms);
  report.set(prefix + ".p95", error.p95);
  report.set(prefix + ".max", error.max);
  report.set(prefix + ".normal_rms_deg", error.normal_rms);
  report.set(prefix + ".normal_p95_deg", error.normal_p95);
}

std::string in_words(const BakeError& error) {
  return fmt::format(
      "mean {:.2f} mm, RMS {:.2f} mm, 95 % below {:.2f} mm, at most {:.2f} mm from the exact skin; "
      "normals {:.1f} degrees RMS",
      1e3 * error.mean, 1e3 * error.rms, 1e3 * error.p95, 1e3 * error.max, error.normal_rms);
}

// The character's own file again, moved by its own joints.
int bake_own_rig(const BakeVerbOptions& options, const Actor& actor,
                 const std::vector<BakedMotion>& motions, const Common& common, Report& report) {
  const OwnRig rig(*actor.character.own, printable(options.character.string()));
  std::vector<OwnRigMotion> out;
  ActorState frame(actor);
  {
    const StageTimer timer(report, "bake");
    int frames = 0, done = 0;
    for (const BakedMotion& each : motions) frames += int(each.motion.frames.size());
    Progress progress(common, options.output.filename().string(), frames);
    for (const BakedMotion& each : motions) {
      OwnRigMotion motion{each.name, each.motion.fps, {}, 0, 0};
      for (const Pose& pose : each.motion.frames) {
        rig.add_frame(evaluate_skin(actor, pose, {}, frame).positions, motion);
        progress.at(++done);
      }
      out.push_back(std::move(motion));
    }
  }
  write_file_atomically(options.output, rig.with_motions(out));
  double worst = 0;
  for (const OwnRigMotion& motion : out) {
    report.set("bake.motions." + motion.name + ".frames", int(motion.frames.size()));
    report.set("bake.motions." + motion.name + ".rms", motion.rms);
    report.set("bake.motions." + motion.name + ".max", motion.max);
    worst = std::max(worst, motion.rms);
    note(common, fmt::format("{}: {} frames by {} joints of its own, RMS {:.1f} mm, at most {:.1f} "
                             "mm from the exact skin",
                             motion.name, motion.frames.size(), rig.rig().joints.size(),
                             1e3 * motion.rms, 1e3 * motion.max));
  }
  report.set("bake.rms", worst);
  report.set("bake.bytes", double(fs::file_size(options.output)));
  return 0;
}

// NAME-normal.png and NAME-displacement.png beside NAME.glb.
fs::path map_file(const BakeVerbOptions& options, const char* what) {
  return options.output.parent_path() /
         fmt::format("{}-{}.png", options.output.stem().string(), what);
}

// `channels` bytes a texel.
Image to_image(const std::vector<std::uint8_t>& texels, int size, std::size_t channels) {
  Image out = make_image(size, size);
  for (std::size_t i = 0; i < texels.size() / channels; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out.rgba[4 * i + k] = texels[channels * i + (channels == 1 ? 0 : k)];
  return out;
}

// What the skin has on its texture; writes the maps beside the bake.
std::optional<BakeTexture> bake_maps(const BakeVerbOptions& options, const Character& character,
                                     const Common& common, Report& report) {
  if (options.maps == 0) return std::nullopt;
  const StageTimer timer(report, "maps");
  const SkinMaps maps =
      relief_maps(common.assets, character, options.definition.value_or(1), options.maps, report);
  const Image normals = to_image(maps.normals, maps.size, 3);
  const CharacterLook look =
      find_look(common.assets, character.body.skin, character.anatomy.skeleton);
  write_png(map_file(options, "normal"), normals);
  write_png(map_file(options, "displacement"), to_image(maps.displacement, maps.size, 1));
  report.set("bake.maps.size", maps.size);
  report.set("bake.maps.displacement_range", maps.range);
  note(common, fmt::format("{} texels: normals in the file and in {}, displacement of -{:.2f} .. "
                           "{:.2f} mm (black .. white) in {}",
                           maps.size, map_file(options, "normal").string(), 1e3 * maps.range,
                           1e3 * maps.range, map_file(options, "displacement").string()));
  return BakeTexture{look.texture, encode_png(normals)};
}

int run_bake(const BakeVerbOptions& options, const Common& common, Report& report) {
  require_ending(options.output, {".glb"});
  std::vector<fs::path> inputs = options.motions;
  inputs.insert(inputs.end(), {options.character, options.weights, options.retarget.map_file});
  std::vector<fs::path> outputs{options.output};
  if (options.maps > 0)
    outputs.insert(outputs.end(), {map_file(options, "normal"), map_file(options, "displacement")});
  check_outputs(common, outputs, inputs);
  Character opened = open_character(options.character, common, report);
  if (options.rig == "own" && !opened.own)
    throw UnfitError(
        fmt::format("{}: it has no rig of its own; leave --rig out", options.character.string()));
  // Before the character is compiled, which takes seconds; motions of own skins need that.
  std::vector<BakedMotion> motions;
  if (!opened.own) motions = open_motions(options, opened, Binding{}, common, report);
  Actor actor = make_actor(common.assets, std::move(opened), report,
                           {.weights = options.weights,
                            .muscles = MuscleMotion::lines,
                            .definition = options.maps > 0 ? 0 : options.definition.value_or(0)});
  const Character& character = actor.character;
  if (character.own) motions = open_motions(options, character, actor.binding, common, report);
  if (character.own &&
      (options.rig == "own" ||
       (options.rig == "auto" &&
        !read_source_rig(*character.own->source, options.character.string()).joints.empty())))
    return bake_own_rig(options, actor, motions, common, report);
  ActorState frame(actor);
  const ExactSkin exact = [&](const Pose& pose, SkinFrame& out) {
    out = evaluate_skin(actor, pose, {}, frame);
  };
  Bake bake;
  {
    const StageTimer timer(report, "bake");
    Progress progress(common, options.output.filename().string(), 100);
    bake = bake_skin(
        character.body.skin, character.anatomy.skeleton, actor.binding.joint_weights, exact,
        std::move(motions), options.bake,
        [&progress](const char* stage, double share) { progress.at(int(100 * share), stage); });
  }
  const std::optional<BakeTexture> texture = bake_maps(options, character, common, report);
  write_bake(options.output, character.body.name, character.body.skin, character.anatomy.skeleton,
             bake, texture ? &*texture : nullptr);
  const double bytes = fs::file_size(options.output);
  const double cache = 12.0 * double(character.body.skin.V.rows()) * bake.error.frames;
  report.set("skin_vertices", actor.binding.vertex_count);
  report.set("bake.morphs", int(bake.morphs.size()));
  report.set("bake.helpers", int(bake.helpers.size()));
  report.set("bake.influences_only_rms", bake.influences_only_rms);
  report_error(bake.error, "bake", report);
  for (const BakedMotion& each : bake.motions)
    report_error(each.error, "bake.motions." + each.name, report);
  report.set("bake.bytes", bytes);
  report.set("bake.cache_bytes", cache);
  for (const BakedMotion& each : bake.motions)
    note(common,
         fmt::format("{}: {} frames, {}", each.name, each.error.frames, in_words(each.error)));
  note(common, fmt::format("{}: 4 influences, {} helper joints, {} morph targets, {:.1f} MB, a "
                           "vertex cache would be {:.1f} MB",
                           options.output.string(), bake.helpers.size(), bake.morphs.size(),
                           1e-6 * bytes, 1e-6 * cache));
  note(common, fmt::format("all: {}", in_words(bake.error)));
  return bake.error.rms <= kAskedRms && bake.error.max <= kAskedMax ? 0 : 8;
}

}  // namespace

void add_bake_verb(VerbRegistry& registry) {
  auto options = std::make_shared<BakeVerbOptions>();
  CLI::App* verb =
      add_verb(registry, registry.app, "bake",
               "Make a character's motions ready for engines: 4 influences, morph targets, curves",
               "ecorche bake anna-anatomy.glb walk.bvh run.bvh -o anna-engine.glb",
               [options](const Common& common, Report& report) {
                 return run_bake(*options, common, report);
               });
  add_character_option(*verb, options->character);
  verb->add_option("motions", options->motions,
                   "Motions (.bvh, .glb, .fbx, .amc, ...), one animation each")
      ->required();
  verb->add_option("-o,--output", options->output, "File to write (.glb)")->required();
  verb->add_option("--rig", options->rig,
                   "The joints that move: own (those of the file that the character came in, with "
                   "its mesh, weights and materials), ecorche (ours, with helpers and morph "
                   "targets), or auto: own where there are any")
      ->check(one_of({"auto", "own", "ecorche"}))
      ->capture_default_str();
  verb->add_option("--morphs", options->bake.morphs, "Corrective morph targets, at most")
      ->check(between(0, 64))
      ->capture_default_str();
  verb->add_option("--helpers", options->bake.helpers,
                   "Joints added where the character's own leave the skin far off, at most")
      ->check(between(0, 128))
      ->capture_default_str();
  verb->add_option("--samples", options->bake.sample_frames,
                   "Frames that weights and shapes are solved on; errors are of every frame")
      ->check(between(2, 2000))
      ->capture_default_str();
  add_weights_option(*verb, options->weights);
  add_definition_option(*verb, options->definition, "0, of --maps 1");
  verb->add_option("--maps", options->maps,
                   "What shows through the skin as maps of this many texels a side in place of "
                   "shape: normals in the .glb and beside it, displacement beside it")
      ->check(between(64, 8192));
  add_motion_options(*verb, options->retarget);
  add_range_options(*verb, options->retarget);
}

}  // namespace ecorche
