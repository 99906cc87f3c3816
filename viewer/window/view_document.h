// State of the window: a value that the panels edit, and the subject that is displayed.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "viewer/scene.h"
#include "viewer/section_plane.h"

namespace ecorche {

// A measure of the subject that the user can set.
struct Slider {
  std::string name, unit;
  double scale = 1;          // displayed: value * scale
  double low = 0, high = 1;  // values
};

struct ViewDocument;

// The displayed character; borrowed, outlives the window. Its owner changes it in `update`.
struct ViewSubject {
  const Anatomy* anatomy = nullptr;
  const SceneModel* model = nullptr;
  int frames = 1;  // at least 1
  double fps = 30;
  std::function<void(int frame, PosedAnatomy& posed, SkinFrame& skin)>
      pose{};  // an empty skin: as at rest
  // box around the figure in all frames, relative to the root's horizontal position; empty: unknown
  Eigen::AlignedBox3f bounds{};
  std::string name{};          // for people: the files
  std::uint64_t revision = 0;  // a new value: a member above has changed
  std::vector<Slider> sliders{};
  // Called before each frame. Takes over results of finished jobs, starts jobs that the document
  // asks for, and writes their state into it. wait: returns when no job is running.
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
  bool follow = true;  // the view's centre moves with the root
  std::uint32_t selected = 0;
  std::vector<std::uint32_t> hidden{};  // parts, rising
  double time = 0;                      // s
  bool playing = false;
  double speed = 1;
  std::optional<int> in{},
      out{};  // frames between which it plays; none: from the first, to the last
  // centre and radius show the whole figure, until the user changes them
  bool framed = true;
  Vec3f center{0, 0.9f,
               0};       // of the view, relative to the root's horizontal position if it follows
  float radius = 1.05f;  // m, of the ball that fills the view
  float azimuth = 0.5f, elevation = 0.1f;      // rad
  bool parallel = false;                       // no perspective
  SectionPlane section{};                      // what lies before it is cut away
  std::vector<std::optional<double>> asked{};  // #sliders
  std::vector<double> achieved{};              // #sliders, as the subject is now
  bool busy = false;                           // a job of the subject is running
  std::string state{};    // of the subject: its running job, or a fault of the displayed character
  std::string message{};  // result or error of the last command

  // Of the window itself.
  bool panels = true, help = false, closing = false;
  bool wants_picture = false;
  enum class Asking { nothing, open, save } asking = Asking::nothing;  // for a file's name
  std::uint64_t touched = 0;  // a new value: a tool has changed what it adds to the picture
  // Middles of what the last frame showed, pixels, by the names that recorded sessions have for it;
  // kept while one is played.
  bool recorded = false, names_places = false;  // the latter: a tool wants them
  std::map<std::string, Eigen::Vector2f> places{};
};

// Pixels of the window, top left first, that no panel covers.
struct ViewRoom {
  float x = 0, y = 0, width = 1, height = 1;
  bool alone = false;  // panels cover all that is beside it
};

// The frame at the document's time.
int frame_of(const ViewSubject& subject, const ViewDocument& document);

// Advances the time while the motion plays; it starts again at the end, or between its marks.
void advance(const ViewSubject& subject, double seconds, ViewDocument& document);
// Sets where it plays from (`in`) or to at the frame that is shown; takes it away where it is
// there.
void mark(const ViewSubject& subject, std::optional<int> ViewDocument::*which,
          ViewDocument& document);
// Goes to a frame and stops playing.
void go_to(const ViewSubject& subject, int frame, ViewDocument& document);

// Camera with the view's ball filling the room. width, height: of the window, pixels.
Camera camera_of(const ViewDocument& document, const Vec3f& root, float width, float height,
                 const ViewRoom& room);
Appearance appearance_of(const ViewDocument& document);

// Sets centre and radius so that the whole figure is in the room; no effect if its bounds are
// unknown.
void frame_figure(const ViewSubject& subject, const ViewRoom& room, ViewDocument& document);
// Sets centre and radius for points, relative to the root's horizontal position if the view
// follows, as the user's own choice.
void frame_points(const std::vector<Vec3f>& points, ViewDocument& document);

// Movements of the mouse, pixels, in a view of `height` pixels.
void orbit(float dx, float dy, ViewDocument& document);
void pan(float dx, float dy, float height, ViewDocument& document);
void zoom(float clicks, ViewDocument& document);

// The next of the planes none, transverse, frontal, sagittal, through the middle of the view.
void next_section(const ViewSubject& subject, ViewDocument& document);
// Where a plane of this kind can lie so that it meets the figure, lowest and highest.
std::pair<double, double> section_range(const ViewSubject& subject, SectionPlane::Kind kind);
// Moves it by millimetres; one across a bone by thousandths of the way.
void move_section(const ViewSubject& subject, double millimetres, ViewDocument& document);

bool is_hidden(const ViewDocument& document, std::uint32_t part);
void set_hidden(std::uint32_t part, bool hidden, ViewDocument& document);
// Hides all other parts; shows all if the part is the only visible one.
void isolate(const Anatomy& anatomy, std::uint32_t part, ViewDocument& document);

}  // namespace ecorche
