#include "morph/dilation/lay_wall.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

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
// By how names begin, and their places; the upper trapezius lies on other muscles.
constexpr std::pair<const char*, int> kSheetsOfBack[] = {{"trapezius_middle", 1},
                                                         {"trapezius_lower", 1},
                                                         {"rhomboid", 2},
                                                         {"latissimus_dorsi_thoracic", 2}};

// The middles of the sheets that lie over `place`, as drawn; of the belly's, from line to line
// alone: what lies under their edges would be laid out of the others' cover.
TriMesh covers_of(const Anatomy& anatomy, const MuscleSurface& surface,
                  std::span<const Ellipse> slices, const WallPlace& place) {
  std::vector<Ellipse> flat(slices.begin(), slices.end());
  for (Ellipse& slice : flat)
    slice.radii = {place.wall == Wall::belly ? 0.0 : slice.radii.x(), 0.0};
  TriMesh out;
  update_muscle_surface(surface, flat, out.V);
  out.F.resize(surface.F.rows(), 3);
  Eigen::Index faces = 0;
  for (const MuscleSurface::Part& part : surface.parts) {
    if (!place.is_under(place_in_wall(anatomy.muscles[std::size_t(part.muscle)]))) continue;
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

// How far a section may go inwards before it meets bone, m.
double room_inwards(const Ellipse& slice, const Vec3& way, const BoneRays* bones) {
  if (!bones) return kMostLaid;
  const RayHit hit = bones->rays.first_hit(slice.center, -way, kMostLaid + slice.radii.y());
  if (hit.triangle < 0) return kMostLaid;
  return std::clamp(double(hit.distance) - slice.radii.y(), 0.0, kMostLaid);
}

void lay_strip(const Muscle& muscle, std::span<Ellipse> strip, const SkinRays& covers,
               const NearestSurface& skin, const BoneRays* bones, double& farthest) {
  const std::vector<double> shares = shares_of(muscle, strip);
  std::vector<Vec3> ways;
  std::vector<double> wanted, most_laid;
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const Ellipse& slice = strip[k];
    ways.push_back((skin.nearest(slice.center).point - slice.center).stableNormalized());
    const double under = slice.radii.y() + kCover;
    double most = 0;
    for (const double side : {-kSides, 0.0, kSides})
      most =
          std::max(most, short_by(covers, slice.center + side * slice.radii.x() * slice.axes.col(0),
                                  ways.back(), under));
    most_laid.push_back(room_inwards(slice, ways.back(), bones));
    wanted.push_back(shares[k] * std::min(most, most_laid.back()));
  }
  std::vector<double> moved = wanted;
  for (int round = 0; round < kEvenRounds; ++round) {
    const std::vector<double> before = moved;
    for (std::size_t k = 0; k < moved.size(); ++k)
      moved[k] = std::clamp(0.5 * before[k] + 0.25 * (before[k > 0 ? k - 1 : k] +
                                                      before[std::min(k + 1, moved.size() - 1)]),
                            wanted[k], most_laid[k]);
  }
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const Vec3 normal = strip[k].axes.col(2), shift = -moved[k] * ways[k];
    strip[k].center += shift - normal * normal.dot(shift);
    farthest = std::max(farthest, moved[k]);
  }
}

}  // namespace

WallPlace place_in_wall(const Muscle& muscle) {
  if (!muscle.sheet) return {};
  if (muscle.group == "trunk_abdomen")
    return {Wall::belly, muscle.layer == "superficial"    ? 1
                         : muscle.layer == "intermediate" ? 2
                                                          : 3};
  for (const auto& [name, depth] : kSheetsOfBack)
    if (muscle.name.starts_with(name)) return {Wall::back, depth};
  return {};
}

double lay_wall(const Anatomy& anatomy, std::span<Ellipse> slices, std::span<const int> partners,
                const SkinRays& skin, const BoneRays* bones) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  const std::vector<std::size_t> begin = slice_begins(anatomy.muscles);
  const NearestSurface nearest(skin.mesh());
  double farthest = 0;
  for (const WallPlace& place : {WallPlace{Wall::belly, 2}, {Wall::belly, 3}, {Wall::back, 2}}) {
    const TriMesh middles = covers_of(anatomy, surface, slices, place);
    if (middles.F.rows() == 0) continue;
    const SkinRays covers(middles, RayBuild::quick);
    for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
      const Muscle& muscle = anatomy.muscles[m];
      if (place_in_wall(muscle) != place || partners[m] >= 0) continue;
      std::size_t at = begin[m];
      for (const Strip& strip : muscle.strips) {
        lay_strip(muscle, slices.subspan(at, strip.slices.size()), covers, nearest, bones,
                  farthest);
        at += strip.slices.size();
      }
    }
  }
  return farthest;
}

}  // namespace ecorche::inline v1
