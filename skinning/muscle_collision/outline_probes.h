// Probes: points of muscles' outlines that are near the skin at rest, and their projections onto it
// in a pose. Private to the room.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/compute/simd_lanes.h"
#include "anatomy/contact/contact_table.h"
#include "skinning/muscle_collision/project_to_skin.h"

namespace ecorche::inline v1 {

static_assert(kContactDirections == 8, "a section's directions fill eight lanes");

// Probes of one section: every second direction of its outline, a lane each.
struct SectionProbes {
  int section = 0;
  unsigned lanes = 0;  // directions with a probe, a bit each
  // of the skin, nearest at rest; of a lane without a probe: another's
  alignas(32) std::array<int, 8> vertex{};
  // m, that the point stays below the skin: less than its depth at rest
  alignas(32) std::array<float, 8> margin{};
};

// Sections that have a point near the skin at rest. `thickness`: #sections, see
// MuscleSurface::Part.
std::vector<SectionProbes> place_probes(std::span<const Ellipse> rest,
                                        std::span<const float> thickness, const TriMesh& skin,
                                        const SkinRings& rings);

// A section's points from its centre, m, in single precision.
Wide3 probe_radials(const Ellipse& section, float thickness);

// A probe against the skin. Without initial values, as whole arrays of it are made each
// frame.
struct ProbeProjection {
  int owner;  // index into the sections with probes
  std::size_t lane;
  int vertex;     // of the skin, nearest
  float height;   // m over the skin, negative below
  Float4 normal;  // outward, unit
};

// Probes of up to kSections sections that may be out in a pose, looked at eight by eight.
class ShallowProbes {
 public:
  static constexpr std::size_t kSections = 64;

  // Those that do not lie so deep below the vertex that they had at rest that they cannot be out.
  void add(int owner, const SectionProbes& probes, const Ellipse& section, float thickness,
           const PosedSkin& skin);

  // All that were added, in that order.
  std::span<const ProbeProjection> project(const SkinRings& rings, const PosedSkin& skin);

 private:
  std::size_t count_ = 0;
  std::array<float, 8 * kSections> x_, y_,
      z_;  // relative to the vertices: nothing is lost far from the origin
  std::array<ProbeProjection, 8 * kSections> projections_;
};

}  // namespace ecorche::inline v1
