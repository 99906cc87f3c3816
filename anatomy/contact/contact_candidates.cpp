#include "anatomy/contact/contact_candidates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "anatomy/contact/section_contact.h"
#include "anatomy/contact/section_shape.h"
#include "anatomy/joint_angles.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/same_muscle.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kLimitPoses = 12;
constexpr double kHalfWay = 0.6;  // share of the way to a limit
// Shares of the way to adduction's limit at which limbs brought inward lie in one another, too, at
// other sections.
constexpr std::array<double, 2> kCrossing = {0.45, 0.8};
constexpr int kPoses = kLimitPoses + int(kCrossing.size());
constexpr double kHinge = 2.5;  // a hinge: range of its flexion over those of its other angles
// Overlap of two sections in some pose, over the volume of all muscles, from which a pair is a
// candidate: for the first pass of a pose, and for any. Less: slower frames; more: overlap stays.
constexpr double kMajorOverlap = 1e-4;
constexpr double kLeastOverlap = 5e-6;
// Pairs that are evaluated together: what is known of them stays in the nearest cache.
constexpr int kBlock = 128;
constexpr float kImage = 3e-3f;     // m, by which a section may lie off another's mirror image
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

// All sections, as members. On the sides on which a sheet's strips are drawn on into the next one
// no vertex follows the outline.
void add_members(const Anatomy& anatomy, const std::vector<SliceRange>& ranges,
                 ContactCandidates& table) {
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
          section_shape(slices[k - range.begin].outline, part.sheet ? 3 & ~drawn[k] : 0));
    }
  }
}

// A pose of all joints: one angle of ball joints goes `share` of the way to its upper or lower
// limit, hinges are bent or straight.
struct LimitAngles {
  int angle = 0;
  bool up = false, bent = false;
  double share = 1;
};

// One angle after the other, with hinges bent and, farther from the limits, straight: bodies bend
// like that, and muscles meet most at the ends of ranges. Legs that come together pass through one
// another before they are there.
LimitAngles limit_pose_of(int index) {
  if (index >= kLimitPoses) return {1, false, false, kCrossing[index - kLimitPoses]};
  const bool bent = index % 2 == 1;
  return {index / 4, index / 2 % 2 == 0, bent, bent ? 1 : kHalfWay};
}

// All joints at once.
Pose limit_pose(const Skeleton& skeleton, const LimitAngles& limits) {
  Pose pose = rest_pose(skeleton);
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const Vec3 range = joint.max - joint.min;
    const bool hinge = range[0] > kHinge * std::max(range[1], range[2]);
    const int axis = hinge ? 0 : limits.angle;
    Vec3 angles = joint_angles(joint, Quat::Identity());
    double& angle = angles[axis];
    const double limit = (hinge ? limits.bent : limits.up) ? std::max(angle, joint.max[axis])
                                                           : std::min(angle, joint.min[axis]);
    angle += (hinge ? 1 : limits.share) * (limit - angle);
    pose.rotations[j] = joint_rotation(joint, angles);
  }
  complete_pose(skeleton, pose);
  return pose;
}

// Overlap of one section with another beyond their overlap at rest, m^3.
float overlap_volume(const ContactCandidates& table, const SectionContactWorkspace& posed,
                     const SectionContactWorkspace& rest, int own, int other) {
  RadialSamples penetration, blocked, rest_penetration;
  if (!find_penetration(posed, own, other, other, penetration, blocked) ||
      !(*std::max_element(penetration.begin(), penetration.end()) > 0))
    return 0;
  if (!find_penetration(rest, own, other, other, rest_penetration, blocked))
    rest_penetration.fill(0);
  for (std::size_t i = 0; i < penetration.size(); ++i) penetration[i] -= rest_penetration[i];
  return penetration_volume(posed.sections[own], table.shapes[own], penetration);
}

struct Places {
  std::vector<SliceRange> strips;
  std::vector<int> mirrored;  // #sections, its image's on the other side, or itself
};

// own << 32 | other, ascending.
using Pairs = std::vector<std::uint64_t>;

// Overlap from which a pair counts, m^3.
struct OverlapLimits {
  float major = 0, least = 0;
};

// Where strips were before.
struct Known {
  std::vector<char> strips;   // #strips of Places: whether its sections were the same
  std::vector<int> sections;  // of each section before, where it is now; -1: nowhere
};

Known known_strips(const Anatomy& anatomy, const std::vector<SliceRange>& strips,
                   const ContactBefore& before) {
  Known out{std::vector<char>(strips.size(), 0), {}};
  if (!before.table) return out;
  SharedSections shared = shared_sections(anatomy, *before.anatomy);
  for (std::size_t s = 0; s < strips.size(); ++s)
    out.strips[s] = shared.before[std::size_t(strips[s].begin)] >= 0;
  out.sections = std::move(shared.now);
  return out;
}

