// Contact between sections, the narrow phase: penetration of one section's outline in another,
// measured as a level (normalised radius: 0 on the neighbour's centre line, 1 on its outline).
// Private to contact.
//
// Along the 8 sampled directions of each cross-section we find how deep its outline lies inside a
// neighbouring section. Overlapping outlines are both cut back along the ray to where the two
// levels are equal, so that each gives up the same relative depth. Overlap that exists at rest is
// tolerated; the rest pose is unchanged bit for bit. Lost area is added back where nothing is in
// contact, in no direction by more than a circular outline would grow (press_outline.h). All of it
// is a continuous function of the slices.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/compute/threads.h"
#include "anatomy/contact/contact_table.h"

namespace ecorche::inline v1 {

// A section as contact sees it, in single precision about a common origin. Its coordinates of a
// point: along its width and thickness in radii, along its tangent in metres.
struct alignas(64) ContactSection {
  float center[4] = {0, 0, 0, 0};
  float width[4] = {1, 0, 0, 0}, thickness[4] = {0, 1, 0, 0};  // axes times their radii
  float to_local[3][4] = {};  // row r: what 1 m along x, y, z adds to the coordinates
  // bounds of what it meets, below -low or above high; the fourth: the third's inverse
  float low[4] = {}, high[4] = {};
};

// A pair whose bounding spheres touch, before its boxes are compared.
struct NearPair {
  int own = 0;  // member
  int pair = 0;
};

// A pair in contact: where the own section lies in the other's coordinates.
struct alignas(64) ContactPair {
  float center[4], width[4], thickness[4];  // center[3]: the level there
  int own = 0, other = 0, group = 0;
};

// Of one section, over all that it meets.
struct OutlineResponse {
  alignas(32) RadialSamples penetration{};  // relative to the outline's factor
  alignas(32) RadialSamples blocked{};      // of growth, 0 free .. 1
  int own = 0;
};

struct ContactThreadWorkspace {
  std::vector<NearPair> near;  // of a block
  std::vector<ContactPair> pairs;
  std::vector<OutlineResponse> responses;
};

// Memory of section contact. Its content has no meaning between calls.
struct SectionContactWorkspace {
  std::vector<ContactSection> sections;     // #members
  std::vector<const SectionShape*> shapes;  // #members: the table's, or those of `updated`
  std::vector<SectionShape> updated;        // of outlines that are not those of rest
  // #members, center and radius of a sphere about the region in which it blocks others
  std::vector<std::array<float, 4>> spheres;
  // #members, center and negative radius of a sphere about its outline
  std::vector<std::array<float, 4>> own_spheres;
  std::vector<ContactThreadWorkspace> threads;
  std::vector<char> changed;   // #all sections, set by the resolve functions
  std::vector<char> selected;  // #members, see select_deep_members()
};

// Depth of contact that a pass over all candidates has found, for the passes over deep contact that
// follow it in the same pose.
struct ContactState {
  // #ContactTable::all.members: volume by which a section's outline lay in others, over that of all
  // muscles
  std::vector<float> depth;
};

// Sections with their rest outlines, for find_penetration().
void place_sections(const ContactCandidates& candidates, std::span<const Ellipse> slices,
                    const Vec3& origin, SectionContactWorkspace& workspace,
                    Threads threads = Threads::one);

// Members among first .. last that may be in contact with `own`, ascending: those whose spheres
// touch. Precondition: placed sections.
void find_in_reach(const SectionContactWorkspace& workspace, int own, int first, int last,
                   std::vector<int>& reached);

// Penetration of member `own` in the members first .. last, and how far they block its growth.
// False, and nothing set, where they are out of each other's reach. Precondition: placed sections.
bool find_penetration(const SectionContactWorkspace& workspace, int own, int first, int last,
                      RadialSamples& penetration, RadialSamples& blocked);

// Volume of a section within this penetration, m^3: about it, half-way to the next ones.
float penetration_volume(const ContactSection& section, const SectionShape& shape,
                         const RadialSamples& penetration);

// Members that a pass over deep contact evaluates: those that were deep, and their candidates.
void select_deep_members(const ContactCandidates& candidates, const ContactState& state,
                         std::vector<char>& selected);

// The passes. Each cuts back the outlines of `slices` that penetrate others and sets
// workspace.changed. The same bytes at any number of threads. `origin`: near the body.

// For slices with the outlines of rest.
void resolve_rest_outlines(const ContactCandidates& candidates, const Vec3& origin,
                           std::span<Ellipse> slices, SectionContactWorkspace& workspace,
                           Threads threads);

// Slices whose outlines, other than `at_rest`, may have been cut back before.
struct LaterPass {
  const ContactCandidates& candidates;
  Vec3 origin;
  std::span<const SliceOutline> at_rest;   // #sections
  std::span<const RadialSamples> blocked;  // #sections, growth blocked from elsewhere, or none
};

// All candidates; sets `state`.
void resolve_all_outlines(const LaterPass& pass, std::span<Ellipse> slices, ContactState& state,
                          SectionContactWorkspace& workspace, Threads threads);

// Sections that were deep in the pass before; updates `state`. Precondition: the state is of these
// candidates.
void resolve_deep_outlines(const LaterPass& pass, std::span<Ellipse> slices, ContactState& state,
                           SectionContactWorkspace& workspace, Threads threads);

}  // namespace ecorche::inline v1
