#include "morph/fit/fit_character.h"

#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/queries/signed_distance.h"

namespace ecorche {
namespace {

constexpr double kOutsideLimit = 1e-3;  // share of muscle surface points
constexpr double kGapLimit = 3e-3;      // m, median

bool is_off(const LandmarkDepth& landmark) {
  return landmark.depth < landmark.low - kDepthSlack ||
         landmark.depth > landmark.high + kDepthSlack;
}

// Points of a section lie near one another: what lies deeper than the next one is far is inside,
// too.
void measure_outside(const Anatomy& anatomy, const TriMesh& closed_skin, FillReport& fill) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  const SkinField field(closed_skin);
  std::vector<double> beyond(positions.rows(), 0);
  tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, positions.rows(), 1024),
                    [&](const auto& range) {
                      constexpr double kRounding = 1e-9;  // m
                      SkinPoint known;
                      Vec3 from = Vec3::Zero();
                      for (Eigen::Index i = range.begin(); i < range.end(); ++i) {
                        const Vec3 p = positions.row(i);
                        if (known.distance + (p - from).norm() < -kRounding) continue;
                        known = field.nearest_judged(p, known.triangle);
                        from = p;
                        beyond[i] = std::max(known.distance, 0.0);
                      }
                    });
  fill.points = positions.rows();
  for (double distance : beyond) {
    if (distance <= 0) continue;
    ++fill.points_outside;
    fill.furthest = std::max(fill.furthest, distance);
  }
}

bool is_limb(BodyPart part) {
  return part == BodyPart::upper_arm || part == BodyPart::forearm || part == BodyPart::thigh ||
         part == BodyPart::shank;
}

Tissues measure_tissues(const Anatomy& anatomy, const TriMesh& closed_skin, const FatLayer& fat) {
  // m; sums over the whole body are good to a few tenths of a percent
  constexpr double kSpacing = 0.004;
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  std::vector<Solid> solids;
  for (const MuscleSurface::Part& part : surface.parts)
    solids.push_back({Solid::Kind::muscle, &positions, &surface.F, part.face_begin, part.face_end});
  for (const Bone& bone : anatomy.bones)
    solids.push_back({Solid::Kind::bone, &bone.mesh.V, &bone.mesh.F, 0, int(bone.mesh.F.rows())});
  const SolidVolumes volumes = measure_solids(solids, kSpacing);
  TriMesh inner = closed_skin;
  const Points normals = vertex_normals(closed_skin);
  for (Eigen::Index i = 0; i < inner.V.rows(); ++i)
    inner.V.row(i) -= double(fat.thickness[i]) * normals.row(i);
  Tissues tissues;
  tissues.body = mesh_volume(closed_skin);
  tissues.bones = std::accumulate(volumes.volume.begin() + long(surface.parts.size()),
                                  volumes.volume.end(), 0.0);
  tissues.muscles = volumes.muscles - volumes.muscle_bone;
  tissues.layer = tissues.body - mesh_volume(inner);
  tissues.rest = tissues.body - tissues.bones - tissues.muscles - tissues.layer;
  return tissues;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + long(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Between muscles and the fat layer all over the limbs, grooves and tendons included. The exact
// distance from each skin vertex to the nearest part is known from the anchoring; what is left
// after fat and skin is the gap.
void measure_skin_gap(const Binding& binding, const Refinement* refinement, const FatLayer& fat,
                      const std::vector<VertexPart>& parts, FillReport& fill) {
  std::vector<double> gaps;
  for (int i = 0; i < std::min<int>(binding.vertex_count, int(parts.size())); ++i) {
    const Anchor& anchor = binding.anchors[refinement ? refinement->base_rows[i] : i];
    if (is_limb(parts[i].part) && anchor.kind == Anchor::Kind::muscle)
      gaps.push_back(anchor.distance - fat.thickness[i]);
  }
  fill.skin_gap_median = median(gaps);
}

// Where a section comes nearest to the layer: least over its rays.
double least_gap(const Ellipse& slice, const SkinRays& rays, const FatLayer& fat) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < std::size_t(kOutlinePoints); ++k) {
    const Vec3 edge = double(slice.outline[k]) * slice.axes.leftCols<2>() *
                      slice.radii.cwiseProduct(outline_directions()[k]);
    const double reach = edge.norm();
    if (reach <= 0) continue;
    const RayHit hit = rays.first_hit(slice.center, edge / reach);
    if (hit.triangle >= 0)
      least = std::min(least, hit.distance - fat.at(rays.mesh().F, hit) - reach);
  }
  return least;
}

