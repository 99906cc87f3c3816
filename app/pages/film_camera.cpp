#include "app/pages/film_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "anatomy/errors.h"
#include "morph/measures/measure_table.h"
#include "skinning/motion/sample_motion.h"
#include "viewer/camera.h"
#include "viewer/follow_camera.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

constexpr float kJointBall = 0.13f;  // m, seen around a joint or a landmark
constexpr float kMargin = 1.25f;     // of a part's ball
constexpr float kFieldOfView = 0.35f;
constexpr float kFree = 0.08f;  // of half the picture, at each edge

// Target of a close-up: points of its parts in every frame, and the least radius of the ball
// around them.
struct Target {
  std::vector<int> bones, muscles, joints, vertices;
  float least = 0;  // m
};

bool is_named(const std::string& known, const std::string& asked) {
  return known == asked || known == asked + "_l" || known == asked + "_r";
}

// The base mesh's vertices of a landmark of data/body/landmarks.csv, on the side asked for, or on
// both.
std::vector<int> vertices_named(const Assets& assets, const Character& character,
                                const std::string& name, std::vector<std::string>& known) {
  const BodyPackage package = read_body_package(assets);
  if (character.own || character.body.skin.V.rows() != package.skin_size) return {};
  std::vector<int> vertices;
  for (const SkinLandmark& landmark :
       read_measure_table(package, package.tables / "body").landmarks) {
    known.push_back(landmark.id);
    const int other = package.mirror[landmark.vertex];
    if (name == landmark.id || name == landmark.id + "_l") vertices.push_back(landmark.vertex);
    if ((name == landmark.id || name == landmark.id + "_r") && other != landmark.vertex)
      vertices.push_back(other);
  }
  return vertices;
}

Target find_target(const Assets& assets, const Character& character, const std::string& name) {
  const Anatomy& anatomy = character.anatomy;
  Target target;
  const std::vector<std::uint32_t> parts = parts_named(anatomy, name);
  const bool exact = std::ranges::any_of(
      parts, [&](std::uint32_t part) { return is_named(part_name(anatomy, part), name); });
  std::vector<std::string> known;
  for (std::size_t j = 0; j < anatomy.skeleton.joints.size(); ++j) {
    known.push_back(anatomy.skeleton.joints[j].name);
    if (!exact && is_named(known.back(), name)) target.joints.push_back(int(j));
  }
  if (target.joints.empty())
    for (const std::uint32_t number : parts) {
      const Part part = part_of(number);
      if (part.kind == Part::Kind::bone) target.bones.push_back(part.index);
      if (part.kind == Part::Kind::muscle) target.muscles.push_back(part.index);
    }
  if (target.joints.empty() && target.bones.empty() && target.muscles.empty())
    target.vertices = vertices_named(assets, character, name, known);
  if (target.bones.empty() && target.muscles.empty()) target.least = kJointBall;
  if (!target.joints.empty() || !target.vertices.empty() || target.least == 0) return target;
  for (const std::uint32_t part : all_parts(anatomy))
    if (const Part::Kind kind = part_of(part).kind;
        kind == Part::Kind::bone || kind == Part::Kind::muscle)
      known.push_back(part_name(anatomy, part));
  const std::string near = nearest_name(name, known);
  throw UsageError(
      fmt::format("--look-at: nothing is called '{}'{}; name a bone, a muscle, a region of "
                  "muscles, a joint or a landmark of the skin",
                  name, near.empty() ? "" : fmt::format(": did you mean '{}'?", near)));
}

// Points of a target in one frame. `ranges`: of the anatomy's strips. Only landmarks need the
// skin.
void add_points(const Anatomy& anatomy, const std::vector<Vec3>& origins,
                const std::vector<SliceRange>& ranges, const Target& target,
                const CharacterState& frame, std::vector<Vec3f>& out) {
  out.clear();
  for (const int j : target.joints) out.push_back(frame.posed.X_WJ[j].translation().cast<float>());
  for (const int b : target.bones) {
    const Bone& bone = anatomy.bones[b];
    const std::size_t j = bone.joint;
    for (Eigen::Index i = 0; i < bone.mesh.V.rows(); ++i)
      out.push_back(
          (frame.posed.X_WJ[j] * (bone.mesh.V.row(i).transpose() - origins[j])).cast<float>());
  }
  for (const SliceRange& range : ranges) {
    if (!std::ranges::binary_search(target.muscles, range.muscle)) continue;
    for (int k = range.begin; k < range.end; ++k) {
      const Ellipse& slice = frame.posed.slices[k];
      for (const double side : {-1.0, 1.0})
        for (int axis = 0; axis < 2; ++axis)
          out.push_back(
              (slice.center + side * slice.radii[axis] * slice.axes.col(axis)).cast<float>());
    }
  }
  for (const int v : target.vertices) out.emplace_back(&frame.skin.positions[4 * v]);
}

