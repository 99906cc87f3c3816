// Still pictures of an anatomy for the report page: sheets with titles, views and scales.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/files/actor.h"
#include "viewer/gl/renderer.h"
#include "viewer/scene.h"

namespace ecorche {

// One column of a sheet.
struct Stage {
  const Anatomy* anatomy = nullptr;  // borrowed
  Look look;
  std::string title;
};

// Stages of one body at rest from left to right, a row for each view ("front", "left", "back",
// ...), all to one scale, with a scale bar.
Image sheet_of_stages(Renderer& renderer, const TriMesh& skin, std::span<const Eyeball> eyes,
                      std::span<const Stage> stages, std::span<const std::string> views,
                      int cell_width, int cell_height);

// The muscles with the largest visible areas from the front and from behind, named at both sides
// of each figure.
Image plate_of_muscles(Renderer& renderer, const Anatomy& anatomy, const TriMesh& skin,
                       std::span<const Eyeball> eyes, int height);

// Moments of a motion side by side, seen from the figure's right (-X) to one scale, their times
// beneath: the skin, the écorché with muscles coloured by their lengths, or both, one above the
// other.
struct MomentsOptions {
  bool skin = true, flayed = true;
  int cell_width = 190, cell_height = 270;
};
Image sheet_of_moments(Renderer& renderer, const Actor& actor, std::span<const Eyeball> eyes,
                       const Motion& motion, std::span<const double> seconds,
                       const MomentsOptions& options = {});

}  // namespace ecorche
