#include "skinning/files/slice_influences.h"

#include <algorithm>
#include <map>

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

// A spline's weights may be slightly negative, which influences must not be.
std::array<Influence, 4> largest(const std::map<int, double>& shares) {
  std::vector<Influence> sorted;
  for (const auto& [joint, weight] : shares) sorted.push_back({joint, std::max(0.0, weight)});
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Influence& l, const Influence& r) { return l.weight > r.weight; });
  std::array<Influence, 4> four{};
  std::copy_n(sorted.begin(), std::min<size_t>(4, sorted.size()), four.begin());
  return four;
}

}  // namespace

std::vector<std::array<Influence, 4>> slice_influences(const Anatomy& anatomy) {
  std::vector<std::array<Influence, 4>> out;
  for (const Muscle& muscle : anatomy.muscles) {
    for (const Strip& strip : muscle.strips) {
      std::vector<double> s;
      for (const Slice& slice : strip.slices) s.push_back(slice.s);
      for (const LineNode& node : line_nodes(strip.path, s)) {
        std::map<int, double> shares;
        for (int i = 0; i < 4; ++i) {
          if (node.weight[i] == 0) continue;
          const PathPoint& p = strip.path[node.first + i];
          shares[p.joints[0]] += node.weight[i] * p.share;
          if (p.joints[1] >= 0) shares[p.joints[1]] += node.weight[i] * (1 - p.share);
        }
        out.push_back(largest(shares));
      }
    }
  }
  return out;
}

std::vector<std::array<Influence, 4>> fascia_influences(
    const FasciaSurface& surface, std::span<const std::array<Influence, 4>> slices) {
  std::vector<std::array<Influence, 4>> out;
  for (int i = 0; i < surface.vertices(); ++i) {
    std::map<int, double> shares;
    for (int t = surface.term_begin[i]; t < surface.term_begin[i + 1]; ++t) {
      const FasciaSurface::Term& term = surface.terms[t];
      if (term.carrier >= surface.slices) {
        shares[term.carrier - surface.slices] += term.weight;
        continue;
      }
      for (const Influence& influence : slices[std::size_t(term.carrier)])
        shares[influence.joint] += double(term.weight) * influence.weight;
    }
    out.push_back(largest(shares));
  }
  return out;
}

}  // namespace ecorche::inline v1
