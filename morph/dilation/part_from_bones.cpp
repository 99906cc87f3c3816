#include "morph/dilation/part_from_bones.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/slice_outline.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

// Of what may be left in bone, as seen along few lines, from which on more are looked at.
constexpr double kSuspect = 0.4;
constexpr int kPressRounds = 40;            // at most; most muscles need none
constexpr double kBoneGap = 0.3e-3;         // m
constexpr double kLeastFactor = 0.02;       // of outlines; larger: thick sheets stay in thin bones
constexpr double kMostPressFromBone = 0.7;  // least factor of a round
constexpr double kBeyond = 0.02;            // m past a line's end, where it may leave bone
constexpr double kShortest = 2e-4;          // m: lines that are not looked at
constexpr double kMainTermFromBone = 0.15;  // weight of a section that a point follows
constexpr double kPastSurface = 1e-6;       // m, from one crossing to the next

using Corners = std::array<double, 3>;  // weights of a triangle's

// A line from the middle of a strip to a point of its surface, that comes through bone.
struct PiercedLine {
  Eigen::Index face = 0;
  Corners place{};    // where it ends in the triangle
  double ratio = 0;   // of its length, at which it enters bone first
  double volume = 0;  // of the wedge about it that bone takes, m^3
  double worth = 0;   // the same, over all that is cut away where the line ends before bone
};

// Where lines end in each triangle of a surface: the middles of so many squared equal parts.
template <int kParts>
constexpr std::array<Corners, kParts * kParts> places_of_parts() {
  std::array<Corners, kParts * kParts> out{};
  std::size_t n = 0;
  constexpr double kStep = 1.0 / (3 * kParts);
  for (int i = 0; i < kParts; ++i)
    for (int j = 0; i + j < kParts; ++j) {
      const double a = (3 * i + 1) * kStep, b = (3 * j + 1) * kStep;
      out[n++] = {a, b, 1 - a - b};
      if (i + j + 1 == kParts) continue;
      out[n++] = {a + kStep, b + kStep, 1 - a - b - 2 * kStep};
    }
  return out;
}
// Which muscles are pierced is seen with few lines, where they are with many; fewer: thin bones
// slip through.
constexpr auto kFewPlaces = places_of_parts<1>();
constexpr auto kManyPlaces = places_of_parts<3>();

// What a line stands for: its share of the volume between a triangle of the surface and the same
// triangle on the middle of the strip, up to a part t of its length.
struct LineVolume {
  std::array<double, 3> of{};  // m^3, of t, t^2, t^3

  double to(double t) const { return t * (of[0] + t * (of[1] + t * of[2])); }
};

// A muscle by itself and what was found to lie in its way.
class PartedMuscle {
 public:
  // `allowed`: share of its volume that may be left in bone.
  PartedMuscle(const Muscle& muscle, std::span<const Ellipse> slices, const BoneRays& bones,
               double allowed)
      : slices_(rounded_sections(slices)), bones_(bones), allowed_(allowed) {
    alone_.muscles.push_back(muscle);
  }

  // Presses the lines that cost the muscle least until enough of it is out of bone. False where it
  // is already.
  bool press() {
    find_lines(kFewPlaces);
    if (pierced() < kSuspect * allowed_ * volume_) return false;
    find_lines(kManyPlaces);
    std::stable_sort(lines_.begin(), lines_.end(),
                     [](const PiercedLine& a, const PiercedLine& b) { return a.worth > b.worth; });
    double left = pierced() - allowed_ * volume_;
    if (left <= 0) return false;
    std::vector<float> ratios(slices_.size() * kOutlinePoints, 1);
    for (std::size_t i = 0; i < lines_.size() && left > 0; ++i) {
      left -= lines_[i].volume;
      take(lines_[i], ratios);
    }
    for (std::size_t ray = 0; ray < ratios.size(); ++ray) {
      float& factor = slices_[ray / kOutlinePoints].outline[ray % kOutlinePoints];
      factor = std::min(factor, std::max(float(kLeastFactor), ratios[ray] * factor));
    }
    set_outlines(alone_.muscles[0], slices_);
    return true;
  }

  const std::vector<Ellipse>& slices() const { return slices_; }

 private:
  double pierced() const {
    double sum = 0;
    for (const PiercedLine& line : lines_) sum += line.volume;
    return sum;
  }

