#include "skinning/files/slice_influences.h"

#include <algorithm>
#include <map>

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {

std::vector<std::array<Influence, 4>> slice_influences(const Anatomy& anatomy) {
  std::vector<std::array<Influence, 4>> out;
  for (const Muscle& muscle : anatomy.muscles) {
    for (const Strip& strip : muscle.strips) {
      std::vector<double> s;
      for (const Slice& slice : strip.slices) s.push_back(slice.s);
      for (const LineNode& node : line_nodes(strip.path, s)) {
        std::map<int, double>
            shares;  // a spline's weights may be slightly negative, which influences must not be
        for (int i = 0; i < 4; ++i) {
          if (node.weight[i] == 0) continue;
          const PathPoint& p = strip.path[node.first + i];
          shares[p.joints[0]] += node.weight[i] * p.share;
          if (p.joints[1] >= 0) shares[p.joints[1]] += node.weight[i] * (1 - p.share);
        }
        std::vector<Influence> sorted;
        for (const auto& [joint, weight] : shares) sorted.push_back({joint, std::max(0.0, weight)});
        std::stable_sort(sorted.begin(), sorted.end(), [](const Influence& l, const Influence& r) {
          return l.weight > r.weight;
        });
        std::array<Influence, 4> four{};
        std::copy_n(sorted.begin(), std::min<size_t>(4, sorted.size()), four.begin());
        out.push_back(four);
      }
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
