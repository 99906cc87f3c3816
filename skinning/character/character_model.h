// A character ready to move. Shared by the verbs animate, render, view, bench and demo.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/posing/pose_anatomy.h"
#include "app/options/motion_options.h"
#include "app/verb.h"
#include "skinning/character/deform_skin.h"
#include "skinning/evaluation/skin_methods.h"
#include "skinning/files/character_io.h"
#include "skinning/motion/activation.h"
#include "skinning/muscle_collision/muscle_collision.h"

namespace ecorche {

struct Actor {
  Character character;
  PosingTable table;
  Binding binding;
  UnderSkin under;
  SkinMethod method = SkinMethod::ecorche;   // what play() moves the skin by
  std::shared_ptr<const RivalSkins> rivals;  // set for every other method
};

// What a refined skin comes from: it is bound by way of its base mesh.
struct BaseSkin {
  TriMesh mesh;
  Refinement refinement;
};

// The base mesh of a skin that is the body package's fine one in any shape; none for other skins or
// without the package.
std::optional<BaseSkin> find_base(const TriMesh& skin);

struct ActorOptions {
  const BaseSkin* base = nullptr;  // of a refined skin, where it is at hand; looked for otherwise
  // table set by hand, in place of the weights that are found (docs/weights.md); may be empty
  std::filesystem::path weights{};
  // false: only written, so that the tables of motion are left out; never played then
  bool moves = true;
};

// Builds the tables and binds the skin. Timings: posing_table, anchoring. Throws InputError for
// weights (see read_painted_weights).
Actor make_actor(Character character, Report& report, const ActorOptions& options = {});

struct ActorFrame {
  PosedAnatomy posed;
  SkinFrame skin;
  RivalScratch scratch;
  UnderSkinMemory under;
};

// Sets actor.rivals. Throws InputError without the body package, UnfitError for a skin of another
// topology.
void add_rivals(Actor& actor);

// Makes play() move the skin by another method: "lbs", "dqs", "deltamush", "paper", "anchors"
// (ours, but it does not settle) or "ecorche". Adds rivals for all but the last two. Throws
// UsageError for another name, and as add_rivals().
void choose_skin(Actor& actor, const std::string& method);

// One frame: kinematics, muscles, skin with normals. Reuses the memory of `frame`. `activation` as
// in pose_anatomy; `flesh` that lags (FleshState::seen) counts for "ecorche" alone, by which the
// muscles then give way where they would come out of the skin.
void play(const Actor& actor, const Pose& pose, ActorFrame& frame,
          std::span<const double> activation = {}, std::span<const float> flesh = {});

// The same skin, in half the time: the muscles stay as the pose alone has them. For who looks at
// the skin only.
void play_skin(const Actor& actor, const Pose& pose, ActorFrame& frame,
               std::span<const double> activation = {}, std::span<const float> flesh = {});

// The skin of a frame whose muscles are posed, by any method.
// Precondition: actor.rivals for those that are not ours.
void move_skin(const Actor& actor, SkinMethod method, ActorFrame& frame,
               std::span<const float> flesh = {});

// Reads a BVH file and retargets it to the character. What was assumed goes to the report under
// `motion`, warnings to people too.
Motion open_motion(const std::filesystem::path& file, const Character& character,
                   const MotionOptions& options, const Common& common, Report& report);

}  // namespace ecorche