// View from the side on which the skin is nearest to the target: its back from behind.
ViewAngles best_seen_from(const Points& skin, const std::vector<Vec3f>& points) {
  Vec3 outward = Vec3::Zero();
  constexpr std::size_t kLooked = 64;  // points
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / kLooked) {
    const Vec3 p = points[i].cast<double>();
    Eigen::Index nearest = 0;
    (skin.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    const Vec3 to_skin = skin.row(nearest).transpose() - p;
    if (to_skin.norm() > 1e-6) outward += to_skin.normalized();
  }
  constexpr float kSteepest = 0.45f;  // rad
  const double level = std::hypot(outward.x(), outward.z());
  // The two sides of the body cancel out, so that the view is from the front or from behind.
  if (level < 1e-3) return {};
  return {float(std::atan2(outward.x(), outward.z())),
          std::clamp(float(std::atan2(outward.y(), level)), -kSteepest, kSteepest)};
}

struct Tracked {
  std::vector<Vec3f> centers;  // of a ball, a moment
  float radius = 0;            // that holds the target in every frame
  ViewAngles angles;           // where it is seen best, at rest
};

Tracked track(const Actor& actor, const Motion& motion, std::span<const double> moments,
              const Target& target) {
  const Anatomy& anatomy = actor.character.anatomy;
  const std::vector<Vec3> origins = rest_positions(anatomy.skeleton);
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  Tracked tracked;
  ActorState frame(actor);
  std::vector<Vec3f> points;
  const auto look = [&](const Pose& pose) {
    pose_muscles(actor.muscles, anatomy.skeleton, pose, frame.posed, frame.contact);
    if (!target.vertices.empty()) evaluate_posed_skin(actor, SkinMethod::anchors, frame);
    add_points(anatomy, origins, ranges, target, frame, points);
  };
  look(rest_pose(anatomy.skeleton));
  tracked.angles = best_seen_from(actor.character.body.skin.V, points);
  Pose pose;
  for (const double at : moments) {
    pose_at(motion, at, pose);
    look(pose);
    Eigen::AlignedBox3f box;
    for (const Vec3f& p : points) box.extend(p);
    tracked.centers.push_back(box.center());
    tracked.radius = std::max({tracked.radius, 0.5f * box.diagonal().norm(), target.least});
  }
  return tracked;
}

// Points that the camera has to keep in view: a sample of the skin of every figure in every
// frame, and the ground beneath. The skin is not settled for this.
std::vector<std::vector<Vec3f>> figures_of(const Actor& actor, const Motion& motion,
                                           std::span<const double> moments,
                                           std::span<const Look> looks) {
  constexpr int stride = 29;
  std::vector<std::vector<Vec3f>> figures;
  ActorState frame(actor);
  const SkinMethod method =
      actor.method == SkinMethod::ecorche ? SkinMethod::anchors : actor.method;
  Pose pose;
  for (const double at : moments) {
    pose_at(motion, at, pose);
    pose_muscles(actor.muscles, actor.character.anatomy.skeleton, pose, frame.posed, frame.contact);
    evaluate_posed_skin(actor, method, frame);
    std::vector<Vec3f>& points = figures.emplace_back();
    const Vec3f root = frame.posed.X_WJ.front().translation().cast<float>();
    for (const Look& look : looks) {
      points.emplace_back(root.x() + look.offset.x(), 0, root.z() + look.offset.z());
      for (std::size_t i = 0; i + 3 < frame.skin.positions.size(); i += 4 * stride)
        points.emplace_back(Vec3f(frame.skin.positions[i], frame.skin.positions[i + 1],
                                  frame.skin.positions[i + 2]) +
                            look.offset);
    }
  }
  return figures;
}

