#include "viewer/window/view_document.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/camera.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

constexpr float room_angle = 0.45f;   // rad, of the room's height as the eye sees it
constexpr double kFrameShare = 1e-6;  // of a frame; so near to the next one it is shown
constexpr float free_margin = 0.04f;

float aspect_of(const ViewRoom& room) {
  return std::max(room.width, 1.0f) / std::max(room.height, 1.0f);
}

}  // namespace

int frame_of(const ViewSubject& subject, const ViewDocument& document) {
  return std::clamp(int(std::floor(document.time * subject.fps + kFrameShare)), 0,
                    subject.frames - 1);
}

void advance(const ViewSubject& subject, double seconds, ViewDocument& document) {
  const double begin = document.in.value_or(0) / subject.fps,
               end = (document.out.value_or(subject.frames - 1) + 1) / subject.fps;
  if (!document.playing || !(end > begin)) return;
  const double gone = std::fmod(document.time - begin + seconds * document.speed, end - begin);
  document.time = begin + (gone < 0 ? gone + end - begin : gone);
  if (document.time * subject.fps + kFrameShare >= end * subject.fps) document.time = begin;
}

void mark(const ViewSubject& subject, std::optional<int> ViewDocument::*which,
          ViewDocument& document) {
  const int frame = frame_of(subject, document);
  std::optional<int>& own = document.*which;
  own = own == frame ? std::nullopt : std::optional(frame);
  if (document.in && document.out && *document.in > *document.out)
    (which == &ViewDocument::in ? document.out : document.in).reset();
}

void go_to(const ViewSubject& subject, int frame, ViewDocument& document) {
  document.playing = false;
  document.time = std::clamp(frame, 0, subject.frames - 1) / subject.fps;
}

Camera camera_of(const ViewDocument& document, const Vec3f& root, float width, float height,
                 const ViewRoom& room) {
  Vec3f center = document.center;
  if (document.follow) center += Vec3f(root.x(), 0, root.z());
  Camera camera = orbit_camera(center, document.radius, document.azimuth, document.elevation,
                               room_angle, aspect_of(room));
  camera.up = upward_from({document.azimuth, document.elevation});
  const float distance = (camera.eye - center).norm();
  camera.far_plane = distance + 60;
  camera.near_plane = std::max(0.02f, 0.2f * (distance - 2));
  // The room is a part of the window, which sees more.
  const float share = std::max(room.height, 1.0f) / std::max(height, 1.0f);
  const float half_height = std::tan(0.5f * room_angle) / share;
  camera.fov_y = 2 * std::atan(half_height);
  camera.shift = {2 * (room.x + 0.5f * room.width) / std::max(width, 1.0f) - 1,
                  1 - 2 * (room.y + 0.5f * room.height) / std::max(height, 1.0f)};
  if (!document.parallel) return camera;
  // From farther off, so that nothing lies behind the eye.
  constexpr float far_off = 20;  // m
  camera.ortho_height = 2 * distance * half_height;
  camera.eye += far_off * (camera.eye - center).normalized();
  camera.near_plane = 0.05f;
  camera.far_plane += far_off;
  return camera;
}

Appearance appearance_of(const ViewDocument& document) {
  Appearance appearance;
  appearance.looks = {document.look};
  // Faint skin keeps its outline, so that the body's shape stays in sight.
  if (document.look.skin > 0 && document.look.skin < 1)
    appearance.looks[0].skin_edge = std::min(0.45f, 2 * document.look.skin);
  // Opaque skin hides all layers beneath, which are then neither drawn nor picked.
  const bool whole = document.look.skin >= 1 && document.look.skin_dissolved <= 0 &&
                     document.section.kind == SectionPlane::Kind::none &&
                     !is_hidden(document, kSkinPart);
  if (whole) appearance.looks[0].muscles = appearance.looks[0].bones = 0;
  appearance.muscle_colors = document.muscle_colors;
  appearance.selected = document.selected;
  appearance.hidden = document.hidden;
  return appearance;
}

