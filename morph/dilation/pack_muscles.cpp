#include "morph/dilation/pack_muscles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/muscles/surface_edges.h"
#include "anatomy/queries/occupancy_grid.h"
#include "anatomy/queries/ray_crossings.h"
#include "morph/dilation/fill_gaps.h"
#include "morph/dilation/lay_wall.h"
#include "morph/dilation/packed_sections.h"
#include "morph/dilation/spoke_limits.h"

namespace ecorche::inline v1 {

namespace {

constexpr std::size_t kDirectionsPackMuscles = kOutlinePoints;
constexpr int kBone = -1;

// Cosine between a direction and the width of a section: from here on the direction counts as
// sideways (muscles that only thicken do not grow that way).
constexpr double kSideways = 0.55;
// Growth. Larger rates and limits fill gaps in fewer rounds, and let neighbours overshoot one
// another; smaller ones leave gaps.
constexpr double kGrowRate = 0.8;      // fraction of the free room taken in a round
constexpr double kMostGrowth = 0.045;  // m, beyond the ellipse
// Sheets, where they are so many times as wide as thick, grow wider by at most so much, m: else
// their free edges fill the room under the fat.
constexpr double kFlat = 3, kMostWider = 0.003;
constexpr double kMostSheath = 0.003;  // m in a round, of tendons: their sheaths
constexpr double kTendonPower = 5;     // larger: what is a little belly grows like a whole one
// Need is the target volume over the present one. A muscle grows into all of a deep room where its
// need is above 1 by this; larger: deep muscles stay thin.
constexpr double kWanting = 0.5;
// What stands out beyond its neighbours is taken back: ridges shorter than `ridge` (m) along a
// strip, but for so much of a rise a length; and points of an outline farther out than so many
// times the mean of the two beside them (a corner between two planes at a right angle: 1.3).
struct Levels {
  double ridge = 0, rise = 0;
  float sharpest = 1;
};
// In every round: stricter levels leave gaps under the layer (2 points less is filled with those of
// torn muscles); looser ones leave fins where one section finds room that those beside it do not.
constexpr Levels kLevels{0.010, 1.5, 1.6f};
// Of muscles that have needles, in the rounds that follow. Stricter: men of great mass are filled
// by 0.3 % less.
constexpr Levels kTornLevels{0.015, 0.15, 1.45f};
constexpr double kPackedNeedle = 0.008;  // m that a point stands off more than that of an ellipse
// Or that share of the way to the next section, where they are few: a blunt edge is no needle.
constexpr double kNeedleStep = 0.6;
constexpr int kFewNeedles = 6;  // of a muscle, that are left
constexpr int kFewRaised = 2;   // of them, that stand out of the surface
// Share of its thickness that a section loses on a tendinous intersection.
constexpr float kGroove = 0.14f;
// Radii by which a needy muscle moves the border into a neighbour with less need; larger: volumes
// agree better with their targets, sections are more uneven.
constexpr double kPush = 0.5;
// Needs are counted as if a muscle had at least this fraction of the volume that it came with.
constexpr double kLeastShare = 0.3;
constexpr double kThinnest = 2e-4;  // m: thinner sections are not pressed
// Least factor by which a section is pressed for what lies between sections, in a round; smaller:
// fewer rounds, and dents.
constexpr double kMostPress = 0.8;
// m: overlap between a tube's sections from which on they are pressed; larger: overlap remains.
constexpr double kDeep = 1e-3;
// weight of a section that a vertex between strips follows
constexpr float kMainTermPackMuscles = 0.2f;
constexpr double kTouchedCell = 0.004, kRayCell = 0.02;  // m, of search grids; speed only

enum class Round { parting, growing, covering_around, covering, settling };

bool covers(Round kind) { return kind == Round::covering || kind == Round::covering_around; }

// Workspace of a ray, reused from one to the next.
struct RayBuffer {
  std::vector<Crossing> crossings;
  std::vector<RayInterval> intervals;
};

class MusclePacking {
 public:
  MusclePacking(Anatomy& anatomy, std::span<Ellipse> slices, std::span<const double> wanted,
                std::span<const int> partners, const SkinRays& skin, const FatLayer& fat,
                const PackingLimits& limits, const DilationTrace& trace)
      : anatomy_(anatomy),
        given_(slices),
        wanted_(wanted),
        limits_(limits),
        trace_(trace),
        surface_(make_muscle_surface(anatomy)),
        all_(anatomy, surface_, slices, trace.with_held(partners)),
        torn_(wanted.size(), 0),
        needs_(wanted.size(), 1.0),
        underside_(underside(skin.mesh(), fat)) {
    for (const Muscle& muscle : anatomy.muscles)
      thickening_.push_back(muscle.group == "face_jaw" || lies_in_fat(muscle)),
          staying_.push_back(thickening_.back() || muscle.layer == "deep"),
          places_.push_back(place_in_wall(muscle));
    limit_by_skin(skin, fat);
    add_bones();
  }

