#include "morph/fit/fit_quality.h"

#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/muscles/torn_muscles.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/fit/layer_gaps.h"
#include "morph/fit/muscle_ends.h"

namespace ecorche::inline v1 {
namespace {

// Accuracy targets, stated in the messages of missed_targets. Larger: worse fits pass unnoticed.
constexpr double kOutsideLimit = 5e-4;  // share of muscle surface points outside the skin
constexpr double kGapLimit = 3e-3;      // m, median gap of superficial muscles
constexpr double kPiercedLimit = 0.05;  // share of one muscle's volume in bones
constexpr double kOverlapLimit = 0.02, kBoneLimit = 0.01;  // shares of all muscles' volume

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

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + long(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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

// Muscles as drawn at rest, and bones.
class DrawnFlesh {
 public:
  explicit DrawnFlesh(const Anatomy& anatomy)
      : anatomy_(anatomy), surface_(make_muscle_surface(anatomy)) {
    update_muscle_surface(surface_, rest_slices(anatomy), positions_);
  }

  // Muscles in order, then bones.
  SolidVolumes measure(double spacing) const {
    std::vector<Solid> solids;
    for (const MuscleSurface::Part& part : surface_.parts)
      solids.push_back(
          {Solid::Kind::muscle, &positions_, &surface_.F, part.face_begin, part.face_end});
    for (const Bone& bone : anatomy_.bones)
      solids.push_back({Solid::Kind::bone, &bone.mesh.V, &bone.mesh.F, 0, int(bone.mesh.F.rows())});
    return measure_solids(solids, spacing);
  }

  TriMesh mesh() const {
    const TriMesh muscles{positions_, surface_.F};
    std::vector<const TriMesh*> all{&muscles};
    for (const Bone& bone : anatomy_.bones) all.push_back(&bone.mesh);
    return join_meshes(all);
  }

 private:
  const Anatomy& anatomy_;
  MuscleSurface surface_;
  Points positions_;
};

TriMesh fascia_mesh(const Anatomy& anatomy) {
  std::vector<TriMesh> sheets;
  for (const FasciaSheet& sheet : anatomy.fascia)
    sheets.push_back({sheet.V, grid_triangles(sheet.rows, sheet.columns)});
  std::vector<const TriMesh*> all;
  for (const TriMesh& sheet : sheets) all.push_back(&sheet);
  return join_meshes(all);
}

}  // namespace

bool is_limb(BodyPart part) {
  return part == BodyPart::upper_arm || part == BodyPart::forearm || part == BodyPart::thigh ||
         part == BodyPart::shank;
}

bool is_off(const LandmarkDepth& landmark) {
  return landmark.depth < landmark.low - kDepthSlack ||
         landmark.depth > landmark.high + kDepthSlack;
}

FillReport measure_fill(const Anatomy& anatomy, const TriMesh& closed_skin, const SkinRays& wall,
                        const FatLayer& fat, const std::vector<VertexPart>& parts) {
  FillReport fill;
  measure_outside(anatomy, closed_skin, fill);
  measure_superficial_gap(anatomy, parts, wall, fat, fill);
  return fill;
}

void measure_rest(const Anatomy& anatomy, const TriMesh& wall, const FatLayer& fat,
                  const std::vector<VertexPart>& parts, FillReport& fill) {
  constexpr double kSpacing = 0.0015;  // m: as CheckOptions::rest_spacing
  const DrawnFlesh flesh(anatomy);
  const SolidVolumes volumes = flesh.measure(kSpacing);
  fill.overlap_share = volumes.muscle_overlap_share();
  fill.bone_share = volumes.bone_overlap_share();
  fill.pierced_share = 0;
  fill.pierced_muscle.clear();
  for (size_t m = 0; m < anatomy.muscles.size(); ++m) {
    if (volumes.in_bone[m] <= fill.pierced_share * volumes.volume[m]) continue;
    fill.pierced_share = volumes.in_bone[m] / volumes.volume[m];
    fill.pierced_muscle = anatomy.muscles[m].name;
  }
  fill.loose_ends = measure_muscle_ends(anatomy).loose;
  fill.filled_share =
      measure_layer_gaps(wall, fat, parts, flesh.mesh(), fascia_mesh(anatomy)).filled_share;
}

void measure_shown(const LayerOrder& layers, const LayeredBody& body, FillReport& fill) {
  const ShownThrough shown = measure_shown_through(layers, body);
  fill.shown = shown.area;
  fill.shown_most = shown.most;
  fill.shown_by_one = shown.by_one;
}

void measure_torn(const Anatomy& anatomy, const std::vector<Muscle>& reference, FillReport& fill) {
  const std::vector<MuscleTear> tears = measure_tears(anatomy.muscles, reference);
  fill.torn.clear();
  for (const int m : torn_muscles(tears)) fill.torn.push_back(anatomy.muscles[m].name);
  fill.needles = 0;
  for (const MuscleTear& tear : tears) fill.needles += tear.needles;
}

Tissues measure_tissues(const Anatomy& anatomy, const TriMesh& closed_skin, const TriMesh& wall,
                        const FatLayer& fat) {
  // m; sums over the whole body are good to a few tenths of a percent
  constexpr double kSpacing = 0.004;
  const SolidVolumes volumes = DrawnFlesh(anatomy).measure(kSpacing);
  TriMesh inner = wall;
  const Points normals = vertex_normals(wall);
  for (Eigen::Index i = 0; i < inner.V.rows(); ++i)
    inner.V.row(i) -= double(fat.thickness[i]) * normals.row(i);
  Tissues tissues;
  tissues.body = mesh_volume(closed_skin);
  tissues.bones = std::accumulate(volumes.volume.begin() + long(anatomy.muscles.size()),
                                  volumes.volume.end(), 0.0);
  tissues.muscles = volumes.muscles - volumes.muscle_bone;
  tissues.layer = tissues.body - mesh_volume(inner);
  tissues.rest = tissues.body - tissues.bones - tissues.muscles - tissues.layer;
  return tissues;
}

std::vector<MissedTarget> missed_targets(const FittingReport& report) {
  std::vector<MissedTarget> missed;
  const FitReport& fit = report.fit;
  const FillReport& fill = report.fill;
  if (fit.bones_outside > 0)
    missed.push_back(
        {"bones_outside", fmt::format("{} bone vertices are outside the skin, up to {:.1f} mm",
                                      fit.bones_outside, 1e3 * fit.bones_furthest)});
  if (fill.points_outside > kOutsideLimit * fill.points)
    missed.push_back(
        {"muscles_outside",
         fmt::format("{:.3f} % of the muscle surface is outside the skin; at most 0.05 % was asked",
                     100.0 * fill.points_outside / fill.points)});
  if (fill.overlap_share > kOverlapLimit)
    missed.push_back({"muscles_overlap",
                      fmt::format("muscles lie within muscles by {:.2f} % of their volume; at most "
                                  "2 % was asked",
                                  100 * fill.overlap_share)});
  if (fill.bone_share > kBoneLimit)
    missed.push_back({"muscles_in_bones",
                      fmt::format("muscles lie within bones by {:.2f} % of their volume; at most "
                                  "1 % was asked",
                                  100 * fill.bone_share)});
  if (fill.loose_ends > 0)
    missed.push_back({"ends_loose", fmt::format("{} muscle ends lie more than 10 mm from their "
                                                "bones",
                                                fill.loose_ends)});
  if (fill.filled_share < kFilledAsked)
    missed.push_back({"layer_unfilled",
                      fmt::format("under the fat layer {:.1f} % of the area is within 5 mm, or a "
                                  "quarter of the layer, of muscle, bone or fascia; at least "
                                  "95 % was asked",
                                  100 * fill.filled_share)});
  if (fill.shown_by_one > kShownAsked)
    missed.push_back({"shown_through",
                      fmt::format("{} shows through what covers it by {:.1f} cm2; at most "
                                  "{:.0f} cm2 was asked",
                                  fill.shown_most, 1e4 * fill.shown_by_one, 1e4 * kShownAsked)});
  if (fill.pierced_share > kPiercedLimit)
    missed.push_back({"muscle_pierced",
                      fmt::format("bones take {:.1f} % of {}; at most 5 % of a muscle was asked",
                                  100 * fill.pierced_share, fill.pierced_muscle)});
  if (!fill.torn.empty())
    missed.push_back(
        {"muscles_torn",
         fmt::format("{} is torn: points of its surface stand out that do not in the template{}",
                     fill.torn.front(),
                     fill.torn.size() > 1
                         ? fmt::format("; so are {} more muscles", fill.torn.size() - 1)
                         : "")});
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
  if (report.dilation.collapsed > 0)
    missed.push_back(
        {"muscles_collapsed", fmt::format("{} muscles found no room between their neighbours and "
                                          "the skin, and keep the shape they were carried with",
                                          report.dilation.collapsed)});
  return missed;
}

}  // namespace ecorche::inline v1
