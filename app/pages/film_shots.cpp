#include "app/pages/film_shots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/files/text_scanner.h"
#include "viewer/camera.h"

namespace ecorche {
namespace {

constexpr double kLongestShot = 600;  // s of the film
constexpr double kStill = 3;          // s, of a shot that says neither span nor time

bool read_span(const std::string& word, Span& out) {
  const std::size_t dash = word.find('-', 1);
  return dash != std::string::npos && parse_number(word.substr(0, dash), out.begin) &&
         parse_number(word.substr(dash + 1), out.end) && out.begin >= 0 && out.end > out.begin;
}

bool read_seconds(const std::string& word, double& out) {
  return word.size() > 1 && word.back() == 's' &&
         parse_number(word.substr(0, word.size() - 1), out) && out > 0 && out <= kLongestShot;
}

FilmShot read_shot(const std::string& text, double moment, bool moves, const std::string& where) {
  std::istringstream words(text);
  std::string camera;
  words >> camera;
  FilmShot out;
  if (const std::size_t at = camera.find('@'); at != std::string::npos) {
    out.view.look_at = camera.substr(at + 1);
    camera.resize(at);
  }
  out.turns = camera == "around" ? 1 : 0;
  out.view.camera = camera == "around" ? (out.view.look_at.empty() ? "front" : "follow") : camera;
  try {
    if (out.view.camera != "follow") view_angles(out.view.camera);
  } catch (const UsageError&) {
    throw InputError(fmt::format("{}: '{}': '{}' is no camera; there are follow, around, {}", where,
                                 text, camera, view_names()));
  }
  bool plays = false;
  for (std::string word; words >> word;) {
    if (read_seconds(word, out.seconds)) continue;
    if (!read_span(word, out.span))
      throw InputError(fmt::format(
          "{}: '{}': '{}': expected FROM-TO of the motion in seconds, or SECONDSs of the film, at "
          "most {:g}s",
          where, text, word, kLongestShot));
    plays = true;
  }
  if (plays && !moves)
    throw InputError(
        fmt::format("{}: '{}': there is no motion; say how long it stands: 3s", where, text));
  if (!plays) out.span = {moment, moment};
  if (out.seconds == 0) out.seconds = plays ? out.span.end - out.span.begin : kStill;
  return out;
}

// Cameras that go around what they look at, by equal angles, once whole for each turn.
void go_around(double turns, std::span<Camera> cameras) {
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const double angle = 2 * std::numbers::pi * turns * double(k) / double(cameras.size());
    const float c = float(std::cos(angle)), s = float(std::sin(angle));
    Camera& camera = cameras[k];
    const Vec3f away = camera.eye - camera.target;
    camera.eye =
        camera.target + Vec3f(c * away.x() + s * away.z(), away.y(), c * away.z() - s * away.x());
  }
}

}  // namespace

std::vector<FilmShot> read_shots(const std::string& text, double moment, bool moves,
                                 const std::string& where) {
  std::vector<FilmShot> out;
  std::istringstream shots(text);
  for (std::string shot; std::getline(shots, shot, ';');)
    if (shot.find_first_not_of(' ') != std::string::npos)
      out.push_back(read_shot(shot.substr(shot.find_first_not_of(' ')), moment, moves, where));
  if (out.empty())
    throw InputError(
        fmt::format("{}: '{}': expected shots as `front 0-1.5; around 6s`", where, text));
  return out;
}

ShotFrames frames_of(const Assets& assets, const Actor& actor, const Motion& motion,
                     std::span<const FilmShot> shots, std::span<const Look> looks, double fps,
                     float aspect) {
  ShotFrames out;
  for (const FilmShot& shot : shots) {
    const int count = std::max(int(std::lround(shot.seconds * fps)), 1);
    std::vector<double> moments;
    const bool plays = shot.span.end > shot.span.begin;
    if (plays) span_within(shot.span.begin, shot.span.end, motion);
    for (int k = 0; k < count; ++k)
      moments.push_back(shot.span.begin +
                        (shot.span.end - shot.span.begin) * double(k) / double(count));
    // one that stands is looked at once
    const std::vector<double> seen = plays ? moments : std::vector<double>(1, moments.front());
    std::vector<Camera> cameras =
        film_cameras(assets, actor, motion, seen, looks, shot.view, fps, aspect);
    cameras.resize(moments.size(), cameras.back());
    if (shot.turns != 0) go_around(shot.turns, cameras);
    out.moments.insert(out.moments.end(), moments.begin(), moments.end());
    out.cameras.insert(out.cameras.end(), cameras.begin(), cameras.end());
  }
  return out;
}

}  // namespace ecorche
