#include "morph/dilation/lay_wall.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kCover = 0.0025;     // m, from a section's outer side to the middle of its cover
constexpr double kSeek = 0.03;        // m, to both sides, how far off a cover is looked for
constexpr double kMostLaid = 0.025;   // m, that a section moves
constexpr double kBesideBone = 0.03;  // m from an end on a bone, over which sections begin to move
constexpr double kSides = 0.8;        // of half a section's width: where it is looked from, too
constexpr int kEvenRounds = 4;

// The middles of the sheets that lie farther out than `depth`, as drawn.
TriMesh covers_of(const Anatomy& anatomy, const MuscleSurface& surface,
                  std::span<const Ellipse> slices, int depth) {
  std::vector<Ellipse> flat(slices.begin(), slices.end());
  for (Ellipse& slice : flat) slice.radii.setZero();
  TriMesh out;
  update_muscle_surface(surface, flat, out.V);
  out.F.resize(surface.F.rows(), 3);
  Eigen::Index faces = 0;
  for (const MuscleSurface::Part& part : surface.parts) {
    const int own = depth_in_wall(anatomy.muscles[std::size_t(part.muscle)]);
    if (own == 0 || own >= depth) continue;
    const Eigen::Index count = part.face_end - part.face_begin;
    out.F.middleRows(faces, count) = surface.F.middleRows(part.face_begin, count);
    faces += count;
  }
  out.F.conservativeResize(faces, 3);
  return out;
}

// How far a point lies short of `under` below the covers, outwards being `way`; 0: nowhere near
// one, or low enough.
double short_by(const SkinRays& covers, const Vec3& point, const Vec3& way, double under) {
  const RayHit hit = covers.first_hit(point - kSeek * way, way, 2 * kSeek);
  if (hit.triangle < 0) return 0;
  return std::max(0.0, under - (double(hit.distance) - kSeek));
}

// Over which share of its shift a section moves, by the ends on bones.
std::vector<double> shares_of(const Muscle& muscle, std::span<const Ellipse> strip) {
  std::vector<double> along(strip.size(), 0.0);
  for (std::size_t k = 1; k < strip.size(); ++k)
    along[k] = along[k - 1] + (strip[k].center - strip[k - 1].center).norm();
  std::vector<double> out(strip.size(), 1.0);
  for (std::size_t k = 0; k < strip.size(); ++k) {
    if (!muscle.origin_bone.empty()) out[k] = std::min(out[k], along[k] / kBesideBone);
    if (!muscle.insertion_bone.empty())
      out[k] = std::min(out[k], (along.back() - along[k]) / kBesideBone);
  }
  return out;
}

void lay_strip(const Muscle& muscle, std::span<Ellipse> strip, const SkinRays& covers,
               const NearestSurface& skin, double& farthest) {
  const std::vector<double> shares = shares_of(muscle, strip);
  std::vector<Vec3> ways;
  std::vector<double> wanted;
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const Ellipse& slice = strip[k];
    ways.push_back((skin.nearest(slice.center).point - slice.center).stableNormalized());
    const double under = slice.radii.y() + kCover;
    double most = 0;
    for (const double side : {-kSides, 0.0, kSides})
      most =
          std::max(most, short_by(covers, slice.center + side * slice.radii.x() * slice.axes.col(0),
                                  ways.back(), under));
    wanted.push_back(shares[k] * std::min(most, kMostLaid));
  }
  std::vector<double> moved = wanted;
  for (int round = 0; round < kEvenRounds; ++round) {
    const std::vector<double> before = moved;
    for (std::size_t k = 0; k < moved.size(); ++k)
      moved[k] =
          std::max(wanted[k], 0.5 * before[k] + 0.25 * (before[k > 0 ? k - 1 : k] +
                                                        before[std::min(k + 1, moved.size() - 1)]));
  }
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const Vec3 normal = strip[k].axes.col(2), shift = -moved[k] * ways[k];
    strip[k].center += shift - normal * normal.dot(shift);
    farthest = std::max(farthest, moved[k]);
  }
}

}  // namespace

int depth_in_wall(const Muscle& muscle) {
  if (muscle.group != "trunk_abdomen" || !muscle.sheet) return 0;
  return muscle.layer == "superficial" ? 1 : muscle.layer == "intermediate" ? 2 : 3;
}

double lay_wall(const Anatomy& anatomy, std::span<Ellipse> slices, std::span<const int> partners,
                const SkinRays& skin) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  const std::vector<std::size_t> begin = slice_begins(anatomy.muscles);
  const NearestSurface nearest(skin.mesh());
  double farthest = 0;
  for (const int depth : {2, 3}) {
    const TriMesh middles = covers_of(anatomy, surface, slices, depth);
    if (middles.F.rows() == 0) continue;
    const SkinRays covers(middles, RayBuild::quick);
    for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
      const Muscle& muscle = anatomy.muscles[m];
      if (depth_in_wall(muscle) != depth || partners[m] >= 0) continue;
      std::size_t at = begin[m];
      for (const Strip& strip : muscle.strips) {
        lay_strip(muscle, slices.subspan(at, strip.slices.size()), covers, nearest, farthest);
        at += strip.slices.size();
      }
    }
  }
  return farthest;
}

}  // namespace ecorche::inline v1