  void round(Round kind, int smoothing) {
    look();
    if (covers(kind)) {
      asked_ = find_gaps(all_, surface_, underside_, *flesh_, mesh_.F, solids_,
                         kind == Round::covering_around);
      report_.rays += underside_.points.rows();
    }
    plan(kind);
    std::vector<SliceOutline> next(all_.slices.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, all_.strips.size(), 4), [&](const auto& range) {
          RayBuffer buffer;
          for (std::size_t s = range.begin(); s < range.end(); ++s) {
            const StripPlace& strip = all_.strips[s];
            if (all_.is_mirrored(strip)) continue;
            for (std::size_t k = strip.begin; k < strip.end; ++k) {
              for (std::size_t i = 0; i < kDirectionsPackMuscles; ++i)
                next[k][i] = due_[k * kDirectionsPackMuscles + i]
                                 ? float(reach(k, i, strip, kind, buffer) /
                                         double(spokes_[k * kDirectionsPackMuscles + i].base))
                                 : all_.slices[k].outline[i];
              all_.fill(k, next[k]);
            }
            for (int pass = 0; pass < smoothing; ++pass)
              smooth_outlines(std::span(next).subspan(strip.begin, strip.end - strip.begin));
          }
        });
    if (kind == Round::settling) {
      for (std::size_t ray = 0; ray < due_.size(); ++ray)
        due_[ray] =
            due_[ray] &&
            next[ray / kDirectionsPackMuscles][ray % kDirectionsPackMuscles] <
                all_.slices[ray / kDirectionsPackMuscles].outline[ray % kDirectionsPackMuscles];
      press_between(next);
      press_along(next);
      settled_.gave_way = due_;
    }
    for (const StripPlace& strip : all_.strips) {
      if (all_.is_mirrored(strip)) continue;
      level_off(strip, torn_[strip.muscle] ? kTornLevels : kLevels, next);
      for (std::size_t k = strip.begin; k < strip.end; ++k) all_.slices[k].outline = next[k];
    }
    follow();
    mirror();
    ++rounds_;
    if (kind != Round::settling) return;
    settled_.outlines.clear();
    for (const Ellipse& slice : all_.slices) settled_.outlines.push_back(slice.outline);
  }

