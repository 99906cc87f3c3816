// Shots of a film: cameras one after another, each over a span of the motion or around a moment.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/files/actor.h"
#include "app/pages/film_camera.h"
#include "app/pages/film_range.h"

namespace ecorche {

struct FilmShot {
  FilmView view;
  Span span;           // of the motion; begin = end: it stands
  double seconds = 0;  // of the film
  double turns = 0;    // that the camera goes around the figure
};

// Shots with ; between them, each `CAMERA[@PART] [FROM-TO] [SECONDS s]`: "front 0-1.5",
// "left@knee_l 1.5-3 6s" (slower), "around 8s" (once around, standing at `moment`), "40,10 2s".
// CAMERA: follow, around, a named view or AZIMUTH,ELEVATION. `moves`: there is a motion. Throws
// InputError that begins with `where`.
std::vector<FilmShot> read_shots(const std::string& text, double moment, bool moves,
                                 const std::string& where);

// Moments of the motion and cameras of all shots, `fps` a second, each cut to the next. Throws as
// film_cameras and span_within.
struct ShotFrames {
  std::vector<double> moments;
  std::vector<Camera> cameras;
};
ShotFrames frames_of(const Assets& assets, const Actor& actor, const Motion& motion,
                     std::span<const FilmShot> shots, std::span<const Look> looks, double fps,
                     float aspect);

}  // namespace ecorche
