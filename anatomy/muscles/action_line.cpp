#include "anatomy/muscles/action_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kPieces = 96;     // per segment, for arc length
constexpr double kTiny = 1e-9;  // m; shorter segments count as this long

constexpr double kJunction = 0.06;  // of the line: half width of the passage from tendon to belly

// The spline of a path. Windows: the weights of segment i refer to path points window(i) ..
// window(i) + 3.
class Spline {
 public:
  explicit Spline(std::span<const PathPoint> path) : path_(path), n_(int(path.size())) {
    if (n_ < 2)
      throw std::invalid_argument("muscle line: " + std::to_string(n_) + " path points, need two");
    for (int i = 0; i + 1 < n_; ++i)
      step_.push_back(std::sqrt(std::max((path[i + 1].rest - path[i].rest).norm(), kTiny)));
    length_.reserve(std::size_t(n_ - 1) * kPieces + 1);
    length_.push_back(0);
    for (int i = 0; i + 1 < n_; ++i) {
      // The piece as a cubic in u: a + b u + c u^2 + d u^3.
      const Vec3 a = path[i].rest, chord = path[i + 1].rest - a;
      const Vec3 out = step_[i] * tangent(i), in = step_[i] * tangent(i + 1);
      const Vec3 b = out, c = 3 * chord - 2 * out - in, d = out + in - 2 * chord;
      Vec3 last = a;
      for (int k = 1; k <= kPieces; ++k) {
        const double u = double(k) / kPieces;
        const Vec3 next = a + u * (b + u * (c + u * d));
        length_.push_back(length_.back() + (next - last).norm());
        last = next;
      }
    }
  }

  double length() const { return length_.back(); }
  double length_to(int i, double u) const {
    const double x = i * kPieces + u * kPieces;
    const int k = std::clamp(int(x), 0, int(length_.size()) - 2);
    return length_[k] + (x - k) * (length_[k + 1] - length_[k]);
  }

  // Segment and share of it at arc length fraction s.
  std::pair<int, double> find(double s) const {
    const double target = std::clamp(s, 0.0, 1.0) * length();
    const auto it = std::upper_bound(length_.begin() + 1, length_.end() - 1, target);
    const int k = int(it - length_.begin()) - 1;
    const double piece = length_[k + 1] - length_[k];
    const double within = piece > 0 ? (target - length_[k]) / piece : 0;
    const int i = k / kPieces;
    return {i, (k - i * kPieces + within) / kPieces};
  }

  LineNode node(int i, double u) const {
    const int first = std::clamp(i - 1, 0, std::max(0, n_ - 4));
    LineNode node;
    node.first = first;
    const double u2 = u * u, u3 = u2 * u;
    add(node, i, 2 * u3 - 3 * u2 + 1);
    add(node, i + 1, 3 * u2 - 2 * u3);
    add_tangent(node, i, (u3 - 2 * u2 + u) * step_[i]);
    add_tangent(node, i + 1, (u3 - u2) * step_[i]);
    return node;
  }

 private:
  // Of the line at path point i, with respect to the spline's own parameter: what add_tangent
  // weighs, as a vector.
  Vec3 tangent(int i) const {
    const auto slope = [&](int k) -> Vec3 {
      return (path_[k + 1].rest - path_[k].rest) / step_[k];
    };
    if (n_ == 2) return slope(0);
    if (i == 0) return 1.5 * slope(0) - 0.5 * tangent(1);
    if (i == n_ - 1) return 1.5 * slope(n_ - 2) - 0.5 * tangent(n_ - 2);
    return (step_[i] * slope(i - 1) + step_[i - 1] * slope(i)) / (step_[i - 1] + step_[i]);
  }
  void add(LineNode& node, int i, double weight) const { node.weight[i - node.first] += weight; }
  void add_chord(LineNode& node, int i,
                 double weight) const {  // weight * (p[i+1] - p[i]) / step[i]
    add(node, i, -weight / step_[i]);
    add(node, i + 1, weight / step_[i]);
  }
  void add_tangent(LineNode& node, int i, double weight) const {
    if (n_ == 2) return add_chord(node, 0, weight);
    if (i == 0) {  // no curvature at the free ends
      add_chord(node, 0, 1.5 * weight);
      return add_tangent(node, 1, -0.5 * weight);
    }
    if (i == n_ - 1) {
      add_chord(node, n_ - 2, 1.5 * weight);
      return add_tangent(node, n_ - 2, -0.5 * weight);
    }
    const double both = step_[i - 1] + step_[i];
    add_chord(node, i - 1, weight * step_[i] / both);
    add_chord(node, i, weight * step_[i - 1] / both);
  }

