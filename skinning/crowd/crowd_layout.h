// Layout of a person's file. Private to the room.
//
// Inverse bind matrices (float, column by column); the person's unit in metres and joint frames
// (one float; 18 a joint: axes column by column, zero, min, max); the skin's joints (four bytes a
// vertex) and weights (four 16-bit integers); then layer by layer positions (three 16-bit whole
// numbers and a pad, 8 bytes a vertex) and normals (three 8-bit whole numbers and a pad, 4 bytes).
// Little-endian, no header: it is a glTF buffer as it is, in which glTF knows nothing of the joint
// frames.
//
// Positions are -1 .. 1 units from the body's middle. The unit is a metre, and more only for those
// who are too tall for it. Middle and unit are those of a node above the joints and not in the
// inverse bind matrices, where glTF would have them, too: programs that make a skeleton's rest pose
// from these matrices know no scale in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/binding.h"
#include "skinning/crowd/crowd_prototype.h"

namespace ecorche::inline v1 {

struct CrowdLayout {
  struct Layer {
    std::size_t vertices = 0, positions = 0, normals = 0;
  };
  std::size_t unit = 0, frames = 0, joints = 0, weights = 0, size = 0;
  std::vector<Layer> layers;
};

inline constexpr std::size_t kMatrixBytes = 64, kFrameFloats = 18, kJointBytes = 4,
                             kWeightBytes = 8, kPositionBytes = 8, kNormalBytes = 4;

// The body's middle, world.
inline const Vec3 kCrowdMiddle(0, 1, 0);

CrowdLayout crowd_layout(const CrowdPrototype& prototype);

// Skin weights as glTF stores them: 16-bit integers that sum to 65535 exactly; the remainder of the
// rounding goes to the largest.
struct QuantizedWeights {
  std::vector<std::uint8_t> joints;    // 4 a vertex
  std::vector<std::uint16_t> weights;  // as many
};
QuantizedWeights quantize_weights(std::span<const std::array<Influence, 4>> influences);

}  // namespace ecorche::inline v1
