// Contact of muscles in motion: sections that are pressed into one another by a pose part half-way,
// by their outlines. Private to make_posing_table and pose_anatomy.
//
// At rest muscles touch (see SliceOutline). In a pose, a point of one section's outline that has
// come into another muscle goes back along its ray to where both are equally deep: their levels (0
// on the line of centres, 1 on the outline) agree there, which both see alike. What a pair overlaps
// at rest it may overlap in every pose, so that the rest outlines stay to the last bit. What a
// section loses it regains towards where nothing presses, in no direction by more than an even
// outline would. Which sections can meet is found beforehand over poses at the joints' limits; a
// frame looks at those alone: at the pairs that share much when it poses the muscles, and, by the
// outlines that they have then, at all of them once the skin has moved and pressed them. All of it
// is a continuous function of the slices.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche {

// every second direction is looked along; those between follow
constexpr int kContactPoints = kOutlinePoints / 2;

using ContactSpokes = std::array<float, kContactPoints>;

// A section as contact sees it, in single precision about a common origin. Its measures of a point:
// along its width and thickness in radii, along its tangent in metres.
struct alignas(64) ContactSection {
  float center[4] = {0, 0, 0, 0};
  float width[4] = {1, 0, 0, 0}, thickness[4] = {0, 1, 0, 0};  // axes times their radii
  float to_measures[3][4] = {};  // row r: what 1 m along x, y, z adds to them
  float low[4] = {},
        high[4] = {};  // nothing meets it below -low or above high; the fourth: the third's inverse
};

// Harmonics 0 .. 4 of a section's outline: its factor as a smooth function of the direction.
// Cosines, then sines from the first on.
constexpr int kHarmonics = 4;
using OutlineWaves = std::array<float, 2 * kHarmonics + 1>;

// How far an outline reaches along its axes, in radii: +width, -width, +thickness, -thickness.
struct OutlineBox {
  float right = 1, left = 1, up = 1, down = 1;
};

// Beside a sheet's next strip a section is flat as far as it goes, and then leaves off: x counts
// from `free` on, so many times.
struct SheetSides {
  float high_free = 0, high_steep = 1, low_free = 0, low_steep = 1;
};

// What of a section is the same in every pose: what it asks others with, what it is asked by, and
// its reach, each a line of memory.
struct alignas(64) ContactShape {
  ContactSpokes along_width,
      along_thickness;  // its outline at rest in the directions that are looked along, in radii
  alignas(64) OutlineWaves waves{};
  SheetSides sides;
  alignas(64) OutlineBox box;  // of its outline
  OutlineBox room;             // of what it holds others off
};

// A section that contact looks at.
struct ContactMember {
  int section = 0;                   // flat
  float thickness = 1;               // of a sheet as it is drawn
  bool first = false, last = false;  // of its strip
};

// The members first .. last, all of one strip, that a member may meet.
struct ContactGroup {
  int own = 0;  // whose outline gives way
  int first = 0, last = 0;
  alignas(32) ContactSpokes at_rest{};  // press that is there at rest
};

struct ContactTable {
  std::vector<ContactMember> members;  // ascending by section
  std::vector<ContactShape> shapes;    // #members
  // #members: what lies beside it at rest that is in no group with it keeps it from growing there,
  // 0 .. 1
  std::vector<ContactSpokes> held;
  std::vector<ContactGroup> groups;  // ascending by own
  // #pairs, members that the groups may meet, in their order; and some more, so that eight may be
  // read from each
  std::vector<int> others;
  std::vector<int> group_of;     // #pairs
  std::vector<int> first_pairs;  // #members + 1, into pairs
  std::vector<int>
      blocks;          // first members of those whose pairs are looked at together, and the end
  int most_pairs = 0;  // of a block
  float whole = 1;     // volume of all muscles, m^3
  bool empty() const { return groups.empty(); }
};

