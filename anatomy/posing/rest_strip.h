// A strip in the rest pose, as posing tables are made from it. Private to posing.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct RestStrip {
  std::vector<Vec3> line;  // slice points without offset
  std::vector<Vec3> tangents;
  std::vector<double> chord;  // cumulative length of the polyline through `line`, m
  std::vector<Ellipse> slices;
};

RestStrip rest_strip(const Strip& strip);

}  // namespace ecorche::inline v1
