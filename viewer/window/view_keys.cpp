#include "viewer/window/view_keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/camera.h"

namespace ecorche {
namespace {

using A = ViewAction;

constexpr double kSectionStep = 5;  // mm

// As Blender has them where it has them.
constexpr ViewKey keys[] = {
    {A::play, "Space", "play and pause", GLFW_KEY_SPACE},
    {A::next_frame, "Right", "one frame on", GLFW_KEY_RIGHT},
    {A::previous_frame, "Left", "one frame back", GLFW_KEY_LEFT},
    {A::first_frame, "Shift + Left", "to the first frame", GLFW_KEY_LEFT, false, true},
    {A::last_frame, "Shift + Right", "to the last frame", GLFW_KEY_RIGHT, false, true},
    {A::mark_in, "[", "play from here on, and back to the first frame", GLFW_KEY_LEFT_BRACKET},
    {A::mark_out, "]", "play to here, and back to the last frame", GLFW_KEY_RIGHT_BRACKET},
    {A::front, "Numpad 1", "from the front", GLFW_KEY_KP_1},
    {A::front, "1", "from the front", GLFW_KEY_1},
    {A::back, "Ctrl + Numpad 1", "from behind", GLFW_KEY_KP_1, true},
    {A::back, "Ctrl + 1", "from behind", GLFW_KEY_1, true},
    {A::left, "Numpad 3", "from the body's left", GLFW_KEY_KP_3},
    {A::left, "3", "from the body's left", GLFW_KEY_3},
    {A::right, "Ctrl + Numpad 3", "from the body's right", GLFW_KEY_KP_3, true},
    {A::right, "Ctrl + 3", "from the body's right", GLFW_KEY_3, true},
    {A::top, "Numpad 7", "from above", GLFW_KEY_KP_7},
    {A::top, "7", "from above", GLFW_KEY_7},
    {A::bottom, "Ctrl + Numpad 7", "from below", GLFW_KEY_KP_7, true},
    {A::bottom, "Ctrl + 7", "from below", GLFW_KEY_7, true},
    {A::oblique, "Numpad 0", "from before and beside", GLFW_KEY_KP_0},
    {A::oblique, "0", "from before and beside", GLFW_KEY_0},
    {A::opposite, "Numpad 9", "from the opposite side", GLFW_KEY_KP_9},
    {A::opposite, "9", "from the opposite side", GLFW_KEY_9},
    {A::turn_left, "Numpad 4", "turn by 15 degrees", GLFW_KEY_KP_4},
    {A::turn_right, "Numpad 6", "turn by 15 degrees, the other way", GLFW_KEY_KP_6},
    {A::turn_up, "Numpad 8", "tilt by 15 degrees", GLFW_KEY_KP_8},
    {A::turn_down, "Numpad 2", "tilt by 15 degrees, the other way", GLFW_KEY_KP_2},
    {A::parallel, "Numpad 5", "perspective on and off", GLFW_KEY_KP_5},
    {A::parallel, "5", "perspective on and off", GLFW_KEY_5},
    {A::frame_all, "Home", "the whole figure", GLFW_KEY_HOME},
    {A::frame_all, "F", "the whole figure", GLFW_KEY_F},
    {A::frame_selected, "Numpad .", "the selected part closely", GLFW_KEY_KP_DECIMAL},
    {A::frame_selected, ".", "the selected part closely", GLFW_KEY_PERIOD},
    {A::hide, "H", "hide the selected part", GLFW_KEY_H},
    {A::isolate, "Shift + H", "hide all others, and back", GLFW_KEY_H, false, true},
    {A::isolate, "I", "hide all others, and back", GLFW_KEY_I},
    {A::show_all, "Alt + H", "show all parts", GLFW_KEY_H, false, false, true},
    {A::let_go, "Escape", "select nothing", GLFW_KEY_ESCAPE},
    {A::skin, "S", "skin: glass, whole, none", GLFW_KEY_S},
    {A::muscles, "M", "muscles on and off", GLFW_KEY_M},
    {A::bones, "B", "bones on and off", GLFW_KEY_B},
    {A::section, "X", "cut: across, from the front, from the side, not at all", GLFW_KEY_X},
    {A::section_on, "Up", "the cut 5 mm up, to the front or to the left", GLFW_KEY_UP},
    {A::section_back, "Down", "the cut 5 mm back", GLFW_KEY_DOWN},
    {A::open, "Ctrl + O", "open a character or a motion", GLFW_KEY_O, true},
    {A::save, "Ctrl + S", "write the character that the sliders made", GLFW_KEY_S, true},
    {A::picture, "F12", "take a picture, into the current folder", GLFW_KEY_F12},
    {A::panels, "N", "panels on and off", GLFW_KEY_N},
    {A::help, "F1", "this list", GLFW_KEY_F1},
    {A::quit, "Ctrl + Q", "close", GLFW_KEY_Q, true},
};

void look_from(std::string_view view, ViewDocument& document) {
  const ViewAngles angles = view_angles(view);
  document.azimuth = angles.azimuth;
  document.elevation = angles.elevation;
}

// Displayed points of a part, relative to the root's horizontal position if the view follows.
std::vector<Vec3f> points_of(const ViewSubject& subject, const PosedAnatomy& posed,
                             const ViewDocument& document) {
  const Part part = part_of(document.selected);
  std::vector<Vec3f> points;
  if (posed.X_WJ.empty()) return points;
  if (part.kind == Part::Kind::bone && part.index < int(subject.model->bones.size())) {
    const std::size_t joint = subject.model->bone_joints[part.index];
    const Transform moved =
        posed.X_WJ[joint] * Eigen::Translation3d(-subject.model->joint_rest[joint]);
    for (const Vec3f& p : subject.model->bones[part.index].positions)
      points.push_back((moved * p.cast<double>()).cast<float>());
  }
  for (const SliceRange& range : subject.model->strips)
    if (part.kind == Part::Kind::muscle && range.muscle == part.index)
      for (int k = range.begin; k < range.end && k < int(posed.slices.size()); ++k)
        points.push_back(posed.slices[k].center.cast<float>());
  const Vec3f root = posed.X_WJ.front().translation().cast<float>();
  if (document.follow)
    for (Vec3f& p : points) p -= Vec3f(root.x(), 0, root.z());
  return points;
}

void move_eye(ViewAction action, ViewDocument& document) {
  constexpr float pi = std::numbers::pi_v<float>, step = pi / 12;
  switch (action) {
    case A::front:
      return look_from("front", document);
    case A::back:
      return look_from("back", document);
    case A::left:
      return look_from("left", document);
    case A::right:
      return look_from("right", document);
    case A::top:
      return look_from("top", document);
    case A::bottom:
      return look_from("bottom", document);
    case A::oblique:
      return look_from("oblique", document);
    case A::opposite:
      document.azimuth = std::remainder(document.azimuth + pi, 2 * pi);
      document.elevation = -document.elevation;
      return;
    case A::turn_left:
      document.azimuth = std::remainder(document.azimuth - step, 2 * pi);
      return;
    case A::turn_right:
      document.azimuth = std::remainder(document.azimuth + step, 2 * pi);
      return;
    case A::turn_up:
      document.elevation = std::min(document.elevation + step, 0.5f * pi);
      return;
    case A::turn_down:
      document.elevation = std::max(document.elevation - step, -0.5f * pi);
      return;
    case A::parallel:
      document.parallel = !document.parallel;
      return;
    case A::frame_all:
      document.framed = true;
      return;
    default:
      return;
  }
}

void show_and_hide(ViewAction action, const ViewSubject& subject, ViewDocument& document) {
  const bool selected = part_of(document.selected).kind != Part::Kind::none;
  Look& look = document.look;
  switch (action) {
    case A::hide:
      if (selected) set_hidden(document.selected, true, document);
      document.selected = 0;
      return;
    case A::isolate:
      if (selected) isolate(*subject.anatomy, document.selected, document);
      return;
    case A::show_all:
      document.hidden.clear();
      return;
    case A::let_go:
      document.selected = 0;
      return;
    case A::skin:
      look.skin = look.skin >= 1 ? 0.0f : look.skin > 0 ? 1.0f : ViewDocument{}.look.skin;
      return;
    case A::muscles:
      look.muscles = look.muscles > 0 ? 0.0f : 1.0f;
      return;
    case A::section:
      return next_section(subject, document);
    case A::section_on:
      return move_section(subject, kSectionStep, document);
    case A::section_back:
      return move_section(subject, -kSectionStep, document);
    case A::bones:
      look.bones = look.bones > 0 ? 0.0f : 1.0f;
      return;
    default:
      return;
  }
}

}  // namespace

std::span<const ViewKey> view_keys() { return keys; }

std::optional<ViewAction> action_of(int key, bool ctrl, bool shift, bool alt) {
  for (const ViewKey& each : keys)
    if (each.key == key && each.ctrl == ctrl && each.shift == shift && each.alt == alt)
      return each.action;
  return std::nullopt;
}

void act(ViewAction action, const ViewSubject& subject, const PosedAnatomy& posed,
         ViewDocument& document) {
  const int frame = frame_of(subject, document);
  switch (action) {
    case A::play:
      document.playing = !document.playing && subject.frames > 1;
      return;
    case A::next_frame:
      return go_to(subject, frame + 1, document);
    case A::previous_frame:
      return go_to(subject, frame - 1, document);
    case A::first_frame:
      return go_to(subject, 0, document);
    case A::last_frame:
      return go_to(subject, subject.frames - 1, document);
    case A::mark_in:
      return mark(subject, &ViewDocument::in, document);
    case A::mark_out:
      return mark(subject, &ViewDocument::out, document);
    case A::frame_selected:
      return frame_points(points_of(subject, posed, document), document);
    case A::open:
      document.asking = ViewDocument::Asking::open;
      return;
    case A::save:
      document.asking = ViewDocument::Asking::save;
      return;
    case A::picture:
      document.wants_picture = true;
      return;
    case A::panels:
      document.panels = !document.panels;
      return;
    case A::help:
      document.help = !document.help;
      return;
    case A::quit:
      document.closing = true;
      return;
    default:
      break;
  }
  move_eye(action, document);
  show_and_hide(action, subject, document);
}

}  // namespace ecorche
