#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>

#include "anatomy/contact/muscle_contact.h"
#include "anatomy/joint_angles.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"

namespace ecorche {
namespace {

constexpr int kLimitPoses = 12;
constexpr double kHalfWay = 0.6;  // of the way to a limit
constexpr std::array<double, 2> kCrossing = {
    0.45,
    0.8};  // of the way: where limbs brought inward lie in one another, too, at other sections
constexpr int kPoses = kLimitPoses + int(kCrossing.size());
constexpr double kHinge = 2.5;  // its flexion has so many times the range of its other angles
// of all muscles' volume, in some pose: what a pose looks at, before the skin has pressed anything,
constexpr double kMuchShared = 1e-4;
constexpr double kLeastShared = 5e-6;  // and what is worth a look at all
// pairs that are looked at together: what is known of them stays in the nearest memory
constexpr int kBlock = 128;
constexpr float kRounding = 1e-5f;  // of a factor, in single precision

struct Box {
  float low[3] = {1e9f, 1e9f, 1e9f}, high[3] = {-1e9f, -1e9f, -1e9f};
  void add(const ContactSection& s, float reach) {
    for (int r = 0; r < 3; ++r)
      low[r] = std::min(low[r], s.center[r] - reach),
      high[r] = std::max(high[r], s.center[r] + reach);
  }
  bool meets(const Box& other) const {
    for (int r = 0; r < 3; ++r)
      if (low[r] > other.high[r] || high[r] < other.low[r]) return false;
    return true;
  }
};

// A sheet's strips have sides on which they are drawn on into the next one: no vertex follows the
// outline there.
void lay_out(const Anatomy& anatomy, const std::vector<SliceRange>& ranges,
             ContactTable& table) {  // all sections, as members
  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, true});
  std::vector<char> drawn(slice_count(anatomy), 0);
  for (const MuscleSurface::Term& t : surface.terms) {
    const long place = std::lround(t.place) % kOutlinePoints;
    if (t.u != 0 && (place == 0 || place == kOutlinePoints / 2))
      drawn[t.slice] |= place == 0 ? 2 : 1;
  }
  for (const SliceRange& range : ranges) {
    const MuscleSurface::Part& part = surface.parts[range.muscle];
    const std::vector<Slice>& slices = anatomy.muscles[range.muscle].strips[range.strip].slices;
    for (int k = range.begin; k < range.end; ++k) {
      table.members.push_back(
          {k, part.sheet ? part.thickness : 1, k == range.begin, k + 1 == range.end});
      table.shapes.push_back(
          contact_shape(slices[k - range.begin].outline, part.sheet ? 3 & ~drawn[k] : 0));
    }
  }
}

// Of joints that turn every way one angle goes so far up or down, of hinges their flexion to an
// end.
struct Turn {
  int angle = 0;
  bool up = false, bent = false;
  double share = 1;
};

// One angle after the other, with hinges bent and, farther from the limits, straight: bodies bend
// like that, and muscles meet most at the ends of ranges. Legs that come together pass through one
// another before they are there.
Turn turn_of(int index) {
  if (index >= kLimitPoses) return {1, false, false, kCrossing[index - kLimitPoses]};
  const bool bent = index % 2 == 1;
  return {index / 4, index / 2 % 2 == 0, bent, bent ? 1 : kHalfWay};
}

// All joints at once.
Pose limit_pose(const Skeleton& skeleton, const Turn& turn) {
  Pose pose = rest_pose(skeleton);
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const Vec3 range = joint.max - joint.min;
    const bool hinge = range[0] > kHinge * std::max(range[1], range[2]);
    const int axis = hinge ? 0 : turn.angle;
    Vec3 angles = joint_angles(joint, Quat::Identity());
    double& angle = angles[axis];
    const double limit = (hinge ? turn.bent : turn.up) ? std::max(angle, joint.max[axis])
                                                       : std::min(angle, joint.min[axis]);
    angle += (hinge ? 1 : turn.share) * (limit - angle);
    pose.rotations[j] = joint_rotation(joint, angles);
  }
  complete_pose(skeleton, pose);
  return pose;
}

// Volume that one section shares with another beyond what it shares at rest, m^3.
float shared_volume(const ContactTable& table, const ContactMemory& posed,
                    const ContactMemory& rest, int own, int other) {
  ContactSpokes press, near, still;
  if (!press_of(posed, own, other, other, press, near) ||
      !(*std::max_element(press.begin(), press.end()) > 0))
    return 0;
  if (!press_of(rest, own, other, other, still, near)) still.fill(0);
  for (std::size_t i = 0; i < press.size(); ++i) press[i] -= still[i];
  return given_volume(posed.sections[own], table.shapes[own], press);
}

