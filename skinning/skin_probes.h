// Points of muscles' outlines that lie near the skin at rest, and where they are against it in a pose. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posed_contact.h"
#include "skinning/lanes.h"
#include "skinning/skin_lie.h"

namespace ecorche {

static_assert(kContactPoints == 8, "a section's directions fill eight lanes");

// Of one section: every second direction of its outline, a lane each.
struct SectionProbes {
  int section = 0;
  unsigned lanes = 0;                         // those that are looked along, a bit each
  alignas(32) std::array<int, 8> vertex{};    // of the skin, nearest at rest; of a lane that is not looked along: another's
  alignas(32) std::array<float, 8> margin{};  // m, that the point stays below the skin: less than its depth at rest
};

// Sections that have a point near the skin at rest. `thickness`: #sections, see MuscleSurface::Part.
std::vector<SectionProbes> place_probes(std::span<const Ellipse> rest, std::span<const float> thickness, const TriMesh& skin, const SkinRings& rings);

// A section's probes in a pose. Places are taken from the vertices near them: nothing is lost far from the origin.
class PosedProbes {
 public:
  PosedProbes(const SectionProbes& probes, const Ellipse& section, float thickness, const PosedSkin& skin);

  // Lanes that do not lie so deep below the vertex that they had at rest that they cannot be out.
  unsigned shallow() const;

  Lie lie(const SkinRings& rings, std::size_t lane) const;

  Vec3 spoke(std::size_t lane) const;  // from the centre, m

 private:
  const SectionProbes& probes_;
  const PosedSkin& skin_;
  Wide3 spokes_, points_;  // `points_`: relative to the vertices
};

}  // namespace ecorche