  void find_lines(std::span<const Corners> places) {
    surface_ = make_muscle_surface(alone_);
    update_muscle_surface(surface_, slices_, positions_);
    roots_.resize(positions_.rows(), 3);
    for (int v = 0; v < surface_.vertices(); ++v) roots_.row(v) = root_of(surface_, v, slices_);
    lines_.clear();
    volume_ = 0;
    for (Eigen::Index f = 0; f < surface_.F.rows(); ++f)
      for (const Corners& place : places) look(f, place, double(places.size()));
  }

  Vec3 at(const Points& points, Eigen::Index f, const Corners& weights) const {
    Vec3 out = Vec3::Zero();
    for (int i = 0; i < 3; ++i) out += weights[i] * points.row(surface_.F(f, i)).transpose();
    return out;
  }

  LineVolume volume_of(Eigen::Index f, const Vec3& way, double lines) const {
    const auto edge = [&](const Points& points, int i) -> Vec3 {
      return points.row(surface_.F(f, i)) - points.row(surface_.F(f, 0));
    };
    const Vec3 a = edge(roots_, 1), b = edge(roots_, 2), more_a = edge(positions_, 1) - a,
               more_b = edge(positions_, 2) - b;
    const Vec3 part = way / (2 * lines);
    return {{a.cross(b).dot(part), (a.cross(more_b) + more_a.cross(b)).dot(part) / 2,
             more_a.cross(more_b).dot(part) / 3}};
  }

  // `lines`: that end in a triangle.
  void look(Eigen::Index f, const Corners& place, double lines) {
    const Vec3 from = at(roots_, f, place), way = at(positions_, f, place) - from;
    const double length = way.norm();
    if (length < kShortest) return;
    const LineVolume volume = volume_of(f, way, lines);
    volume_ += volume.to(1);
    const Vec3 along = way / length;
    RayHit hit = bones_.rays.first_hit(from, along, length + kBeyond);
    if (hit.triangle < 0 || (hit.facing <= 0 && double(hit.distance) > length)) return;
    const double first = hit.facing > 0 ? 0 : double(hit.distance) / length;
    // Bones are made of shells that may cross: the line is out of bone where it has left as many as
    // it entered.
    double begin = 0, inside = 0;
    int depth = hit.facing > 0 ? 1 : 0;
    while (hit.triangle >= 0) {
      const double end = std::min(double(hit.distance) / length, 1.0);
      if (depth > 0) inside += volume.to(end) - volume.to(begin);
      depth = std::max(0, depth + (hit.facing > 0 ? -1 : 1));
      begin = end;
      hit = bones_.rays.first_hit(from, along, length, double(hit.distance) + kPastSurface);
    }
    if (depth > 0) inside += volume.to(1) - volume.to(begin);
    const double lost = volume.to(1) - volume.to(first);
    if (inside <= 0 || lost <= 0) return;
    lines_.push_back({f, place, std::max(0.0, first - kBoneGap / length), inside, inside / lost});
  }

  void take(const PiercedLine& line, std::vector<float>& ratios) const {
    const auto ratio = float(std::max(line.ratio, kMostPressFromBone));
    for (int i = 0; i < 3; ++i) {
      const int v = surface_.F(line.face, i);
      for (int j = surface_.term_begin[v]; j < surface_.term_begin[v + 1]; ++j) {
        const MuscleSurface::Term& term = surface_.terms[j];
        if (line.place[i] * double(term.weight) < kMainTermFromBone) continue;
        float& least = ratios[std::size_t(term.slice) * kOutlinePoints + outline_place(term)];
        least = std::min(least, ratio);
      }
    }
  }

  Anatomy alone_;
  std::vector<Ellipse> slices_;  // to the micrometre
  const BoneRays& bones_;
  double allowed_;
  MuscleSurface surface_;
  Points positions_, roots_;
  std::vector<PiercedLine> lines_;
  double volume_ = 0;  // of the muscle, m^3
};

}  // namespace

void part_from_bones(std::span<const Muscle> muscles, std::span<Ellipse> slices,
                     std::span<const int> partners, const BoneRays& bones, double allowed) {
  const std::vector<std::size_t> begin = slice_begins(muscles);
  tbb::parallel_for(std::size_t{0}, muscles.size(), [&](std::size_t m) {
    if (partners[m] >= 0) return;
    const std::span<Ellipse> own = slices.subspan(begin[m], begin[m + 1] - begin[m]);
    PartedMuscle parted(muscles[m], own, bones, allowed);
    int rounds = kPressRounds;
    while (rounds > 0 && parted.press()) --rounds;
    for (std::size_t k = 0; k < own.size(); ++k) own[k].outline = parted.slices()[k].outline;
  });
}

}  // namespace ecorche::inline v1