// Whether superficial muscles of the limbs reach the layer: the nearest approach of each section of
// their bellies.
void measure_superficial_gap(const Anatomy& anatomy, const std::vector<VertexPart>& parts,
                             const SkinRays& rays, const FatLayer& fat, FillReport& fill) {
  std::vector<double> gaps;
  for (const Muscle& muscle : anatomy.muscles) {
    if (muscle.layer != "superficial") continue;
    for (const Strip& strip : muscle.strips) {
      const auto slices = rest_slices(strip);
      for (size_t k = 0; k < slices.size(); ++k) {
        if (strip.slices[k].s < strip.belly_begin || strip.slices[k].s > strip.belly_end) continue;
        const RayHit above = rays.first_hit(slices[k].center, slices[k].axes.col(1));
        const int corner = above.triangle < 0 ? -1 : rays.mesh().F(above.triangle, 0);
        if (corner < 0 || corner >= int(parts.size()) || !is_limb(parts[corner].part)) continue;
        const double gap = least_gap(slices[k], rays, fat);
        if (std::isfinite(gap)) gaps.push_back(gap);
      }
    }
  }
  fill.superficial_slices = gaps.size();
  fill.superficial_gap_median = median(gaps);
}

void report_fit(const FittedCharacter& fitted, Report& report) {
  const FitReport& fit = fitted.fit;
  report.set("timings_ms.fit_bones", fit.bones_ms);
  report.set("timings_ms.fit_muscles", fit.muscles_ms);
  if (const InteriorReport& interior = fit.interior; interior.warp_ms > 0) {
    report.set("timings_ms.fit_tissue_prepared", interior.prepare_ms);
    report.set("timings_ms.fit_tissue_warp", interior.warp_ms);
    report.set("fit.tissue.nodes", interior.nodes);
    report.set("fit.tissue.tetrahedra", interior.tetrahedra);
    report.set("fit.tissue.inverted", interior.inverted);
    report.set("fit.tissue.template_soft_volume", interior.soft_before);
    report.set("fit.tissue.soft_volume", interior.soft_after);
  }
  report.set("fit.muscle_surface_outside_before_keeping_inside", fitted.dilation.surface_outside);
  report.set("fit.muscles_collapsed", fitted.dilation.collapsed);
  report.set("rays", double(fitted.dilation.rays));
  report.set("fit.ray_misses", double(fitted.dilation.misses));
  report.set("fit.stature", fit.stature);
  report.set("fit.bone_vertices", fit.bone_vertices);
  report.set("fit.bone_vertices_outside", fit.bones_outside);
  report.set("fit.muscle_points", fitted.fill.points);
  report.set(
      "fit.muscle_points_outside_share",
      fitted.fill.points > 0 ? double(fitted.fill.points_outside) / fitted.fill.points : 0.0);
  report.set("fit.muscle_points_outside_max", fitted.fill.furthest);
  report.set("fit.superficial_gap_median", fitted.fill.superficial_gap_median);
  report.set("fit.skin_gap_median", fitted.fill.skin_gap_median);
  report.set("fit.muscle_mass_wanted", fit.muscle_mass);
  report.set("fit.muscle_volume_wanted", fitted.dilation.wanted_volume);
  report.set("fit.muscle_volume", fitted.dilation.volume);
  const Tissues& tissues = fitted.tissues;
  report.set("fit.tissue_volume.body", tissues.body);
  report.set("fit.tissue_volume.bones", tissues.bones);
  report.set("fit.tissue_volume.muscles", tissues.muscles);
  report.set("fit.tissue_volume.layer", tissues.layer);
  report.set("fit.tissue_volume.rest", tissues.rest);
  report.set("fit.tissue_mass.bones", kBoneDensity * tissues.bones);
  report.set("fit.tissue_mass.muscles", kMuscleDensity * tissues.muscles);
  report.set("fit.tissue_mass.layer", kAdiposeDensity * tissues.layer);
  report.set("fit.tissue_mass.rest", kOrganDensity * tissues.rest);
  report.set("fit.landmarks", int(fit.landmarks.size()));
  report.set("fit.landmarks_off_bracket",
             int(std::count_if(fit.landmarks.begin(), fit.landmarks.end(), is_off)));
  for (const LandmarkDepth& landmark : fit.landmarks)
    report.set("fit.landmark_depth." + landmark.name, landmark.depth);
}

}  // namespace

