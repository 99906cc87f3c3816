#include "skinning/motion_files/marker_take.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

// Diagonal of the box round a person's markers, m: a child that crouches, a man who reaches up.
constexpr double kSmallest = 0.3, kLargest = 4;

// Diagonal of the box round the markers, median over at most 100 frames, m.
double extent_of(const MarkerTake& take) {
  std::vector<double> diagonals;
  const std::size_t step = std::max<std::size_t>(1, take.frames.size() / 100);
  for (std::size_t f = 0; f < take.frames.size(); f += step) {
    Eigen::AlignedBox3d box;
    for (const auto& p : take.frames[f].rowwise())
      if (p.allFinite()) box.extend(Vec3(p.transpose()));
    if (!box.isEmpty()) diagonals.push_back(box.diagonal().norm());
  }
  if (diagonals.empty()) return 0;
  const auto middle = diagonals.begin() + std::ptrdiff_t(diagonals.size() / 2);
  std::nth_element(diagonals.begin(), middle, diagonals.end());
  return *middle;
}

void correct_unit(const std::string& unit, MarkerTake& take) {
  const double extent = extent_of(take);
  if (extent == 0 || (extent > kSmallest && extent < kLargest)) return;
  for (const double factor : {1e-3, 1e3, 1e-2, 1e2, 1e-1, 1e1}) {
    if (!(factor * extent > kSmallest && factor * extent < kLargest)) continue;
    for (Points& places : take.frames) places *= factor;
    take.warnings.push_back(fmt::format(
        "{}: its unit is {}, in which the markers reach over {:.3g} m; places are taken {:g} times "
        "as far from the origin",
        take.name, unit.empty() ? "not said" : "'" + unit + "'", extent, factor));
    return;
  }
}

}  // namespace

double metres_of_unit(const std::string& unit) {
  std::string word;
  for (const unsigned char c : unit)
    if (std::isalpha(c)) word += char(std::tolower(c));
  constexpr std::array<std::pair<const char*, double>, 11> kUnits = {{{"mm", 1e-3},
                                                                      {"millimeters", 1e-3},
                                                                      {"cm", 1e-2},
                                                                      {"dm", 1e-1},
                                                                      {"m", 1},
                                                                      {"meters", 1},
                                                                      {"metres", 1},
                                                                      {"in", 0.0254},
                                                                      {"inch", 0.0254},
                                                                      {"inches", 0.0254},
                                                                      {"ft", 0.3048}}};
  for (const auto& [name, metres] : kUnits)
    if (word == name) return metres;
  return 0;
}

void finish_take(const std::string& unit, MarkerTake& take) {
  if (take.frames.empty()) throw UnfitError(take.name + ": no frames of markers");
  constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
  int noughts = 0;
  std::vector<char> seen(take.markers.size(), 0);
  for (Points& places : take.frames)
    for (Eigen::Index m = 0; m < places.rows(); ++m) {
      if (places.row(m).isZero(0)) ++noughts, places.row(m).setConstant(kUnseen);
      if (!places.row(m).allFinite())
        places.row(m).setConstant(kUnseen);
      else
        seen[m] = 1;
    }
  if (noughts > 0)
    take.warnings.push_back(fmt::format(
        "{}: {} places are exactly (0, 0, 0), and are taken as not seen", take.name, noughts));
  std::vector<Eigen::Index> kept;
  std::vector<std::string> names;
  for (std::size_t m = 0; m < seen.size(); ++m)
    if (seen[m]) kept.push_back(Eigen::Index(m)), names.push_back(take.markers[m]);
  if (kept.empty()) throw UnfitError(take.name + ": no marker is seen in any frame");
  if (kept.size() < seen.size()) {
    take.warnings.push_back(
        fmt::format("{}: {} markers are never seen", take.name, seen.size() - kept.size()));
    for (Points& places : take.frames) places = Points(places(kept, Eigen::all));
    take.markers = std::move(names);
  }
  correct_unit(unit, take);
}

void cut_take(const ClipRange& range, MarkerTake& take) {
  const auto [first, last] = frames_of_range(range, take.name, take.fps, int(take.frames.size()));
  take.start += first / take.fps;
  take.frames.erase(take.frames.begin() + last + 1, take.frames.end());
  take.frames.erase(take.frames.begin(), take.frames.begin() + first);
}

}  // namespace ecorche::inline v1
