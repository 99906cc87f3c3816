// An animation -> a film, or numbered pictures. Posing, drawing and encoding overlap.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "viewer/film/video_pipe.h"
#include "viewer/gl/renderer.h"
#include "viewer/scene.h"

namespace ecorche {

// Called with each finished picture, in order, before it is written: legends and titles.
using FrameFinish = std::function<void(int frame, Image& picture)>;

// Two scenes a frame: halves of the picture, or the second over the first, right of a line.
enum class Pairing { none, beside, wiped };

struct FilmOptions {
  std::filesystem::path output;  // FILM.mp4, DIR/%04d.png (any width), or STILL.png for one frame
  int first_number = 1, number_step = 1;  // of numbered pictures
  int width = 1280, height = 720;         // made even for an .mp4
  VideoOptions video{};
  RenderOptions render{};
  Pairing pairing = Pairing::none;
  float wipe = 0.5f;  // where that line is, of the picture's width
  FrameFinish finish{};
};

struct FilmReport {
  int frames = 0, width = 0, height = 0;
  double seconds = 0;  // from the first pose to the finished file
  double pose_seconds = 0, draw_seconds = 0,
         write_seconds = 0;  // wall time of each of the three that overlap
  std::string driver;
};

// Called for frames 0, 1, 2, ... in order from a thread of its own; writes into a scene that it may
// have written to before. Of a pairing it is called for the two scenes of frame f as 2 f, 2 f + 1.
using FrameSource = std::function<void(int frame, Scene& scene)>;

// Throws UsageError (size, name, no frames, several for a still), LimitError (size), OutputError
// (folder, ffmpeg, disk). Numbered pictures that were finished before an error stay; a film appears
// whole or not at all. Exceptions of `source` are rethrown.
FilmReport make_film(const FilmOptions& options, int frames, const FrameSource& source,
                     const std::function<void(int)>& progress = {});

}  // namespace ecorche
