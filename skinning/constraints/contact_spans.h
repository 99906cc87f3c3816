// Spans of contacts, and values that fade out around them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "anatomy/compute/smooth_step.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche::inline v1 {

inline bool inside(const Interval& i, int f) { return i.begin <= f && f < i.end; }

// What both spans have; it may be empty.
Interval common(const Interval& a, const Interval& b);

// A heel contact that spans two contacts of its ball is split between them: the foot was shifted.
std::vector<Interval> split_heels(const std::vector<Interval>& heels,
                                  const std::vector<Interval>& balls);

// Extends values that are known inside of intervals into the gaps: each edge's value fades out
// within `fade` frames, or half the gap. `edges`: values at the intervals' onsets and lifts.
template <typename Value, typename Blend>
void fade_out(const std::vector<Interval>& known, const std::vector<std::array<Value, 2>>& edges,
              std::vector<Value>& values, double fade, const Value& nothing, Blend blend) {
  for (int f = 0; f < int(values.size()); ++f) {
    int before = -1, after = -1;
    bool is_known = false;
    for (int i = 0; i < int(known.size()); ++i) {
      if (known[i].end <= f && (before < 0 || known[i].end > known[before].end)) before = i;
      if (known[i].begin > f && (after < 0 || known[i].begin < known[after].begin)) after = i;
      is_known |= inside(known[i], f);
    }
    if (is_known) continue;
    const double gap =
        before >= 0 && after >= 0 ? known[after].onset() - known[before].lift() : HUGE_VAL;
    const double reach = std::max(1e-9, std::min(fade, 0.5 * gap));
    values[f] = nothing;
    if (before >= 0)
      values[f] =
          blend(values[f], edges[before][1], 1 - smooth_step((f - known[before].lift()) / reach));
    if (after >= 0)
      values[f] =
          blend(values[f], edges[after][0], 1 - smooth_step((known[after].onset() - f) / reach));
  }
}

}  // namespace ecorche::inline v1