std::vector<Camera> whole_figure(const Actor& actor, const Motion& motion,
                                 std::span<const double> moments, std::span<const Look> looks,
                                 const FilmView& view, double fps, float aspect) {
  FollowCamera side;
  side.fov_y = 0.30f;
  side.smoothing = 0.22;
  side.aspect = aspect;
  if (looks.size() > 1) {  // from before and beside them, where neither figure hides the other
    side.begin_azimuth = -0.62f;
    side.end_azimuth = -0.95f;
  }
  const bool follows = view.camera == "follow";
  if (!follows) side.begin_azimuth = side.end_azimuth = view_angles(view.camera).azimuth;
  const std::vector<std::vector<Vec3f>> figures = figures_of(actor, motion, moments, looks);
  std::vector<Camera> cameras = follow(figures, fps, side);
  if (follows) return cameras;
  // One distance for all frames, at which the figure fills the picture in its widest frame.
  const ViewAngles angles = view_angles(view.camera);
  const Vec3f away = away_from(angles);
  float distance = 0;
  std::vector<Vec3f> centers;
  for (std::size_t f = 0; f < cameras.size(); ++f) {
    Eigen::AlignedBox3f box;
    for (const Vec3f& p : figures[f]) box.extend(p);
    centers.emplace_back(cameras.size() > 1 ? cameras[f].target : box.center());
    distance = std::max(
        distance, distance_to_see(figures[f], centers.back(), away, kFieldOfView, aspect, kFree));
  }
  const float radius = distance * std::sin(0.5f * narrow_angle(kFieldOfView, aspect));
  for (std::size_t f = 0; f < cameras.size(); ++f)
    cameras[f] =
        orbit_camera(centers[f], radius, angles.azimuth, angles.elevation, kFieldOfView, aspect);
  return cameras;
}

std::vector<Camera> close_ups(const Assets& assets, const Actor& actor, const Motion& motion,
                              std::span<const double> moments, const FilmView& view, float aspect) {
  const Tracked tracked =
      track(actor, motion, moments, find_target(assets, actor.character, view.look_at));
  const ViewAngles angles = view.camera == "follow" ? tracked.angles : view_angles(view.camera);
  std::vector<Camera> cameras;
  for (const Vec3f& center : tracked.centers) {
    Camera& camera = cameras.emplace_back(orbit_camera(
        center, kMargin * tracked.radius, angles.azimuth, angles.elevation, kFieldOfView, aspect));
    // The near plane is close to the eye, so that it does not cut parts in front of the target.
    camera.near_plane = 0.02f;
    camera.far_plane = 200;
  }
  return cameras;
}

void require_numbers(const FilmView& view) {
  if (!(view.zoom > 0) || !std::isfinite(view.zoom))
    throw UsageError(fmt::format("--zoom: {}: must be above 0", view.zoom));
  if (view.distance && (!(*view.distance > 0) || !std::isfinite(*view.distance)))
    throw UsageError(fmt::format("--distance: {}: must be above 0 m", *view.distance));
  if (view.camera != "follow") view_angles(view.camera);
}

}  // namespace

void check_view(const Assets& assets, const Character& character, const FilmView& view) {
  require_numbers(view);
  if (!view.look_at.empty()) find_target(assets, character, view.look_at);
}

std::vector<Camera> film_cameras(const Assets& assets, const Actor& actor, const Motion& motion,
                                 std::span<const double> moments, std::span<const Look> looks,
                                 const FilmView& view, double fps, float aspect) {
  require_numbers(view);
  std::vector<Camera> cameras = view.look_at.empty()
                                    ? whole_figure(actor, motion, moments, looks, view, fps, aspect)
                                    : close_ups(assets, actor, motion, moments, view, aspect);
  for (Camera& camera : cameras) {
    camera.fov_y = 2 * std::atan(std::tan(0.5f * camera.fov_y) / float(view.zoom));
    if (!view.distance) continue;
    camera.eye = camera.target + float(*view.distance) * (camera.eye - camera.target).normalized();
    camera.near_plane = 0.02f;
    camera.far_plane = float(*view.distance) + 200;
  }
  return cameras;
}

}  // namespace ecorche
