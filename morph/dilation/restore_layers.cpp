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
constexpr int kNone = -1;

enum class Level { none, deeper, cover };

bool is_rib(const Bone& bone) { return bone.name.starts_with("rib"); }

// Muscles as drawn and ribs, in a body whose sections change.
class Chest {
 public:
  Chest(const Anatomy& anatomy, const MuscleSurface& surface) : surface_(surface) {
    for (const Muscle& muscle : anatomy.muscles)
      levels_.push_back(lies_in_fat(muscle)             ? Level::none
                        : muscle.layer == "superficial" ? Level::cover
                                                        : Level::deeper);
    std::vector<const TriMesh*> ribs;
    for (const Bone& bone : anatomy.bones)
      if (is_rib(bone)) ribs.push_back(&bone.mesh);
    if (ribs.empty()) return;
    const TriMesh joined = join_meshes(ribs);
    for (Eigen::Index i = 0; i < joined.V.rows(); ++i) box_.extend(Vec3(joined.V.row(i)));
    box_.min().array() -= kAboutRibs;
    box_.max().array() += kAboutRibs;
    mesh_.V.resize(surface.vertices() + joined.V.rows(), 3);
    mesh_.V.bottomRows(joined.V.rows()) = joined.V;
    mesh_.F.resize(surface.F.rows() + joined.F.rows(), 3);
    mesh_.F.topRows(surface.F.rows()) = surface.F;
    mesh_.F.bottomRows(joined.F.rows()) = (joined.F.array() + surface.vertices()).matrix();
    for (Eigen::Index f = 0; f < surface.F.rows(); ++f)
      solids_.push_back(surface.muscle[std::size_t(surface.F(f, 0))]);
    solids_.insert(solids_.end(), std::size_t(joined.F.rows()), int(levels_.size()));
    levels_.push_back(Level::deeper);
  }

  bool has_ribs() const { return mesh_.F.rows() > 0; }
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
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Chest chest(anatomy, surface);
  if (!chest.has_ribs()) return 0;
  const std::vector<UndersideSample> samples = samples_over(chest, skin, fat);
  PackedSections sections(anatomy, surface, slices, partners);
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
