#include "skinning/checks/wholeness.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

#include "anatomy/compute/angle_between.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kCrease = 0.25 * std::numbers::pi;
constexpr double kNeedle = 0.010;    // m
constexpr double kTouching = 0.005;  // m, at rest
constexpr double kApart = 0.010;     // m, in a pose
constexpr double kBare = 0.020;      // m, at rest
constexpr double kLift = 1e-4;       // m, of a ray's origin off its own surface
constexpr double kShortEdge = 1e-3;  // m; shorter ones say nothing about stretch
constexpr float kTendon = 0.3f;      // share of belly below which a section is tendon

// How far each vertex of the muscles is, along its normal, from what lies over it: 0 within another
// muscle or bone; infinite where nothing does.
std::vector<double> cover_distances(const TriMesh& flesh, int vertices) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  const SkinRays rays(flesh, RayBuild::quick);
  const Points normals = vertex_normals(flesh);
  std::vector<double> out(vertices, kNothing);
  for (int v = 0; v < vertices; ++v) {
    const Vec3 normal = normals.row(v);
    if (!(normal.squaredNorm() > 0.5)) continue;
    const Vec3 origin = flesh.V.row(v).transpose() + kLift * normal;
    // From within another solid the first surface that is met is left, however far it is.
    const RayHit hit = rays.first_hit(origin, normal);
    if (hit.triangle >= 0) out[v] = hit.facing > 0 ? 0 : double(hit.distance);
  }
  return out;
}

// Turn of the line of centres at each section of tendon over the length about it, rad/m; elsewhere
// -1.
std::vector<double> turns_of_tendons(std::span<const SliceRange> ranges,
                                     const PosedAnatomy& posed) {
  std::vector<double> out(posed.slices.size(), -1.0);
  for (const SliceRange& strip : ranges)
    for (int k = strip.begin + 1; k + 1 < strip.end; ++k) {
      if (posed.belly[k] > kTendon) continue;
      const Vec3 before = posed.slices[k].center - posed.slices[k - 1].center,
                 after = posed.slices[k + 1].center - posed.slices[k].center;
      const double length = 0.5 * (before.norm() + after.norm());
      if (length > 0) out[k] = angle_between(before, after) / length;
    }
  return out;
}

// Ends that the table puts on a bone and that one joint carries.
std::vector<StripEnd> ends_on_bones(const Anatomy& anatomy, std::span<const SliceRange> ranges,
                                    const PosedAnatomy& rest) {
  std::vector<StripEnd> out;
  for (const SliceRange& range : ranges) {
    const Muscle& muscle = anatomy.muscles[range.muscle];
    const auto [origin, insertion] = end_joints(muscle, muscle.strips[range.strip]);
    for (const auto& [joint, slice] :
         {std::pair(origin, range.begin), std::pair(insertion, range.end - 1)})
      if (joint >= 0)
        out.push_back(
            {range.muscle, slice, joint, rest.X_WJ[joint].inverse() * rest.slices[slice].center});
  }
  return out;
}

}  // namespace

RestSurface make_rest_surface(const Anatomy& anatomy, const MuscleSurface& surface,
                              std::span<const SliceRange> ranges, const PosedAnatomy& rest,
                              const TriMesh& flesh) {
  RestSurface out;
  out.edges = inner_edges(surface, flesh.V);
  out.standing_off = standing_off(surface, out.edges, flesh.V).off;
  out.cover = cover_distances(flesh, surface.vertices());
  out.tendon_turns = turns_of_tendons(ranges, rest);
  out.ends = ends_on_bones(anatomy, ranges, rest);
  return out;
}

std::vector<MuscleWholeness> measure_wholeness(const RestSurface& rest,
                                               const MuscleSurface& surface,
                                               std::span<const SliceRange> ranges,
                                               const PosedAnatomy& posed, const TriMesh& flesh) {
  std::vector<MuscleWholeness> out(surface.parts.size());
  std::vector<std::vector<double>> stretches(out.size());
  for (const SurfaceEdge& edge : rest.edges) {
    MuscleWholeness& muscle = out[edge.muscle];
    const SurfaceEdge posed_edge = edge_at(edge, surface, flesh.V);
    muscle.edge_length += posed_edge.length;
    if (posed_edge.turn > edge.turn + kCrease) muscle.creased_length += posed_edge.length;
    if (edge.length > kShortEdge) stretches[edge.muscle].push_back(posed_edge.length / edge.length);
  }
  for (std::size_t m = 0; m < out.size(); ++m) {
    if (stretches[m].empty()) continue;
    const auto at = stretches[m].begin() + std::ptrdiff_t(0.99 * double(stretches[m].size() - 1));
    std::nth_element(stretches[m].begin(), at, stretches[m].end());
    out[m].stretch = *at;
  }
  const std::vector<double> off = standing_off(surface, rest.edges, flesh.V).off;
  const std::vector<double> cover = cover_distances(flesh, surface.vertices());
  const std::vector<double> areas = vertex_areas(flesh);
  for (int v = 0; v < surface.vertices(); ++v) {
    MuscleWholeness& muscle = out[surface.muscle[v]];
    muscle.needles += off[v] > rest.standing_off[v] + kNeedle;
    if (rest.cover[v] <= kTouching && cover[v] > kApart) muscle.daylight += areas[v];
    if (rest.cover[v] > kBare && cover[v] == 0) muscle.buried += areas[v];
  }
  const std::vector<double> turns = turns_of_tendons(ranges, posed);
  for (const SliceRange& strip : ranges)
    for (int k = strip.begin; k < strip.end; ++k)
      if (turns[k] >= 0 && rest.tendon_turns[k] >= 0)
        out[strip.muscle].kink = std::max(out[strip.muscle].kink, turns[k] - rest.tendon_turns[k]);
  for (const StripEnd& end : rest.ends) {
    double& farthest = out[end.muscle].end_off;
    const Vec3 held = posed.X_WJ[end.joint] * end.center;
    farthest = std::max(farthest, (posed.slices[end.slice].center - held).norm());
  }
  return out;
}

}  // namespace ecorche::inline v1
