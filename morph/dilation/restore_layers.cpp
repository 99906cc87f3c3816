#include "morph/dilation/restore_layers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/queries/ray_crossings.h"
#include "morph/dilation/fill_gaps.h"
#include "morph/dilation/packed_sections.h"
#include "morph/fat/underside_samples.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kRounds = 3;
constexpr double kBetweenRays = 0.004;  // m; larger: specks of bone are missed
constexpr double kAbove = 0.5;          // share of the layer above its underside where rays begin
constexpr double kBeneath = 0.03;       // m below it, to where they go
constexpr double kThrough = 0.008;      // m; larger: what lies beside is drawn over
constexpr double kOver = 0.6e-3;        // m, that the raised muscle lies over what came through
constexpr double kAboutRibs = 0.03;     // m
constexpr double kUnderSkin = 2e-3;     // m, that sections keep
constexpr float kMostFactor = 6;        // of an outline: thin sheets become no ridges
constexpr double kSight = 0.06;         // m about sections that may be raised
constexpr int kNone = -1;

enum class Level { none, deeper, cover };

bool is_rib(const Bone& bone) { return bone.name.starts_with("rib"); }

Eigen::AlignedBox3d wider(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

// About the ribs, as far as sections near them may be raised; may be empty.
Eigen::AlignedBox3d sight_of(const Anatomy& anatomy, std::span<const Ellipse> slices,
                             std::span<const int> partners) {
  Eigen::AlignedBox3d ribs, near;
  for (const Bone& bone : anatomy.bones)
    for (Eigen::Index i = 0; is_rib(bone) && i < bone.mesh.V.rows(); ++i)
      ribs.extend(Vec3(bone.mesh.V.row(i)));
  const std::vector<std::size_t> begin = slice_begins(anatomy.muscles);
  for (std::size_t m = 0; m < partners.size(); ++m)
    for (std::size_t k = begin[m]; k < begin[m + 1] && partners[m] < 0; ++k) {
      const double reach =
          slices[k].radii.maxCoeff() * double(*std::ranges::max_element(slices[k].outline));
      near.extend(wider(Eigen::AlignedBox3d(slices[k].center), reach));
    }
  if (ribs.isEmpty() || near.isEmpty()) return {};
  return wider(ribs, kAboutRibs).intersection(wider(near, kSight));
}

// Muscles as drawn and ribs, in a body whose sections change, as far as they are in sight.
class Chest {
 public:
  Chest(const Anatomy& anatomy, const MuscleSurface& surface, std::span<const Ellipse> slices,
        const Eigen::AlignedBox3d& box)
      : surface_(surface), box_(box) {
    for (const Muscle& muscle : anatomy.muscles)
      levels_.push_back(lies_in_fat(muscle)             ? Level::none
                        : muscle.layer == "superficial" ? Level::cover
                                                        : Level::deeper);
    std::vector<const TriMesh*> ribs;
    for (const Bone& bone : anatomy.bones)
      if (is_rib(bone)) ribs.push_back(&bone.mesh);
    const TriMesh joined = join_meshes(ribs);
    mesh_.V.resize(surface.vertices() + joined.V.rows(), 3);
    update_muscle_surface(surface, slices, positions_);
    mesh_.V.topRows(positions_.rows()) = positions_;
    mesh_.V.bottomRows(joined.V.rows()) = joined.V;
    const int ribs_are = int(levels_.size());
    levels_.push_back(Level::deeper);
    const Eigen::AlignedBox3d about = wider(box_, kSight);
    std::vector<Eigen::RowVector3i> near;
    const auto add = [&](const Eigen::RowVector3i& corners, int solid) {
      Eigen::AlignedBox3d box;
      for (const int v : corners) box.extend(Vec3(mesh_.V.row(v)));
      if (!box.intersects(about)) return;
      near.push_back(corners);
      solids_.push_back(solid);
    };
    for (Eigen::Index f = 0; f < surface.F.rows(); ++f)
      add(surface.F.row(f), surface.muscle[std::size_t(surface.F(f, 0))]);
    for (Eigen::Index f = 0; f < joined.F.rows(); ++f)
      add(joined.F.row(f).array() + surface.vertices(), ribs_are);
    mesh_.F.resize(Eigen::Index(near.size()), 3);
    for (std::size_t f = 0; f < near.size(); ++f) mesh_.F.row(Eigen::Index(f)) = near[f];
  }

  const Eigen::AlignedBox3d& box() const { return box_; }
  const Triangles& F() const { return mesh_.F; }

  void move(std::span<const Ellipse> slices) {
    update_muscle_surface(surface_, slices, positions_);
    mesh_.V.topRows(positions_.rows()) = positions_;
    if (rays_)
      rays_->move(positions_);
    else
      rays_.emplace(mesh_.V, mesh_.F, solids_, positions_.rows());
  }

  // The muscle that has to come up on a ray, and by how much.
  Raise look(const UndersideSample& sample, std::vector<Crossing>& crossings,
             std::vector<RayInterval>& intervals) const {
    const Vec3 from = sample.point - kAbove * sample.layer * sample.inwards;
    const double far = kAbove * sample.layer + kBeneath;
    rays_->cross(from, sample.inwards, far, far, kNone, crossings);
    find_intervals(crossings, solids_, far, intervals);
    std::erase_if(intervals,
                  [&](const RayInterval& one) { return level(one.solid) == Level::none; });
    std::ranges::stable_sort(intervals, {}, &RayInterval::from);
    if (intervals.empty() || level(intervals.front().solid) != Level::deeper) return {};
    const RayInterval& first = intervals.front();
    for (const RayInterval& over : intervals) {
      if (over.from > first.from + kThrough) break;
      if (level(over.solid) != Level::cover) continue;
      for (const Crossing& crossing : crossings)
        if (crossing.entering && solids_[std::size_t(crossing.triangle)] == over.solid)
          return {crossing.triangle, float(over.from - first.from + kOver), sample.inwards};
    }
    return {};
  }

 private:
  Level level(int solid) const { return levels_[std::size_t(solid)]; }

  const MuscleSurface& surface_;
  std::vector<Level> levels_;  // by solid: muscles, and all ribs as the last
  std::vector<int> solids_;    // by triangle
  TriMesh mesh_;
  Points positions_;
  Eigen::AlignedBox3d box_;
  std::optional<CrossingRays> rays_;
};

// The factor of a section's outline in a direction, `more` metres further out if the skin is not
// met before.
float raised(float factor, float more, const Vec3& centre, const Vec3& edge, const SkinRays& skin) {
  const double length = std::max(edge.norm(), 1e-6);
  const RayHit hit = skin.first_hit(centre, edge / length);
  const double room = hit.triangle >= 0 && hit.facing > 0 ? double(hit.distance) - kUnderSkin : 0;
  const double out = std::min(double(factor) * length + double(more), room);
  return std::max(factor, std::min(kMostFactor, float(out / length)));
}

std::vector<UndersideSample> samples_over(const Chest& chest, const SkinRays& skin,
                                          const FatLayer& fat) {
  std::vector<char> looked_at(fat.thickness.size());
  for (std::size_t i = 0; i < looked_at.size(); ++i)
    looked_at[i] = chest.box().contains(Vec3(skin.mesh().V.row(Eigen::Index(i))));
  return underside_samples(skin.mesh(), fat.thickness, looked_at, kBetweenRays);
}

}  // namespace

