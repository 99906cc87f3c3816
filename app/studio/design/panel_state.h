// What the studio's panels remember between frames, and where the mouse is in a drag.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/edit/unsaved_sessions.h"
#include "app/studio/handles/bone_clicks.h"
#include "app/studio/handles/dropped_bone.h"
#include "app/studio/handles/handles.h"
#include "viewer/window/view_keys.h"

namespace ecorche {

struct HandleDrag {
  Handle handle;
  Vec3 moved = Vec3::Zero();  // so far, world, m
  bool begun = false;         // it has travelled
};

struct PanelState {
  std::vector<UnsavedSession> left;             // by sessions that were killed, to go on with
  std::vector<std::filesystem::path> projects;  // of other sessions, to go on with
  std::string find;                             // over the list of muscles
  int grouped = 0;                              // by kGroupings
  int peel = 0;                                 // layers of muscles that are taken off, 0 .. 3
  bool one_side = false;                        // drags move the handle's side alone
  bool mark_changed = false;                    // colour what differs from what was saved
  bool points = true, sections = true, wraps = true, joints = false;
  bool axes = false;           // ends of the chosen joint's axes, to drag
  bool joint_tab = false;      // its panel is open: the chosen joint's limits are seen
  bool script_tab = false;     // likewise, what was done
  bool asks_tour = false;      // it is to begin
  bool actions = false;        // the search box of actions is open
  bool actions_begin = false;  // it opened in this frame
  std::string typed;           // in it
  bool asks_folder = false;    // where to save to
  bool asks_to_close = false, closes = false;
  std::string folder;
  std::string joint;                 // that the panel of joints shows
  std::optional<double> effort_key;  // of the activation's curve that is dragged, s; -1: a new one
  bool effort_begun = false;         // it has travelled, or is new
  int curve_axis = 0;  // of the moment arm over the motion: flexion, abduction, rotation
  std::string group;   // of bones, that the panel of joints shows
  std::string body_file;
  std::string joint_name, joint_place, bone_name, bone_file;  // of what is being added
  std::optional<DroppedBone> dropped;                         // that waits for its joint
  bool shows_bones = false;                                   // they are to be scrolled to
  std::string asks_tab;                                       // that is to be opened
  bool asks_export = false;                                   // where to write what
  int export_kind = -1;  // that was chosen; -1: by the file's ending
  std::string export_file;
  std::optional<ViewAction> look;  // that a panel asks the view for
  std::vector<Handle> handles;     // of the last frame
  int hovered = -1;                // of them
  std::optional<HandleDrag> drag;
  Eigen::Vector2f pressed{0, 0};        // where it began, pixels
  std::optional<BoneClick> bone_click;  // what the next click on a bone is for
  bool bone_clicked = false;            // one of this frame was for it
};

}  // namespace ecorche
