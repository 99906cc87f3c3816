// Ecorche as a library: bodies, their anatomy, motions, frames and files by one header.
//
//   open_assets -> read_template, make_body -> fit_character -> compile_character
//   read_motion -> retarget -> evaluate, a frame at a time -> Pc2Writer, write_character
//
// Lengths are metres, angles radians, masses kilograms, times seconds; y is up, the figure looks
// along +z, its left hand is at +x. Matrices of points have a row a point. Functions throw the
// types of anatomy/errors.h, whose messages name the file, the part, the value and the next step;
// std::invalid_argument is a broken precondition. Values may be read by several threads at once; a
// CharacterState belongs to one.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "anatomy/errors.h"
#include "anatomy/files/assets.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "morph/fit/fit_character.h"
#include "morph/measures/tape_measure.h"
#include "morph/shapes/body_model.h"
#include "morph/template/template_cache.h"
#include "skinning/character/character_model.h"
#include "skinning/character/character_state.h"
#include "skinning/character/evaluate.h"
#include "skinning/files/character_read.h"
#include "skinning/files/character_write.h"
#include "skinning/files/clip_shapes.h"
#include "skinning/files/pc2_io.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"

namespace ecorche::inline v1 {

// "0.2.0", of the library that runs.
const char* version();

// The most probable person with what `spec` asks. Reads the body package and a shape space; a
// BodyModel makes many bodies from one reading. Throws UnfitError that names what cannot be met.
Body make_body(const Assets& assets, const BodySpec& spec);

// Bones and muscles inside a body's skin. Reads the body package. The report of what is returned
// holds the figures of the fit; missed_targets() says which are not met.
FittedCharacter fit_character(const Assets& assets, const Template& body_template, const Body& body,
                              const FittingOptions& options = {});

// The model of a fitted body, in its own skin.
CharacterModel compile(const FittedCharacter& fitted, const Body& body);

struct Retargeted {
  Motion motion;
  RetargetReport report;
};

// A motion on a character. Soles and self-collision are those of its own skin where the options do
// not say otherwise.
Retargeted retarget(const MotionClip& clip, const Character& character,
                    RetargetOptions options = {});

// As the program writes characters: with the skin's texture coordinates and eyes. With shapes of
// the motion (ClipRecorder takes them as frames are evaluated) any viewer shows muscles and skin as
// they were evaluated, otherwise by joints alone.
void write_character(const Assets& assets, const std::filesystem::path& file,
                     const CharacterModel& model, const Motion* motion = nullptr,
                     const ClipShapes* shapes = nullptr);

}  // namespace ecorche::inline v1
