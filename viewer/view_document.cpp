#include "viewer/view_document.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/camera.h"

namespace ecorche {

int frame_of(const ViewSubject& subject, const ViewDocument& document) {
  return std::clamp(static_cast<int>(std::floor(document.time * subject.fps + 1e-6)), 0, subject.frames - 1);
}

void advance(const ViewSubject& subject, double seconds, ViewDocument& document) {
  const double end = subject.frames / subject.fps;
  if (!document.playing || !(end > 0)) return;
  document.time = std::fmod(document.time + seconds * document.speed, end);
  if (document.time < 0) document.time += end;
}

Camera camera_of(const ViewDocument& document, const Vec3f& root, float aspect) {
  Vec3f center = document.center;
  if (document.follow) center += Vec3f(root.x(), 0, root.z());
  Camera camera = orbit_camera(center, document.radius, document.azimuth, document.elevation, 0.45f, aspect);
  camera.far_plane = (camera.eye - center).norm() + 60;
  camera.near_plane = std::max(0.02f, 0.2f * ((camera.eye - center).norm() - 2));
  return camera;
}

Appearance appearance_of(const ViewDocument& document) {
  Appearance appearance;
  appearance.looks = {document.look};
  // Faint skin keeps its outline, so that the body's shape stays in sight.
  if (document.look.skin > 0 && document.look.skin < 1) appearance.looks[0].skin_edge = std::min(0.45f, 2 * document.look.skin);
  // Nothing is seen through whole skin: what lies beneath is not drawn, and cannot be picked.
  if (document.look.skin >= 1 && document.look.skin_dissolved <= 0) appearance.looks[0].muscles = appearance.looks[0].bones = 0;
  appearance.muscle_colors = document.muscle_colors;
  appearance.selected = document.selected;
  return appearance;
}

void orbit(float dx, float dy, ViewDocument& document) {
  constexpr float limit = 0.5f * std::numbers::pi_v<float> - 0.01f;
  document.azimuth = std::remainder(document.azimuth - 0.008f * dx, 2 * std::numbers::pi_v<float>);
  document.elevation = std::clamp(document.elevation + 0.008f * dy, -limit, limit);
}

void pan(float dx, float dy, int height, ViewDocument& document) {
  const Vec3f away(std::cos(document.elevation) * std::sin(document.azimuth), std::sin(document.elevation),
                   std::cos(document.elevation) * std::cos(document.azimuth));
  const Vec3f side = Vec3f(0, 1, 0).cross(away).normalized();
  const float metres = 2 * document.radius / static_cast<float>(std::max(height, 1));
  document.center += metres * (-dx * side + dy * away.cross(side));
}

void zoom(float clicks, ViewDocument& document) { document.radius = std::clamp(document.radius * std::pow(0.88f, clicks), 0.02f, 30.0f); }

}  // namespace ecorche
