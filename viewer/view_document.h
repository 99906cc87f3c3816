// What a person has chosen in the window: a value that the panels edit. The window owns nothing else of the model.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "viewer/scene.h"

namespace ecorche {

// A figure of the subject that a person may ask for.
struct Slider {
  std::string name, unit;
  double scale = 1;          // shown is value * scale
  double low = 0, high = 1;  // values
};

// What is looked at; borrowed, outlives the window.
struct ViewSubject {
  const Anatomy& anatomy;
  const SceneModel& model;
  int frames = 1;   // at least 1
  double fps = 30;
  std::function<void(int frame, PosedAnatomy& posed, SkinFrame& skin)> pose;  // an empty skin: as at rest
  std::vector<Slider> sliders{};
  // Changes the subject to what is asked of its sliders, and says what each of them reads then. Called before `pose`.
  std::function<void(const std::vector<std::optional<double>>& asked, std::vector<double>& achieved)> reshape{};
};

struct ViewDocument {
  Look look{.skin = 0.15f};  // glass: all layers are seen
  MuscleColors muscle_colors = MuscleColors::flesh;
  bool ground = true;
  bool follow = true;       // the view's centre goes along with the root
  std::uint32_t selected = 0;
  double time = 0;          // s
  bool playing = false;
  double speed = 1;
  Vec3f center{0, 0.9f, 0};  // of the view, relative to the root's horizontal place if it follows
  float radius = 1.05f;     // m, of the ball that fills the view
  float azimuth = 0.5f, elevation = 0.1f;  // rad
  std::vector<std::optional<double>> asked{};  // #sliders
  std::vector<double> achieved{};              // #sliders, as the subject is now
};

// The frame that a document's time falls on.
int frame_of(const ViewSubject& subject, const ViewDocument& document);

// One step of the clock: time runs on while it plays, and begins again at the end.
void advance(const ViewSubject& subject, double seconds, ViewDocument& document);

Camera camera_of(const ViewDocument& document, const Vec3f& root, float aspect);
Appearance appearance_of(const ViewDocument& document);

// Moves of the mouse, in pixels of a view that is `height` pixels high.
void orbit(float dx, float dy, ViewDocument& document);
void pan(float dx, float dy, int height, ViewDocument& document);
void zoom(float clicks, ViewDocument& document);

}  // namespace ecorche
