#include "skinning/interior/strip_joints.h"

#include <algorithm>
#include <set>
#include <utility>

#include "anatomy/compute/smooth_step.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kHeld = 0.05;  // m from an end, over which its bone holds a strip
// A deep strip most of which lies along the bone of its end is bedded on it.
constexpr double kBedded = 0.8, kLong = 0.6;  // by which share; from which share of its length on
constexpr double kBed = 0.1;                  // m from that end
constexpr double kOwnFade = 0.03;  // m, over which joints of a piece of the line fade beyond it

// How far along a strip its sections lie, m.
std::vector<double> distances_along(std::span<const Ellipse> slices) {
  std::vector<double> out(slices.size(), 0.0);
  for (std::size_t k = 1; k < slices.size(); ++k)
    out[k] = out[k - 1] + (slices[k].center - slices[k - 1].center).norm();
  return out;
}

// Joints of the bones that carry a piece of a line, and those between them.
std::vector<char> joints_of(std::span<const PathPoint> line, std::span<const int> parents) {
  std::set<int> carriers;
  for (const PathPoint& point : line)
    for (const int j : point.joints)
      if (j >= 0) carriers.insert(j);
  std::vector<std::size_t> carried(parents.size(), 0);  // carriers that move with each joint
  for (const int carrier : carriers)
    for (int j = carrier; j >= 0; j = parents[j]) ++carried[j];
  std::vector<char> out(parents.size(), 0);
  int common = 0;  // parents precede children
  for (std::size_t j = 0; j < parents.size(); ++j) {
    out[j] = carried[j] > 0 && carried[j] < carriers.size();
    if (carried[j] == carriers.size()) common = int(j);
  }
  out[common] = 1;
  return out;
}

// How far along a strip the sections next to its line's points lie, m, rising.
std::vector<double> points_along(const Strip& strip, std::span<const Ellipse> slices,
                                 std::span<const double> along) {
  std::vector<double> out;
  std::size_t from = 0;
  for (const PathPoint& point : strip.path) {
    for (std::size_t k = from + 1; k < slices.size(); ++k)
      if ((slices[k].center - point.rest).norm() < (slices[from].center - point.rest).norm())
        from = k;
    out.push_back(along[from]);
  }
  out.front() = 0;
  out.back() = along.back();
  return out;
}

}  // namespace

std::vector<BoneHold> bone_holds(const Muscle& muscle, const Strip& strip,
                                 std::span<const Ellipse> slices) {
  const std::vector<double> along = distances_along(slices);
  const double fade = std::min(kHeld, 0.5 * along.back());
  std::vector<BoneHold> out(along.size());
  // By a share up to `reach` from an end, fading beyond; the larger share counts.
  const auto hold = [&](int joint, bool from_last, double share, double reach, double over) {
    if (joint < 0) return;
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double distance = from_last ? along.back() - along[k] : along[k],
                   here = share * (1 - smooth_step(reach, reach + over, distance));
      if (here > out[k].share) out[k] = {joint, here};
    }
  };
  const auto [origin, insertion] = end_joints(muscle, strip);
  hold(origin, false, 1, 0, fade);
  hold(insertion, true, 1, 0, fade);
  if (muscle.layer != "deep" || muscle.sheet) return out;
  const std::span<const PathPoint> line = strip.path;
  const std::vector<double> points = points_along(strip, slices, along);
  const auto on_end = [&](const PathPoint& p, int joint) {
    return p.joints[1] < 0 && p.joints[0] == joint;
  };
  std::size_t first = 0, last = line.size() - 1;
  while (first + 1 < line.size() && on_end(line[first + 1], origin)) ++first;
  while (last > 0 && on_end(line[last - 1], insertion)) --last;
  const auto bed = [&](int joint, bool from_last, double length) {
    if (length >= kLong * along.back())
      hold(joint, from_last, kBedded, std::min(length, kBed), kOwnFade);
  };
  bed(origin, false, points[first]);
  bed(insertion, true, along.back() - points[last]);
  return out;
}

std::vector<GlideHold> glide_holds(const Strip& strip, std::span<const Ellipse> slices) {
  std::vector<GlideHold> out(slices.size());
  const std::span<const PathPoint> line = strip.path;
  if (std::ranges::none_of(line, [](const PathPoint& p) { return p.placing_joint >= 0; }))
    return out;
  const std::vector<double> along = distances_along(slices),
                            points = points_along(strip, slices, along);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    std::size_t i = 0;  // the piece of the line that the section is in
    while (i + 2 < line.size() && along[k] > points[i + 1]) ++i;
    const double length = points[i + 1] - points[i],
                 t = length > 0 ? std::clamp((along[k] - points[i]) / length, 0.0, 1.0) : 0;
    std::vector<std::pair<int, double>> weights;
    for (const auto& [point, weight] : {std::pair(&line[i], 1 - t), std::pair(&line[i + 1], t)}) {
      if (point->placing_joint < 0) continue;
      out[k].share += weight;
      weights.emplace_back(point->joints[0], weight * point->share);
      if (point->joints[1] >= 0)
        weights.emplace_back(point->joints[1], weight * (1 - point->share));
    }
    if (out[k].share > 0) out[k].joints = largest_weights(weights);
  }
  return out;
}

std::vector<std::vector<double>> own_joints(const Strip& strip, bool sheet,
                                            std::span<const int> parents,
                                            std::span<const Ellipse> slices) {
  const std::vector<double> along = distances_along(slices);
  std::vector<std::vector<double>> out(slices.size(), std::vector<double>(parents.size(), 0.0));
  const auto add = [&](std::span<const PathPoint> piece, double begin, double end) {
    const std::vector<char> joints = joints_of(piece, parents);
    for (std::size_t k = 0; k < slices.size(); ++k) {
      const double beyond = std::max({0.0, begin - along[k], along[k] - end}),
                   share = 1 - smooth_step(0.0, kOwnFade, beyond);
      for (std::size_t j = 0; j < parents.size(); ++j)
        if (joints[j]) out[k][j] = std::max(out[k][j], share);
    }
  };
  const std::span<const PathPoint> line = strip.path;
  if (sheet) {
    add(line, 0, along.back());
    return out;
  }
  const std::vector<double> points = points_along(strip, slices, along);
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    add(line.subspan(i, 2), points[i], points[i + 1]);
  return out;
}

}  // namespace ecorche::inline v1