struct ContactTables {
  ContactTable first;  // pairs that share much
  ContactTable again;  // all that share anything worth a look
};

struct ContactPair {
  int own = 0;  // member
  int pair = 0;
};

// A pair that is near enough to press: where its own section lies in the other's measures.
struct alignas(64) ContactMeeting {
  float center[4], width[4], thickness[4];  // center[3]: the level there
  int own = 0, other = 0, group = 0;
};

// What a section is told: shares of its outline's factors to give, and how little it is free to
// grow (0 .. 1).
struct ContactPress {
  alignas(32) ContactSpokes press{}, near{};
  int own = 0;
};

// What a thread works in.
struct ContactWork {
  std::vector<ContactPair> near;         // of a block, whose balls touch
  std::vector<ContactMeeting> meetings;  // of a block
  std::vector<ContactPress> presses;     // of a block
};

// Memory of a frame, kept from one to the next; nothing in it outlives one.
struct ContactMemory {
  std::vector<ContactSection> sections;     // #members
  std::vector<const ContactShape*> shapes;  // #members: the table's, or those of `pressed`
  std::vector<ContactShape> pressed;        // of outlines that are not those of rest
  // #members, center and radius of a ball about it and what it speaks for along the line
  std::vector<std::array<float, 4>> balls;
  std::vector<std::array<float, 4>>
      own_balls;  // #members, center and radius, negative, of a ball about its outline
  std::vector<ContactWork> work;  // a thread each
  std::vector<char> changed;      // #all sections
  std::vector<char> chosen;       // #members of the table that parts again: whether it is looked at
  // #members of the table that parts again: the volume that they were to give last, of that of all
  // muscles
  std::vector<float> deep;
};

// Which sections may meet in some pose. `still`: a table of the same anatomy without contact. The
// same at any number of threads.
ContactTables make_contact_tables(const Anatomy& anatomy, const PosingTable& still);

// Shape of a section. `sides`: bit 0, its sheet goes on at the low side of the width axis, bit 1,
// at the high side.
ContactShape contact_shape(const SliceOutline& outline, int sides);

// With the outlines of rest.
void look_at_sections(const ContactTable& table, std::span<const Ellipse> slices,
                      const Vec3& origin, ContactMemory& memory, Threads threads = Threads::one);

// Share of its outline's factors that member `own` gives way to the members first .. last, and how
// little it is free to grow (0 .. 1). False, and nothing set, where they are out of each other's
// reach.
bool press_of(const ContactMemory& memory, int own, int first, int last, ContactSpokes& press,
              ContactSpokes& near);

// Volume that a section gives by these shares of its outline's factors, m^3: about it, half-way to
// the next ones.
float given_volume(const ContactSection& section, const ContactShape& shape,
                   const ContactSpokes& press);

// An outline pressed by these shares of its factors, and grown again by what it has lost where it
// is not held (0 free .. 1). It keeps at least this share of its area.
constexpr float kLeastArea = 0.3f;
void press_outline(const ContactSpokes& press, const ContactSpokes& held, SliceOutline& outline,
                   float least = kLeastArea);

// Outlines of all sections that give way; memory.changed tells which did. `slices` have the
// outlines of rest. The same bytes at any number of threads.
void give_way_to_neighbours(const ContactTable& table, const Vec3& origin,
                            std::span<Ellipse> slices, ContactMemory& memory, Threads threads);

// Which sections look about them again: all, or those alone that were to give much volume the last
// time, in the same memory; what was nearly too little then gives way by a part.
enum class Parting { all, deep };

// The same for slices whose outlines, other than `at_rest`, have given way already. `held`
// (#sections): what else keeps them from growing, 0 .. 1.
void give_way_again(const ContactTable& table, const Vec3& origin,
                    std::span<const SliceOutline> at_rest, std::span<const ContactSpokes> held,
                    Parting parting, std::span<Ellipse> slices, ContactMemory& memory,
                    Threads threads);

}  // namespace ecorche
