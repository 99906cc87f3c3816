// What lies around a muscle gives way to it at once, before the body is fitted: its neighbours and
// the skin go where the muscle's surface goes, less with the distance from it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "viewer/draw_list.h"

namespace ecorche {

// A section of a muscle as it was and as it is, in one pose, world.
struct MovedSection {
  Ellipse was, is;
};

// How far a place beside the muscle goes, m; at most 40 mm. Zero beyond 80 mm of all sections.
Vec3f given_way(const std::vector<MovedSection>& sections, const Vec3f& place);

// Meshes that give way, with their places as they were.
class GivingWay {
 public:
  // Moves vertices of a mesh that was drawn before: those of the last call go back first.
  void move(const std::vector<MovedSection>& sections, DrawMesh& mesh);

 private:
  std::vector<std::pair<std::uint32_t, Vec3f>> kept_;
  std::uint64_t revision_ = 0;  // that the mesh has where kept_ is of it
};

}  // namespace ecorche
