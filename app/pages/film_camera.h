// Where the eye of a film is in each of its frames: it follows the figure, stands in a named place
// beside it, or looks at one part closely.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "skinning/character/character_model.h"
#include "viewer/draw_list.h"
#include "viewer/scene.h"

namespace ecorche {

struct FilmView {
  std::string camera = "follow";  // or a named view or AZIMUTH,ELEVATION that travels along; of a
                                  // part "follow" is from where it is seen best
  // a bone, muscle, region of muscles, joint, or landmark of the skin; empty: the whole figure
  std::string look_at;
  double zoom = 1;  // times as large, by a narrower lens
  std::optional<double>
      distance;  // m, from the eye to what is looked at; as far as needed when left out
};

// A camera a moment (s of the motion, `fps` of them a second in the film). `looks`: the figures
// side by side. aspect: width / height. Throws UsageError for a view or a name that is not known
// (the nearest is named) and for numbers that are not above 0.
std::vector<Camera> film_cameras(const Actor& actor, const Motion& motion,
                                 std::span<const double> moments, std::span<const Look> looks,
                                 const FilmView& view, double fps, float aspect);

}  // namespace ecorche
