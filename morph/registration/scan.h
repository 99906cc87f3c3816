// A scan made ready for registration.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// What is left of a scan, sculpt or character once floor, islands and noise are gone, at most some
// 400,000 points. Axes are the file's own; lengths are metres, guessed where the unit is not known.
struct Scan {
  Points points;                  // #N x 3, m, file's axes
  Points normals;                 // #N x 3, unit, outwards; zero where nothing tells the side
  Triangles F;                    // over points; empty: a bare cloud
  std::vector<float> area;        // #N, m^2 that a point stands for
  std::vector<char> border;       // #N, 1: beside a hole, an edge of what was seen
  std::vector<char> covering;     // #N, 1: clothes or hair: the body lies within
  double unit = 1;                // metres in one unit of the file; `points` = unit * file
  bool unit_known = false;        // false: the size was guessed from nothing but its plausibility
  bool unit_told = false;         // by the person who asks, not by the file
  std::optional<Vec3> up;         // where the file's format or contents tell it
  std::optional<double> stature;  // m, where it was told
  // parts of the file that are no body: eyes, teeth, hair, props
  std::vector<std::string> left_out;
  bool one_view = false;  // a depth frame: all was seen from `seen_from`
  Vec3 seen_from = Vec3::Zero();
  std::vector<std::string> notes;  // what was found out, taken away or assumed, for people
};

}  // namespace ecorche::inline v1
