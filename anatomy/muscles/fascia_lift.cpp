#include "anatomy/muscles/fascia_lift.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kBelow = 5e-3;        // m, of what lies right below a sheet
constexpr double kLeastAcross = 0.05;  // squared, of a direction, across a strip
constexpr int kBeside = 6;             // sections before and after the nearest
constexpr int kRounds = 4;             // of finding where a line leaves an outline
constexpr int kSpreadRounds = 24;
constexpr float kSpread = 0.95f;  // of the neighbours' mean
constexpr int kSmoothRounds = 3;
constexpr float kRounding = 1e-4f;  // m, so that sheets at rest stay as they are

// A section's outline in the direction of a point of its plane, in units of its radii.
double reach_toward(const Ellipse& a, const Ellipse& b, double share, const Vec2& scaled) {
  double turn = std::atan2(scaled.y(), scaled.x()) / (2 * std::numbers::pi);
  turn -= std::floor(turn);
  const double place = std::min(turn * kOutlinePoints, kOutlinePoints - 1e-6);
  return (1 - share) * outline_factor(a.outline, place) + share * outline_factor(b.outline, place);
}

std::span<const Ellipse> sections_of(const FasciaLift::Cover& cover,
                                     std::span<const Ellipse> slices) {
  return slices.subspan(std::size_t(cover.begin), std::size_t(cover.end - cover.begin));
}

// How far along `out` from the point the strip's outline ends, m, negative where the point lies
// beyond; none: the line misses it.
std::optional<double> height_of_strip(std::span<const Ellipse> sections, const Vec3& point,
                                      const Vec3& out) {
  // Before a section, along the strip.
  const auto before = [&](std::size_t k) {
    return (point - sections[k].center).dot(sections[k].axes.col(2));
  };
  std::optional<double> most;
  double ahead = before(0);
  for (std::size_t k = 0; k + 1 < sections.size(); ++k) {
    const double here = ahead;
    ahead = before(k + 1);
    if (here < 0 || ahead >= 0) continue;  // not between the two
    const Ellipse &a = sections[k], &b = sections[k + 1];
    const double share = here / (here - ahead);
    const Vec2 radii = ((1 - share) * a.radii + share * b.radii).cwiseMax(1e-5);
    const auto in_plane = [](const Ellipse& section, const Vec3& v) -> Vec2 {
      return section.axes.leftCols<2>().transpose() * v;
    };
    const Vec2 at = ((1 - share) * in_plane(a, point - a.center) +
                     share * in_plane(b, point - b.center))
                        .cwiseQuotient(radii),
               toward =
                   ((1 - share) * in_plane(a, out) + share * in_plane(b, out)).cwiseQuotient(radii);
    const double speed = toward.squaredNorm(), along = at.dot(toward);
    if (speed * radii.squaredNorm() < kLeastAcross) continue;
    double height = 0;
    bool met = true;
    for (int round = 0; round < kRounds && met; ++round) {
      const double reach = reach_toward(a, b, share, at + height * toward),
                   rest = along * along - speed * (at.squaredNorm() - reach * reach);
      met = rest > 0;
      if (met) height = (std::sqrt(rest) - along) / speed;
    }
    if (met) most = std::max(most.value_or(height), height);
  }
  return most;
}

}  // namespace

float height_over_strip(std::span<const Ellipse> sections, const Vec3& point, const Vec3& out) {
  return std::clamp(float(height_of_strip(sections, point, out).value_or(0)), 0.0f,
                    kMostFasciaLift);
}

void add_covers(std::span<const SliceRange> strips, std::span<const Ellipse> slices,
                const PointsF& points, const PointsF& normals, int begin, int end, bool rises,
                FasciaLift& lift) {
  std::vector<std::vector<FasciaLift::Cover>> found(std::size_t(end - begin));
  const auto sheet = points.middleRows(begin, end - begin);
  const Vec3 low = sheet.colwise().minCoeff().transpose().cast<double>().array() - kFasciaLiftReach,
             high =
                 sheet.colwise().maxCoeff().transpose().cast<double>().array() + kFasciaLiftReach;
  const auto near_sheet = [&](const Ellipse& section) {
    const double reach = section.radii.maxCoeff();
    return (section.center.array() + reach >= low.array()).all() &&
           (section.center.array() - reach <= high.array()).all();
  };
  std::vector<std::pair<std::size_t, FasciaLift::Cover>> by_strip;  // of points of the sheet
  for (const SliceRange& strip : strips) {
    if (!rises) break;
    const auto own = slices.subspan(std::size_t(strip.begin), std::size_t(strip.end - strip.begin));
    if (std::ranges::none_of(own, near_sheet)) continue;
    bool below = false;
    by_strip.clear();
    for (int i = begin; i < end; ++i) {
      const Vec3 at = points.row(i).transpose().cast<double>(),
                 up = normals.row(i).transpose().cast<double>();
      double least = kFasciaLiftReach;
      int nearest = -1;
      for (int k = strip.begin; k < strip.end; ++k) {
        const Ellipse& section = slices[std::size_t(k)];
        const double distance = (section.center - at).norm() - section.radii.maxCoeff();
        if (distance < least) least = distance, nearest = k;
      }
      if (nearest < 0) continue;
      FasciaLift::Cover cover{std::max(strip.begin, nearest - kBeside),
                              std::min(strip.end, nearest + kBeside + 1)};
      const double height = height_of_strip(sections_of(cover, slices), at, up).value_or(0);
      below = below || (height < 0 && height > -kBelow);
      cover.rest = float(std::max(0.0, height));
      by_strip.emplace_back(std::size_t(i - begin), cover);
    }
    if (!below) continue;
    for (const auto& [point, cover] : by_strip) found[point].push_back(cover);
  }
  for (const std::vector<FasciaLift::Cover>& covers : found) {
    lift.covers.insert(lift.covers.end(), covers.begin(), covers.end());
    lift.begin.push_back(int(lift.covers.size()));
  }
}

float wanted_lift(const FasciaLift& lift, const PosedAnatomy& posed, int point, const Vec3& at,
                  const Vec3& out) {
  float most = 0;
  for (int i = lift.begin[std::size_t(point)]; i < lift.begin[std::size_t(point) + 1]; ++i) {
    const FasciaLift::Cover& cover = lift.covers[std::size_t(i)];
    if (cover.rest >= kMostFasciaLift) continue;  // it lies over the sheet
    const float height = height_over_strip(sections_of(cover, posed.slices), at, out);
    most = std::max(most, height - cover.rest - kRounding);
  }
  return most;
}

void spread_lift(int rows, int columns, std::span<float> heights, std::span<float> workspace) {
  std::copy(heights.begin(), heights.end(), workspace.begin());
  const auto beside = [&](int r, int c) {  // the neighbours' mean
    const auto at = [&](int row, int column) {
      return heights[std::size_t(std::clamp(row, 0, rows - 1) * columns +
                                 std::clamp(column, 0, columns - 1))];
    };
    return 0.25f * (at(r - 1, c) + at(r + 1, c) + at(r, c - 1) + at(r, c + 1));
  };
  for (int round = 0; round < kSpreadRounds + kSmoothRounds; ++round)
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const std::size_t i = std::size_t(r * columns + c);
        heights[i] = round < kSpreadRounds ? std::max(workspace[i], kSpread * beside(r, c))
                                           : 0.5f * (heights[i] + beside(r, c));
      }
}

}  // namespace ecorche::inline v1
