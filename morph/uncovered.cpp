#include "morph/uncovered.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "anatomy/mesh_measures.h"

namespace ecorche {

namespace {

constexpr std::size_t kDirections = kOutlinePoints;
constexpr double kDeepest = 0.02;      // m: what lies farther under the layer does not come up to it
constexpr float kLeastGap = 0.5e-3f;   // m
constexpr float kMainTerm = 0.2f;      // weight of a section that a vertex between strips follows
constexpr double kLeastCosine = 0.3;   // of a spoke that can still raise the surface
constexpr int kNothing = -2;           // a label that no surface has

struct Find {
  int triangle = -1;
  float gap = 0;
};

// Half of the neighbours' mean and more, so that a section does not come up as a single point.
void spread(const SharedSections& sections, std::vector<float>& asked) {
  const std::vector<float> old = asked;
  for (const StripPlace& strip : sections.strips)
    for (std::size_t k = strip.begin; k < strip.end; ++k) {
      const std::size_t before = k > strip.begin ? k - 1 : k, after = k + 1 < strip.end ? k + 1 : k;
      for (std::size_t i = 0; i < kDirections; ++i) {
        const std::size_t left = (i + kDirections - 1) % kDirections, right = (i + 1) % kDirections;
        const float around = old[before * kDirections + i] + old[after * kDirections + i] + old[k * kDirections + left] + old[k * kDirections + right];
        asked[k * kDirections + i] = std::max(old[k * kDirections + i], around / 3);
      }
    }
}

}  // namespace

Underside underside(const TriMesh& skin, const FatLayer& fat) {
  Underside out{skin.V, vertex_normals(skin)};
  for (Eigen::Index i = 0; i < out.points.rows(); ++i) out.points.row(i) -= static_cast<double>(fat.thickness[static_cast<std::size_t>(i)]) * out.normals.row(i);
  return out;
}

std::vector<float> find_uncovered(const SharedSections& sections, const MuscleSurface& surface, const Underside& underside, const CrossingRays& flesh,
                                  const Triangles& F, std::span<const int> solids) {
  std::vector<Find> finds(static_cast<std::size_t>(underside.points.rows()));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, finds.size(), 64), [&](const auto& range) {
    std::vector<Crossing> crossings;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      flesh.cross(underside.points.row(row), -underside.normals.row(row), kDeepest, 0, kNothing, crossings);
      // What is left before anything is entered reaches the layer already.
      if (!crossings.empty() && crossings[0].entering) finds[i] = {crossings[0].triangle, crossings[0].distance};
    }
  });
  std::vector<float> asked(sections.slices.size() * kDirections, 0);
  for (std::size_t n = 0; n < finds.size(); ++n) {
    const Find& find = finds[n];
    if (find.triangle < 0 || find.gap < kLeastGap || solids[static_cast<std::size_t>(find.triangle)] < 0) continue;
    const Vec3 out = underside.normals.row(static_cast<Eigen::Index>(n));
    for (int corner = 0; corner < 3; ++corner) {
      const auto vertex = static_cast<std::size_t>(F(find.triangle, corner));
      for (int j = surface.term_begin[vertex]; j < surface.term_begin[vertex + 1]; ++j) {
        const MuscleSurface::Term& t = surface.terms[static_cast<std::size_t>(j)];
        if (t.weight < kMainTerm || (t.u == 0 && t.v == 0)) continue;
        const std::size_t k = static_cast<std::size_t>(t.slice), i = outline_place(t);
        const double cosine = sections.edge(k, i).normalized().dot(out);
        if (cosine < kLeastCosine) continue;
        float& most = asked[k * kDirections + i];
        most = std::max(most, static_cast<float>(static_cast<double>(find.gap) / cosine));
      }
    }
  }
  spread(sections, asked);
  return asked;
}

}  // namespace ecorche
