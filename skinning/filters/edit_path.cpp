#include "skinning/filters/edit_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/errors.h"
#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kShortestWay = 0.3;    // m
constexpr double kSmoothing = 0.8;      // s
constexpr double kSlowest = 0.15;       // m/s: slower, a figure has no direction of its own
constexpr double kStepOfCurves = 0.01;  // m

// A place on the ground with the direction of the way there, by frame.
struct Way {
  std::vector<GroundMove> places;
  std::vector<double> length;  // m, from the first frame on
  double whole() const { return length.back(); }
};

Vec3 direction_of(double yaw) { return {std::sin(yaw), 0, std::cos(yaw)}; }

double yaw_of(const Vec3& direction) { return std::atan2(direction.x(), direction.z()); }

// Means under a raised cosine; beyond its ends a series goes on point-symmetrically.
template <class Value>
std::vector<Value> smoothed(const std::vector<Value>& given, int reach) {
  const int last = int(given.size()) - 1;
  reach = std::min(reach, last);
  const auto at = [&](int f) -> Value {
    if (f < 0) return 2 * given.front() - given[std::size_t(-f)];
    if (f > last) return 2 * given.back() - given[std::size_t(2 * last - f)];
    return given[std::size_t(f)];
  };
  std::vector<Value> out;
  for (int f = 0; f <= last; ++f) {
    out.push_back(
        raised_cosine_mean(reach, Value(0 * given.front()), [&](int k) { return at(f + k); }));
  }
  return out;
}

// Directions where the figure moves; where it waits, from the one before to the one after.
std::vector<double> yaws_of(const std::vector<Vec3>& path, double fps, int reach) {
  const int count = int(path.size());
  std::vector<double> out(path.size(), 0);
  int known = -1;
  for (int f = 0; f < count; ++f) {
    const int a = std::max(0, f - 1), b = std::min(count - 1, f + 1);
    const Vec3 speed = fps / std::max(1, b - a) * (path[std::size_t(b)] - path[std::size_t(a)]);
    if (speed.norm() < kSlowest) continue;
    const double yaw = yaw_of(speed);
    const double before = known < 0 ? yaw : out[std::size_t(known)];
    const double here = before + std::remainder(yaw - before, 2 * std::numbers::pi);
    for (int g = known + 1; g <= f; ++g)
      out[std::size_t(g)] = before + (here - before) * (g - known) / (f - known);
    known = f;
  }
  for (int g = known + 1; g < count; ++g)
    out[std::size_t(g)] = known < 0 ? 0 : out[std::size_t(known)];
  return smoothed(out, reach);
}

Way way_of(const std::string& name, const Motion& motion) {
  std::vector<Vec3> roots;
  for (const Pose& pose : motion.frames) roots.emplace_back(pose.root.x(), 0, pose.root.z());
  const int reach = int(std::lround(0.5 * kSmoothing * motion.fps));
  const std::vector<Vec3> path = smoothed(roots, reach);
  const std::vector<double> yaws = yaws_of(path, motion.fps, reach);
  Way out;
  for (std::size_t f = 0; f < path.size(); ++f) {
    out.places.push_back({yaws[f], path[f]});
    out.length.push_back(f == 0 ? 0 : out.length.back() + (path[f] - path[f - 1]).norm());
  }
  if (out.whole() < kShortestWay)
    throw UnfitError(fmt::format(
        "{}: --filter path: the figure goes {:.2f} m; a way of {} m or more can be changed (turn "
        "turns a figure that stays in its place)",
        name, out.whole(), kShortestWay));
  return out;
}

void put_on(const Way& way, const std::vector<GroundMove>& places, FilteredMotion& filtered) {
  for (std::size_t f = 0; f < places.size(); ++f)
    move_pose(places[f] * inverse(way.places[f]), filtered.motion.frames[f]);
}

