// Motions read from files for a character.
#pragma once

#include <filesystem>

#include "app/common_options.h"
#include "app/files/actor.h"
#include "app/options/motion_options.h"
#include "app/report.h"
#include "skinning/character/character_model.h"

namespace ecorche {

// How a motion lies to its file.
struct MotionPlace {
  double start = 0;              // s, of the first frame by the file's clock
  double scale = 1;              // metres of the file -> ours
  Mat3 turn = Mat3::Identity();  // axes of the file -> ours
};

// Reads a motion file and retargets it to the character; a motion of its own skin's joints
// (own_motion.h) is taken over as it is, unless `options` say what is up or which joint is which.
// What was assumed goes to the report under `motion`, warnings to people too; `place` is filled
// where given.
Motion open_motion(const std::filesystem::path& file, const Character& character,
                   const Binding& binding, const MotionOptions& options, const Common& common,
                   Report& report, MotionPlace* place = nullptr);
Motion open_motion(const std::filesystem::path& file, const CharacterModel& model,
                   const MotionOptions& options, const Common& common, Report& report,
                   MotionPlace* place = nullptr);

struct MovedActor {
  Actor actor;
  Motion motion;
};

// Reads the motion before it compiles the character, which takes seconds: what cannot be read is
// said at once. Motions of own skins alone need the compiled character. Throws as open_motion()
// and make_actor().
MovedActor open_moved_actor(const std::filesystem::path& file, Character character,
                            const ActorOptions& how, const MotionOptions& options,
                            const Common& common, Report& report);

}  // namespace ecorche
