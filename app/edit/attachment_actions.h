// Actions on where muscles hold on: ends painted as areas of bone, and muscles that come as meshes.
// Conventions as in muscle_actions.h.
#pragma once

#include <optional>
#include <string>

#include "app/edit/document/arguments.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

struct PaintEnd {
  std::string muscle, end, places;
};

struct ResampleMesh {
  std::string name, file, from, to, unit, up, group;
  int points = 3, slices = 12;
};

void arguments(Arguments& a, PaintEnd& x);
void arguments(Arguments& a, ResampleMesh& x);

// Its strips' ends are spread over the places, along the way in which they reach farthest, in the
// order that the strips have; a single strip's end is as wide as they are.
Document apply(Workshop& workshop, const Document& document, const PaintEnd& x);
// The mesh as sections along an action line (anatomy/authoring/resample_mesh.h), its ends on the
// bones that are nearest. Throws as read_own_mesh and resample_muscle.
Document apply(Workshop& workshop, const Document& document, const ResampleMesh& x);

}  // namespace ecorche
