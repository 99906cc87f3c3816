// Contact of muscles in motion: sections that are pressed into one another by a pose part half-way, by their outlines. Private to
// make_posing_table and pose_anatomy.
//
// At rest muscles touch (see SliceOutline). In a pose, a point of one section's outline that has come into another muscle goes back
// along its ray to where both are equally deep: their levels (0 on the line of centres, 1 on the outline) agree there, which both see
// alike. What a pair overlaps at rest it may overlap in every pose, so that the rest outlines stay to the last bit.
// What a section loses it regains towards where nothing presses. Which sections can meet is found beforehand over poses spread through the
// joints' ranges; a frame looks at those alone. All of it is a continuous function of the slices.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/pose_anatomy.h"

namespace ecorche {

constexpr int kContactPoints = kOutlinePoints / 2;  // every second direction is looked along; those between follow

using ContactSpokes = std::array<float, kContactPoints>;

// A section as contact sees it, in single precision about a common origin.
struct ContactSection {
  float center[3] = {0, 0, 0}, wide = 0;         // of a ball about its outline
  float width[3] = {1, 0, 0}, per_width2 = 0;    // axis times its radius; the radius' inverse square
  float thickness[3] = {0, 1, 0}, per_thickness2 = 0;
  float tangent[3] = {0, 0, 1}, reach = 0;       // of a ball about it and what it speaks for along the line
  float per_before = 0, per_after = 0;           // inverse distances to its neighbours on the line
};

// Harmonics 0 .. 4 of a section's outline: its factor as a smooth function of the direction. Cosines, then sines from the first on.
constexpr int kHarmonics = 4;
using OutlineWaves = std::array<float, 2 * kHarmonics + 1>;

// How far an outline reaches along its axes, in radii: +width, -width, +thickness, -thickness.
struct OutlineBox {
  float right = 1, left = 1, up = 1, down = 1;
};

// The sections first .. last of one strip that a section may meet.
struct ContactGroup {
  int own = 0;          // whose outline gives way
  int first = 0, last = 0;
  ContactSpokes at_rest{};  // press that is there at rest
};

struct ContactStrip {
  int begin = 0, end = 0;     // slices
  float thickness = 1;        // of a sheet as it is drawn
};

struct ContactTable {
  std::vector<ContactStrip> strips;
  std::vector<OutlineWaves> waves;    // #sections
  std::vector<char> sides;            // #sections, bit 0: the sheet goes on at the low side of the width axis, bit 1: at the high side
  std::vector<ContactSpokes> spokes;  // #sections, factors at rest
  std::vector<OutlineBox> boxes;      // #sections
  std::vector<ContactGroup> groups;   // by own
  std::vector<int> owners;            // sections that have groups
  std::vector<int> owner_begin;       // #owners + 1 into groups
  bool empty() const { return groups.empty(); }
};

// Memory of a frame, kept from one to the next; nothing in it outlives one.
struct ContactMemory {
  std::vector<ContactSection> sections;
  std::vector<std::array<float, 4>> balls;  // #sections, center and reach
  std::vector<char> changed;  // #sections
};

// Which sections may meet in some pose. `still`: a table of the same anatomy without contact. The same at any number of threads.
ContactTable make_contact_table(const Anatomy& anatomy, const PosingTable& still);

OutlineWaves outline_waves(const SliceOutline& outline);
OutlineBox outline_box(const SliceOutline& outline);

void look_at_sections(const ContactTable& table, std::span<const Ellipse> slices, const Vec3& origin, ContactMemory& memory);

// Share of its outline's factors that section `own` gives way to the group's sections, and how little it is free to grow (0 .. 1). False, and
// nothing set, where they are out of each other's reach.
bool press_of(const ContactTable& table, const ContactMemory& memory, const ContactGroup& group, ContactSpokes& press, ContactSpokes& near);

// An outline pressed by these shares of its factors, and grown again by what it has lost where it is not held (0 free .. 1).
void press_outline(const ContactSpokes& press, const ContactSpokes& held, SliceOutline& outline);

// Outlines of all sections that give way; memory.changed tells which did.
void give_way_to_neighbours(const ContactTable& table, const Vec3& origin, std::span<Ellipse> slices, ContactMemory& memory);

}  // namespace ecorche
