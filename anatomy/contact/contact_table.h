// Candidates for contact between muscles: which sections may meet in some pose, and the constant
// shape of each. Made once a character (contact_candidates.h), read every frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Contact samples every second radial direction of an outline; those between follow.
constexpr int kContactDirections = kOutlinePoints / 2;

// One value a radial direction of a section.
using RadialSamples = std::array<float, kContactDirections>;

// Harmonics 0 .. 4 of a section's outline: its factor as a smooth function of the direction.
// Cosines, then sines from the first on.
constexpr int kHarmonics = 4;
using OutlineHarmonics = std::array<float, 2 * kHarmonics + 1>;

// Extent of an outline along its axes, in radii: +width, -width, +thickness, -thickness.
struct OutlineBox {
  float right = 1, left = 1, up = 1, down = 1;
};

// Beside the next strip of its sheet a section is flat up to the edge and then ends steeply: the
// width coordinate counts from `free` on, times `steep`.
struct SheetSides {
  float high_free = 0, high_steep = 1, low_free = 0, low_steep = 1;
};

// What of a section is the same in every pose, each group a line of memory: its sample points, by
// which it probes others; its level function, by which others probe it; its extents.
struct alignas(64) SectionShape {
  RadialSamples along_width, along_thickness;  // sample points on its outline, in radii
  alignas(64) OutlineHarmonics harmonics{};
  SheetSides sides;
  alignas(64) OutlineBox box;  // of its outline
  OutlineBox reach;            // of the region in which it blocks others
};

// A section that takes part in contact.
struct ContactMember {
  int section = 0;                   // flat
  float thickness = 1;               // factor of a sheet's thickness as it is drawn
  bool first = false, last = false;  // of its strip
};

// The members first .. last, all of one strip, that a member may meet.
struct ContactGroup {
  int own = 0;  // member whose outline is cut back
  int first = 0, last = 0;
  // penetration at rest, relative to the outline's factor, which every pose may keep
  alignas(32) RadialSamples at_rest{};
};

struct ContactCandidates {
  std::vector<ContactMember> members;  // ascending by section
  std::vector<SectionShape> shapes;    // #members, of the rest outlines
  // #members, 0 free .. 1: growth blocked by what lies beside the section at rest and is in no
  // group with it
  std::vector<RadialSamples> blocked;
  std::vector<ContactGroup> groups;  // ascending by own
  // #pairs, members of the groups in their order; padded, so that eight may be read from each
  std::vector<int> others;
  std::vector<int> group_of;     // #pairs
  std::vector<int> first_pairs;  // #members + 1, into pairs
  // first members of the blocks whose pairs are evaluated together, and the end
  std::vector<int> blocks;
  int most_pairs = 0;      // of a block
  float total_volume = 1;  // of all muscles, m^3
  bool empty() const { return groups.empty(); }
};

// Pairs of sections, own << 32 | other, that overlap in one of the poses at the joints' limits.
struct FoundPairs {
  std::vector<std::uint64_t> major, all;
};

struct ContactTable {
  ContactCandidates major;  // pairs with much overlap in some pose: resolved right after posing
  ContactCandidates all;    // pairs with any overlap worth resolving: for later passes
  std::shared_ptr<const std::vector<FoundPairs>> found;  // of each pose, that both are made of
};

}  // namespace ecorche::inline v1
