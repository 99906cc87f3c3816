// Self-contact of the skin: parts that meet are pressed flat against each other instead of passing
// through. Private to the library.
//
// A vertex is in contact when a point a little before it is inside another part: a ray from there
// along its normal first meets the back of a triangle. It is then pushed half of the way to where
// that point is free; the other part's vertices go the other half. The gap left between parts keeps
// their edges out of each other, not only their vertices. The ring about pushed vertices follows a
// little, so that the dent has no edge. Vertices that lie inside something at rest (lips, eyelids,
// the mouth) are left alone.
#pragma once

#include <span>
#include <vector>

#include "anatomy/queries/refitted_bvh.h"
#include "anatomy/types.h"
#include "skinning/relaxed_skin.h"
#include "skinning/settle/contact_patches.h"
#include "skinning/settle/membrane.h"

namespace ecorche::inline v1 {

struct SelfContactParameters {
  float ray_length = 0.5f;  // m, of the rays that tell inside from outside
  float ray_start = 2e-4f;  // m, before the vertex, at rest
  float gap = 2e-3f;        // m, left between parts. Smaller: edges pass through each other.
  // Bound of a vertex's push: a fraction of the tissue beneath it, and m more. Larger: thin parts
  // are pushed through.
  double push_of_tissue = 1, least_push = 1e-3;
  // Bound of a vertex's push as a fraction of the part's thickness, the least within two rings:
  // the tip of a toe would be pressed flat.
  float push_of_thickness = 0.3f;
  float thickest = 0.1f;  // m, as which thicker parts count
  // Depth to which rays look behind a vertex, as a fraction of the bound of its push. Deeper, the
  // far side of a thin part would be met.
  float look_behind = 1;
  int rounds = 2;
  // Fraction of its neighbours' mean push that a vertex about pushed ones takes, and the rings.
  float spread_fraction = 0.6f;
  int spread_rings = 2;
  // Push (m) beyond which skin does not swell and holds muscles that lie beneath it.
  float pressed = 1e-3f;
  // Freedom of skin in contact to be lifted over muscles: it rises by less than half, and muscles
  // are pushed in for the rest.
  float liftable_in_contact = 0.1f;
};

struct SelfContact {
  // #V m, bound of each vertex's push; 0 for those that are left alone
  std::vector<float> max_push;
  std::vector<float> gap;  // #V m, left before each; less than the free space before it at rest
  std::vector<int> about_first, about;  // #V + 1 into the triangles about each vertex, by 3 corners
  ContactPatches patches;
  RefittedBvh tree;
};

// `positions`: #V x 4, rest; `triangles`: 3 indices each; `tissue`: between skin and bone, m, #V.
SelfContact make_self_contact(const Membrane& rings, std::span<const float> positions,
                              std::span<const int> triangles, std::span<const double> tissue);

// Pushes skin.positions apart by rounds; whether any has moved: workspace.before then has all as
// they were. skin.normals become those of the separated skin. Allocates only at first use; same
// input, same bytes at any number of threads.
bool separate_skin(const Membrane& rings, const SelfContact& contact,
                   std::span<const int> triangles, RelaxedSkin& skin,
                   SelfContactWorkspace& workspace);

// Fills skin.liftable: as open as the skin is, and little where it is in contact with another part,
// whose tissue holds it down.
void find_liftable(const SelfContact& contact, RelaxedSkin& skin, SelfContactWorkspace& workspace);

// separate_skin(); vertices that it has moved are marked in skin.pressed and less open to swelling.
bool resolve_self_contact(const Membrane& rings, const SelfContact& contact,
                          std::span<const int> triangles, RelaxedSkin& skin,
                          SelfContactWorkspace& workspace);

}  // namespace ecorche::inline v1
