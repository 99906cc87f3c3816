#include "app/edit/palpable_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "morph/fit/fit_quality.h"

namespace ecorche {
namespace {

double beyond(const LandmarkDepth& point) {
  return std::max(point.low - point.depth, point.depth - point.high);
}

}  // namespace

std::vector<LandmarkDepth> points_off(std::span<const LandmarkDepth> points) {
  std::vector<LandmarkDepth> out;
  std::ranges::copy_if(points, std::back_inserter(out), is_off);
  std::ranges::sort(out, std::ranges::greater{}, beyond);
  return out;
}

std::string point_text(const LandmarkDepth& point) {
  std::string name = point.name;
  std::ranges::replace(name, '_', ' ');
  return fmt::format("{}: {:.0f} mm under the skin, people have {:.0f} to {:.0f}", name,
                     1e3 * point.depth, 1e3 * point.low, 1e3 * point.high);
}

}  // namespace ecorche
