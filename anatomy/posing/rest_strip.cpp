#include "anatomy/posing/rest_strip.h"

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {

RestStrip rest_strip(const Strip& strip) {
  RestStrip rest;
  std::vector<double> s;
  for (const Slice& slice : strip.slices) s.push_back(slice.s);
  rest.line = line_points(strip.path, s);
  rest.tangents = line_tangents(rest.line);
  rest.slices = rest_slices(strip);
  rest.chord.push_back(0);
  for (size_t k = 1; k < rest.line.size(); ++k)
    rest.chord.push_back(rest.chord.back() + (rest.line[k] - rest.line[k - 1]).norm());
  return rest;
}

}  // namespace ecorche::inline v1