struct Places {
  std::vector<SliceRange> strips;
  std::vector<int> mirrored;  // #sections, its image's on the other side, or itself
};

// own << 32 | other, ascending.
using Pairs = std::vector<std::uint64_t>;

// m^3
struct Shared {
  float much = 0, least = 0;
};

struct FoundPairs {
  Pairs much, all;
};

// Pairs of sections that share so much.
FoundPairs pairs_of(const ContactTable& table, const Places& places, const ContactMemory& posed,
                    const ContactMemory& rest, const Shared& asked) {
  const std::size_t n = places.strips.size();
  std::vector<Box> near(n), wide(n);  // about outlines, about what they speak for
  for (std::size_t s = 0; s < n; ++s)
    for (int k = places.strips[s].begin; k < places.strips[s].end; ++k) {
      const std::size_t i = k;
      near[s].add(posed.sections[i], -posed.own_balls[i][3]);
      wide[s].add(posed.sections[i], posed.balls[i][3]);
    }
  FoundPairs out;
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t t = 0; t < n; ++t) {
      if (places.strips[s].muscle == places.strips[t].muscle || !near[s].meets(wide[t])) continue;
      for (int a = places.strips[s].begin; a < places.strips[s].end; ++a) {
        const ContactSection& own = posed.sections[a];
        Box box;
        box.add(own, -posed.own_balls[a][3]);
        if (!box.meets(wide[t])) continue;
        for (int b = places.strips[t].begin; b < places.strips[t].end; ++b) {
          const float shared = shared_volume(table, posed, rest, a, b);
          if (!(shared > asked.least)) continue;
          const std::uint64_t pair = std::uint64_t(a) << 32 | std::uint64_t(b);
          out.all.push_back(pair);
          if (shared > asked.much) out.much.push_back(pair);
        }
      }
    }
  return out;
}

std::vector<int> mirrored_sections(const Anatomy& anatomy, const std::vector<SliceRange>& ranges,
                                   int count) {
  std::vector<int> out(count);
  for (const SliceRange& range : ranges) {
    const Muscle& muscle = anatomy.muscles[range.muscle];
    std::string name = muscle.name;
    if (muscle.side != Side::middle && name.size() > 2)
      name.replace(name.size() - 2, 2, muscle.side == Side::left ? "_r" : "_l");
    const int other = find_muscle(anatomy, name);
    const auto image = std::find_if(ranges.begin(), ranges.end(), [&](const SliceRange& r) {
      return r.muscle == other && r.strip == range.strip &&
             r.end - r.begin == range.end - range.begin;
    });
    for (int k = range.begin; k < range.end; ++k)
      out[k] = image == ranges.end() ? k : image->begin + k - range.begin;
  }
  return out;
}

void group(const Pairs& pairs, const Places& places, const ContactMemory& rest,
           ContactTable& table) {
  std::vector<int> strip(rest.sections.size());
  for (std::size_t s = 0; s < places.strips.size(); ++s)
    std::fill(strip.begin() + places.strips[s].begin, strip.begin() + places.strips[s].end, int(s));
  for (const std::uint64_t pair : pairs) {
    const int own = int(pair >> 32), other = int(pair & 0xffffffffu);
    if (!table.groups.empty()) {
      ContactGroup& last = table.groups.back();
      if (last.own == own && strip[last.last] == strip[other]) {
        last.last = other;
        continue;
      }
    }
    table.groups.push_back({own, other, other, {}});
  }
  ContactSpokes near;
  for (ContactGroup& of : table.groups) {
    if (!press_of(rest, of.own, of.first, of.last, of.at_rest, near)) of.at_rest.fill(0);
    for (float& p : of.at_rest) p += kRounding;
  }
}

// What a section touches at rest and is in no group with stays beside it in every pose, for all
// that is known.
void hold(const Places& places, const ContactMemory& rest, ContactTable& table) {
  const std::size_t n = places.strips.size();
  std::vector<Box> wide(n);
  for (std::size_t t = 0; t < n; ++t)
    for (int k = places.strips[t].begin; k < places.strips[t].end; ++k)
      wide[t].add(rest.sections[k], rest.balls[k][3]);
  table.held.assign(table.members.size(), {});
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t s) {
    ContactSpokes press, near;
    for (int a = places.strips[s].begin; a < places.strips[s].end; ++a) {
      Box box;
      box.add(rest.sections[a], -rest.own_balls[a][3]);
      const auto first = std::partition_point(table.groups.begin(), table.groups.end(),
                                              [&](const ContactGroup& g) { return g.own < a; });
      for (std::size_t t = 0; t < n; ++t) {
        if (places.strips[s].muscle == places.strips[t].muscle || !box.meets(wide[t])) continue;
        bool looked_at = false;
        for (auto g = first; g != table.groups.end() && g->own == a; ++g)
          looked_at =
              looked_at || (g->first < places.strips[t].end && g->last >= places.strips[t].begin);
        if (looked_at ||
            !press_of(rest, a, places.strips[t].begin, places.strips[t].end - 1, press, near))
          continue;
        ContactSpokes& held = table.held[a];
        for (std::size_t i = 0; i < held.size(); ++i) held[i] = std::max(held[i], near[i]);
      }
    }
  });
}

