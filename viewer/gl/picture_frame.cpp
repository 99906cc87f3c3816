#include "viewer/gl/picture_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>
#include <vector>

#include "viewer/camera.h"
#include "viewer/glm_values.h"

namespace ecorche {
namespace {

// World positions of the corners of a box in an item's own frame.
std::array<glm::vec3, 8> corners_of(const Eigen::AlignedBox3f& box, const DrawItem& item) {
  const glm::mat4 X_WM = to_glm(item.X_WM);
  const glm::vec3 low = to_glm(box.min()), high = to_glm(box.max());
  std::array<glm::vec3, 8> corners;
  for (int k = 0; k < 8; ++k)
    corners[k] =
        X_WM * glm::vec4(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z, 1);
  return corners;
}

// Ball that shadows have to cover: the list's focus, else one around everything that casts a
// shadow.
Ball focus_ball(const DrawList& list, const GpuMeshes& meshes) {
  if (list.focus_radius > 0) return {to_glm(list.focus), list.focus_radius};
  Eigen::AlignedBox3f all;
  for (const DrawItem& item : list.items) {
    const Eigen::AlignedBox3f& box = meshes.box(item.mesh);
    if (!item.casts_shadow || box.isEmpty()) continue;
    for (const glm::vec3& corner : corners_of(box, item)) all.extend(to_eigen(corner));
  }
  if (all.isEmpty()) return {};
  return {to_glm(Vec3f(all.center())), std::max(0.5f * all.diagonal().norm(), 1e-6f)};
}

// Pixels that hold the given points, with a margin; the whole picture if a point is at or behind
// the eye.
PixelWindow pixels_around(std::span<const glm::vec3> points, const glm::mat4& view_projection,
                          int width, int height) {
  if (points.empty()) return {};
  constexpr float far_away = std::numeric_limits<float>::max();
  glm::vec2 low(far_away), high(-far_away);  // normalized device coordinates
  for (const glm::vec3& p : points) {
    const glm::vec4 clip = view_projection * glm::vec4(p, 1);
    if (clip.w <= 1e-6f) return {0, 0, width, height};
    const glm::vec2 seen = glm::vec2(clip) / clip.w;
    low = glm::min(low, seen);
    high = glm::max(high, seen);
  }
  constexpr int margin = 3;
  auto pixel = [](float ndc, int size) {
    return int(std::clamp(0.5f * (ndc + 1), -1.0f, 2.0f) * float(size));
  };
  const int x0 = std::clamp(pixel(low.x, width) - margin, 0, width),
            x1 = std::clamp(pixel(high.x, width) + margin, 0, width);
  const int y0 = std::clamp(pixel(low.y, height) - margin, 0, height),
            y1 = std::clamp(pixel(high.y, height) + margin, 0, height);
  return {x0, y0, x1 - x0, y1 - y0};
}

// Corners of the boxes around all items. One box per bone or belly is tighter than one around
// everything.
std::vector<glm::vec3> item_corners(const DrawList& list, const GpuMeshes& meshes) {
  std::vector<glm::vec3> corners;
  for (const DrawItem& item : list.items) {
    const Eigen::AlignedBox3f& box = meshes.box(item.mesh);
    if (box.isEmpty()) continue;
    const std::array<glm::vec3, 8> own = corners_of(box, item);
    corners.insert(corners.end(), own.begin(), own.end());
  }
  return corners;
}

PixelWindow grown(const PixelWindow& w, int by, int width, int height) {
  if (w.width == 0 || w.height == 0) return {};
  const int x0 = std::max(w.x - by, 0), y0 = std::max(w.y - by, 0);
  return {x0, y0, std::min(w.x + w.width + by, width) - x0,
          std::min(w.y + w.height + by, height) - y0};
}

// Reach of ambient occlusion, as a share of the ball's radius.
constexpr float occlusion_share = 0.11f;

float occlusion_pixels(const PictureFrame& frame, const Camera& camera, int height) {
  const float distance = std::max(
      glm::distance(to_glm(camera.eye), frame.ball.center) - frame.ball.radius, camera.near_plane);
  const float seen =
      camera.ortho_height > 0 ? camera.ortho_height : 2 * distance * std::tan(0.5f * camera.fov_y);
  return 1.5f * frame.occlusion_reach / seen * float(height);
}

// The side of the cut that is farther from the eye.
glm::vec4 kept_side(const Vec4f& cut, const Camera& camera) {
  const Vec3f normal = cut.head<3>();
  const float beside = camera.ortho_height > 0 ? normal.dot(camera.eye - camera.target)
                                               : normal.dot(camera.eye) - cut.w();
  return beside > 0 ? glm::vec4(-to_glm(normal), cut.w()) : glm::vec4(to_glm(normal), -cut.w());
}

}  // namespace

PictureFrame make_picture_frame(const DrawList& list, const GpuMeshes& meshes, int width,
                                int height, int shadow_size) {
  PictureFrame frame;
  const glm::mat4 view = to_glm(view_matrix(list.camera));
  frame.view_projection =
      to_glm(projection_matrix(list.camera, float(width) / float(height))) * view;
  frame.unproject = glm::inverse(frame.view_projection);
  frame.ball = focus_ball(list, meshes);
  if (list.cut) frame.kept = kept_side(*list.cut, list.camera);
  std::vector<glm::vec3> corners = item_corners(list, meshes);
  frame.figure = pixels_around(corners, frame.view_projection, width, height);
  const glm::mat3 from_eye = glm::transpose(glm::mat3(view));
  frame.key = unit(list.lighting.key_direction);
  if (list.lighting.follows_camera) frame.key = from_eye * frame.key;
  if (frame.key.y < -0.05f) {
    for (glm::vec3& p : corners) p += (list.ground.height - p.y) / frame.key.y * frame.key;
    frame.shadow = pixels_around(corners, frame.view_projection, width, height);
  } else {
    frame.shadow = {0, 0, width, height};
  }
  // The rim light stands behind the subject, above and on the side that the key leaves dark.
  const float side = glm::dot(from_eye[0], frame.key) > 0 ? -1.0f : 1.0f;
  frame.rim = glm::normalize(from_eye * glm::vec3(side * 0.6f, -0.5f, 0.7f));
  const float r = frame.ball.radius;
  frame.shadow_view_projection = to_glm(orthographic(r, r, 0, 4 * r)) *
                                 to_glm(look_along(to_eigen(frame.ball.center - 2 * r * frame.key),
                                                   to_eigen(frame.key), {0, 1, 0}));
  frame.shadow_texel_world = shadow_size > 0 ? 2 * r / float(shadow_size) : 0;
  frame.occlusion_reach = occlusion_share * r;
  frame.shaded =
      grown(frame.figure, int(occlusion_pixels(frame, list.camera, height)) + 2, width, height);
  return frame;
}

}  // namespace ecorche
