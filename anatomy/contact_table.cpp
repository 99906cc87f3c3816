#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "anatomy/joint_angles.h"
#include "anatomy/muscle_line.h"
#include "anatomy/muscle_surface.h"
#include "anatomy/posed_contact.h"

namespace ecorche {
namespace {

constexpr int kPoses = 12;
constexpr double kStep = 0.6180339887498949;  // of successive poses in a joint's range: never the same, and evenly spread
constexpr double kLeastShared = 8e-5;         // of all muscles' volume, in some pose: less is not worth a look
constexpr float kRounding = 1e-5f;            // of a factor, in single precision

struct Box {
  float low[3] = {1e9f, 1e9f, 1e9f}, high[3] = {-1e9f, -1e9f, -1e9f};
  void add(const ContactSection& s, float reach) {
    for (int r = 0; r < 3; ++r) low[r] = std::min(low[r], s.center[r] - reach), high[r] = std::max(high[r], s.center[r] + reach);
  }
  bool meets(const Box& other) const {
    for (int r = 0; r < 3; ++r)
      if (low[r] > other.high[r] || high[r] < other.low[r]) return false;
    return true;
  }
};

// A sheet's strips have sides on which they are drawn on into the next one: no vertex follows the outline there.
void lay_out(const Anatomy& anatomy, const std::vector<SliceRange>& ranges, ContactTable& table) {
  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, true});
  const std::size_t count = static_cast<std::size_t>(slice_count(anatomy));
  table.sides.assign(count, 0);
  std::vector<char> drawn(count, 0);
  for (const MuscleSurface::Term& t : surface.terms) {
    const long place = std::lround(t.place) % kOutlinePoints;
    if (t.u != 0 && (place == 0 || place == kOutlinePoints / 2)) drawn[static_cast<std::size_t>(t.slice)] |= place == 0 ? 2 : 1;
  }
  for (const SliceRange& range : ranges) {
    const MuscleSurface::Part& part = surface.parts[static_cast<std::size_t>(range.muscle)];
    table.strips.push_back({range.begin, range.end, part.sheet ? part.thickness : 1});
    if (!part.sheet) continue;
    for (int k = range.begin; k < range.end; ++k) table.sides[static_cast<std::size_t>(k)] = static_cast<char>(3 & ~drawn[static_cast<std::size_t>(k)]);
  }
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips)
      for (const Slice& slice : strip.slices) {
        ContactSpokes& spokes = table.spokes.emplace_back();
        for (std::size_t i = 0; i < spokes.size(); ++i) spokes[i] = slice.outline[2 * i];
        table.waves.push_back(outline_waves(slice.outline));
        table.boxes.push_back(outline_box(slice.outline));
      }
}

// Poses that spread through the ranges of all joints at once, and farther from their middles than from their ends.
Pose spread_pose(const Skeleton& skeleton, int index) {
  Pose pose = rest_pose(skeleton);
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    Vec3 angles;
    for (int axis = 0; axis < 3; ++axis) {
      const double seed = 0.7548776662466927 * static_cast<double>(3 * j) + 0.5698402909980532 * axis;
      const double at = seed + kStep * (index + 1) * (1 + 0.37 * static_cast<double>((3 * j + static_cast<std::size_t>(axis)) % 7));
      const double share = 0.5 - 0.5 * std::cos(3.141592653589793 * (at - std::floor(at)));
      angles[axis] = joint.min[axis] + share * (joint.max[axis] - joint.min[axis]);
    }
    pose.rotations[j] = joint_rotation(joint, angles);
  }
  complete_pose(skeleton, pose);
  return pose;
}

// Volume that one section shares with another beyond what it shares at rest, m^3.
float shared_volume(const ContactTable& table, const ContactMemory& posed, const ContactMemory& rest, int own, int other) {
  ContactSpokes press, near, still;
  const ContactGroup pair{own, other, other, {}};
  if (!press_of(table, posed, pair, press, near) || !(*std::max_element(press.begin(), press.end()) > 0)) return 0;
  if (!press_of(table, rest, pair, still, near)) still.fill(0);
  const ContactSection& s = posed.sections[static_cast<std::size_t>(own)];
  const float a = 1 / s.per_width2, b = 1 / s.per_thickness2;
  float sum = 0;
  for (std::size_t i = 0; i < press.size(); ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / kContactPoints, c = std::cos(angle), factor = table.spokes[static_cast<std::size_t>(own)][i];
    sum += std::max(press[i] - still[i], 0.0f) * factor * factor * (a * c * c + b * (1 - c * c));
  }
  return sum * (6.2831853f / kContactPoints) * 0.5f * (1 / s.per_before + 1 / s.per_after);
}

bool in_reach(const ContactSection& own, const ContactSection& other) {
  const float x = own.center[0] - other.center[0], y = own.center[1] - other.center[1], z = own.center[2] - other.center[2], reach = own.wide + other.reach;
  return x * x + y * y + z * z < reach * reach;
}

struct Places {
  std::vector<int> muscle, mirrored;  // #strips; #sections, its image's on the other side, or itself
};

// own << 32 | other, ascending.
using Pairs = std::vector<std::uint64_t>;

