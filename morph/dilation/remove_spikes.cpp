#include "morph/dilation/remove_spikes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/muscles/surface_reference.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

// m that a point stands out more than in the reference: what is left is a blunt edge. Smaller: the
// layer's underside is covered less.
constexpr double kSpike = 0.014;
constexpr int kRounds = 12;            // at most; most muscles need none
constexpr float kLeastOfRound = 0.8f;  // of a factor; smaller: dents where spikes were
constexpr float kMainTerm = 0.2f;      // weight of a section that a point follows

// One muscle by itself.
class Despiked {
 public:
  Despiked(const Muscle& muscle, const Muscle& reference, std::span<Ellipse> slices)
      : muscle_(muscle), reference_(reference), slices_(slices) {
    set_slices(muscle_, slices_);
  }

  // Draws outlines back at all spikes; their count.
  int round() {
    set_outlines(muscle_, slices_);
    const DrawnMuscle now(muscle_);
    if (!reference_.matches(now)) return 0;
    const Standing beyond = reference_.standing_beyond(now);
    std::vector<float> ratios(slices_.size() * kOutlinePoints, 1.0f);
    int spikes = 0;
    for (int v = 0; v < now.surface.vertices(); ++v) {
      const double excess = beyond.out[v] - kSpike;
      if (excess <= 0) continue;
      ++spikes;
      draw_back(now, v, excess, ratios);
    }
    for (std::size_t ray = 0; ray < ratios.size(); ++ray)
      slices_[ray / kOutlinePoints].outline[ray % kOutlinePoints] *= ratios[ray];
    return spikes;
  }

 private:
  void draw_back(const DrawnMuscle& now, int v, double excess, std::vector<float>& ratios) const {
    const MuscleSurface& surface = now.surface;
    const double length = (now.positions.row(v).transpose() - root_of(surface, v, slices_)).norm();
    const auto ratio = std::max(kLeastOfRound, float(1 - excess / std::max(length, 1e-6)));
    for (int j = surface.term_begin[v]; j < surface.term_begin[v + 1]; ++j) {
      const MuscleSurface::Term& term = surface.terms[j];
      if (term.weight < kMainTerm) continue;
      float& least = ratios[std::size_t(term.slice) * kOutlinePoints + outline_place(term)];
      least = std::min(least, ratio);
    }
  }

  Muscle muscle_;
  SurfaceReference reference_;
  std::span<Ellipse> slices_;
};

}  // namespace

int remove_spikes(std::span<const Muscle> muscles, std::span<const Muscle> reference,
                  std::span<const int> partners, std::span<Ellipse> slices) {
  const std::vector<std::size_t> begin = slice_begins(muscles);
  std::atomic<int> spikes = 0;
  tbb::parallel_for(std::size_t{0}, muscles.size(), [&](std::size_t m) {
    if (partners[m] >= 0 || m >= reference.size() || !same_sections(muscles[m], reference[m]))
      return;
    Despiked despiked(muscles[m], reference[m], slices.subspan(begin[m], begin[m + 1] - begin[m]));
    int found = despiked.round();
    spikes += found;
    for (int round = 1; round < kRounds && found > 0; ++round) found = despiked.round();
  });
  return spikes;
}

}  // namespace ecorche::inline v1
