// Balls to draw, for tests of pictures.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "viewer/draw_list.h"

namespace ecorche {

// Of radius 1, about the origin.
inline DrawMesh sphere(int rings) {
  DrawMesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const float t = std::numbers::pi_v<float> * float(i) / float(rings);
      const float p = 2 * std::numbers::pi_v<float> * float(j) / float(around);
      mesh.positions.emplace_back(std::sin(t) * std::sin(p), std::cos(t),
                                  std::sin(t) * std::cos(p));
    }
  mesh.normals = mesh.positions;
  auto at = [&](int i, int j) { return std::uint32_t(i * around + j % around); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return mesh;
}

inline DrawItem ball(const Vec3f& color, std::uint32_t part, const Vec3f& center = Vec3f::Zero(),
                     float radius = 1) {
  DrawItem item;
  item.surface.color = color;
  item.part = part;
  item.X_WM.topLeftCorner<3, 3>() *= radius;
  item.X_WM.topRightCorner<3, 1>() = center;
  return item;
}

}  // namespace ecorche
