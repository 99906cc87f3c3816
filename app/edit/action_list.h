// All that a hand can do, by name: the one list that window, scripts and tests share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/edit/attachment_actions.h"
#include "app/edit/body_actions.h"
#include "app/edit/document/arguments.h"
#include "app/edit/line_actions.h"
#include "app/edit/muscle_actions.h"
#include "app/edit/session_actions.h"
#include "app/edit/skeleton_actions.h"
#include "app/edit/trial_actions.h"

namespace ecorche {

using Action =
    std::variant<Pick, NewMuscle, CopyMuscle, RemoveMuscle, RenameMuscle, MirrorMuscle, SetMuscle,
                 DescribeMuscle, ImportMuscle, PaintEnd, ResampleMesh, MovePoint, AddPoint,
                 RemovePoint, SetSection, RemoveSection, ScaleSections, SetBelly, AddStrip,
                 RemoveStrip, NewWrap, SetWrap, RemoveWrap, UseWrap, LeaveWrap, MoveJoint, TurnAxes,
                 SetLimits, ResetJoint, SnapJoint, SetGroup, ResetGroup, AddJoint, RemoveJoint,
                 RestoreJoint, AddBone, SetBone, RemoveBone, SetBody, SetMeasure, FreeMeasure,
                 SetLayer, SetFit, SetPose, TurnJoint, Activate, Relax, PlayMotion, ShowMoment,
                 Compare, Undo, Redo, Save, ExportMuscle, WriteCharacter, WriteTemplate, WriteModel,
                 Render, Film, ReportMuscle, WriteCurves, CheckBones>;

struct ActionKind {
  const char *name, *group, *help;
  const char* example;  // its arguments in a script
  Action fresh;         // with nothing but defaults
};
std::span<const ActionKind> action_kinds();

// A line of a script: the action's name and its arguments. Nothing for a line of blanks and
// remarks. Throws InputError that names action, argument and value, with the most similar names.
std::optional<Action> read_action(std::string_view line);

// The line that read_action() reads as the same action.
std::string action_line(const Action& action);

// Its arguments, in order.
std::vector<ArgumentInfo> arguments_of(const ActionKind& kind);

// The list with units and help, for people and for programs.
std::string list_of_actions();
std::string list_of_actions_json();

// The document after an edit; nothing for actions that leave it alone (session_actions.h). Throws
// as the action's apply().
std::optional<Document> applied(Workshop& workshop, const Document& document, const Action& action);

}  // namespace ecorche
