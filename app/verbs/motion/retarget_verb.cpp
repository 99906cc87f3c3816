#include "app/verbs/motion/retarget_verb.h"

#include <CLI/CLI.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/options/motion_options.h"
#include "app/verbs/motion/write_motion.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct RetargetVerbOptions {
  fs::path motion, character;
  std::vector<fs::path> outputs;
  MotionOptions retarget;
};

void check_kinds(const std::vector<fs::path>& outputs) {
  for (const fs::path& output : outputs) require_ending(output, {".bvh", ".glb", ".fbx"});
}

int run_retarget(const RetargetVerbOptions& options, const Common& common, Report& report) {
  check_kinds(options.outputs);
  check_outputs(
      common, options.outputs,
      {options.motion, options.character, options.retarget.map_file, options.retarget.skeleton});
  const BoundCharacter bound =
      bind_character(common.assets, open_character(options.character, common, report), report);
  const Motion motion =
      open_motion(options.motion, bound.character, bound.binding, options.retarget, common, report);
  const Skeleton& skeleton = bound.character.anatomy.skeleton;
  const std::string take = printable(options.motion.stem().string());
  for (const fs::path& output : options.outputs)
    write_motion(output, skeleton, motion, take, common);
  return 0;
}

}  // namespace

void add_retarget_verb(VerbRegistry& registry) {
  auto options = std::make_shared<RetargetVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "retarget",
      "Put a motion on a character's skeleton and write it alone, for other programs",
      "ecorche retarget walk.bvh anna-anatomy.glb -o anna-walk.bvh -o anna-walk.fbx --from 1f --to "
      "0.1s\n"
      "  ecorche retarget walk.bvh anna-anatomy.glb -o mirrored.glb --filter mirror --filter "
      "speed=0.5",
      [options](const Common& common, Report& report) {
        return run_retarget(*options, common, report);
      });
  verb->add_option("motion", options->motion, kMotionFilesHelp)->required();
  verb->add_option("character", options->character,
                   "Character written by `ecorche fit`, or CROWD.glb#NAME")
      ->required();
  verb->add_option(
          "-o,--output", options->outputs,
          "File to write; may be given several times: .bvh, or .glb or .fbx with the skeleton "
          "and an animation of it")
      ->required()
      ->allow_extra_args(false);
  add_motion_options(*verb, options->retarget);
  add_range_options(*verb, options->retarget);
}

}  // namespace ecorche
