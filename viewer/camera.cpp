#include "viewer/camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "anatomy/errors.h"
#include "viewer/glm_values.h"

namespace ecorche {
namespace {

struct NamedView {
  std::string_view name;
  float azimuth = 0, elevation = 0;  // degrees
};

constexpr NamedView named_views[] = {{"front", 0, 0},    {"back", 180, 0}, {"left", 90, 0},
                                     {"right", -90, 0},  {"top", 0, 90},   {"bottom", 0, -90},
                                     {"oblique", 35, 12}};

}  // namespace

Mat4f look_along(const Vec3f& eye, const Vec3f& forward, const Vec3f& up) {
  const glm::vec3 ahead = unit(forward), side = glm::cross(ahead, to_glm(up));
  glm::vec3 upward = to_glm(up);
  // Looking straight up or down, any horizontal direction serves as up.
  if (glm::dot(side, side) < 1e-8f)
    upward = std::abs(ahead.z) < 0.9f ? glm::vec3(0, 0, -1) : glm::vec3(1, 0, 0);
  const glm::mat4 turned = glm::lookAtRH(glm::vec3(0), ahead, upward);
  return to_eigen(glm::translate(turned, -to_glm(eye)));
}

Mat4f orthographic(float half_width, float half_height, float near_plane, float far_plane) {
  return to_eigen(
      glm::orthoRH_NO(-half_width, half_width, -half_height, half_height, near_plane, far_plane));
}

Mat4f view_matrix(const Camera& camera) {
  return look_along(camera.eye, camera.target - camera.eye, camera.up);
}

Mat4f projection_matrix(const Camera& camera, float aspect) {
  const float n = camera.near_plane, f = camera.far_plane;
  const glm::mat4 centered = camera.ortho_height > 0
                                 ? to_glm(orthographic(0.5f * camera.ortho_height * aspect,
                                                       0.5f * camera.ortho_height, n, f))
                                 : glm::perspectiveRH_NO(camera.fov_y, aspect, n, f);
  const glm::vec3 shift(camera.shift.x(), camera.shift.y(), 0);
  return to_eigen(glm::translate(glm::mat4(1), shift) * centered);
}

float narrow_angle(float fov_y, float aspect) {
  return std::min(fov_y, 2 * std::atan(std::tan(0.5f * fov_y) * aspect));
}

Camera orbit_camera(const Vec3f& center, float radius, float azimuth, float elevation, float fov_y,
                    float aspect) {
  if (!(radius > 0) || !(fov_y > 0) || !(fov_y < std::numbers::pi_v<float>))
    throw std::invalid_argument(
        fmt::format("orbit_camera: radius {} and field of view {} must be above 0", radius, fov_y));
  Camera camera;
  const float distance = radius / std::sin(0.5f * narrow_angle(fov_y, aspect));
  camera.eye = center + distance * away_from({azimuth, elevation});
  camera.target = center;
  camera.fov_y = fov_y;
  camera.near_plane = std::max(0.05f * radius, distance - 3 * radius);
  camera.far_plane = distance + 20 * radius;
  return camera;
}

Vec3f away_from(const ViewAngles& angles) {
  return {std::cos(angles.elevation) * std::sin(angles.azimuth), std::sin(angles.elevation),
          std::cos(angles.elevation) * std::cos(angles.azimuth)};
}

Vec3f upward_from(const ViewAngles& angles) {
  return {-std::sin(angles.elevation) * std::sin(angles.azimuth), std::cos(angles.elevation),
          -std::sin(angles.elevation) * std::cos(angles.azimuth)};
}

float distance_to_see(std::span<const Vec3f> points, const Vec3f& target, const Vec3f& away,
                      float fov_y, float aspect, float margin) {
  const Mat4f seen = look_along(Vec3f::Zero(), -away, {0, 1, 0});
  const Vec3f side = seen.block<1, 3>(0, 0).transpose(),
              upward = seen.block<1, 3>(1, 0).transpose();
  const float tan_y = std::tan(0.5f * fov_y) * (1 - margin), tan_x = tan_y * aspect;
  float distance = 0;
  for (const Vec3f& p : points) {
    const Vec3f q = p - target;
    distance = std::max(distance, q.dot(away) + std::max(std::abs(q.dot(side)) / tan_x,
                                                         std::abs(q.dot(upward)) / tan_y));
  }
  return distance;
}

ViewAngles view_angles(std::string_view name) {
  constexpr float degree = std::numbers::pi_v<float> / 180;
  for (const auto& [known, azimuth, elevation] : named_views)
    if (name == known) return {azimuth * degree, elevation * degree};
  float angles[2] = {0, 0};
  const std::size_t comma = name.find(',');
  bool good = comma != std::string_view::npos;
  if (good) {
    const std::string_view texts[2] = {name.substr(0, comma), name.substr(comma + 1)};
    for (int i = 0; i < 2 && good; ++i) {
      const auto [end, code] =
          std::from_chars(texts[i].data(), texts[i].data() + texts[i].size(), angles[i]);
      good = code == std::errc() && end == texts[i].data() + texts[i].size() &&
             std::isfinite(angles[i]);
    }
  }
  if (!good) throw UsageError(fmt::format("view '{}': expected {}", name, view_names()));
  return {angles[0] * degree, angles[1] * degree};
}

std::string view_names() {
  std::string names;
  for (const NamedView& view : named_views) names += fmt::format("{}, ", view.name);
  return names + "or AZIMUTH,ELEVATION in degrees";
}

}  // namespace ecorche
