#include "anatomy/base_mesh/tissue_look.h"

#include <cmath>

namespace ecorche::inline v1 {

std::uint32_t scrambled(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

float scattered(std::uint32_t x) { return float(scrambled(x) >> 8) / 16777216.0f; }

float muscle_tone(int muscle) {
  return kLowestTone + (kHighestTone - kLowestTone) * scattered(std::uint32_t(muscle) + 17);
}

Rgb muscle_color(int muscle, float belly) {
  return kTendonLook.color + belly * (muscle_tone(muscle) * kMuscleLook.color - kTendonLook.color);
}

std::vector<char> tendon_faces(std::span<const float> belly, const Triangles& F) {
  constexpr float kWhole = 0.999f;
  std::vector<char> out;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const auto whole = [&](int corner) { return belly[F(f, corner)] > kWhole; };
    out.push_back(whole(0) && whole(1) && whole(2) ? 0 : 1);
  }
  return out;
}

Triangles faces_with(const Triangles& F, const std::vector<char>& flags, char flag) {
  std::vector<int> corners;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    if (flags[f] == flag) corners.insert(corners.end(), {F(f, 0), F(f, 1), F(f, 2)});
  return Eigen::Map<const Triangles>(corners.data(), Eigen::Index(corners.size() / 3), 3);
}

Rgb linear_light(const Rgb& color) {
  return color.unaryExpr(
      [](float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); });
}

}  // namespace ecorche::inline v1
