#include "viewer/window/window_tool.h"

#include <algorithm>

#include "viewer/camera.h"

namespace ecorche {

ViewProjection::ViewProjection(const Camera& camera, float width, float height)
    : width_(std::max(width, 1.0f)), height_(std::max(height, 1.0f)) {
  const Mat4f view = view_matrix(camera);
  clip_from_world_ = projection_matrix(camera, width_ / height_) * view;
  right_ = view.row(0).head<3>().transpose();
  up_ = view.row(1).head<3>().transpose();
}

std::optional<Vec2f> ViewProjection::pixel(const Vec3f& place) const {
  const Eigen::Vector4f clip = clip_from_world_ * place.homogeneous();
  if (clip.w() <= 1e-4f) return std::nullopt;
  return Vec2f((0.5f + 0.5f * clip.x() / clip.w()) * width_,
               (0.5f - 0.5f * clip.y() / clip.w()) * height_);
}

float ViewProjection::depth(const Vec3f& place) const {
  const Eigen::Vector4f clip = clip_from_world_ * place.homogeneous();
  return clip.z() / clip.w();
}

Vec3f ViewProjection::moved(const Vec3f& place, float dx, float dy) const {
  // What a pixel is worth there, by what a millimetre to the side does.
  constexpr float step = 1e-3f;
  const auto at = pixel(place), aside = pixel(place + step * right_);
  if (!at || !aside) return Vec3f::Zero();
  const float pixels = std::max((*aside - *at).norm(), 1e-6f);
  return step / pixels * (dx * right_ - dy * up_);
}

}  // namespace ecorche
