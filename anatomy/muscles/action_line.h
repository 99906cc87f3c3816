// The shape of a strip at rest: how path, reference, roll, offset and radii become ellipses, and
// the way back.
//
// The smooth line is a centripetal Catmull-Rom spline (Yuksel et al.
// 2011, 10.1016/j.cad.2010.08.008) through the rest path points with natural ends. Its parameter s
// is the fraction of its rest length, 0 at the origin and 1 at the insertion. A point of the line
// is a fixed weighted sum of at most four path points, at rest and in every pose.
//
// At slice k:  tangent   derivative of the parabola through line points k-1, k, k+1 (ends: of the
// nearest three)
//              frame     rotation-minimising (Wang et al. 2008, 10.1145/1330511.1330513), starting
//              from Strip::reference
//                        made perpendicular to the first tangent:  r, tangent x r
//              width     cos(roll) r + sin(roll) (tangent x r);   thickness = tangent x width
//              center    line point + offset.x width + offset.y thickness
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// A point of the smooth line: sum of weight[i] * path[first + i]; weights sum to 1. Unused weights
// are 0.
struct LineNode {
  int first = 0;
  std::array<double, 4> weight{0, 0, 0, 0};
};

// Where the line is at parameters s (rising or not). Throws std::invalid_argument for fewer than
// two path points.
std::vector<LineNode> line_nodes(std::span<const PathPoint> path, std::span<const double> s);
std::vector<Vec3> line_points(std::span<const PathPoint> path,
                              std::span<const double> s);  // rest, world

double line_length(std::span<const PathPoint> path);  // of the smooth line at rest, m

// Parameters s of the path points themselves. #path, first 0, last 1
std::vector<double> path_parameters(std::span<const PathPoint> path);

// Parameter s of the place that lies at `fraction` of the polyline's length (profiles are often
// authored along the polyline): the same piece, the same share of it.
double line_parameter(std::span<const PathPoint> path, double fraction);

// Unit tangents of a line given by at least two points, as defined above.
std::vector<Vec3> line_tangents(std::span<const Vec3> points);

// The ellipses of the rest pose; pose_anatomy gives exactly these at rest.
// Precondition: at least two slices with rising s.
std::vector<Ellipse> rest_slices(const Strip& strip);
std::vector<Ellipse> rest_slices(const Anatomy& anatomy);  // flat: muscles, strips, slices in order

// A cross-section as an author knows it: in world directions at rest.
struct Station {
  double s = 0;  // parameter of the smooth line
  // from the line to the section's centre; its part along the line is dropped
  Vec3 offset = Vec3::Zero();
  // direction of the width axis; made perpendicular to the line, either sign
  Vec3 width = Vec3::UnitX();
  Vec2 radii = Vec2::Zero();  // half width, half thickness
};

// A strip with the given sections. The first width becomes the reference; each next width may be
// given with either sign and is taken with the sign that turns less from its neighbour. Sets
// slices, reference and rest_length. Throws std::invalid_argument for fewer than two stations, s
// not rising or a width along the line.
Strip make_strip(std::vector<PathPoint> path, std::span<const Station> stations);

// Sections by linear interpolation of the stations at other parameters (for example evenly spaced
// ones).
std::vector<Station> resample_stations(std::span<const PathPoint> path,
                                       std::span<const Station> stations,
                                       std::span<const double> s);

// Rewrites roll, offset, radii and outline so that rest_slices(strip) gives these centres, width
// directions, radii and outlines; s stays. The way back from a change made to the ellipses
// (dilation). Precondition: one ellipse a slice.
void set_slices(Strip& strip, std::span<const Ellipse> ellipses);
// The same for all strips of a muscle, whose ellipses follow one another; and their outlines alone.
void set_slices(Muscle& muscle, std::span<const Ellipse> ellipses);
void set_outlines(Muscle& muscle, std::span<const Ellipse> ellipses);

// 1 on the belly, 0 on tendon, smooth over 6 % of the line on either side of a junction. A strip
// without tendon is belly to its end (belly_begin 0, belly_end 1).
double belly_weight(const Strip& strip, double s);

// 1 on a tendinous intersection, fading to 0 within this share of the line on either side.
inline constexpr double kIntersection = 0.018;
double intersection_weight(const Strip& strip, double s);

// Of the surface: 1 where it is red, 0 where it is pale. Tendons and intersections are pale, and
// the raphe: `width_share` is 0 at the edge next to the mid-plane, 1 at the other.
double flesh_weight(const Strip& strip, double s, double width_share = 1);

// Volume of the tube lofted through the sections in order (no caps), m^3:
//   V = sum over pieces of pi ((c1 - c0) . (A00 + A01 + A11) + L) / 3,   pi Aij the mixed area
//   vector of sections i and j, L what lopsided
// sections add as they turn (both in slice_outline.h). It is exact for linear interpolation of
// centre, axes and outlines, however the line bends or twists.
double tube_volume(std::span<const Ellipse> ellipses);

}  // namespace ecorche::inline v1
