#include "morph/registration/scan_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace ecorche::inline v1 {
namespace {

struct NamedUnit {
  const char* name;
  double metres, usual;
};
// How often files are in them, at a guess that only decides between sizes of equal likelihood.
constexpr std::array<NamedUnit, 6> kUnits{{{"metres", 1, 1},
                                           {"centimetres", 0.01, 1},
                                           {"millimetres", 0.001, 1},
                                           {"inches", 0.0254, 0.35},
                                           {"feet", 0.3048, 0.15},
                                           {"decimetres", 0.1, 0.15}}};

// How well a largest extent, m, fits a person: standing adults, arms raised or wide, children and
// the bent, busts.
double plausible(double extent) {
  constexpr std::array<std::pair<double, double>, 10> kAt{{{0.6, 0},
                                                           {0.7, 0.1},
                                                           {0.8, 0.3},
                                                           {1.2, 0.5},
                                                           {1.5, 1},
                                                           {2.0, 1},
                                                           {2.3, 0.5},
                                                           {2.6, 0.2},
                                                           {3.0, 0.05},
                                                           {3.5, 0}}};
  if (extent <= kAt.front().first || extent >= kAt.back().first) return 0;
  const auto next = std::ranges::find_if(kAt, [&](const auto& at) { return at.first > extent; });
  const auto last = std::prev(next);
  const double t = (extent - last->first) / (next->first - last->first);
  return std::lerp(last->second, next->second, t);
}

// A body of stature h has a surface of about 0.6 h^2 (1.85 m^2 at 1.75 m): what tells the size of
// those who sit or bend.
double plausible(double extent, double area, double metres) {
  constexpr double kSurface = 0.6, kLess = 0.8;
  const double by_area = plausible(std::sqrt(area / kSurface) * metres);
  return std::max(plausible(extent * metres),
                  plausible(1.6 * extent * metres) > 0 ? kLess * by_area : 0);
}

}  // namespace

ScanUnit guess_unit(double extent, double area, std::optional<double> said) {
  constexpr double kSaid = 6, kAsLikely = 0.45, kUsualSize = 1.7, kUnsure = 0.09;
  struct Weighed {
    std::string name;
    double metres, weight;
  };
  std::vector<Weighed> units;
  for (const NamedUnit& unit : kUnits)
    units.push_back({unit.name, unit.metres, unit.usual * plausible(extent, area, unit.metres)});
  if (said) {
    const auto same = std::ranges::find_if(
        units, [&](const Weighed& w) { return std::abs(w.metres - *said) < 1e-3 * *said; });
    if (same == units.end())
      units.push_back(
          {fmt::format("units of {:g} m", *said), *said, kSaid * plausible(extent, area, *said)});
    else
      same->weight = kSaid * plausible(extent, area, *said);
  }
  std::ranges::stable_sort(units, std::greater{}, &Weighed::weight);
  const Weighed& best = units.front();
  if (best.weight < kUnsure) {
    const double metres = kUsualSize / extent;
    return {metres, false,
            fmt::format("unit unknown: {:g} units are no person's size in any; the size is that of "
                        "usual people of such a shape, --unit or --stature tell it",
                        extent)};
  }
  std::string note = fmt::format("unit: {}{}, largest extent {:.2f} m", best.name,
                                 said && best.metres == *said ? " as the file says" : " assumed",
                                 extent * best.metres);
  if (said && std::abs(best.metres - *said) > 1e-3 * *said)
    note += fmt::format("; the file says {:g} m, which makes {:.3g} m", *said, extent * *said);
  for (std::size_t i = 1; i < units.size() && units[i].weight > kAsLikely * best.weight; ++i)
    note += fmt::format("; may be {}: {:.2f} m", units[i].name, extent * units[i].metres);
  return {best.metres, true, note};
}

}  // namespace ecorche::inline v1
