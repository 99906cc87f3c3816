// Sections of a strip slide along its line of centres, so that it lengthens evenly.
#pragma once

#include <span>

#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

// A section where the map brings it: its centre, and what becomes of its unit axes of width and
// thickness.
struct MappedSection {
  Vec3 center = Vec3::Zero();
  Eigen::Matrix<double, 3, 2> axes = Eigen::Matrix<double, 3, 2>::Zero();
};

// `gaps`: from each section to the next at rest, m, #sections - 1 or more. The ends stay, the
// others go along the line, so that a gap that has grown by more than a quarter, or shrunk by more
// than a fifth, shares that with those about it, over `reach`, m. Others stay. At most
// kMaxStripSlices sections.
void slide_sections(std::span<const double> gaps, double reach, std::span<MappedSection> strip);

}  // namespace ecorche::inline v1