// Pairs of sections that share more than `least`, m^3.
Pairs pairs_of(const ContactTable& table, const Places& places, const ContactMemory& posed, const ContactMemory& rest, float least) {
  const std::size_t n = table.strips.size();
  std::vector<Box> near(n), wide(n);  // about outlines, about what they speak for
  for (std::size_t s = 0; s < n; ++s)
    for (int k = table.strips[s].begin; k < table.strips[s].end; ++k) {
      const ContactSection& section = posed.sections[static_cast<std::size_t>(k)];
      near[s].add(section, section.wide);
      wide[s].add(section, section.reach);
    }
  Pairs out;
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t t = 0; t < n; ++t) {
      if (places.muscle[s] == places.muscle[t] || !near[s].meets(wide[t])) continue;
      for (int a = table.strips[s].begin; a < table.strips[s].end; ++a) {
        const ContactSection& own = posed.sections[static_cast<std::size_t>(a)];
        Box box;
        box.add(own, own.wide);
        if (!box.meets(wide[t])) continue;
        for (int b = table.strips[t].begin; b < table.strips[t].end; ++b)
          if (in_reach(own, posed.sections[static_cast<std::size_t>(b)]) && shared_volume(table, posed, rest, a, b) > least) out.push_back(static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b));
      }
    }
  return out;
}

std::vector<int> mirrored_sections(const Anatomy& anatomy, const std::vector<SliceRange>& ranges, int count) {
  std::vector<int> out(static_cast<std::size_t>(count));
  for (const SliceRange& range : ranges) {
    const Muscle& muscle = anatomy.muscles[static_cast<std::size_t>(range.muscle)];
    std::string name = muscle.name;
    if (muscle.side != Side::middle && name.size() > 2) name.replace(name.size() - 2, 2, muscle.side == Side::left ? "_r" : "_l");
    const int other = find_muscle(anatomy, name);
    const auto image = std::find_if(ranges.begin(), ranges.end(), [&](const SliceRange& r) { return r.muscle == other && r.strip == range.strip && r.end - r.begin == range.end - range.begin; });
    for (int k = range.begin; k < range.end; ++k) out[static_cast<std::size_t>(k)] = image == ranges.end() ? k : image->begin + k - range.begin;
  }
  return out;
}

void group(const Pairs& pairs, const ContactMemory& rest, ContactTable& table) {
  std::vector<int> strip(rest.sections.size());
  for (std::size_t s = 0; s < table.strips.size(); ++s) std::fill(strip.begin() + table.strips[s].begin, strip.begin() + table.strips[s].end, static_cast<int>(s));
  for (const std::uint64_t pair : pairs) {
    const int own = static_cast<int>(pair >> 32), other = static_cast<int>(pair & 0xffffffffu);
    if (!table.groups.empty()) {
      ContactGroup& last = table.groups.back();
      if (last.own == own && strip[static_cast<std::size_t>(last.last)] == strip[static_cast<std::size_t>(other)]) {
        last.last = other;
        continue;
      }
    }
    table.groups.push_back({own, other, other, {}});
  }
  ContactSpokes near;
  for (std::size_t g = 0; g < table.groups.size(); ++g) {
    ContactGroup& of = table.groups[g];
    if (!press_of(table, rest, of, of.at_rest, near)) of.at_rest.fill(0);
    for (float& p : of.at_rest) p += kRounding;
    if (table.owners.empty() || table.owners.back() != of.own) {
      table.owners.push_back(of.own);
      table.owner_begin.push_back(static_cast<int>(g));
    }
  }
  table.owner_begin.push_back(static_cast<int>(table.groups.size()));
}

}  // namespace

ContactTable make_contact_table(const Anatomy& anatomy, const PosingTable& still) {
  ContactTable table;
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  lay_out(anatomy, ranges, table);
  Places places{{}, mirrored_sections(anatomy, ranges, still.slices())};
  for (const SliceRange& range : ranges) places.muscle.push_back(range.muscle);
  const Skeleton& skeleton = anatomy.skeleton;
  PosedAnatomy standing;
  pose_anatomy(still, skeleton, rest_pose(skeleton), standing);
  ContactMemory rest;
  look_at_sections(table, standing.slices, standing.X_WJ[0].translation(), rest);

  double whole = 0;
  for (const SliceRange& range : ranges) whole += strip_volume(standing, range);
  const double least = kLeastShared * whole;
  std::vector<Pairs> found(kPoses);
  tbb::parallel_for(0, kPoses, [&](int i) {
    PosedAnatomy posed;
    ContactMemory memory;
    pose_anatomy(still, skeleton, spread_pose(skeleton, i), posed);
    look_at_sections(table, posed.slices, posed.X_WJ[0].translation(), memory);
    found[static_cast<std::size_t>(i)] = pairs_of(table, places, memory, rest, static_cast<float>(least));
  });
  Pairs pairs;
  for (const Pairs& some : found) {
    for (const std::uint64_t pair : some) {
      const auto image = [&](std::uint64_t k) { return static_cast<std::uint64_t>(places.mirrored[static_cast<std::size_t>(k)]); };
      pairs.push_back(pair);
      pairs.push_back(image(pair >> 32) << 32 | image(pair & 0xffffffffu));
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }
  group(pairs, rest, table);
  return table;
}

}  // namespace ecorche
