// Cameras of a film's frames: following the figure, in a named view beside it, or close to one
// part.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "app/files/actor.h"
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

// Throws for the view what film_cameras() would: before a character is compiled, which takes
// seconds.
void check_view(const Assets& assets, const Character& character, const FilmView& view);

// A camera a moment (s of the motion, `fps` of them a second in the film). `looks`: the figures
// side by side. aspect: width / height. Throws UsageError for a view or a name that is not known
// (the nearest is named) and for numbers that are not above 0.
std::vector<Camera> film_cameras(const Assets& assets, const Actor& actor, const Motion& motion,
                                 std::span<const double> moments, std::span<const Look> looks,
                                 const FilmView& view, double fps, float aspect);

}  // namespace ecorche