void frame_figure(const ViewSubject& subject, const ViewRoom& room, ViewDocument& document) {
  if (subject.bounds.isEmpty()) return;
  std::vector<Vec3f> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(subject.bounds.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)));
  document.center = subject.bounds.center();
  const float aspect = aspect_of(room);
  const ViewAngles angles{document.azimuth, document.elevation};
  float distance =
      distance_to_see(corners, document.center, away_from(angles), room_angle, aspect, free_margin);
  if (document.parallel) {  // near things are no larger then
    const Vec3f up = upward_from(angles), side = up.cross(away_from(angles));
    float half = 0;
    for (const Vec3f& p : corners)
      half = std::max({half, std::abs((p - document.center).dot(up)),
                       std::abs((p - document.center).dot(side)) / aspect});
    distance = half / (1 - free_margin) / std::tan(0.5f * room_angle);
  }
  document.radius = distance * std::sin(0.5f * narrow_angle(room_angle, aspect));
}

void frame_points(const std::vector<Vec3f>& points, ViewDocument& document) {
  Eigen::AlignedBox3f box;
  for (const Vec3f& p : points) box.extend(p);
  if (box.isEmpty()) return;
  document.framed = false;
  document.center = box.center();
  document.radius = std::max(0.02f, 0.55f * box.diagonal().norm());
}

void orbit(float dx, float dy, ViewDocument& document) {
  constexpr float limit = 0.5f * std::numbers::pi_v<float>;
  document.azimuth = std::remainder(document.azimuth - 0.008f * dx, 2 * std::numbers::pi_v<float>);
  document.elevation = std::clamp(document.elevation + 0.008f * dy, -limit, limit);
}

void pan(float dx, float dy, float height, ViewDocument& document) {
  const Vec3f away = away_from({document.azimuth, document.elevation}),
              up = upward_from({document.azimuth, document.elevation});
  const float metres = 2 * document.radius / std::max(height, 1.0f);
  document.center += metres * (-dx * up.cross(away) + dy * up);
  document.framed = false;
}

void zoom(float clicks, ViewDocument& document) {
  document.radius = std::clamp(document.radius * std::pow(0.88f, clicks), 0.02f, 30.0f);
  document.framed = false;
}

std::pair<double, double> section_range(const ViewSubject& subject, SectionPlane::Kind kind) {
  using Kind = SectionPlane::Kind;
  if (kind == Kind::across) return {0, 1};
  if (subject.bounds.isEmpty())
    return kind == Kind::transverse ? std::pair(0, 2) : std::pair(-1, 1);
  const int axis = kind == Kind::transverse ? 1 : kind == Kind::frontal ? 2 : 0;
  return {subject.bounds.min()[axis], subject.bounds.max()[axis]};
}

void next_section(const ViewSubject& subject, ViewDocument& document) {
  using Kind = SectionPlane::Kind;
  Kind& kind = document.section.kind;
  kind = kind == Kind::none         ? Kind::transverse
         : kind == Kind::transverse ? Kind::frontal
         : kind == Kind::frontal    ? Kind::sagittal
                                    : Kind::none;
  const auto [low, high] = section_range(subject, kind);
  const int axis = kind == Kind::transverse ? 1 : kind == Kind::frontal ? 2 : 0;
  document.section.place = std::clamp(double(document.center[axis]), low, high);
}

void move_section(const ViewSubject& subject, double millimetres, ViewDocument& document) {
  SectionPlane& section = document.section;
  if (section.kind == SectionPlane::Kind::none) return;
  const auto [low, high] = section_range(subject, section.kind);
  double& value = section.kind == SectionPlane::Kind::across ? section.share : section.place;
  value = std::clamp(value + 1e-3 * millimetres, low, high);
}

bool is_hidden(const ViewDocument& document, std::uint32_t part) {
  return std::ranges::binary_search(document.hidden, part);
}

void set_hidden(std::uint32_t part, bool hidden, ViewDocument& document) {
  const auto at = std::ranges::lower_bound(document.hidden, part);
  const bool there = at != document.hidden.end() && *at == part;
  if (hidden && !there) document.hidden.insert(at, part);
  if (!hidden && there) document.hidden.erase(at);
}

void isolate(const Anatomy& anatomy, std::uint32_t part, ViewDocument& document) {
  std::vector<std::uint32_t> others = all_parts(anatomy);
  std::erase(others, part);
  std::ranges::sort(others);
  document.hidden = document.hidden == others ? std::vector<std::uint32_t>() : others;
}

}  // namespace ecorche