FittedCharacter fit_character(const Template& body_template, const Body& body,
                              const BodyPackage& package, const FittingOptions& options,
                              Report& report) {
  FittedCharacter fitted;
  Fit fit = fit_anatomy(body_template, body, options.fit);
  fitted.fit = std::move(fit.report);
  fitted.tissue = std::move(fit.tissue);
  fitted.undilated = fit.anatomy;
  const TriMesh closed_skin = capped_skin(package, body.skin.V);
  DilateOptions dilation = options.dilate;
  dilation.even_about = fitted.fit.even_about;
  // Strips of one muscle lie in one another: all sections together hold more than is drawn.
  constexpr double kDrawn = 0.915;
  if (!dilation.most_volume)
    dilation.most_volume = fitted.fit.muscle_mass / (kMuscleDensity * kDrawn);
  auto timer = std::make_optional<StageTimer>(report, "dilation");
  const SkinRays rays(closed_skin);
  const FatLayer fat = make_fat_layer(rays, fit.anatomy, body);
  if (options.dilated)
    fitted.dilation = dilate_muscles(fit.anatomy, fitted.undilated.muscles,
                                     body_template.tables->muscles, rays, fat, dilation);
  timer.reset();
  Character character{std::move(fit.anatomy), body};
  std::optional<BaseSkin> base;
  if (options.fine_skin) {
    base = BaseSkin{body.skin, refine_skin(package)};
    character.body.skin = {refine_points(base->refinement, body.skin.V), base->refinement.F};
  }
  if (options.bound)
    fitted.actor = make_actor(std::move(character), report,
                              {base ? &*base : nullptr, options.weights, options.moves});
  else
    fitted.actor.character = std::move(character);
  const std::vector<VertexPart> read =
      options.parts ? std::vector<VertexPart>() : vertex_parts(package);
  const std::vector<VertexPart>& parts = options.parts ? *options.parts : read;
  measure_outside(fitted.actor.character.anatomy, closed_skin, fitted.fill);
  measure_superficial_gap(fitted.actor.character.anatomy, parts, rays, fat, fitted.fill);
  if (options.tissues) {
    if (options.bound)
      measure_skin_gap(fitted.actor.binding, base ? &base->refinement : nullptr, fat, parts,
                       fitted.fill);
    fitted.tissues = measure_tissues(fitted.actor.character.anatomy, closed_skin, fat);
  }
  report_fit(fitted, report);
  return fitted;
}

std::vector<MissedTarget> missed_targets(const FittedCharacter& fitted) {
  std::vector<MissedTarget> missed;
  const FitReport& fit = fitted.fit;
  const FillReport& fill = fitted.fill;
  if (fit.bones_outside > 0)
    missed.push_back(
        {"bones_outside", fmt::format("{} bone vertices are outside the skin, up to {:.1f} mm",
                                      fit.bones_outside, 1e3 * fit.bones_furthest)});
  if (fill.points_outside > kOutsideLimit * fill.points)
    missed.push_back(
        {"muscles_outside",
         fmt::format("{:.2f} % of the muscle surface is outside the skin; at most 0.1 % was asked",
                     100.0 * fill.points_outside / fill.points)});
  if (fill.superficial_gap_median > kGapLimit)
    missed.push_back({"superficial_gap", fmt::format("superficial muscles stay {:.1f} mm from the "
                                                     "fat layer (median); at most 3 mm was asked",
                                                     1e3 * fill.superficial_gap_median)});
  for (const LandmarkDepth& landmark : fit.landmarks)
    if (is_off(landmark))
      missed.push_back(
          {landmark.name,
           fmt::format("{} lies {:.1f} mm deep; {:.0f} to {:.0f} mm were asked", landmark.name,
                       1e3 * landmark.depth, 1e3 * landmark.low, 1e3 * landmark.high)});
  if (fitted.dilation.collapsed > 0)
    missed.push_back(
        {"muscles_collapsed", fmt::format("{} muscles found no room between their neighbours and "
                                          "the skin, and keep the shape they were carried with",
                                          fitted.dilation.collapsed)});
  return missed;
}

}  // namespace ecorche