  // Takes back what stands out beyond its neighbours along and round a strip; nothing grows by it.
  void level_off(const StripPlace& strip, const Levels& levels,
                 std::vector<SliceOutline>& outlines) const {
    constexpr std::size_t n = kDirectionsPackMuscles;
    for (std::size_t k = strip.begin; k < strip.end; ++k) {
      const SliceOutline old = outlines[k];
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t left = (i + n - 1) % n, right = (i + 1) % n;
        if (all_.is_drawn(k, left) && all_.is_drawn(k, i) && all_.is_drawn(k, right))
          outlines[k][i] = std::min(old[i], levels.sharpest * 0.5f * (old[left] + old[right]));
      }
    }
    const std::size_t count = strip.end - strip.begin;
    if (count < 4) return;
    double length = 0;
    for (std::size_t k = strip.begin + 1; k < strip.end; ++k)
      length += (all_.slices[k].center - all_.slices[k - 1].center).norm();
    const double step = length / double(count - 1);
    const std::size_t window =
        std::clamp(std::size_t(levels.ridge / std::max(step, 1e-4)) + 2, std::size_t{2}, count / 2);
    std::vector<float> least(count - window + 1);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < least.size(); ++j) {
        least[j] = outlines[strip.begin + j][i];
        for (std::size_t k = 1; k < window; ++k)
          least[j] = std::min(least[j], outlines[strip.begin + j + k][i]);
      }
      for (std::size_t k = 0; k < count; ++k) {
        if (!all_.is_drawn(strip.begin + k, i)) continue;
        float level = 0;
        for (std::size_t j = k + 1 < window ? 0 : k + 1 - window;
             j <= std::min(k, least.size() - 1); ++j)
          level = std::max(level, least[j]);
        const double base = double(spokes_[(strip.begin + k) * n + i].base);
        float& factor = outlines[strip.begin + k][i];
        factor = std::min(factor, level + float(levels.rise * step / base));
      }
    }
  }

  // From each section to the next one of its strip, m.
  std::vector<double> steps_along() const {
    std::vector<double> out(all_.slices.size(), 0);
    for (const StripPlace& strip : all_.strips)
      for (std::size_t k = strip.begin; k < strip.end; ++k) {
        const std::size_t one = std::min(k, std::max(strip.begin, strip.end - 2));
        if (one + 1 < strip.end)
          out[k] = (all_.slices[one + 1].center - all_.slices[one].center).norm();
      }
    return out;
  }

  // How points stand off if sections are ellipses.
  void look_at_ellipses() {
    std::vector<Ellipse> ellipses = all_.slices;
    for (Ellipse& ellipse : ellipses) ellipse.outline = kEllipticOutline;
    Points smooth;
    update_muscle_surface(surface_, ellipses, smooth);
    edges_ = inner_edges(surface_, smooth);
    std::erase_if(edges_, [&](const SurfaceEdge& edge) { return is_mirrored(edge.muscle); });
    of_ellipses_ = standing_off(surface_, edges_, smooth);
  }

  // Muscles with points that stand off their neighbours and would not if sections were ellipses,
  // some of them out of the surface, are kept level from here on.
  void find_torn() {
    if (edges_.empty()) look_at_ellipses();
    update_muscle_surface(surface_, all_.slices, positions_);
    const Standing is = standing_off(surface_, edges_, positions_);
    const Standing& was = of_ellipses_;
    const std::vector<double> steps = steps_along();
    std::vector<int> off(wanted_.size(), 0), out(wanted_.size(), 0);
    for (std::size_t v = 0; v < is.off.size(); ++v) {
      const double needle = std::max(kPackedNeedle, kNeedleStep * steps[surface_.slice[v]]);
      off[surface_.muscle[v]] += is.off[v] > was.off[v] + needle;
      out[surface_.muscle[v]] += std::abs(is.out[v]) > std::abs(was.out[v]) + needle;
    }
    for (std::size_t m = 0; m < torn_.size(); ++m)
      if (off[m] > kFewNeedles && out[m] > kFewRaised) torn_[m] = 1;
  }

  void finish() {
    std::size_t at = 0;
    for (Muscle& muscle : anatomy_.muscles)
      for (Strip& strip : muscle.strips)
        for (Slice& slice : strip.slices) {
          groove(intersection_weight(strip, slice.s), all_.slices[at].outline);
          given_[at].outline = all_.slices[at].outline;
          slice.outline = all_.slices[at++].outline;
        }
  }

  // Thinner by a share of `depth`, as wide as before.
  static void groove(double depth, SliceOutline& outline) {
    for (std::size_t i = 0; i < kDirectionsPackMuscles && depth > 0; ++i)
      outline[i] *= 1 - kGroove * float(depth * std::abs(outline_directions()[i].y()));
  }

  // Every muscle as if it had its volume already; those that reached the layer by more grow back to
  // it.
  void begin() {
    for (std::size_t m = 0; m < wanted_.size(); ++m) {
      double volume = 0;
      for (std::size_t s = all_.strip_begin[m]; s < all_.strip_begin[m + 1]; ++s)
        volume += tube_volume(
            std::span<const Ellipse>(all_.slices)
                .subspan(all_.strips[s].begin, all_.strips[s].end - all_.strips[s].begin));
      const double factor =
          volume > 0 ? std::sqrt(std::clamp(wanted_[m] / volume, kLeastShare, 1.0)) : 1;
      for (std::size_t k = all_.muscle_begin[m]; k < all_.muscle_begin[m + 1]; ++k) {
        // Flat sections get thinner, not narrower.
        const Vec2& radii = all_.slices[k].radii;
        const double flat =
            std::clamp((radii.maxCoeff() / std::max(radii.minCoeff(), 1e-6) - 1) / 2, 0.0, 1.0) *
            (radii.x() > radii.y() ? 1 : -1);
        const double own = 1 + all_.belly[k] * (factor - 1);
        const Vec2 scale(std::pow(own, 1 - flat), std::pow(own, 1 + flat));
        for (std::size_t i = 0; i < kDirectionsPackMuscles; ++i)
          all_.slices[k].outline[i] =
              float(1 / outline_directions()[i].cwiseQuotient(scale).norm());
      }
    }
  }

  const PackingReport& report() const { return report_; }

 private:
  const PackingRound& round_before() const { return trace_.before->packing[rounds_]; }

  // Muscles that are held take their outlines of this round.
  void follow() {
    trace_.for_held(all_.muscle_begin, [&](std::size_t k, std::size_t before) {
      all_.slices[k].outline = round_before().outlines[before];
    });
    if (!trace_.record) return;
    PackingRound& written = trace_.record->packing.emplace_back();
    written.needs = needs_;
    for (const Ellipse& slice : all_.slices) written.outlines.push_back(slice.outline);
  }

  // Muscles end at the layer of fat, those that lie in it at the skin itself.
  void limit_by_skin(const SkinRays& skin, const FatLayer& fat) {
    std::vector<char> below, within;
    for (const Muscle& muscle : anatomy_.muscles)
      within.push_back(lies_in_fat(muscle)), below.push_back(!within.back());
    RadialLimits under = find_radial_limits(all_, below, skin, fat, underside_, limits_.skin_gap);
    spokes_ = std::move(under.spokes);
    report_.rays += under.rays;
    if (std::ranges::find(within, 1) == within.end()) return;
    const FatLayer bare = skin_of(fat);
    const RadialLimits in = find_radial_limits(all_, within, skin, bare,
                                               underside(skin.mesh(), bare), limits_.skin_gap);
    report_.rays += in.rays;
    for (std::size_t m = 0; m < within.size(); ++m)
      for (std::size_t ray = all_.muscle_begin[m] * kDirectionsPackMuscles;
           within[m] && ray < all_.muscle_begin[m + 1] * kDirectionsPackMuscles; ++ray)
        spokes_[ray] = in.spokes[ray];
  }

  // Where a section's rays can come to, and from where others can grow to there.
  Eigen::AlignedBox3d sight_of(std::size_t k) const {
    Eigen::AlignedBox3d box(all_.slices[k].center);
    for (std::size_t i = 0; i < kDirectionsPackMuscles; ++i) {
      if (!all_.is_drawn(k, i)) continue;
      const RadialLimit& spoke = spokes_[k * kDirectionsPackMuscles + i];
      const double base = double(spoke.base),
                   most = std::max(base, std::min(base + kMostGrowth, double(spoke.over)));
      box.extend(all_.slices[k].center + (most + limits_.reach) / base * all_.edge(k, i));
    }
    return {box.min() - Vec3::Constant(kMostGrowth), box.max() + Vec3::Constant(kMostGrowth)};
  }

  // All of that: of an even body little more than one half.
  TouchedCells find_sight() {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const StripPlace& strip : all_.strips)
      for (std::size_t k = strip.begin; k < strip.end && !all_.is_mirrored(strip); ++k)
        seen_.extend(boxes.emplace_back(sight_of(k)));
    TouchedCells cells(seen_, kRayCell);
    for (const Eigen::AlignedBox3d& box : boxes) cells.mark(box);
    return cells;
  }

  // What lies out of sight need not be drawn.
  void leave_out_unseen() {
    std::vector<char> seen(surface_.vertices(), 0);
    for (Eigen::Index f = 0; f < mesh_.F.rows() && solids_[f] != kBone; ++f)
      for (int i = 0; i < 3; ++i) seen[mesh_.F(f, i)] = 1;
    std::vector<MuscleSurface::Term> kept;
    std::vector<int> begin{0};
    for (std::size_t v = 0; v < seen.size(); ++v) {
      if (seen[v])
        kept.insert(kept.end(), surface_.terms.begin() + surface_.term_begin[v],
                    surface_.terms.begin() + surface_.term_begin[v + 1]);
      begin.push_back(int(kept.size()));
    }
    surface_.terms = std::move(kept);
    surface_.term_begin = std::move(begin);
  }

  void add_bones() {
    Eigen::Index points = surface_.vertices(), faces = surface_.F.rows();
    for (const Bone& bone : anatomy_.bones)
      points += bone.mesh.V.rows(), faces += bone.mesh.F.rows();
    mesh_.V.resize(points, 3);
    mesh_.F.resize(faces, 3);
    mesh_.F.topRows(surface_.F.rows()) = surface_.F;
    points = surface_.vertices(), faces = surface_.F.rows();
    for (const Bone& bone : anatomy_.bones) {
      mesh_.V.middleRows(points, bone.mesh.V.rows()) =
          bone.mesh.V.unaryExpr([](double x) { return rounded(x); });
      mesh_.F.middleRows(faces, bone.mesh.F.rows()) = (bone.mesh.F.array() + int(points)).matrix();
      points += bone.mesh.V.rows();
      faces += bone.mesh.F.rows();
    }
    update_muscle_surface(surface_, all_.slices, positions_);
    mesh_.V.topRows(positions_.rows()) = positions_;
    std::vector<int> strip_of(all_.slices.size()), labels;
    for (std::size_t s = 0; s < all_.strips.size(); ++s)
      std::fill(strip_of.begin() + long(all_.strips[s].begin),
                strip_of.begin() + long(all_.strips[s].end), int(s));
    const TouchedCells buffer = find_sight();
    Triangles near(faces, 3);
    for (Eigen::Index f = 0; f < faces; ++f) {
      const bool muscle = f < surface_.F.rows();
      const std::size_t vertex = mesh_.F(f, 0);
      Eigen::AlignedBox3d box;
      for (int i = 0; i < 3; ++i) box.extend(mesh_.V.row(mesh_.F(f, i)).transpose());
      if ((!muscle || is_mirrored(surface_.muscle[vertex])) && !buffer.touches(box)) continue;
      near.row(solids_.size()) = mesh_.F.row(f);
      solids_.push_back(muscle ? surface_.muscle[vertex] : kBone);
      labels.push_back(muscle ? all_.strips[strip_of[surface_.slice[vertex]]].label : kBone);
    }
    mesh_.F = near.topRows(solids_.size());
    flesh_.emplace(mesh_.V, mesh_.F, std::move(labels), surface_.vertices());
    leave_out_unseen();
  }

  // Or held: its outlines come from elsewhere.
  bool is_mirrored(int muscle) const { return all_.partners[muscle] >= 0; }

  // What has moved since the last settling round.
  void mark_touched() {
    if (!touched_) touched_.emplace(seen_, kTouchedCell);
    touched_->clear();
    const auto moved = [&](int v) {
      return (positions_.row(v).array() != settled_.positions.row(v).array()).any();
    };
    for (Eigen::Index f = 0; f < mesh_.F.rows() && mesh_.F(f, 0) < positions_.rows(); ++f) {
      if (!moved(mesh_.F(f, 0)) && !moved(mesh_.F(f, 1)) && !moved(mesh_.F(f, 2))) continue;
      Eigen::AlignedBox3d box;
      for (int i = 0; i < 3; ++i)
        box.extend(positions_.row(mesh_.F(f, i)).transpose())
            .extend(settled_.positions.row(mesh_.F(f, i)).transpose());
      touched_->mark(box);
    }
  }

  // Whether a ray that did not give way in the last settling round may in this one.
  bool may_give_way(std::size_t k, std::size_t i) const {
    const float factor = all_.slices[k].outline[i],
                base = spokes_[k * kDirectionsPackMuscles + i].base;
    if (settled_.gave_way[k * kDirectionsPackMuscles + i] || settled_.outlines[k][i] != factor)
      return true;
    return touched_->touches(all_.slices[k].center, all_.edge(k, i) / double(base),
                             double(base * factor) + limits_.settled_reach);
  }

  // Which rays are cast. Where nothing gave way in a settling round, nothing will in the next: all
  // of them only give way. Nor will it in a later one where nothing has moved since.
  void plan(Round kind) {
    const bool again = kind == Round::settling && last_ == Round::settling,
               later = kind == Round::settling && !again && !settled_.gave_way.empty();
    if (kind == Round::settling && !settled_.gave_way.empty()) mark_touched();
    if (!again) {
      due_.assign(all_.slices.size() * kDirectionsPackMuscles, 0);
      for (const StripPlace& strip : all_.strips) {
        if (all_.is_mirrored(strip)) continue;
        const bool intervals = does_stay(strip);
        for (std::size_t k = strip.begin; k < strip.end; ++k)
          for (std::size_t i = 0; i < kDirectionsPackMuscles; ++i)
            due_[k * kDirectionsPackMuscles + i] = char(
                all_.is_drawn(k, i) &&
                (!covers(kind) || (asked_[k * kDirectionsPackMuscles + i] > 0 && !intervals)) &&
                (!later || may_give_way(k, i)));
      }
    }
    last_ = kind;
    report_.rays += std::count(due_.begin(), due_.end(), 1);
  }

  // Where everything is now, and who wants more.
  void look() {
    update_muscle_surface(surface_, all_.slices, positions_);
    mesh_.V.topRows(positions_.rows()) = positions_;
    flesh_->move(positions_);
    if (last_ == Round::settling) settled_.positions = positions_;
    for (const MuscleSurface::Part& part : surface_.parts) {
      const std::size_t m = part.muscle;
      if (is_mirrored(part.muscle)) continue;
      const double volume = part_volume(surface_, part, positions_);
      needs_[m] = volume > 0 ? std::pow(std::clamp(wanted_[m] / volume, 0.5, 2.0), 2) : 1;
    }
    for (std::size_t m = 0; m < needs_.size(); ++m)
      if (trace_.holds(m)) needs_[m] = round_before().needs[std::size_t(trace_.held[m])];
    for (std::size_t m = 0; m < needs_.size(); ++m) {
      if (all_.partners[m] >= 0) needs_[m] = needs_[all_.partners[m]];
      all_.weights[m] = std::pow(needs_[m], -0.25);
    }
  }

  // Everything on the ray but the strip itself. A sheet is one surface, which is left at the end of
  // its own section. It ends at `far`, or where it enters something beyond `enough`.
  void cast(const Vec3& from, const Vec3& direction, double far, double enough,
            const StripPlace& own, RayBuffer& buffer) const {
    flesh_->cross(from, direction, far, enough, own.label, buffer.crossings);
    find_intervals(buffer.crossings, solids_, far, buffer.intervals);
  }

  // Beside the jaw's muscles lie glands and the cheek's pad of fat, beside those of the skin fat:
  // they grow for their volume's sake alone, and thicker, not wider.
  bool does_thicken(const StripPlace& strip) const { return thickening_[strip.muscle]; }

  // How far a section may grow in a direction, beyond the ellipse, m.
  double most_growth(std::size_t k, std::size_t i, const StripPlace& strip) const {
    const Vec2& radii = all_.slices[k].radii;
    if (!anatomy_.muscles[std::size_t(strip.muscle)].sheet || radii.x() <= kFlat * radii.y())
      return kMostGrowth;
    const double across = std::abs(outline_directions()[i].x());
    return std::min(kMostGrowth, kMostWider / std::max(across, 1e-6));
  }

  // Where a deep muscle lies next under the layer, others, tendons and vessels run over it: it
  // grows for its volume's sake alone.
  bool does_stay(const StripPlace& strip) const { return staying_[strip.muscle]; }

  // Whether a ray of a sheet of a wall comes out over one that covers it: where a big belly draws
  // the outer one's strips apart, it lies lower between them.
  bool comes_through(int muscle, const RayInterval& cover, double now) const {
    return cover.solid != kBone && cover.from > 0 && cover.to < now &&
           places_[std::size_t(muscle)].is_under(places_[std::size_t(cover.solid)]);
  }

  // The new radius in a direction, m.
  double reach(std::size_t k, std::size_t i, const StripPlace& strip, Round kind,
               RayBuffer& buffer) const {
    const bool grows = kind == Round::growing || covers(kind), settling = kind == Round::settling;
    const RadialLimit& spoke = spokes_[k * kDirectionsPackMuscles + i];
    const double base = double(spoke.base), now = base * double(all_.slices[k].outline[i]);
    const Vec3 direction = all_.edge(k, i) / base;
    cast(all_.slices[k].center, direction, now + (settling ? limits_.settled_reach : limits_.reach),
         settling ? 1e3 : now, strip, buffer);
    double end = std::min(now, double(spoke.most));
    const double need = needs_[strip.muscle];
    const double room = spoke.layer;
    const bool open = room > now + limits_.reach;  // that far off lie organs
    double deep = 1e3;                             // to the next muscle or bone
    for (const RayInterval& interval : buffer.intervals) {
      // another strip of the same muscle: they may share room, but not take each other's
      if (interval.solid == strip.muscle) {
        if (interval.to > now) deep = std::min(deep, std::max(now, interval.from));
      } else if (interval.solid == kBone) {
        if (interval.from > 0)
          end = std::min(end, interval.from - limits_.bone_gap),
          deep = std::min(deep, interval.from - limits_.bone_gap);
        else if (interval.to >= now)
          end = 0;
      } else if (comes_through(strip.muscle, interval, now)) {
        end = std::min(end, interval.from - limits_.gap);
      } else if (interval.from >= now) {
        const double theirs = needs_[interval.solid];
        const double push = std::clamp((need - theirs) / (need + theirs), 0.0, 0.5) * kPush * now;
        deep = std::min(deep,
                        now + (interval.from - now) * need / (need + theirs) + push - limits_.gap);
      } else {
        const double parted = all_.part(k, std::size_t(strip.muscle), direction, now, interval);
        if (parted < now) end = std::min(end, parted - limits_.gap);
      }
    }
    const double least = limits_.least * base;
    if (!grows || end < now || (kind == Round::growing && all_.belly[k] <= 0))
      return std::max(end, least);
    const double most = std::min(limits_.most * base, base + most_growth(k, i, strip));
    if (covers(kind)) {
      const double asked = asked_[k * kDirectionsPackMuscles + i];
      const double tendons = std::pow(1 - all_.belly[k], kTendonPower);
      return std::max(
          now, std::min({double(spoke.over), deep, most,
                         now + (1 - tendons) * asked + tendons * std::min(asked, kMostSheath)}));
    }
    if (does_thicken(strip) && std::abs(outline_directions()[i].x()) > kSideways)
      return std::max(end, least);
    // Room that ends at the layer is filled; what is deep stays open to fat and vessels unless
    // volume is wanting.
    const bool outwards = !open && room <= deep && !does_stay(strip);
    const double rate =
        kGrowRate * all_.belly[k] * (!outwards ? std::clamp((need - 1) / kWanting, 0.0, 1.0) : 1);
    const double growth = std::min({room, deep, most, now + limits_.reach}) - now;
    return growth > 0 ? now + rate * growth : std::max(end, least);
  }

  // What a vertex of a sheet between its strips keeps of its height, where it ends in another
  // muscle or a bone. What comes out of another again is free to the layer: that its root lies in
  // the other, as between strips that a big belly draws apart, is none of this side's making.
  double kept_between(int v, const StripPlace& own, RayBuffer& buffer) {
    const auto terms =
        std::span(surface_.terms)
            .subspan(std::size_t(surface_.term_begin[v]),
                     std::size_t(surface_.term_begin[v + 1] - surface_.term_begin[v]));
    if (terms.size() < 2 || terms[0].w != 0) return 1;
    Vec3 middle = Vec3::Zero();
    for (const MuscleSurface::Term& t : terms)
      middle += double(t.weight) * all_.slices[t.slice].center;
    const Vec3 out = mesh_.V.row(v).transpose() - middle;
    const double now = out.norm();
    if (now < kThinnest || is_settled(v, middle, out / now, now)) return 1;
    cast(middle, out / now, now + limits_.settled_reach, 1e3, own, buffer);
    double end = now;
    for (const RayInterval& interval : buffer.intervals) {
      if (interval.from >= now) continue;
      if (interval.solid == kBone) {
        if (interval.from > 0) end = std::min(end, interval.from - limits_.bone_gap);
      } else if (comes_through(own.muscle, interval, now)) {
        end = std::min(end, interval.from - limits_.gap);
      } else if (interval.to >= now) {
        end = std::min(end, 0.5 * (interval.from + now) - limits_.gap);
      }
    }
    return std::max(end / now, kMostPress);
  }

  // Sheets are drawn between their strips, too: where they end in others there, the strips on
  // either side give way.
  void press_between(std::vector<SliceOutline>& next) {
    std::vector<float> ratios(surface_.vertices(), 1);
    for (const MuscleSurface::Part& sheet : surface_.parts) {
      const std::size_t m = sheet.muscle;
      if (!sheet.sheet || all_.partners[m] >= 0) continue;
      const StripPlace& own = all_.strips[all_.strip_begin[m]];
      tbb::parallel_for(tbb::blocked_range<int>(sheet.vertex_begin, sheet.vertex_end, 64),
                        [&](const auto& range) {
                          RayBuffer buffer;
                          for (int v = range.begin(); v < range.end(); ++v)
                            ratios[v] = float(kept_between(v, own, buffer));
                        });
    }
    pressed_.resize(ratios.size());
    for (std::size_t v = 0; v < ratios.size(); ++v) pressed_[v] = ratios[v] < 1;
    for (std::size_t v = 0; v < ratios.size(); ++v) {
      if (ratios[v] >= 1) continue;
      for (int j = surface_.term_begin[v]; j < surface_.term_begin[v + 1]; ++j) {
        const MuscleSurface::Term& t = surface_.terms[j];
        const std::size_t k = t.slice;
        float& factor = next[k][outline_place(t)];
        if (t.weight > kMainTermPackMuscles)
          factor = std::min(factor, std::max(float(limits_.least),
                                             ratios[v] * all_.slices[k].outline[outline_place(t)]));
      }
    }
  }

  // Tubes are drawn straight from section to section: where an edge ends deep in another muscle
  // half-way there, the sections on either side give way by half of it. What begins in the other or
  // comes out of it again is none of the sides' making.
  void press_along(std::vector<SliceOutline>& next) {
    std::vector<float> ratios(due_.size(), 1);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, all_.strips.size(), 4), [&](const auto& range) {
          RayBuffer buffer;
          for (std::size_t s = range.begin(); s < range.end(); ++s) {
            const StripPlace& strip = all_.strips[s];
            for (std::size_t k = strip.begin;
                 k + 1 < strip.end && !strip.sheet && !all_.is_mirrored(strip); ++k) {
              const Vec3 middle = 0.5 * (all_.slices[k].center + all_.slices[k + 1].center);
              for (std::size_t i = 0; i < kDirectionsPackMuscles; ++i) {
                const Vec3 out =
                    0.5 * (double(all_.slices[k].outline[i]) * all_.edge(k, i) +
                           double(all_.slices[k + 1].outline[i]) * all_.edge(k + 1, i));
                const double now = out.norm();
                if (now < kThinnest || is_settled_along(k, i, middle, out / now, now)) continue;
                cast(middle, out / now, now + limits_.settled_reach, 1e3, strip, buffer);
                double end = now;
                for (const RayInterval& interval : buffer.intervals)
                  if (interval.solid != strip.muscle && interval.solid != kBone &&
                      interval.from > 0 && interval.from < now - kDeep && interval.to >= now)
                    end = std::min(end, 0.5 * (interval.from + now));
                ratios[k * kDirectionsPackMuscles + i] = float(std::max(end / now, kMostPress));
              }
            }
          }
        });
    pressed_along_.resize(ratios.size());
    for (std::size_t ray = 0; ray < ratios.size(); ++ray) {
      pressed_along_[ray] = ratios[ray] < 1;
      const std::size_t i = ray % kDirectionsPackMuscles, here = ray / kDirectionsPackMuscles;
      for (std::size_t k = here; k < here + 2 && ratios[ray] < 1; ++k)
        next[k][i] = std::min(
            next[k][i], std::max(float(limits_.least), ratios[ray] * all_.slices[k].outline[i]));
    }
  }

  // An edge between sections that was not pressed in the last settling round, and about which
  // nothing has moved since.
  bool is_settled_along(std::size_t k, std::size_t i, const Vec3& middle, const Vec3& direction,
                        double now) const {
    if (pressed_along_.empty() || pressed_along_[k * kDirectionsPackMuscles + i]) return false;
    if (settled_.outlines[k][i] != all_.slices[k].outline[i] ||
        settled_.outlines[k + 1][i] != all_.slices[k + 1].outline[i])
      return false;
    return !touched_->touches(middle, direction, now + limits_.settled_reach);
  }

  // A vertex between strips that was not pressed in the last settling round, and about which
  // nothing has moved since.
  bool is_settled(int v, const Vec3& middle, const Vec3& direction, double now) const {
    if (pressed_.empty() || pressed_[v] || positions_.row(v) != settled_.positions.row(v))
      return false;
    return !touched_->touches(middle, direction, now + limits_.settled_reach);
  }

  void mirror() {
    for (std::size_t m = 0; m < anatomy_.muscles.size(); ++m) {
      if (all_.partners[m] < 0 || all_.partners[m] == int(m)) continue;
      const auto of = [&](std::size_t muscle) {
        const std::size_t begin = all_.muscle_begin[muscle];
        return std::span(all_.slices).subspan(begin, all_.muscle_begin[muscle + 1] - begin);
      };
      mirror_outlines(of(std::size_t(all_.partners[m])), of(m));
    }
  }

  Anatomy& anatomy_;
  std::span<Ellipse> given_;
  std::span<const double> wanted_;
  PackingLimits limits_;
  DilationTrace trace_;
  std::size_t rounds_ = 0;  // done
  MuscleSurface surface_;
  PackedSections all_;
  std::vector<char> torn_;          // #muscles: kept level
  std::vector<SurfaceEdge> edges_;  // of what is not given
  Standing of_ellipses_;
  std::vector<double> needs_;        // #muscles: more than 1 where volume is wanting
  std::vector<RadialLimit> spokes_;  // #slices x #directions
  std::vector<float>
      asked_;  // #slices x #directions: in a covering round, how far to come up to the layer, m
  std::vector<char> due_;  // #slices x #directions: rays of this round
  Round last_ = Round::parting;
  struct Settled {
    std::vector<char> gave_way;  // #slices x #directions; empty before the first settling round
    std::vector<SliceOutline> outlines;  // as it left them,
    Points positions;                    // and what was drawn then
  } settled_;
  std::vector<char> pressed_;        // #vertices of the surface, in the last settling round
  std::vector<char> pressed_along_;  // #slices x #directions, from each to the next
  Eigen::AlignedBox3d seen_;         // within sight
  std::optional<TouchedCells> touched_;
  std::vector<char> thickening_;   // #muscles
  std::vector<char> staying_;      // #muscles: that do not come up to the layer
  std::vector<WallPlace> places_;  // #muscles
  Underside underside_;
  TriMesh mesh_;                       // muscles, then bones; triangles within sight
  Points positions_;                   // of the muscles' surface
  std::vector<int> solids_;            // #triangles: muscle or bone
  std::optional<CrossingRays> flesh_;  // of mesh_
  PackingReport report_;
};

}  // namespace

PackingReport pack_muscles(Anatomy& anatomy, std::span<Ellipse> slices,
                           std::span<const double> wanted, std::span<const int> partners,
                           const SkinRays& rays, const FatLayer& fat, const PackingLimits& limits,
                           const DilationTrace& trace) {
  if (slices.empty()) return {};
  MusclePacking sharing(anatomy, slices, wanted, partners, rays, fat, limits, trace);
  sharing.begin();
  for (int round = 0; round < limits.parting; ++round) sharing.round(Round::parting, 1);
  for (int round = 0; round < limits.growing; ++round) sharing.round(Round::growing, 1);
  for (int turn = 0; turn < limits.covering; ++turn) {
    sharing.find_torn();
    const Round kind = turn == 0 ? Round::covering_around : Round::covering;
    sharing.round(kind, 0);
    sharing.round(kind, 0);
    sharing.round(Round::settling, 0);
  }
  for (int round = 0; round < limits.settling; ++round) sharing.round(Round::settling, 0);
  sharing.finish();
  return sharing.report();
}

}  // namespace ecorche::inline v1
