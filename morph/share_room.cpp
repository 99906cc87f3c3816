#include "morph/share_room.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "anatomy/muscle_line.h"
#include "anatomy/muscle_surface.h"
#include "anatomy/outline.h"
#include "morph/crossing_rays.h"

namespace ecorche {

namespace {

constexpr std::size_t kDirections = kOutlinePoints;
constexpr int kBone = -1;
constexpr double kTendonLevel = 0.4;   // levels of tendons count this much: they keep their room before bellies do
constexpr double kGrowRate = 0.8;      // of the room, a round
constexpr double kMostGrowth = 0.035;  // m, beyond the ellipse
constexpr double kWanting = 0.5;       // need beyond 1 that makes a muscle grow into all of a deep room
constexpr double kPush = 0.5;          // of a radius, into a neighbour that has more than its need
constexpr double kLeastShare = 0.3;    // of the volume that a muscle comes with, to begin with
constexpr double kThinnest = 2e-4;     // m
constexpr double kMostPress = 0.6;     // factor of a sheet's thickness in a round
constexpr float kMainTerm = 0.2f;      // weight of a section that a vertex between strips follows
constexpr double kSteepest = 0.25;     // least cosine that the layer's slope is taken to have
constexpr int kLevelSteps = 6, kHalvings = 5;
constexpr std::size_t kMostStrips = 16;  // of a muscle, that are looked at

enum class Round { parting, growing, settling };

struct StripPlace {
  int muscle = 0;
  bool sheet = false;
  std::size_t begin = 0, end = 0;  // slices
  int label = 0;                   // of its surface: a sheet's strips have one
};

// Memory for a ray.
struct Sight {
  std::vector<Crossing> crossings;
  std::vector<Stay> stays;
};

// From a section's centre in one direction.
struct Spoke {
  float base = 0;       // the drawn ellipse's radius, m
  float layer = 1e3f;   // to the layer of fat, m
  float most = 1e3f;    // to where the layer has given as far as it can
};

// To a micrometre: who meets whom is yes or no, and must not turn on the last digits of two ways to the same place.
double rounded(double x) { return std::round(x * 1e6) / 1e6; }

Ellipse rounded(Ellipse e) {
  const auto each = [](double x) { return rounded(x); };
  e.center = e.center.unaryExpr(each).eval();
  e.axes = e.axes.unaryExpr(each).eval();
  e.radii = e.radii.unaryExpr(each).eval();
  return e;
}

class Sharing {
 public:
  Sharing(Anatomy& anatomy, std::span<Ellipse> slices, std::span<const double> wanted, std::span<const int> partners, const SkinRays& skin,
          const FatLayer& fat, const SharingLimits& limits)
      : anatomy_(anatomy), given_(slices), slices_(slices.begin(), slices.end()), wanted_(wanted), partners_(partners), limits_(limits), surface_(make_muscle_surface(anatomy)) {
    for (Ellipse& e : slices_) e = rounded(e);
    lay_out();
    find_drawn();
    find_layer(skin, fat);
    add_bones();
  }

  void round(Round kind, int smoothing) {
    look();
    plan(kind);
    std::vector<SliceOutline> next(slices_.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, strips_.size(), 4), [&](const auto& range) {
      Sight sight;
      for (std::size_t s = range.begin(); s < range.end(); ++s) {
        const StripPlace& strip = strips_[s];
        if (partners_[static_cast<std::size_t>(strip.muscle)] >= 0) continue;
        for (std::size_t k = strip.begin; k < strip.end; ++k) {
          for (std::size_t i = 0; i < kDirections; ++i)
            next[k][i] = due_[k * kDirections + i] ? static_cast<float>(reach(k, i, strip, kind, sight) / static_cast<double>(spokes_[k * kDirections + i].base)) : slices_[k].outline[i];
          fill(k, next[k]);
        }
        for (int pass = 0; pass < smoothing; ++pass) smooth(std::span(next).subspan(strip.begin, strip.end - strip.begin));
      }
    });
    if (kind == Round::settling) {
      for (std::size_t ray = 0; ray < due_.size(); ++ray) due_[ray] = due_[ray] && next[ray / kDirections][ray % kDirections] < slices_[ray / kDirections].outline[ray % kDirections];
      press_between(next);
    }
    for (const StripPlace& strip : strips_) {
      if (partners_[static_cast<std::size_t>(strip.muscle)] >= 0) continue;
      for (std::size_t k = strip.begin; k < strip.end; ++k) slices_[k].outline = next[k];
    }
    mirror();
  }

