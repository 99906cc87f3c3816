#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

std::vector<SliceRange> slice_ranges(const Anatomy& anatomy) {
  std::vector<SliceRange> ranges;
  int at = 0;
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m)
    for (std::size_t i = 0; i < anatomy.muscles[m].strips.size(); ++i) {
      const int count = anatomy.muscles[m].strips[i].slices.size();
      ranges.push_back({int(m), int(i), at, at + count});
      at += count;
    }
  return ranges;
}

}  // namespace ecorche::inline v1