// Those of before whose strips are both known.
Pairs known_pairs(const Pairs& before, const Known& known) {
  Pairs out;
  for (const std::uint64_t pair : before) {
    const int own = known.sections[pair >> 32], other = known.sections[pair & 0xffffffffu];
    if (own >= 0 && other >= 0) out.push_back(std::uint64_t(own) << 32 | std::uint64_t(other));
  }
  return out;
}

// Which strips lie at rest as the mirror images of others do, and which of those come second.
struct Images {
  std::vector<char> alike, second;  // #strips of Places
};

Images find_images(const Places& places, const SectionContactWorkspace& rest) {
  Images out;
  for (const SliceRange& strip : places.strips) {
    bool alike = true;
    for (int k = strip.begin; k < strip.end && alike; ++k) {
      const ContactSection &here = rest.sections[k], &there = rest.sections[places.mirrored[k]];
      float apart = 0;
      for (int r = 0; r < 3; ++r) {
        const float image = r == 0 ? -there.center[r] : there.center[r];
        apart += (here.center[r] - image) * (here.center[r] - image);
      }
      alike = apart < kImage * kImage;
    }
    out.alike.push_back(alike);
    out.second.push_back(alike && places.mirrored[strip.begin] < strip.begin);
  }
  return out;
}

// Pairs of sections that overlap by so much, but for those of which both strips are known, and for
// second images with others that have images: poses are the same on both sides, and gather() adds
// the images of what is found on one.
FoundPairs find_pairs(const ContactCandidates& table, const Places& places,
                      const SectionContactWorkspace& posed, const SectionContactWorkspace& rest,
                      const OverlapLimits& limits, std::span<const char> known,
                      const Images& images) {
  const std::size_t n = places.strips.size();
  std::vector<Box> near(n), wide(n);  // about outlines, about the regions that they block
  for (std::size_t s = 0; s < n; ++s)
    for (int k = places.strips[s].begin; k < places.strips[s].end; ++k) {
      const std::size_t i = k;
      near[s].add(posed.sections[i], -posed.own_spheres[i][3]);
      wide[s].add(posed.sections[i], posed.spheres[i][3]);
    }
  FoundPairs out;
  std::vector<int> reached;
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t t = 0; t < n; ++t) {
      if (places.strips[s].muscle == places.strips[t].muscle || !near[s].meets(wide[t]) ||
          (known[s] && known[t]) || (images.second[s] && images.alike[t]))
        continue;
      for (int a = places.strips[s].begin; a < places.strips[s].end; ++a) {
        const ContactSection& own = posed.sections[a];
        Box box;
        box.add(own, -posed.own_spheres[a][3]);
        if (!box.meets(wide[t])) continue;
        find_in_reach(posed, a, places.strips[t].begin, places.strips[t].end - 1, reached);
        for (const int b : reached) {
          const float overlap = overlap_volume(table, posed, rest, a, b);
          if (!(overlap > limits.least)) continue;
          const std::uint64_t pair = std::uint64_t(a) << 32 | std::uint64_t(b);
          out.all.push_back(pair);
          if (overlap > limits.major) out.major.push_back(pair);
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

void add_groups(const Pairs& pairs, const Places& places, const SectionContactWorkspace& rest,
                ContactCandidates& table) {
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
  RadialSamples blocked;
  for (ContactGroup& of : table.groups) {
    if (!find_penetration(rest, of.own, of.first, of.last, of.at_rest, blocked)) of.at_rest.fill(0);
    for (float& p : of.at_rest) p += kRounding;
  }
}

// Sections that touch at rest and are in no group together are taken to stay beside one another in
// every pose: they block each other's growth.
void block_growth(const Places& places, const SectionContactWorkspace& rest,
                  ContactCandidates& table) {
  const std::size_t n = places.strips.size();
  std::vector<Box> wide(n);
  for (std::size_t t = 0; t < n; ++t)
    for (int k = places.strips[t].begin; k < places.strips[t].end; ++k)
      wide[t].add(rest.sections[k], rest.spheres[k][3]);
  table.blocked.assign(table.members.size(), {});
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t s) {
    RadialSamples penetration, blocked;
    for (int a = places.strips[s].begin; a < places.strips[s].end; ++a) {
      Box box;
      box.add(rest.sections[a], -rest.own_spheres[a][3]);
      const auto first = std::partition_point(table.groups.begin(), table.groups.end(),
                                              [&](const ContactGroup& g) { return g.own < a; });
      for (std::size_t t = 0; t < n; ++t) {
        if (places.strips[s].muscle == places.strips[t].muscle || !box.meets(wide[t])) continue;
        bool candidate = false;
        for (auto g = first; g != table.groups.end() && g->own == a; ++g)
          candidate =
              candidate || (g->first < places.strips[t].end && g->last >= places.strips[t].begin);
        if (candidate || !find_penetration(rest, a, places.strips[t].begin,
                                           places.strips[t].end - 1, penetration, blocked))
          continue;
        RadialSamples& at_a = table.blocked[a];
        for (std::size_t i = 0; i < at_a.size(); ++i) at_a[i] = std::max(at_a[i], blocked[i]);
      }
    }
  });
}

// Removes members that are in no group.
void remove_idle(ContactCandidates& table) {
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
    table.blocked[count] = table.blocked[i];
    place[i] = count++;
  }
  table.members.resize(count);
  table.shapes.resize(count);
  table.blocked.resize(count);
  table.members.shrink_to_fit();
  table.shapes.shrink_to_fit();
  for (ContactGroup& group : table.groups)
    for (int* member : {&group.own, &group.first, &group.last}) *member = place[*member];
}

