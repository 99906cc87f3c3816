// Rigs of the body package, placed in a shape, and the parts of the body that its skin belongs to.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anatomy/base_mesh/body_package.h"

namespace ecorche::inline v1 {

// Weights of bones a vertex: entries start[i] .. start[i + 1] of `bone` and `weight`; falling
// weight; they sum to 1.
struct VertexWeights {
  std::vector<int> start;  // #skin + 1
  std::vector<int> bone;
  std::vector<double> weight;
};

// A rig placed in a shape.
struct Rig {
  std::string name;
  std::vector<std::string> names;
  std::vector<int> parents;  // parents precede children; -1 for the root
  std::vector<Vec3> heads;   // metres, world
  std::vector<Vec3> tails;
  std::vector<double>
      rolls;  // rad, of the undeformed shape, about the bone in its z-up authoring frame
  // world orientation of the bone at rest: column 1 runs from head to tail, column 0 and 2 by the
  // roll
  std::vector<Mat3> axes;
  VertexWeights weights;  // over the skin's vertices
};

// name: "default" (163 bones), "cmu_mb", "mixamo", "game_engine". Throws UnfitError for another
// name, InputError for bad files. Precondition: points has all #P rows of the package.
Rig read_rig(const BodyPackage& package, std::string_view name, const Points& points);

enum class BodyPart { head, neck, trunk, upper_arm, forearm, hand, thigh, shank, foot };

// The part of the body that each skin vertex belongs to, and its side (middle: head, neck, trunk):
// by the heaviest bone of the package's default rig. #skin
struct VertexPart {
  BodyPart part = BodyPart::trunk;
  Side side = Side::middle;
};
std::vector<VertexPart> vertex_parts(const BodyPackage& package);

}  // namespace ecorche::inline v1
