// How a skin hangs on the skeleton and the anatomy beneath it: nouns that binding finds and files,
// baselines and measurements read.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Parameters of binding.
struct BindOptions {
  // Width of the passage from one joint to the next, in local radii of the limb. Smaller: creases
  // at joints; larger: bones drag skin that lies far from them.
  double blend_width = 1.0;
  // Share of the height change of the muscles that reaches the skin, 0 .. 1; 0: bones only.
  double muscle_share = 1.0;
  // Offset of the skin by muscles that is never reached, m; an offset of this size in the muscle
  // moves the skin by half of it. Smaller: bellies hardly show; larger: a muscle that has slid from
  // beneath its handle drags the skin along.
  double lift_limit = 0.1;
  // Distance between muscle handles along the skin, m. Larger: muscles lose their outline.
  double handle_spacing = 0.04;
};

// The component of the anatomy nearest to a skin vertex at rest, exact.
struct Anchor {
  enum class Kind : std::uint8_t { none, bone, muscle };
  Kind kind = Kind::none;
  int part = -1;              // index into Anatomy::bones, or flat index of the nearer slice
  double distance = 0;        // m
  Vec3 point = Vec3::Zero();  // on the component, world, rest pose
};

// Weight of one joint (or blend frame, or muscle handle) for one vertex.
struct Influence {
  int joint = 0;
  double weight = 0;
};

// The four largest joint weights of a vertex, sum 1: what an engine with four influences can use.
using JointWeights = std::array<Influence, 4>;

// The part of a binding that files hold.
struct Binding {
  int vertex_count = 0;
  std::vector<Anchor> anchors;              // #V
  std::vector<JointWeights> joint_weights;  // #V
};

}  // namespace ecorche::inline v1
