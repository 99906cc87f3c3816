// How tissues look wherever they are drawn or written: one list, so that pictures of ours and other
// programs' agree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

using Rgb = Eigen::Vector3f;  // sRGB in [0, 1], as on the screen

struct TissueLook {
  const char* name;
  Rgb color;
  float roughness;  // of the highlight, 0 mirror .. 1 matt
};

inline const TissueLook kSkinLook{"skin", Rgb(0.82f, 0.63f, 0.53f), 0.50f};
inline const TissueLook kBoneLook{"bone", Rgb(0.90f, 0.86f, 0.77f), 0.55f};
inline const TissueLook kCartilageLook{"cartilage", Rgb(0.78f, 0.85f, 0.86f), 0.40f};
inline const TissueLook kMuscleLook{"muscle", Rgb(0.62f, 0.24f, 0.20f), 0.38f};
inline const TissueLook kTendonLook{"tendon", Rgb(0.93f, 0.88f, 0.78f), 0.38f};
inline const TissueLook kEyeWhiteLook{"eye_white", Rgb(0.90f, 0.88f, 0.84f), 0.18f};
inline const TissueLook kIrisLook{"iris", Rgb(0.28f, 0.19f, 0.11f), 0.18f};
inline const TissueLook kPupilLook{"pupil", Rgb(0.03f, 0.025f, 0.02f), 0.18f};

// A muscle's own tone, a factor of its colour, so that no two neighbours are quite alike and the
// eye tells them apart.
inline constexpr float kLowestTone = 0.90f, kHighestTone = 1.10f;
float muscle_tone(int muscle);

// Of a muscle's surface at rest. belly: 1 on the belly, 0 on tendon.
Rgb muscle_color(int muscle, float belly);

// One flag a face: 1 where it is not wholly belly. belly: of the vertices that F indexes.
std::vector<char> tendon_faces(std::span<const float> belly, const Triangles& F);

// The faces whose flag is `flag`, in order.
Triangles faces_with(const Triangles& F, const std::vector<char>& flags, char flag);

// In proportion to light, as glTF has colours.
Rgb linear_light(const Rgb& color);

// Scattered whole numbers, and evenly in [0, 1).
std::uint32_t scrambled(std::uint32_t x);
float scattered(std::uint32_t x);

}  // namespace ecorche::inline v1