// Sets the pairs, where those of a member begin, and their blocks.
void list_pairs(ContactCandidates& table) {
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
  table.others.insert(table.others.end(), kContactDirections, 0);
  table.blocks.push_back(0);
  for (std::size_t i = 1; i < table.first_pairs.size(); ++i) {
    const int count = table.first_pairs[i] - table.first_pairs[table.blocks.back()];
    if (count < kBlock && i + 1 < table.first_pairs.size()) continue;
    table.most_pairs = std::max(table.most_pairs, count);
    table.blocks.push_back(int(i));
  }
}

// Pairs of all poses, and their mirror images.
Pairs gather(std::span<const FoundPairs> found, Pairs FoundPairs::*kind, const Places& places) {
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

ContactTable make_contact_table(const Anatomy& anatomy, const PosingTable& posing,
                                const ContactBefore& before) {
  ContactCandidates all;
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  add_members(anatomy, ranges, all);
  Places places{ranges, mirrored_sections(anatomy, ranges, posing.slices())};
  // Muscles in the fat of the skin slide over all that lies beneath.
  std::erase_if(places.strips, [&](const SliceRange& range) {
    return lies_in_fat(anatomy.muscles[range.muscle]);
  });
  const Skeleton& skeleton = anatomy.skeleton;
  PosedAnatomy standing;
  pose_anatomy(posing, skeleton, rest_pose(skeleton), standing);
  SectionContactWorkspace rest;
  place_sections(all, standing.slices, standing.X_WJ[0].translation(), rest);

  double whole = 0;
  for (const SliceRange& range : ranges) whole += strip_volume(standing, range);
  const OverlapLimits limits{float(kMajorOverlap * whole), float(kLeastOverlap * whole)};
  const Known known = known_strips(anatomy, places.strips, before);
  const Images images = find_images(places, rest);
  std::vector<FoundPairs> found(kPoses);
  tbb::parallel_for(0, kPoses, [&](int i) {
    PosedAnatomy posed;
    SectionContactWorkspace sections;
    pose_anatomy(posing, skeleton, limit_pose(skeleton, limit_pose_of(i)), posed);
    place_sections(all, posed.slices, posed.X_WJ[0].translation(), sections);
    FoundPairs& pairs = found[i];
    pairs = find_pairs(all, places, sections, rest, limits, known.strips, images);
    if (before.table) {
      const FoundPairs& was = (*before.table->found)[std::size_t(i)];
      for (const auto kind : {&FoundPairs::major, &FoundPairs::all}) {
        const Pairs kept = known_pairs(was.*kind, known);
        (pairs.*kind).insert((pairs.*kind).end(), kept.begin(), kept.end());
      }
    }
    if (i >= kLimitPoses)
      // a later pass is enough: what hardly overlaps at the limits would cost every pose more than
      // it gives
      pairs.major.clear();
  });
  const auto table_of = [&](Pairs FoundPairs::*kind) {
    ContactCandidates table = all;
    add_groups(gather(found, kind, places), places, rest, table);
    block_growth(places, rest, table);
    remove_idle(table);
    list_pairs(table);
    table.total_volume = float(whole);
    return table;
  };
  return {table_of(&FoundPairs::major), table_of(&FoundPairs::all),
          std::make_shared<const std::vector<FoundPairs>>(std::move(found))};
}

}  // namespace ecorche::inline v1
