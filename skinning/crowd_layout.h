// Private to the files that write crowds: where things lie in a person's file.
//
// Inverse bind matrices (float, column by column), then layer by layer positions (three 16-bit whole numbers and a pad, 8 bytes a vertex)
// and normals (three 8-bit whole numbers and a pad, 4 bytes). Little-endian, no header: it is a glTF buffer as it is.
#pragma once

#include <cstddef>

#include "skinning/crowd_io.h"

namespace ecorche {

struct CrowdLayout {
  std::array<std::size_t, 3> vertices{}, positions{}, normals{};
  std::size_t size = 0;
};

inline constexpr std::size_t kMatrixBytes = 64, kPositionBytes = 8, kNormalBytes = 4;

// The point that 0 0 0 stands for, in front of which a standing body lies evenly.
inline const Vec3 kCrowdCentre(0, 1, 0);

inline CrowdLayout crowd_layout(const CrowdMould& mould) {
  CrowdLayout out;
  out.size = kMatrixBytes * mould.skeleton.joints.size();
  for (std::size_t l = 0; l < mould.layers.size(); ++l) {
    out.vertices[l] = mould.layers[l].influences.size();
    out.positions[l] = out.size;
    out.normals[l] = out.positions[l] + kPositionBytes * out.vertices[l];
    out.size = out.normals[l] + kNormalBytes * out.vertices[l];
  }
  return out;
}

}  // namespace ecorche
