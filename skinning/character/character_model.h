// A character compiled for motion: constant, made once, read by every frame of every thread.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/base_mesh/base_skin.h"
#include "anatomy/character.h"
#include "anatomy/contact/muscle_model.h"
#include "skinning/bind/painted_weights.h"
#include "skinning/binding.h"
#include "skinning/character/skin_model.h"
#include "skinning/interior/body_map.h"
#include "skinning/relief/skin_relief.h"

namespace ecorche::inline v1 {

// What carries muscles from rest to pose: each its own action line, or one map of the body's inside
// (interior/body_map.h).
enum class MuscleMotion { lines, map };

struct CharacterModel {
  Character character;
  MuscleModel muscles;
  Binding binding;  // for files
  SkinModel skin;
  std::shared_ptr<const BodyMap> interior;  // null: muscles move with their lines
  SkinRelief relief;                        // empty: the anatomy makes none
};

// Wall times of the stages of compile_character().
struct CompileTimes {
  double muscles_ms = 0;  // posing and contact tables
  double skin_ms = 0;     // binding, elastic skin, collision tables
};

struct CompileOptions {
  const BaseSkin* base = nullptr;  // of a refined skin; null: the skin is bound by itself
  BindOptions bind{};
  MuscleMotion muscles = MuscleMotion::lines;
  PaintedWeights painted{};  // of the base mesh's vertices where there is one
  double definition = 0;     // 0 .. 1, relief of the anatomy on a refined skin; others have none
  double layer = 0;          // m, ReliefOptions::layer
  std::vector<VeinPath> veins{};  // that the relief shows, too
  // Of the same skin, bones and joints with other muscles: what rests on these, and what two
  // muscles do that are the same, is taken over. Null: nothing is.
  const CharacterModel* before = nullptr;
  CompileTimes* times = nullptr;  // filled where given
};

// Throws UnfitError for a skin or an anatomy that cannot be bound (see bind_skin), and as
// make_muscle_model().
CharacterModel compile_character(Character character, const CompileOptions& options = {});

// The binding alone, for characters that are written and not moved; in less time the same as
// compile_character().binding, but for rounding of the muscles' rest pose. Fills times->skin_ms.
// Throws as bind_skin().
Binding bind_for_export(const Character& character, const CompileOptions& options = {});

}  // namespace ecorche::inline v1
