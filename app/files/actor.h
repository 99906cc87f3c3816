// A compiled character and the method that moves its skin: ours, or a baseline. Shared by the verbs
// that move characters.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/base_mesh/base_skin.h"
#include "anatomy/files/assets.h"
#include "anatomy/geometry/split_edges.h"
#include "app/report.h"
#include "skinning/character/evaluate.h"
#include "skinning/evaluation/skin_methods.h"

namespace ecorche {

struct Actor : CharacterModel {
  SkinMethod method = SkinMethod::ecorche;         // of evaluate()
  std::shared_ptr<const BaselineSkins> baselines;  // set for every method that is not ours
  std::vector<TextureCorner> corners;              // of ActorOptions::texture
};

struct ActorState : CharacterState {
  using CharacterState::CharacterState;
  BaselineWorkspace baseline;
};

struct ActorOptions {
  const BaseSkin* base = nullptr;  // of a refined skin, where it is at hand; looked for otherwise
  // table set by hand, in place of the weights that are found (docs/weights.md); may be empty
  std::filesystem::path weights{};
  MuscleMotion muscles = MuscleMotion::map;
  // 0 .. 1, relief of the anatomy on a fine skin; left out: by the body's fat, on skins of ours
  std::optional<double> definition = 0;
  // a skin on the base mesh gets edges below 5 mm, shorter along veins, where the anatomy shows
  bool refinement = false;
  bool texture = false;  // with that: where its triangles lie on the texture, into Actor::corners
  const CharacterModel* before = nullptr;  // CompileOptions::before
};

// Compiles the character. Timings: posing_table, anchoring. Throws InputError for weights (see
// read_painted_weights), and as compile_character().
Actor make_actor(const Assets& assets, Character character, Report& report,
                 const ActorOptions& options = {});

// A character that is only written, and its binding.
struct BoundCharacter {
  Character character;
  Binding binding;
};

// Timings: anchoring. Throws as make_actor().
BoundCharacter bind_character(const Assets& assets, Character character, Report& report,
                              const ActorOptions& options = {});

// Sets actor.baselines. Throws InputError without the body package, UnfitError for a skin of
// another topology.
void add_baselines(const Assets& assets, Actor& actor);

// Makes evaluate() move the skin by another method: "lbs", "dqs", "deltamush", "paper", "anchors"
// (ours, but it does not settle) or "ecorche". Adds baselines for all but the last two. Throws
// UsageError for another name, and as add_baselines().
void choose_skin(const Assets& assets, Actor& actor, const std::string& method);

// evaluate() and evaluate_skin() of the model with the actor's method. Soft tissue counts for
// "ecorche" alone, by which alone muscles are pushed below the skin.
void evaluate(const Actor& actor, const Pose& pose, const FrameInputs& inputs,
              CharacterState& state, BaselineWorkspace& workspace);
void evaluate(const Actor& actor, const Pose& pose, const FrameInputs& inputs, ActorState& state);
const SkinFrame& evaluate_skin(const Actor& actor, const Pose& pose, const FrameInputs& inputs,
                               ActorState& state);

// The skin of a state whose muscles are posed, by any method.
// Precondition: actor.baselines for those that are not ours.
const SkinFrame& evaluate_posed_skin(const Actor& actor, SkinMethod method, ActorState& state);

}  // namespace ecorche
