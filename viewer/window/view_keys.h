// Commands of the window's keys. docs/viewer.md has the same table.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "anatomy/posing/pose_anatomy.h"
#include "viewer/window/view_document.h"

namespace ecorche {

enum class ViewAction {
  play,
  next_frame,
  previous_frame,
  first_frame,
  last_frame,
  mark_in,
  mark_out,
  frame_all,
  frame_selected,
  front,
  back,
  left,
  right,
  top,
  bottom,
  oblique,
  opposite,
  parallel,
  turn_left,
  turn_right,
  turn_up,
  turn_down,
  hide,
  isolate,
  show_all,
  let_go,
  skin,
  muscles,
  bones,
  section,
  section_on,
  section_back,
  open,
  save,
  picture,
  panels,
  help,
  quit
};

struct ViewKey {
  ViewAction action = ViewAction::play;
  std::string_view name;    // "Ctrl + Numpad 1"
  std::string_view effect;  // what it does, for people
  int key = 0;              // GLFW's number
  bool ctrl = false, shift = false, alt = false;
};

// In the order in which help shows them.
std::span<const ViewKey> view_keys();

// The command of a pressed key.
std::optional<ViewAction> action_of(int key, bool ctrl, bool shift, bool alt);

// Carries the command out. `posed`: the displayed pose.
void act(ViewAction action, const ViewSubject& subject, const PosedAnatomy& posed,
         ViewDocument& document);

}  // namespace ecorche
