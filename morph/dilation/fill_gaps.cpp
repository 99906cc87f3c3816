#include "morph/dilation/fill_gaps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {

namespace {

constexpr std::size_t kDirections = kOutlinePoints;
// m: muscles farther under the layer do not grow up to it. Larger: deep muscles grow into grooves.
constexpr double kDeepest = 0.02;
constexpr float kSunken = 10e-3f;     // m: deeper gaps may be closed by neighbouring muscles, too
constexpr int kAround = 6;            // directions in which it is looked for,
constexpr double kLean = 0.85;        // sine of their angle with straight in
constexpr float kLeastGap = 0.5e-3f;  // m
constexpr float kMainTerm = 0.2f;     // weight of a section that a vertex between strips follows
constexpr double kLeastCosine = 0.3;  // of a spoke that can still raise the surface
constexpr int kNothing = -2;          // a label that no surface has

constexpr double kBeside = 0.01;  // m, by which a drawn muscle may stand out beyond its sections

struct Find {
  int triangle = -1;  // -1: nothing is entered within the depth
  float gap = std::numeric_limits<float>::infinity();
  Vec3 direction = Vec3::Zero();
};

Find look(const CrossingRays& flesh, const Vec3& from, const Vec3& direction,
          std::vector<Crossing>& crossings) {
  flesh.cross(from, direction, kDeepest, 0, kNothing, crossings);
  if (crossings.empty()) return {};
  // What is left before anything is entered reaches the layer already.
  if (!crossings[0].entering) return {-1, 0, direction};
  return {crossings[0].triangle, crossings[0].distance, direction};
}

// About all sections that can be asked: mirror images cannot.
Eigen::AlignedBox3d askable(const PackedSections& sections) {
  Eigen::AlignedBox3d box;
  for (const StripPlace& strip : sections.strips)
    for (std::size_t k = strip.begin; k < strip.end && !sections.is_mirrored(strip); ++k)
      for (std::size_t i = 0; i < kDirections; ++i)
        box.extend(sections.slices[k].center +
                   double(sections.slices[k].outline[i]) * sections.edge(k, i));
  return box;
}

// Half of the neighbours' mean and more, so that a section does not come up as a single point.
void spread(const PackedSections& sections, std::vector<float>& asked) {
  const std::vector<float> old = asked;
  for (const StripPlace& strip : sections.strips)
    for (std::size_t k = strip.begin; k < strip.end; ++k) {
      const std::size_t before = k > strip.begin ? k - 1 : k, after = k + 1 < strip.end ? k + 1 : k;
      for (std::size_t i = 0; i < kDirections; ++i) {
        const std::size_t left = (i + kDirections - 1) % kDirections, right = (i + 1) % kDirections;
        const float around = old[before * kDirections + i] + old[after * kDirections + i] +
                             old[k * kDirections + left] + old[k * kDirections + right];
        asked[k * kDirections + i] = std::max(old[k * kDirections + i], around / 3);
      }
    }
}

}  // namespace

Underside underside(const TriMesh& skin, const FatLayer& fat) {
  Underside out{skin.V, vertex_normals(skin)};
  for (Eigen::Index i = 0; i < out.points.rows(); ++i)
    out.points.row(i) -= double(fat.thickness[i]) * out.normals.row(i);
  return out;
}

std::vector<float> asked_of_sections(const PackedSections& sections, const MuscleSurface& surface,
                                     const Triangles& F, std::span<const Raise> raises) {
  std::vector<float> asked(sections.slices.size() * kDirections, 0);
  for (const Raise& raise : raises) {
    if (raise.triangle < 0) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const std::size_t vertex = F(raise.triangle, corner);
      for (int j = surface.term_begin[vertex]; j < surface.term_begin[vertex + 1]; ++j) {
        const MuscleSurface::Term& t = surface.terms[j];
        if (t.weight < kMainTerm || (t.u == 0 && t.v == 0)) continue;
        const std::size_t k = std::size_t(t.slice), i = outline_place(t);
        const double cosine = -sections.edge(k, i).normalized().dot(raise.direction);
        if (cosine < kLeastCosine) continue;
        float& most = asked[k * kDirections + i];
        most = std::max(most, float(double(raise.by) / cosine));
      }
    }
  }
  spread(sections, asked);
  return asked;
}

std::vector<float> find_gaps(const PackedSections& sections, const MuscleSurface& surface,
                             const Underside& underside, const CrossingRays& flesh,
                             const Triangles& F, std::span<const int> solids, bool around) {
  const Eigen::AlignedBox3d near = askable(sections);
  std::vector<std::array<Find, 1 + kAround>> finds(underside.points.rows());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, finds.size(), 64), [&](const auto& range) {
    std::vector<Crossing> crossings;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Eigen::Index row = i;
      const Vec3 from = underside.points.row(row), in = -underside.normals.row(row);
      if (in.squaredNorm() == 0 || near.exteriorDistance(from) > kDeepest + kBeside) continue;
      finds[i][0] = look(flesh, from, in, crossings);
      if (!around || finds[i][0].gap < kSunken) continue;
      const Vec3 side = in.unitOrthogonal(), other = in.cross(side);
      for (int k = 0; k < kAround; ++k) {
        const double turn = 2 * std::numbers::pi * k / kAround;
        finds[i][k + 1] = look(flesh, from,
                               kLean * (std::cos(turn) * side + std::sin(turn) * other) +
                                   std::sqrt(1 - kLean * kLean) * in,
                               crossings);
      }
    }
  });
  std::vector<Raise> raises;
  for (const auto& group : finds)
    for (const Find& find : group)
      if (find.triangle >= 0 && find.gap >= kLeastGap && solids[find.triangle] >= 0)
        raises.push_back({find.triangle, find.gap, find.direction});
  return asked_of_sections(sections, surface, F, raises);
}

}  // namespace ecorche::inline v1
