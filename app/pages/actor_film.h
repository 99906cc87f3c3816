// A character's motion as a film: layers, camera, ground. Shared by the verbs render and demo.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/common_options.h"
#include "app/files/actor.h"
#include "app/pages/film_camera.h"
#include "app/pages/film_range.h"
#include "app/pages/film_shots.h"
#include "skinning/motion/activation.h"
#include "viewer/film/film.h"
#include "viewer/section_plane.h"

namespace ecorche {

// Another figure in the same picture, with the same layers and looks. All are borrowed.
struct SecondFigure {
  const Actor* actor = nullptr;
  const Motion* motion = nullptr;
  Activations activations;
  std::vector<std::uint32_t> hidden;  // of its own parts, rising
  Pairing pairing = Pairing::beside;
  float wipe = 0.5f;
  std::string first_name, name;  // written over the two
};

struct ActorFilm {
  std::filesystem::path output;  // FILM.mp4, DIR/%04d.png, or STILL.png for one moment
  int width = 1280, height = 720;
  double fps = 30;
  std::optional<double> from, to;  // s of the motion; its beginning and end when left out
  // frames of the motion in place of from, to and fps: one a picture, which has its number
  std::optional<FrameRange> frames;
  std::vector<std::uint32_t> hidden;  // parts that are left away, rising
  bool skin = true, muscles = true, bones = true;
  // the skin, and the écorché beside it; otherwise one figure with the layers above
  bool beside = false;
  // span in which the skin over the écorché dissolves, patch by patch from the feet
  std::optional<Span> dissolve;
  std::optional<Span> slow;  // goes by more slowly
  double slowness = 2.5;     // by this factor
  MuscleColors muscle_colors = MuscleColors::flesh;
  std::vector<FilmShot> shots;        // in place of from, to, frames and view; empty: one shot
  std::vector<std::uint32_t> labels;  // parts with names and lines to them, rising
  std::optional<SecondFigure> second;
  bool legend = true;  // what the muscles' colours mean, where muscles are seen
  FilmView view;
  SectionPlane section;             // what lies before it is cut away
  Ground ground;                    // shown as it is
  std::optional<Vec3f> background;  // a sky when left out
  bool transparent = false;         // nothing around the figure; pictures only
  Activations activations;          // of the muscles, over the motion's time
  bool dynamics = false;            // loose flesh lags and settles
};

// Throws as make_film and film_cameras, UsageError for a span or frames that the motion lacks.
FilmReport film_actor(const Actor& actor, const Motion& motion, const ActorFilm& film,
                      const Common& common);

}  // namespace ecorche
