// How a wrap lies to the rest line of its strip, for reports.
#pragma once

namespace ecorche::inline v1 {

struct WrapNote {
  int muscle = 0, strip = 0, wrap = 0;
  // false: the line passes too far off, through the middle, or only its ends are near
  bool used = true;
  double depth = 0;  // of the rest line in the object, which stays allowed, m
};

}  // namespace ecorche::inline v1
