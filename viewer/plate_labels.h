// Names beside a picture, as on the plate of an atlas: a line leads from each to its part.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "viewer/draw_list.h"
#include "viewer/image.h"

namespace ecorche {

// Where a part is seen.
struct PartPlace {
  std::uint32_t part = 0;
  float x = 0, y = 0;  // shares of the picture's width and height, from the upper left
  int pixels = 0;      // that it covers of a picture of 480 columns
};

// The point of each part that lies farthest from the edge of what is seen of it; parts that are
// hidden behind others are left out. Glass hides nothing. `parts` rise; so do those returned.
std::vector<PartPlace> seen_places(const DrawList& list, float aspect,
                                   std::span<const std::uint32_t> parts);

// A name on the plate.
struct PlateLabel {
  std::string text;
  float x = 0, y = 0;  // of what it names, as PartPlace
};

// One label a name: of the two sides of a part the one that covers more.
std::vector<PlateLabel> plate_labels(const Anatomy& anatomy, std::span<const PartPlace> places);

// Writes names in a column at either edge, none over another, with lines to their parts.
void draw_labels(Image& picture, std::vector<PlateLabel> labels);

}  // namespace ecorche