  std::span<const PathPoint> path_;
  int n_;
  std::vector<double> step_;    // #segments, square roots of chords
  std::vector<double> length_;  // cumulative, kPieces a segment
};

Vec3 perpendicular(const Vec3& direction, const Vec3& tangent) {
  Vec3 d = direction - direction.dot(tangent) * tangent;
  // A reference along the line leaves the choice open: take the axis farthest from it.
  if (d.squaredNorm() < 1e-12 * std::max(1e-300, direction.squaredNorm())) {
    int axis;
    tangent.cwiseAbs().minCoeff(&axis);
    d = Vec3::Unit(axis) - tangent[axis] * tangent;
  }
  return d.normalized();
}

// Rotation-minimising frame vectors by double reflection.
std::vector<Vec3> transport(std::span<const Vec3> points, std::span<const Vec3> tangents,
                            const Vec3& start) {
  std::vector<Vec3> r{perpendicular(start, tangents[0])};
  for (size_t k = 0; k + 1 < points.size(); ++k) {
    const Vec3 v1 = points[k + 1] - points[k];
    const double c1 = std::max(v1.squaredNorm(), 1e-300);
    const Vec3 r_left = r[k] - (2 / c1) * v1.dot(r[k]) * v1;
    const Vec3 t_left = tangents[k] - (2 / c1) * v1.dot(tangents[k]) * v1;
    const Vec3 v2 = tangents[k + 1] - t_left;
    const double c2 = std::max(v2.squaredNorm(), 1e-300);
    r.push_back(r_left - (2 / c2) * v2.dot(r_left) * v2);
  }
  return r;
}

struct Frames {
  std::vector<Vec3> points, tangents, r;
};

Frames frames(const Strip& strip) {
  if (strip.slices.size() < 2)
    throw std::invalid_argument("muscle line: " + std::to_string(strip.slices.size()) +
                                " slices, need two");
  std::vector<double> s;
  for (const Slice& slice : strip.slices) s.push_back(slice.s);
  Frames f;
  f.points = line_points(strip.path, s);
  f.tangents = line_tangents(f.points);
  f.r = transport(f.points, f.tangents, strip.reference);
  return f;
}

}  // namespace

std::vector<LineNode> line_nodes(std::span<const PathPoint> path, std::span<const double> s) {
  const Spline spline(path);
  std::vector<LineNode> nodes;
  for (double value : s) {
    const auto [i, u] = spline.find(value);
    nodes.push_back(spline.node(i, u));
  }
  return nodes;
}

std::vector<Vec3> line_points(std::span<const PathPoint> path, std::span<const double> s) {
  std::vector<Vec3> points;
  for (const LineNode& node : line_nodes(path, s)) {
    Vec3 p = Vec3::Zero();
    for (size_t k = 0; k < 4 && node.first + k < path.size(); ++k)
      p += node.weight[k] * path[node.first + k].rest;
    points.push_back(p);
  }
  return points;
}

double line_length(std::span<const PathPoint> path) { return Spline(path).length(); }

std::vector<double> path_parameters(std::span<const PathPoint> path) {
  const Spline spline(path);
  std::vector<double> s{0};
  for (size_t i = 1; i < path.size(); ++i)
    s.push_back(spline.length_to(int(i) - 1, 1) / spline.length());
  s.back() = 1;
  return s;
}

double line_parameter(std::span<const PathPoint> path, double fraction) {
  const Spline spline(path);
  double whole = 0;
  for (size_t i = 0; i + 1 < path.size(); ++i) whole += (path[i + 1].rest - path[i].rest).norm();
  double left = std::clamp(fraction, 0.0, 1.0) * whole;
  for (size_t i = 0; i + 1 < path.size(); ++i) {
    const double chord = (path[i + 1].rest - path[i].rest).norm();
    if (left <= chord || i + 2 == path.size()) {
      const double share = chord > 0 ? std::min(left / chord, 1.0) : 0;
      const double a = spline.length_to(int(i), 0), b = spline.length_to(int(i), 1);
      return std::clamp((a + share * (b - a)) / spline.length(), 0.0, 1.0);
    }
    left -= chord;
  }
  return 1;
}

