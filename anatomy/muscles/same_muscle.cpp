#include "anatomy/muscles/same_muscle.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {
namespace {

bool is_same(const PathPoint& a, const PathPoint& b) {
  return a.rest == b.rest && a.joints == b.joints && a.share == b.share &&
         a.placing_joint == b.placing_joint;
}

bool is_same(const Slice& a, const Slice& b) {
  return a.s == b.s && a.roll == b.roll && a.offset == b.offset && a.radii == b.radii &&
         a.outline == b.outline;
}

bool is_same(const Wrap& a, const Wrap& b) {
  return a.kind == b.kind && a.joint == b.joint && a.radii == b.radii &&
         a.X_WO.matrix() == b.X_WO.matrix();
}

template <class T>
bool are_same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(a, b, [](const T& x, const T& y) { return is_same(x, y); });
}

}  // namespace

bool is_same(const Strip& a, const Strip& b) {
  return are_same(a.path, b.path) && are_same(a.slices, b.slices) && are_same(a.wraps, b.wraps) &&
         a.reference == b.reference && a.belly_begin == b.belly_begin &&
         a.belly_end == b.belly_end && a.intersections == b.intersections && a.raphe == b.raphe;
}

bool is_same(const Muscle& a, const Muscle& b) {
  return a.name == b.name && a.label == b.label && a.origin == b.origin &&
         a.insertion == b.insertion && a.group == b.group && a.layer == b.layer &&
         a.sheet == b.sheet && a.origin_bone == b.origin_bone &&
         a.insertion_bone == b.insertion_bone && a.volume == b.volume &&
         a.fibre_length == b.fibre_length && a.pennation == b.pennation &&
         a.max_force == b.max_force && a.tendon_slack == b.tendon_slack &&
         a.tense_thickness == b.tense_thickness && are_same(a.strips, b.strips);
}

SharedSections shared_sections(const Anatomy& now, const Anatomy& before) {
  SharedSections out;
  std::map<std::pair<std::string, int>, SliceRange> were;
  for (const SliceRange& range : slice_ranges(before)) {
    were.emplace(std::pair(before.muscles[std::size_t(range.muscle)].name, range.strip), range);
    out.now.resize(std::size_t(range.end), -1);
  }
  for (const SliceRange& range : slice_ranges(now)) {
    out.before.resize(std::size_t(range.end), -1);
    const Muscle& muscle = now.muscles[std::size_t(range.muscle)];
    const auto was = were.find({muscle.name, range.strip});
    if (was == were.end() || !is_same(muscle, before.muscles[std::size_t(was->second.muscle)]))
      continue;
    for (int k = range.begin; k < range.end; ++k) {
      const int then = was->second.begin + k - range.begin;
      out.now[std::size_t(then)] = k;
      out.before[std::size_t(k)] = then;
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
