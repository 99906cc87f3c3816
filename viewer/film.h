// An animation -> a film, or numbered pictures. Posing, drawing and encoding overlap.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "viewer/renderer.h"
#include "viewer/scene.h"
#include "viewer/video_pipe.h"

namespace ecorche {

struct FilmOptions {
  std::filesystem::path output;    // FILM.mp4, or DIR/%04d.png (any width; counted from 1)
  int width = 1280, height = 720;  // made even for an .mp4
  VideoOptions video{};
  RenderOptions render{};
};

struct FilmReport {
  int frames = 0, width = 0, height = 0;
  double seconds = 0;                                           // from the first pose to the finished file
  double pose_seconds = 0, draw_seconds = 0, write_seconds = 0;  // wall time of each of the three that overlap
  std::string driver;
};

// Called for frames 0, 1, 2, ... in order from a thread of its own; writes into a scene that it may have written to before.
using FrameSource = std::function<void(int frame, Scene& scene)>;

// Throws UsageError (size, name, no frames), LimitError (size), OutputError (folder, ffmpeg, disk). Numbered pictures that were
// finished before an error stay; a film appears whole or not at all. What `source` throws comes out here.
FilmReport make_film(const FilmOptions& options, int frames, const FrameSource& source, const std::function<void(int)>& progress = {});

// A camera that goes along with the athlete without shaking: the root's path, smoothed over time.
struct FollowCamera {
  double smoothing = 0.35;     // s, standard deviation of the filter over the path
  double lead = 0.25;          // m ahead of the athlete, along the smoothed motion
  float distance = 6.2f;       // m, level
  float height = 1.15f;        // m, of the eye
  float target_height = 0.98f;  // m, of the point looked at, while the root is at its first height
  float climb = 0.5f;          // share of the root's rise that the target follows
  float begin_azimuth = -1.05f, end_azimuth = -1.5707963f;  // rad, of the eye seen from the athlete; 0 front, -pi/2 its right side
  double turn_begin = 0, turn_end = 1;  // shares of the film in which it goes from one to the other
  float fov_y = 0.42f;         // rad
};

// Cameras for all frames. roots: the root joint's world positions.
std::vector<Camera> follow(std::span<const Vec3> roots, double fps, const FollowCamera& options = {});

}  // namespace ecorche
