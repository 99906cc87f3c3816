// Planes through a body, named as an anatomist names them.
#pragma once

#include <string>

#include "anatomy/anatomy.h"
#include "anatomy/posed_anatomy.h"
#include "viewer/draw_list.h"

namespace ecorche {

struct SectionPlane {
  enum class Kind { none, transverse, frontal, sagittal, across } kind = Kind::none;
  // transverse: height over the ground; frontal, sagittal: before the root, to its left, m
  double place = 0;
  // across: square to the line from one joint to another, at this share of it
  std::string from{}, to{};
  double share = 0.5;

  bool operator==(const SectionPlane&) const = default;
};

// "transverse:95cm", "frontal:-2cm", "sagittal:0.1", "hip_l-knee_l:50%". Throws UsageError that
// begins with `where` and says what is expected.
SectionPlane read_section_plane(const std::string& text, const Skeleton& skeleton,
                                const std::string& where);

// n . x = w in a pose, for DrawList::cut. Precondition: its joints are of the skeleton, and it is
// not none.
Vec4f plane_of(const SectionPlane& section, const Skeleton& skeleton, const PosedAnatomy& posed);

}  // namespace ecorche