  void finish() {
    std::size_t at = 0;
    for (Muscle& muscle : anatomy_.muscles)
      for (Strip& strip : muscle.strips)
        for (Slice& slice : strip.slices) {
          given_[at].outline = slices_[at].outline;
          slice.outline = slices_[at++].outline;
        }
  }

  // Every muscle as if it had its volume already; those that reached the layer by more grow back to it.
  void begin() {
    for (std::size_t m = 0; m < wanted_.size(); ++m) {
      double volume = 0;
      for (std::size_t s = strip_begin_[m]; s < strip_begin_[m + 1]; ++s) volume += tube_volume(std::span<const Ellipse>(slices_).subspan(strips_[s].begin, strips_[s].end - strips_[s].begin));
      const double factor = volume > 0 ? std::sqrt(std::clamp(wanted_[m] / volume, kLeastShare, 1.0)) : 1;
      for (std::size_t k = muscle_begin_[m]; k < muscle_begin_[m + 1]; ++k) {
        // Flat sections get thinner, not narrower.
        const Vec2& radii = slices_[k].radii;
        const double flat = std::clamp((radii.maxCoeff() / std::max(radii.minCoeff(), 1e-6) - 1) / 2, 0.0, 1.0) * (radii.x() > radii.y() ? 1 : -1);
        const double own = 1 + belly_[k] * (factor - 1);
        const Vec2 scale(std::pow(own, 1 - flat), std::pow(own, 1 + flat));
        for (std::size_t i = 0; i < kDirections; ++i) slices_[k].outline[i] = static_cast<float>(1 / outline_directions()[i].cwiseQuotient(scale).norm());
      }
    }
  }

  const SharingReport& report() const { return report_; }

 private:
  void lay_out() {
    std::size_t at = 0;
    for (std::size_t m = 0; m < anatomy_.muscles.size(); ++m) {
      muscle_begin_.push_back(at);
      strip_begin_.push_back(strips_.size());
      for (const Strip& strip : anatomy_.muscles[m].strips) {
        const bool sheet = surface_.parts[m].sheet;
        strips_.push_back({static_cast<int>(m), sheet, at, at + strip.slices.size(), static_cast<int>(sheet ? strip_begin_[m] : strips_.size())});
        at += strip.slices.size();
        for (const Slice& slice : strip.slices) belly_.push_back(belly_weight(strip, slice.s));
      }
    }
    muscle_begin_.push_back(at);
    strip_begin_.push_back(strips_.size());
    thickness_.assign(at, 1);
    for (const MuscleSurface::Part& part : surface_.parts) {
      const auto m = static_cast<std::size_t>(part.muscle);
      std::fill(thickness_.begin() + static_cast<long>(muscle_begin_[m]), thickness_.begin() + static_cast<long>(muscle_begin_[m + 1]), static_cast<double>(part.thickness));
    }
    needs_.assign(anatomy_.muscles.size(), 1);
    weights_.assign(anatomy_.muscles.size(), 1);
  }

