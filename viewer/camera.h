// Cameras: matrices, named views, and distances from which points are in view.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "viewer/draw_list.h"

namespace ecorche {

Mat4f view_matrix(const Camera& camera);  // world -> eye, which looks along its -z
Mat4f projection_matrix(const Camera& camera,
                        float aspect);  // eye -> clip, aspect = width / height
// View matrix of an eye that looks along `forward`.
Mat4f look_along(const Vec3f& eye, const Vec3f& forward, const Vec3f& up);
// Parallel projection with OpenGL's clip space: -1 .. 1 on all axes.
Mat4f orthographic(float half_width, float half_height, float near_plane, float far_plane);

// Camera outside the ball around `center`, at the distance from which the ball fills the picture.
// Azimuth 0 looks at the front (+Z), pi/2 at the body's left side (+X); elevation above 0 looks
// down. Radians. Throws std::invalid_argument unless radius > 0 and 0 < fov_y < pi.
Camera orbit_camera(const Vec3f& center, float radius, float azimuth, float elevation,
                    float fov_y = 0.35f, float aspect = 1);

// The smaller of the two angles of view of a picture of width / height `aspect`, rad: a ball of
// radius r about the target touches its edges from r / sin(half of it).
float narrow_angle(float fov_y, float aspect);

struct ViewAngles {
  float azimuth = 0, elevation = 0;
};
// "front", "back", "left", "right", "top", "bottom", "oblique", or "AZIMUTH,ELEVATION" in degrees.
// Throws UsageError.
ViewAngles view_angles(std::string_view name);
// All view names as text, for messages and help.
std::string view_names();
// Unit vectors: from the target towards the eye, and the picture's upward direction (also for views
// from above and below).
Vec3f away_from(const ViewAngles& angles);
Vec3f upward_from(const ViewAngles& angles);

// Smallest distance of the eye from `target`, in the direction `away`, at which all points are in
// the picture. margin: share of half the picture that stays free at each edge.
float distance_to_see(std::span<const Vec3f> points, const Vec3f& target, const Vec3f& away,
                      float fov_y, float aspect, float margin = 0);

}  // namespace ecorche
