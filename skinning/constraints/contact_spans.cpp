#include "skinning/constraints/contact_spans.h"

namespace ecorche::inline v1 {

Interval common(const Interval& a, const Interval& b) {
  Interval out{std::max(a.begin, b.begin), std::min(a.end, b.end)};
  out.early = out.begin - std::max(a.onset(), b.onset());
  out.late = std::min(a.lift(), b.lift()) - (out.end - 1);
  return out;
}

std::vector<Interval> split_heels(const std::vector<Interval>& heels,
                                  const std::vector<Interval>& balls) {
  std::vector<Interval> parts;
  for (Interval heel : heels) {
    for (size_t k = 0; k + 1 < balls.size(); ++k) {
      const Interval gap{balls[k].end, balls[k + 1].begin};
      if (!inside(heel, gap.begin - 1) || !inside(heel, gap.end)) continue;
      parts.push_back({heel.begin, gap.begin, heel.early, balls[k].late});
      heel.begin = gap.end;
      heel.early = balls[k + 1].early;
    }
    parts.push_back(heel);
  }
  return parts;
}

}  // namespace ecorche::inline v1
