// What a person has chosen in the window: a value that the panels edit. The window owns nothing
// else of the model.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
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

struct ViewDocument;

// What is looked at; borrowed, outlives the window. Whoever serves the window changes it in
// `update`.
struct ViewSubject {
  const Anatomy* anatomy = nullptr;
  const SceneModel* model = nullptr;
  int frames = 1;  // at least 1
  double fps = 30;
  std::function<void(int frame, PosedAnatomy& posed, SkinFrame& skin)>
      pose{};  // an empty skin: as at rest
  // of the figure in all frames, its root's place on the ground taken away; empty: not known
  Eigen::AlignedBox3f bounds{};
  std::string name{};          // for people: the files
  std::uint64_t revision = 0;  // another one: something above is another
  std::vector<Slider> sliders{};
  // Called before each frame. Takes in what has been made since the last one, begins what the
  // document asks for, and says in it how far that is. wait: nothing is under way any more when it
  // returns.
  std::function<void(ViewDocument& document, bool wait)> update{};
  std::function<void(const std::filesystem::path& file)>
      open{};  // begins to open a character or a motion; says so by `update`
  std::function<void(const std::filesystem::path& file)>
      save{};  // begins to write the character as the sliders have it; likewise
};

struct ViewDocument {
  Look look{.skin = 0.15f};  // glass: all layers are seen
  MuscleColors muscle_colors = MuscleColors::flesh;
  bool ground = true;
  bool follow = true;  // the view's centre goes along with the root
  std::uint32_t selected = 0;
  std::vector<std::uint32_t> hidden{};  // parts, rising
  double time = 0;                      // s
  bool playing = false;
  double speed = 1;
  // centre and radius are chosen so that the whole figure is seen, until a person chooses others
  bool framed = true;
  Vec3f center{0, 0.9f, 0};  // of the view, relative to the root's horizontal place if it follows
  float radius = 1.05f;      // m, of the ball that fills the view
  float azimuth = 0.5f, elevation = 0.1f;      // rad
  bool parallel = false;                       // no perspective
  std::vector<std::optional<double>> asked{};  // #sliders
  std::vector<double> achieved{};              // #sliders, as the subject is now
  bool busy = false;                           // the subject is at work
  std::string state{};    // of the subject: what it is at, or what is wrong with what is shown
  std::string message{};  // what was done last, or why it could not be

  // Of the window itself.
  bool panels = true, help = false, closing = false;
  bool wants_picture = false;
  enum class Asking { nothing, open, save } asking = Asking::nothing;  // for a file's name
};

// Pixels of the window, top left first, that no panel covers.
struct ViewRoom {
  float x = 0, y = 0, width = 1, height = 1;
};

// The frame that a document's time falls on.
int frame_of(const ViewSubject& subject, const ViewDocument& document);

// One step of the clock: time runs on while it plays, and begins again at the end.
void advance(const ViewSubject& subject, double seconds, ViewDocument& document);
// To a frame; the clock stops.
void go_to(const ViewSubject& subject, int frame, ViewDocument& document);

// The ball that fills the room. Width and height: of the window.
Camera camera_of(const ViewDocument& document, const Vec3f& root, float width, float height,
                 const ViewRoom& room);
Appearance appearance_of(const ViewDocument& document);

// Centre and radius so that the whole figure is in the room; nothing where its bounds are not
// known.
void frame_figure(const ViewSubject& subject, const ViewRoom& room, ViewDocument& document);
// The same for points, relative to the root's horizontal place if the view follows; the view is
// then a person's own.
void frame_points(const std::vector<Vec3f>& points, ViewDocument& document);

// Moves of the mouse, in pixels of a view that is `height` pixels high.
void orbit(float dx, float dy, ViewDocument& document);
void pan(float dx, float dy, float height, ViewDocument& document);
void zoom(float clicks, ViewDocument& document);

bool is_hidden(const ViewDocument& document, std::uint32_t part);
void set_hidden(std::uint32_t part, bool hidden, ViewDocument& document);
// All but this one; shows all where it is alone already.
void isolate(const Anatomy& anatomy, std::uint32_t part, ViewDocument& document);

}  // namespace ecorche