// Members that are in no group go.
void leave_out_idle(ContactTable& table) {
  std::vector<int> place(table.members.size(), -1);
  for (const ContactGroup& group : table.groups) {
    place[group.own] = 0;
    std::fill(place.begin() + group.first, place.begin() + group.last + 1, 0);
  }
  int count = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] < 0) continue;
    table.members[count] = table.members[i];
    table.shapes[count] = table.shapes[i];
    table.held[count] = table.held[i];
    place[i] = count++;
  }
  table.members.resize(count);
  table.shapes.resize(count);
  table.held.resize(count);
  table.members.shrink_to_fit();
  table.shapes.shrink_to_fit();
  for (ContactGroup& group : table.groups)
    for (int* member : {&group.own, &group.first, &group.last}) *member = place[*member];
}

// Pairs, where members' begin, and their blocks.
void list_pairs(ContactTable& table) {
  table.first_pairs.assign(table.members.size() + 1, 0);
  for (std::size_t g = 0; g < table.groups.size(); ++g) {
    const ContactGroup& group = table.groups[g];
    for (int k = group.first; k <= group.last; ++k) {
      table.others.push_back(k);
      table.group_of.push_back(int(g));
    }
    table.first_pairs[group.own + 1] = table.others.size();
  }
  for (std::size_t i = 1; i < table.first_pairs.size(); ++i)
    // of members without
    table.first_pairs[i] = std::max(table.first_pairs[i], table.first_pairs[i - 1]);
  table.others.insert(table.others.end(), kContactPoints, 0);
  table.blocks.push_back(0);
  for (std::size_t i = 1; i < table.first_pairs.size(); ++i) {
    const int count = table.first_pairs[i] - table.first_pairs[table.blocks.back()];
    if (count < kBlock && i + 1 < table.first_pairs.size()) continue;
    table.most_pairs = std::max(table.most_pairs, count);
    table.blocks.push_back(int(i));
  }
}

// Of all poses, and their mirror images.
Pairs gathered(std::span<const FoundPairs> found, Pairs FoundPairs::*kind, const Places& places) {
  Pairs pairs;
  for (const FoundPairs& some : found) {
    for (const std::uint64_t pair : some.*kind) {
      const auto image = [&](std::uint64_t k) { return std::uint64_t(places.mirrored[k]); };
      pairs.push_back(pair);
      pairs.push_back(image(pair >> 32) << 32 | image(pair & 0xffffffffu));
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }
  return pairs;
}

}  // namespace

ContactTables make_contact_tables(const Anatomy& anatomy, const PosingTable& still) {
  ContactTable all;
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  lay_out(anatomy, ranges, all);
  const Places places{ranges, mirrored_sections(anatomy, ranges, still.slices())};
  const Skeleton& skeleton = anatomy.skeleton;
  PosedAnatomy standing;
  pose_anatomy(still, skeleton, rest_pose(skeleton), standing);
  ContactMemory rest;
  look_at_sections(all, standing.slices, standing.X_WJ[0].translation(), rest);

  double whole = 0;
  for (const SliceRange& range : ranges) whole += strip_volume(standing, range);
  const Shared asked{float(kMuchShared * whole), float(kLeastShared * whole)};
  std::vector<FoundPairs> found(kPoses);
  tbb::parallel_for(0, kPoses, [&](int i) {
    PosedAnatomy posed;
    ContactMemory memory;
    pose_anatomy(still, skeleton, limit_pose(skeleton, turn_of(i)), posed);
    look_at_sections(all, posed.slices, posed.X_WJ[0].translation(), memory);
    FoundPairs& pairs = found[i];
    pairs = pairs_of(all, places, memory, rest, asked);
    if (i >= kLimitPoses)
      // what shares little at the limits costs every pose more than it gives: parting again is
      // enough
      pairs.much.clear();
  });
  const auto table_of = [&](Pairs FoundPairs::*kind) {
    ContactTable table = all;
    group(gathered(found, kind, places), places, rest, table);
    hold(places, rest, table);
    leave_out_idle(table);
    list_pairs(table);
    table.whole = float(whole);
    return table;
  };
  return {table_of(&FoundPairs::much), table_of(&FoundPairs::all)};
}

}  // namespace ecorche