long long restore_layers(const Anatomy& anatomy, std::span<Ellipse> slices,
                         std::span<const int> partners, const SkinRays& skin, const FatLayer& fat) {
  const Eigen::AlignedBox3d sight = sight_of(anatomy, slices, partners);
  if (sight.isEmpty()) return 0;
  const MuscleSurface surface = make_muscle_surface(anatomy);
  PackedSections sections(anatomy, surface, slices, partners);
  Chest chest(anatomy, surface, sections.slices, sight);
  const std::vector<UndersideSample> samples = samples_over(chest, skin, fat);
  for (int round = 0; round < kRounds; ++round) {
    chest.move(sections.slices);
    std::vector<Raise> raises(samples.size());
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t k) {
      thread_local std::vector<Crossing> crossings;
      thread_local std::vector<RayInterval> intervals;
      raises[k] = chest.look(samples[k], crossings, intervals);
    });
    const std::vector<float> asked = asked_of_sections(sections, surface, chest.F(), raises);
    for (std::size_t k = 0; k < sections.slices.size(); ++k) {
      SliceOutline& outline = sections.slices[k].outline;
      for (std::size_t i = 0; i < kOutlinePoints; ++i)
        if (const float more = asked[k * kOutlinePoints + i]; more > 0)
          outline[i] =
              raised(outline[i], more, sections.slices[k].center, sections.edge(k, i), skin);
      sections.fill(k, outline);
    }
  }
  for (const StripPlace& strip : sections.strips)
    for (std::size_t k = strip.begin; k < strip.end && !sections.is_mirrored(strip); ++k)
      slices[k].outline = sections.slices[k].outline;
  return kRounds * std::ssize(samples);
}

}  // namespace ecorche::inline v1
