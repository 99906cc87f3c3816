#include "viewer/gl/picture_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "viewer/camera.h"

namespace ecorche {
namespace {

Eigen::AlignedBox3f moved(const Eigen::AlignedBox3f& box, const Mat4f& by) {
  Eigen::AlignedBox3f out;
  if (box.isEmpty()) return out;
  for (int k = 0; k < 8; ++k)
    out.extend(
        (by * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)).homogeneous()).head<3>());
  return out;
}

// What shadows have to cover: the list's focus, else the box around everything that casts one.
Ball focus_ball(const DrawList& list, const GpuMeshes& meshes) {
  if (list.focus_radius > 0) return {list.focus, list.focus_radius};
  Eigen::AlignedBox3f all;
  for (const DrawItem& item : list.items)
    if (item.casts_shadow) all.extend(moved(meshes.box(item.mesh), item.X_WM));
  if (all.isEmpty()) return {};
  return {all.center(), std::max(0.5f * all.diagonal().norm(), 1e-6f)};
}

// The pixels that hold the given points, with a margin; all of the picture where one is at or
// behind the eye.
PixelWindow pixels_around(std::span<const Vec3f> points, const Mat4f& view_projection, int width,
                          int height) {
  Eigen::AlignedBox2f all;
  for (const Vec3f& p : points) {
    const Vec4f clip = view_projection * p.homogeneous();
    if (clip.w() <= 1e-6f) return {0, 0, width, height};
    all.extend(Eigen::Vector2f(clip.head<2>() / clip.w()));
  }
  if (all.isEmpty()) return {};
  constexpr int margin = 3;
  auto pixel = [](float ndc, int size) {
    return int(std::clamp(0.5f * (ndc + 1), -1.0f, 2.0f) * float(size));
  };
  const int x0 = std::clamp(pixel(all.min().x(), width) - margin, 0, width),
            x1 = std::clamp(pixel(all.max().x(), width) + margin, 0, width);
  const int y0 = std::clamp(pixel(all.min().y(), height) - margin, 0, height),
            y1 = std::clamp(pixel(all.max().y(), height) + margin, 0, height);
  return {x0, y0, x1 - x0, y1 - y0};
}

// Corners of the boxes around all items; a bone's or belly's box is tighter than one around
// everything.
std::vector<Vec3f> item_corners(const DrawList& list, const GpuMeshes& meshes) {
  std::vector<Vec3f> corners;
  for (const DrawItem& item : list.items) {
    const Eigen::AlignedBox3f& box = meshes.box(item.mesh);
    if (box.isEmpty()) continue;
    for (int k = 0; k < 8; ++k)
      corners.emplace_back(
          (item.X_WM * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)).homogeneous())
              .head<3>());
  }
  return corners;
}

PixelWindow grown(const PixelWindow& w, int by, int width, int height) {
  if (w.width == 0 || w.height == 0) return {};
  const int x0 = std::max(w.x - by, 0), y0 = std::max(w.y - by, 0);
  return {x0, y0, std::min(w.x + w.width + by, width) - x0,
          std::min(w.y + w.height + by, height) - y0};
}

// Of the ball's radius: how far ambient occlusion looks.
constexpr float occlusion_share = 0.11f;

float occlusion_pixels(const PictureFrame& frame, const Camera& camera, int height) {
  const float distance =
      std::max((camera.eye - frame.ball.center).norm() - frame.ball.radius, camera.near_plane);
  const float seen =
      camera.ortho_height > 0 ? camera.ortho_height : 2 * distance * std::tan(0.5f * camera.fov_y);
  return 1.5f * frame.occlusion_reach / seen * float(height);
}

}  // namespace

PictureFrame make_picture_frame(const DrawList& list, const GpuMeshes& meshes, int width,
                                int height, int shadow_size) {
  PictureFrame frame;
  const Mat4f view = view_matrix(list.camera);
  frame.view_projection = projection_matrix(list.camera, float(width) / float(height)) * view;
  frame.unproject = frame.view_projection.inverse();
  frame.ball = focus_ball(list, meshes);
  std::vector<Vec3f> corners = item_corners(list, meshes);
  frame.figure = pixels_around(corners, frame.view_projection, width, height);
  const Eigen::Matrix3f from_eye = view.topLeftCorner<3, 3>().transpose();
  frame.key = list.lighting.key_direction.normalized();
  if (list.lighting.follows_camera) frame.key = from_eye * frame.key;
  if (frame.key.y() < -0.05f) {
    for (Vec3f& p : corners) p += (list.ground.height - p.y()) / frame.key.y() * frame.key;
    frame.shadow = pixels_around(corners, frame.view_projection, width, height);
  } else {
    frame.shadow = {0, 0, width, height};
  }
  // The rim light stands behind the subject, above and on the side that the key leaves dark.
  const float side = (from_eye.col(0).dot(frame.key) > 0) ? -1.0f : 1.0f;
  frame.rim = (from_eye * Vec3f(side * 0.6f, -0.5f, 0.7f)).normalized();
  const float r = frame.ball.radius;
  frame.shadow_view_projection =
      orthographic(r, r, 0, 4 * r) *
      look_along(frame.ball.center - 2 * r * frame.key, frame.key, {0, 1, 0});
  frame.shadow_texel_world = shadow_size > 0 ? 2 * r / float(shadow_size) : 0;
  frame.occlusion_reach = occlusion_share * r;
  frame.shaded =
      grown(frame.figure, int(occlusion_pixels(frame, list.camera, height)) + 2, width, height);
  return frame;
}

}  // namespace ecorche