  // Directions whose factor moves a vertex of the drawn surface: all of a tube's, of a sheet's strips the sides and the outer edges.
  void find_drawn() {
    drawn_.assign(slices_.size() * kDirections, 0);
    for (const MuscleSurface::Term& t : surface_.terms)
      if (t.u != 0 || t.v != 0) drawn_[static_cast<std::size_t>(t.slice) * kDirections + static_cast<std::size_t>(std::lround(t.place)) % kDirections] = 1;
  }
  bool drawn(std::size_t k, std::size_t i) const { return drawn_[k * kDirections + i] != 0; }

  Vec3 edge(std::size_t k, std::size_t i) const {
    const Ellipse& e = slices_[k];
    const Vec2& d = outline_directions()[i];
    return e.radii.x() * d.x() * e.axes.col(0) + thickness_[k] * e.radii.y() * d.y() * e.axes.col(1);
  }

  void find_layer(const SkinRays& skin, const FatLayer& fat) {
    spokes_.resize(slices_.size() * kDirections);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slices_.size(), 16), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k)
        for (std::size_t i = 0; i < kDirections; ++i) {
          const Vec3 to_edge = edge(k, i);
          Spoke& spoke = spokes_[k * kDirections + i];
          spoke.base = std::max(static_cast<float>(to_edge.norm()), 1e-6f);
          const RayHit hit = skin.first_hit(slices_[k].center, to_edge / static_cast<double>(spoke.base));
          if (hit.triangle < 0) continue;
          const float layer = static_cast<float>(rounded(static_cast<double>(fat.at(skin.mesh().F, hit)))) / std::max(hit.facing, static_cast<float>(kSteepest));
          spoke.layer = hit.distance - layer;
          // Only ellipses that press into the layer may go on doing so, by half of it.
          spoke.most = std::max(spoke.layer, std::min(spoke.base, hit.distance - std::max(layer / 2, static_cast<float>(limits_.skin_gap))));
        }
    });
    report_.rays += static_cast<long long>(spokes_.size());
  }

  // Where rays can come to, and what can come to them: of an even body little more than one half.
  Eigen::AlignedBox3d within_sight() const {
    Eigen::AlignedBox3d box;
    for (const StripPlace& strip : strips_) {
      if (partners_[static_cast<std::size_t>(strip.muscle)] >= 0) continue;
      for (std::size_t k = strip.begin; k < strip.end; ++k) {
        const Vec3 far = Vec3::Constant(std::max(slices_[k].radii.x(), thickness_[k] * slices_[k].radii.y()) + 2 * kMostGrowth + limits_.reach);
        box.extend(slices_[k].center - far);
        box.extend(slices_[k].center + far);
      }
    }
    return box;
  }

  void add_bones() {
    Eigen::Index points = surface_.vertices(), faces = surface_.F.rows();
    for (const Bone& bone : anatomy_.bones) points += bone.mesh.V.rows(), faces += bone.mesh.F.rows();
    mesh_.V.resize(points, 3);
    mesh_.F.resize(faces, 3);
    mesh_.F.topRows(surface_.F.rows()) = surface_.F;
    points = surface_.vertices(), faces = surface_.F.rows();
    for (const Bone& bone : anatomy_.bones) {
      mesh_.V.middleRows(points, bone.mesh.V.rows()) = bone.mesh.V.unaryExpr([](double x) { return rounded(x); });
      mesh_.F.middleRows(faces, bone.mesh.F.rows()) = (bone.mesh.F.array() + static_cast<int>(points)).matrix();
      points += bone.mesh.V.rows();
      faces += bone.mesh.F.rows();
    }
    update_muscle_surface(surface_, slices_, positions_);
    mesh_.V.topRows(positions_.rows()) = positions_;
    std::vector<int> strip_of(slices_.size()), labels;
    for (std::size_t s = 0; s < strips_.size(); ++s)
      std::fill(strip_of.begin() + static_cast<long>(strips_[s].begin), strip_of.begin() + static_cast<long>(strips_[s].end), static_cast<int>(s));
    const Eigen::AlignedBox3d seen = within_sight();
    Triangles near(faces, 3);
    for (Eigen::Index f = 0; f < faces; ++f) {
      Eigen::AlignedBox3d box;
      for (int i = 0; i < 3; ++i) box.extend(mesh_.V.row(mesh_.F(f, i)).transpose());
      if (!box.intersects(seen)) continue;
      near.row(static_cast<Eigen::Index>(solids_.size())) = mesh_.F.row(f);
      const bool muscle = f < surface_.F.rows();
      const auto vertex = static_cast<std::size_t>(mesh_.F(f, 0));
      solids_.push_back(muscle ? surface_.muscle[vertex] : kBone);
      labels.push_back(muscle ? strips_[static_cast<std::size_t>(strip_of[static_cast<std::size_t>(surface_.slice[vertex])])].label : kBone);
    }
    mesh_.F = near.topRows(static_cast<Eigen::Index>(solids_.size()));
    flesh_.emplace(mesh_.V, mesh_.F, std::move(labels));
  }

  // Which rays are cast. Where nothing gave way in a settling round, nothing will in the next: all of them only give way.
  void plan(Round kind) {
    const bool again = kind == Round::settling && last_ == Round::settling;
    if (!again) {
      due_.assign(slices_.size() * kDirections, 0);
      for (const StripPlace& strip : strips_) {
        if (partners_[static_cast<std::size_t>(strip.muscle)] >= 0) continue;
        for (std::size_t k = strip.begin; k < strip.end; ++k)
          for (std::size_t i = 0; i < kDirections; ++i) due_[k * kDirections + i] = static_cast<char>(drawn(k, i));
      }
    }
    last_ = kind;
    report_.rays += std::count(due_.begin(), due_.end(), 1);
  }

  // Where everything is now, and who wants more.
  void look() {
    update_muscle_surface(surface_, slices_, positions_);
    mesh_.V.topRows(positions_.rows()) = positions_;
    flesh_->move(mesh_.V);
    for (const MuscleSurface::Part& part : surface_.parts) {
      const auto m = static_cast<std::size_t>(part.muscle);
      const double volume = part_volume(surface_, part, positions_);
      needs_[m] = volume > 0 ? std::pow(std::clamp(wanted_[m] / volume, 0.5, 2.0), 2) : 1;
      weights_[m] = std::pow(needs_[m], -0.25);
    }
  }

  // Everything on the ray but the strip itself. A sheet is one surface, which is left at the end of its own section.
  // It ends at `far`, or where it enters something beyond `enough`.
  void cast(const Vec3& from, const Vec3& direction, double far, double enough, const StripPlace& own, Sight& sight) const {
    flesh_->cross(from, direction, far, enough, own.label, sight.crossings);
    find_stays(sight.crossings, solids_, far, sight.stays);
  }

  // 0 on the line of a section's centre, 1 on its outline, as far as the section speaks for this place.
  double level(std::size_t k, const Vec3& p) const {
    const Ellipse& e = slices_[k];
    const Vec3 d = p - e.center;
    double x = d.dot(e.axes.col(0)) / std::max(e.radii.x(), 1e-6);
    if (!drawn(k, x > 0 ? 0 : kDirections / 2)) x = 0;  // the sheet goes on there
    const double y = d.dot(e.axes.col(1)) / std::max(thickness_[k] * e.radii.y(), 1e-6);
    double place = std::atan2(y, x) * (kOutlinePoints / 6.283185307179586);
    if (place < 0) place += kOutlinePoints;
    if (place >= kOutlinePoints) place = 0;
    return std::hypot(x, y) / std::max(outline_factor(e.outline, place), 1e-3);
  }

  double level_share(std::size_t slice) const { return kTendonLevel + (1 - kTendonLevel) * belly_[slice]; }

  // The same between a slice and the next one towards the point.
  double level_near(const StripPlace& strip, std::size_t k, const Vec3& p) const {
    const Ellipse& e = slices_[k];
    const double along = e.axes.col(2).dot(p - e.center);
    const std::size_t next = along > 0 ? std::min(k + 1, strip.end - 1) : k > strip.begin ? k - 1 : k;
    const double here = level_share(k) * level(k, p);
    if (next == k) return here;
    const double step = std::abs(e.axes.col(2).dot(slices_[next].center - e.center));
    const double share = std::clamp(std::abs(along) / std::max(step, 1e-6), 0.0, 1.0);
    return (1 - share) * here + share * level_share(next) * level(next, p);
  }

  // The slice of a strip whose centre is nearest.
  std::size_t nearest(const StripPlace& strip, const Vec3& p) const {
    std::size_t best = strip.begin;
    double least = 1e300;
    for (std::size_t k = strip.begin; k < strip.end; ++k) {
      const double d = (slices_[k].center - p).squaredNorm();
      if (d < least) least = d, best = k;
    }
    return best;
  }

  // Where a muscle that stays on the ray has to be parted from the section whose surface is at `radius`.
  double part(std::size_t k, std::size_t own, const Vec3& direction, double radius, const Stay& stay) const {
    const double mine = weights_[own] * level_share(k) / radius;
    const double end = std::min(stay.to, radius);
    const auto at = [&](double t) -> Vec3 { return slices_[k].center + t * direction; };
    const auto m = static_cast<std::size_t>(stay.solid);
    const Vec3 middle = at(0.5 * (stay.from + end));
    const std::size_t first = strip_begin_[m], count = std::min(strip_begin_[m + 1] - first, kMostStrips);
    std::array<std::size_t, kMostStrips> near;
    for (std::size_t s = 0; s < count; ++s) near[s] = nearest(strips_[first + s], middle);
    const auto theirs = [&](double t) {
      double least = 1e300;
      for (std::size_t s = 0; s < count; ++s) least = std::min(least, level_near(strips_[first + s], near[s], at(t)));
      return weights_[m] * least;
    };
    double low = stay.from, high = -1;
    if (mine * low >= theirs(low)) return low;
    for (int step = 1; step <= kLevelSteps; ++step) {
      const double t = stay.from + (end - stay.from) * step / kLevelSteps;
      if (mine * t >= theirs(t)) {
        high = t;
        break;
      }
      low = t;
    }
    if (high < 0) return radius;
    for (int step = 0; step < kHalvings; ++step) {
      const double half = 0.5 * (low + high);
      (mine * half >= theirs(half) ? high : low) = half;
    }
    return 0.5 * (low + high);
  }

  // The new radius in a direction, m.
  double reach(std::size_t k, std::size_t i, const StripPlace& strip, Round kind, Sight& sight) const {
    const bool grows = kind == Round::growing, settling = kind == Round::settling;
    const Spoke& spoke = spokes_[k * kDirections + i];
    const double base = static_cast<double>(spoke.base), now = base * static_cast<double>(slices_[k].outline[i]);
    const Vec3 direction = edge(k, i) / base;
    cast(slices_[k].center, direction, now + (settling ? limits_.settled_reach : limits_.reach), grows ? now : 1e3, strip, sight);
    double end = std::min(now, static_cast<double>(spoke.most));
    const double need = needs_[static_cast<std::size_t>(strip.muscle)];
    const double room = static_cast<double>(spoke.layer);
    const bool open = room > now + limits_.reach;  // that far off lie organs
    double deep = 1e3;  // to the next muscle or bone
    for (const Stay& stay : sight.stays) {
      if (stay.solid == strip.muscle) {  // another strip of the same muscle: they may share room, but not take each other's
        if (stay.to > now) deep = std::min(deep, std::max(now, stay.from));
      } else if (stay.solid == kBone) {
        if (stay.from > 0) end = std::min(end, stay.from - limits_.bone_gap), deep = std::min(deep, stay.from - limits_.bone_gap);
        else if (stay.to >= now) end = 0;
      } else if (stay.from >= now) {
        const double theirs = needs_[static_cast<std::size_t>(stay.solid)];
        const double push = std::clamp((need - theirs) / (need + theirs), 0.0, 0.5) * kPush * now;
        deep = std::min(deep, now + (stay.from - now) * need / (need + theirs) + push - limits_.gap);
      } else {
        const double parted = part(k, static_cast<std::size_t>(strip.muscle), direction, now, stay);
        if (parted < now) end = std::min(end, parted - limits_.gap);
      }
    }
    const double least = limits_.least * base;
    if (!grows || end < now || belly_[k] <= 0) return std::max(end, least);
    const double most = std::min(limits_.most * base, base + kMostGrowth);
    // Room that ends at the layer is filled; what is deep stays open to fat and vessels unless volume is wanting.
    const bool outwards = !open && room <= deep;
    const double rate = kGrowRate * belly_[k] * (!outwards ? std::clamp((need - 1) / kWanting, 0.0, 1.0) : 1);
    const double growth = std::min({room, deep, most, now + limits_.reach}) - now;
    return growth > 0 ? now + rate * growth : std::max(end, least);
  }

  // Sheets are drawn between their strips, too: where they reach into others there, the strips on either side give way.
  void press_between(std::vector<SliceOutline>& next) const {
    std::vector<float> ratios(static_cast<std::size_t>(surface_.vertices()), 1);
    for (const MuscleSurface::Part& sheet : surface_.parts) {
      const auto m = static_cast<std::size_t>(sheet.muscle);
      if (!sheet.sheet || partners_[m] >= 0) continue;
      tbb::parallel_for(tbb::blocked_range<int>(sheet.vertex_begin, sheet.vertex_end, 64), [&](const auto& range) {
        Sight sight;
        for (int v = range.begin(); v < range.end(); ++v) {
          const auto terms = std::span(surface_.terms).subspan(static_cast<std::size_t>(surface_.term_begin[static_cast<std::size_t>(v)]), static_cast<std::size_t>(surface_.term_begin[static_cast<std::size_t>(v) + 1] - surface_.term_begin[static_cast<std::size_t>(v)]));
          if (terms.size() < 2 || terms[0].w != 0) continue;
          Vec3 middle = Vec3::Zero();
          for (const MuscleSurface::Term& t : terms) middle += static_cast<double>(t.weight) * slices_[static_cast<std::size_t>(t.slice)].center;
          const Vec3 out = mesh_.V.row(v).transpose() - middle;
          const double now = out.norm();
          if (now < kThinnest) continue;
          cast(middle, out / now, now + limits_.settled_reach, 1e3, strips_[strip_begin_[m]], sight);
          double end = now;
          for (const Stay& stay : sight.stays)
            if (stay.from < now && (stay.from > 0 || stay.solid != kBone)) end = std::min(end, stay.solid == kBone ? stay.from - limits_.bone_gap : 0.5 * (stay.from + std::min(stay.to, now)) - limits_.gap);
          ratios[static_cast<std::size_t>(v)] = static_cast<float>(std::max(end / now, kMostPress));
        }
      });
    }
    for (std::size_t v = 0; v < ratios.size(); ++v) {
      if (ratios[v] >= 1) continue;
      for (int j = surface_.term_begin[v]; j < surface_.term_begin[v + 1]; ++j) {
        const MuscleSurface::Term& t = surface_.terms[static_cast<std::size_t>(j)];
        const auto k = static_cast<std::size_t>(t.slice);
        float& factor = next[k][static_cast<std::size_t>(std::lround(t.place)) % kDirections];
        if (t.weight > kMainTerm) factor = std::min(factor, std::max(static_cast<float>(limits_.least), ratios[v] * slices_[k].outline[static_cast<std::size_t>(std::lround(t.place)) % kDirections]));
      }
    }
  }

  // Directions that are not drawn lie between those that are.
  void fill(std::size_t k, SliceOutline& outline) const {
    for (std::size_t i = 0; i < kDirections; ++i) {
      if (drawn(k, i)) continue;
      std::size_t before = 1, after = 1;
      while (before < kDirections && !drawn(k, (i + kDirections - before) % kDirections)) ++before;
      while (after < kDirections && !drawn(k, (i + after) % kDirections)) ++after;
      if (before == kDirections) {
        outline[i] = 1;
        continue;
      }
      const float share = static_cast<float>(before) / static_cast<float>(before + after);
      outline[i] = (1 - share) * outline[(i + kDirections - before) % kDirections] + share * outline[(i + after) % kDirections];
    }
  }

  static void smooth(std::span<SliceOutline> outlines) {
    std::vector<SliceOutline> old(outlines.begin(), outlines.end());
    const std::size_t n = old.size();
    for (std::size_t k = 0; k < n; ++k) {
      const SliceOutline &before = old[k > 0 ? k - 1 : k], &after = old[k + 1 < n ? k + 1 : k], &here = old[k];
      for (std::size_t i = 0; i < kDirections; ++i) {
        const std::size_t left = (i + kDirections - 1) % kDirections, right = (i + 1) % kDirections;
        outlines[k][i] = (4 * here[i] + before[i] + after[i] + here[left] + here[right]) / 8;
      }
    }
  }

  void mirror() {
    for (std::size_t m = 0; m < anatomy_.muscles.size(); ++m) {
      if (partners_[m] < 0) continue;
      const std::size_t left = muscle_begin_[static_cast<std::size_t>(partners_[m])], right = muscle_begin_[m];
      for (std::size_t k = 0; k < muscle_begin_[m + 1] - right; ++k) {
        const Ellipse &from = slices_[left + k];
        Ellipse& to = slices_[right + k];
        const auto turned = [&](int axis) { return from.axes.col(axis).cwiseProduct(Vec3(-1, 1, 1)).dot(to.axes.col(axis)) < 0; };
        to.outline = flipped_outline(from.outline, turned(0), turned(1));
      }
    }
  }

  Anatomy& anatomy_;
  std::span<Ellipse> given_;
  std::vector<Ellipse> slices_;  // rounded
  std::span<const double> wanted_;
  std::span<const int> partners_;
  SharingLimits limits_;
  MuscleSurface surface_;
  std::vector<StripPlace> strips_;
  std::vector<std::size_t> muscle_begin_;  // #muscles + 1, slices
  std::vector<std::size_t> strip_begin_;   // #muscles + 1, into strips_
  std::vector<double> belly_, thickness_;  // #slices
  std::vector<char> drawn_;                // #slices x #directions
  std::vector<char> due_;                  // #slices x #directions: rays of this round
  Round last_ = Round::parting;
  std::vector<Spoke> spokes_;              // #slices x #directions
  std::vector<double> needs_, weights_;    // #muscles: more than 1 where volume is wanting; of their levels
  TriMesh mesh_;                           // muscles, then bones
  Points positions_;                       // of the muscles' surface
  std::vector<int> solids_;                // #triangles: muscle or bone
  std::optional<CrossingRays> flesh_;      // of mesh_
  SharingReport report_;
};

}  // namespace

SharingReport share_room(Anatomy& anatomy, std::span<Ellipse> slices, std::span<const double> wanted, std::span<const int> partners,
                         const SkinRays& rays, const FatLayer& fat, const SharingLimits& limits) {
  if (slices.empty()) return {};
  Sharing sharing(anatomy, slices, wanted, partners, rays, fat, limits);
  sharing.begin();
  for (int round = 0; round < limits.parting; ++round) sharing.round(Round::parting, 1);
  for (int round = 0; round < limits.growing; ++round) sharing.round(Round::growing, 1);
  for (int round = 0; round < limits.settling; ++round) sharing.round(Round::settling, 0);
  sharing.finish();
  return sharing.report();
}

}  // namespace ecorche