std::vector<Vec3> line_tangents(std::span<const Vec3> points) {
  const int n = points.size();
  if (n < 2) throw std::invalid_argument("muscle line: tangents of fewer than two points");
  std::vector<Vec3> tangents(n);
  if (n == 2) {
    tangents[0] = tangents[1] = (points[1] - points[0]).normalized();
    return tangents;
  }
  // Derivative at the middle of three points, by arc length; at the ends the same parabola's.
  for (int k = 0; k < n; ++k) {
    const int m = std::clamp(k, 1, n - 2);
    const Vec3 before = points[m] - points[m - 1], after = points[m + 1] - points[m];
    const double h0 = std::max(before.norm(), kTiny), h1 = std::max(after.norm(), kTiny);
    Vec3 d = before * (h1 / h0) + after * (h0 / h1);
    if (k == 0) d = before * ((2 * h0 + h1) / h0) - after * (h0 / h1);
    if (k == n - 1) d = after * ((2 * h1 + h0) / h1) - before * (h1 / h0);
    tangents[k] = d.normalized();
  }
  return tangents;
}

std::vector<Ellipse> rest_slices(const Strip& strip) {
  const Frames f = frames(strip);
  std::vector<Ellipse> ellipses(strip.slices.size());
  for (size_t k = 0; k < ellipses.size(); ++k) {
    const Slice& slice = strip.slices[k];
    Ellipse& e = ellipses[k];
    const Vec3 side = f.tangents[k].cross(f.r[k]);
    e.axes.col(0) = std::cos(slice.roll) * f.r[k] + std::sin(slice.roll) * side;
    e.axes.col(1) = f.tangents[k].cross(e.axes.col(0));
    e.axes.col(2) = f.tangents[k];
    e.center = f.points[k] + slice.offset.x() * e.axes.col(0) + slice.offset.y() * e.axes.col(1);
    e.radii = slice.radii;
    e.outline = slice.outline;
  }
  return ellipses;
}

std::vector<Ellipse> rest_slices(const Anatomy& anatomy) {
  std::vector<Ellipse> all;
  all.reserve(slice_count(anatomy));
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      const std::vector<Ellipse> some = rest_slices(strip);
      all.insert(all.end(), some.begin(), some.end());
    }
  return all;
}

Strip make_strip(std::vector<PathPoint> path, std::span<const Station> stations) {
  Strip strip;
  strip.path = std::move(path);
  strip.rest_length = line_length(strip.path);
  double last_s = -1;
  for (const Station& station : stations) {
    if (!(station.s > last_s) || station.s < 0 || station.s > 1)
      throw std::invalid_argument("make_strip: station at s " + std::to_string(station.s) +
                                  " after " + std::to_string(last_s));
    last_s = station.s;
    Slice slice;
    slice.s = station.s;
    slice.radii = station.radii;
    strip.slices.push_back(slice);
  }
  if (stations.empty()) throw std::invalid_argument("make_strip: no stations");
  strip.reference = stations[0].width;
  const Frames f = frames(strip);
  strip.reference = f.r[0];
  double last_roll = 0;
  for (size_t k = 0; k < stations.size(); ++k) {
    const Vec3& t = f.tangents[k];
    const Vec3 side = t.cross(f.r[k]);
    const Vec3& width = stations[k].width;
    if (!(width.cross(t).norm() > 1e-6 * width.norm()))
      throw std::invalid_argument("make_strip: the width at s " + std::to_string(stations[k].s) +
                                  " lies along the line");
    double roll = std::atan2(width.dot(side), width.dot(f.r[k]));
    roll = last_roll + std::remainder(roll - last_roll, std::numbers::pi);
    Slice& slice = strip.slices[k];
    slice.roll = last_roll = roll;
    const Vec3 w = std::cos(roll) * f.r[k] + std::sin(roll) * side;
    slice.offset = Vec2(stations[k].offset.dot(w), stations[k].offset.dot(t.cross(w)));
  }
  return strip;
}

std::vector<Station> resample_stations(std::span<const PathPoint> path,
                                       std::span<const Station> stations,
                                       std::span<const double> s) {
  if (stations.empty()) throw std::invalid_argument("resample_stations: no stations");
  // Widths turn with the line between two stations, so they are interpolated as rolls of a strip
  // that has slices at both.
  std::vector<double> all(s.begin(), s.end());
  for (const Station& station : stations) all.push_back(station.s);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  const std::vector<Vec3> points = line_points(path, all);
  const std::vector<Vec3> tangents = line_tangents(points);
  const std::vector<Vec3> r = transport(points, tangents, stations[0].width);
  const auto index = [&](double value) {
    return std::lower_bound(all.begin(), all.end(), value) - all.begin();
  };
  std::vector<double> rolls;
  for (const Station& station : stations) {
    const auto k = index(station.s);
    const double roll =
        std::atan2(station.width.dot(tangents[k].cross(r[k])), station.width.dot(r[k]));
    rolls.push_back(rolls.empty()
                        ? roll
                        : rolls.back() + std::remainder(roll - rolls.back(), std::numbers::pi));
  }
  std::vector<Station> out;
  for (double value : s) {
    size_t b = 0;
    while (b < stations.size() && stations[b].s < value) ++b;
    const size_t a = b == 0 ? 0 : b - 1;
    b = std::min(b, stations.size() - 1);
    const double gap = stations[b].s - stations[a].s;
    const double share = gap > 0 ? (value - stations[a].s) / gap : 0;
    const auto k = index(value);
    const double roll = rolls[a] + share * (rolls[b] - rolls[a]);
    Station station;
    station.s = value;
    station.offset = stations[a].offset + share * (stations[b].offset - stations[a].offset);
    station.radii = stations[a].radii + share * (stations[b].radii - stations[a].radii);
    station.width = std::cos(roll) * r[k] + std::sin(roll) * tangents[k].cross(r[k]);
    out.push_back(station);
  }
  return out;
}

