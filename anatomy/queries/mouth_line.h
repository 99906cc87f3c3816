// The line where the lips of a skin meet, to tell the upper lip from the lower one: they touch, so
// that what is nearest says nothing.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Heights on columns of the face, 1 mm side by side, from the middle to both sides. World, in an
// upright rest pose that faces +z.
struct MouthLine {
  double middle = 0;                             // x, m
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // of the face about the mouth, world, m
  std::vector<double> left, right;               // y, m; never empty

  bool about(const Vec3& p) const {  // whether a place is of that face
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
  bool spans(double x) const;        // whether the mouth is as wide
  double over(const Vec3& p) const;  // m above the line, or above its end
};

// Seen from the front, the mouth is the deepest place of the skin near the edge of the jaw's front
// teeth; that edge, and no wider than a column, where there is none. It is followed to both sides
// until it closes. Nothing where no bone is carried by a joint named "jaw".
std::optional<MouthLine> find_mouth(const Anatomy& anatomy, const TriMesh& skin);

}  // namespace ecorche::inline v1
