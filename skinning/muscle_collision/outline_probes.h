// Points of muscles' outlines that lie near the skin at rest, and where they are against it in a
// pose. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/compute/simd_lanes.h"
#include "anatomy/contact/muscle_contact.h"
#include "skinning/muscle_collision/skin_walk.h"

namespace ecorche {

static_assert(kContactPoints == 8, "a section's directions fill eight lanes");

// Of one section: every second direction of its outline, a lane each.
struct SectionProbes {
  int section = 0;
  unsigned lanes = 0;  // those that are looked along, a bit each
  // of the skin, nearest at rest; of a lane that is not looked along: another's
  alignas(32) std::array<int, 8> vertex{};
  // m, that the point stays below the skin: less than its depth at rest
  alignas(32) std::array<float, 8> margin{};
};

// Sections that have a point near the skin at rest. `thickness`: #sections, see
// MuscleSurface::Part.
std::vector<SectionProbes> place_probes(std::span<const Ellipse> rest,
                                        std::span<const float> thickness, const TriMesh& skin,
                                        const SkinRings& rings);

// A section's points from its centre, m.
Wide3 probe_spokes(const Ellipse& section, float thickness);

// How a probe lies against the skin. Without initial values, as whole arrays of it are made each
// frame.
struct ProbeLie {
  int owner;  // into the sections that have some
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
  std::span<const ProbeLie> lie(const SkinRings& rings, const PosedSkin& skin);

 private:
  std::size_t count_ = 0;
  std::array<float, 8 * kSections> x_, y_,
      z_;  // relative to the vertices: nothing is lost far from the origin
  std::array<ProbeLie, 8 * kSections> lies_;
};

}  // namespace ecorche