// Points at even distances along Catmull and Rom's curve through the given ones, its tangents by
// the distances between them.
std::vector<Vec3> curve_through(const std::vector<Eigen::Vector2d>& points) {
  std::vector<Vec3> p;
  for (const Eigen::Vector2d& one : points) p.emplace_back(one.x(), 0, one.y());
  const int last = int(p.size()) - 1;
  const auto tangent = [&](int k) -> Vec3 {
    const int a = std::max(0, k - 1), b = std::min(last, k + 1);
    return (p[std::size_t(b)] - p[std::size_t(a)]).normalized();
  };
  std::vector<Vec3> fine{p.front()};
  for (int k = 0; k < last; ++k) {
    const Vec3 &a = p[std::size_t(k)], &b = p[std::size_t(k + 1)];
    const double apart = (b - a).norm();
    const int steps = 1 + int(apart / (0.1 * kStepOfCurves));
    for (int i = 1; i <= steps; ++i) {
      const double t = double(i) / steps, u = 1 - t;
      fine.push_back(u * u * (1 + 2 * t) * a + t * t * (3 - 2 * t) * b +
                     t * u * apart * (u * tangent(k) - t * tangent(k + 1)));
    }
  }
  std::vector<Vec3> even{fine.front()};
  double over = 0;
  for (std::size_t k = 1; k < fine.size(); ++k) {
    over += (fine[k] - fine[k - 1]).norm();
    if (over < kStepOfCurves) continue;
    even.push_back(fine[k]);
    over = 0;
  }
  // The rest, shorter than a step, would have no direction to rely on.
  if (even.size() > 1) even.pop_back();
  even.push_back(fine.back());
  return even;
}

}  // namespace

void straighten_path(const std::string& name, FilteredMotion& filtered) {
  const Way way = way_of(name, filtered.motion);
  const GroundMove& begin = way.places.front();
  std::vector<GroundMove> places;
  for (const double s : way.length)
    places.push_back({begin.yaw, begin.shift + s * direction_of(begin.yaw)});
  put_on(way, places, filtered);
}

void bend_path(const std::string& name, double angle, FilteredMotion& filtered) {
  const Way way = way_of(name, filtered.motion);
  std::vector<GroundMove> places{way.places.front()};
  for (std::size_t f = 1; f < way.places.size(); ++f) {
    const double middle = 0.5 * (way.length[f] + way.length[f - 1]) / way.whole();
    const Vec3 step = way.places[f].shift - way.places[f - 1].shift;
    places.push_back({way.places[f].yaw + angle * way.length[f] / way.whole(),
                      places.back().shift + GroundMove{angle * middle, Vec3::Zero()}.turned(step)});
  }
  put_on(way, places, filtered);
}

void follow_points(const std::string& name, const std::vector<Eigen::Vector2d>& points,
                   FilteredMotion& filtered) {
  const Way way = way_of(name, filtered.motion);
  const std::vector<Vec3> curve = curve_through(points);
  std::vector<double> at{0};
  for (std::size_t k = 1; k < curve.size(); ++k)
    at.push_back(at.back() + (curve[k] - curve[k - 1]).norm());
  std::vector<double> yaws;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(curve.size() - 1, k + 1);
    const double yaw = yaw_of(curve[b] - curve[a]), before = yaws.empty() ? yaw : yaws.back();
    yaws.push_back(before + std::remainder(yaw - before, 2 * std::numbers::pi));
  }
  std::vector<GroundMove> places;
  std::size_t k = 0;
  for (const double s : way.length) {
    while (k + 2 < at.size() && at[k + 1] <= s) ++k;
    const double share = (s - at[k]) / (at[k + 1] - at[k]);
    if (share <= 1)
      places.push_back({yaws[k] + share * (yaws[k + 1] - yaws[k]),
                        curve[k] + share * (curve[k + 1] - curve[k])});
    else
      places.push_back({yaws.back(), curve.back() + (s - at.back()) * direction_of(yaws.back())});
  }
  put_on(way, places, filtered);
}

void turn_motion(double angle, FilteredMotion& filtered) {
  if (filtered.motion.frames.empty()) return;
  const Vec3 root = filtered.motion.frames.front().root, about(root.x(), 0, root.z());
  const GroundMove there{angle, Vec3::Zero()};
  const GroundMove move{angle, about - there * about};
  for (Pose& pose : filtered.motion.frames) move_pose(move, pose);
  filtered.belt = move.turned(filtered.belt);
  if (filtered.loop) filtered.loop->round = move * filtered.loop->round * inverse(move);
}

}  // namespace ecorche::inline v1