void set_slices(Strip& strip, std::span<const Ellipse> ellipses) {
  if (ellipses.size() != strip.slices.size())
    throw std::invalid_argument("set_slices: " + std::to_string(ellipses.size()) +
                                " ellipses for " + std::to_string(strip.slices.size()) + " slices");
  const Frames f = frames(strip);
  for (size_t k = 0; k < ellipses.size(); ++k) {
    Slice& slice = strip.slices[k];
    const Vec3 side = f.tangents[k].cross(f.r[k]);
    const Vec3 width = ellipses[k].axes.col(0);
    slice.roll = std::atan2(width.dot(side), width.dot(f.r[k]));
    const Vec3 w = std::cos(slice.roll) * f.r[k] + std::sin(slice.roll) * side;
    const Vec3 offset = ellipses[k].center - f.points[k];
    slice.offset = Vec2(offset.dot(w), offset.dot(f.tangents[k].cross(w)));
    slice.radii = ellipses[k].radii;
    slice.outline = ellipses[k].outline;
  }
}

void set_slices(Muscle& muscle, std::span<const Ellipse> ellipses) {
  std::size_t at = 0;
  for (Strip& strip : muscle.strips) {
    set_slices(strip, ellipses.subspan(at, strip.slices.size()));
    at += strip.slices.size();
  }
}

void set_outlines(Muscle& muscle, std::span<const Ellipse> ellipses) {
  std::size_t at = 0;
  for (Strip& strip : muscle.strips)
    for (Slice& slice : strip.slices) slice.outline = ellipses[at++].outline;
}

double belly_weight(const Strip& strip, double s) {
  double share = 1;
  if (strip.belly_begin > 0) share *= smooth_step((s - strip.belly_begin) / (2 * kJunction) + 0.5);
  if (strip.belly_end < 1) share *= smooth_step((strip.belly_end - s) / (2 * kJunction) + 0.5);
  return share;
}

double intersection_weight(const Strip& strip, double s) {
  double off = 1;
  for (const double place : strip.intersections)
    off = std::min(off, smooth_step(std::abs(s - place) / kIntersection));
  return 1 - off;
}

double flesh_weight(const Strip& strip, double s, double width_share) {
  const double beside = strip.raphe > 0 ? smooth_step(width_share / strip.raphe - 1) : 1;
  return belly_weight(strip, s) * (1 - intersection_weight(strip, s)) * beside;
}

double tube_volume(std::span<const Ellipse> ellipses) {
  double volume = 0;
  for (size_t k = 0; k + 1 < ellipses.size(); ++k) {
    const Ellipse &p = ellipses[k], &q = ellipses[k + 1];
    const Vec3 a0 = p.radii.x() * p.axes.col(0), b0 = p.radii.y() * p.axes.col(1);
    const Vec3 a1 = q.radii.x() * q.axes.col(0), b1 = q.radii.y() * q.axes.col(1);
    const PieceAreas areas = piece_areas(p.outline, q.outline);
    const Vec3 between = areas.ab * a0.cross(b1) + areas.ba * a1.cross(b0) +
                         areas.aa * a0.cross(a1) + areas.bb * b0.cross(b1);
    const Vec3 area =
        (areas.own * a0.cross(b0) + 0.5 * between + outline_area(q.outline) * a1.cross(b1)) / 3;
    const double turned = (areas.more_a1 * a1 + areas.more_b1 * b1).dot(a0.cross(b0)) -
                          (areas.more_a0 * a0 + areas.more_b0 * b0).dot(a1.cross(b1));
    volume += std::numbers::pi * ((q.center - p.center).dot(area) + turned / 3);
  }
  return volume;
}

}  // namespace ecorche::inline v1
