// A character's motion as a film: layers, camera, ground. Shared by the verbs render and demo.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/actor.h"
#include "app/verb.h"
#include "viewer/film.h"

namespace ecorche {

// Seconds of the motion.
struct Span {
  double begin = 0, end = 0;
};

struct ActorFilm {
  std::filesystem::path output;      // FILM.mp4 or DIR/%04d.png
  int width = 1280, height = 720;
  double fps = 30;
  bool skin = true, muscles = true, bones = true;
  bool beside = false;               // the skin, and the écorché beside it; otherwise one figure with the layers above
  std::optional<Span> dissolve;      // the écorché's skin is whole before, and goes patch by patch from the feet meanwhile
  std::optional<Span> slow;          // goes by more slowly
  double slowness = 2.5;             // by this factor
  MuscleColors muscle_colors = MuscleColors::flesh;
  bool legend = true;                // what the muscles' colours mean, where muscles are seen
  std::string camera = "follow";     // "follow", or a named view or AZIMUTH,ELEVATION that travels with the figure
  Ground ground;                     // shown as it is
  Activations activations;           // of the muscles, over the motion's time
  bool dynamics = false;             // loose flesh lags and settles
};

FilmReport film_actor(const Actor& actor, const Motion& motion, const ActorFilm& film, const Common& common);

}  // namespace ecorche
