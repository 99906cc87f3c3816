// Actions on the skeleton: measures of bone groups, joints added and taken away, bones of one's
// own, centres where the skin's regressor has them. Conventions as in muscle_actions.h; a joint
// without _l or _r is both.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/edit/document/arguments.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

struct SetGroup {
  std::string group;
  std::array<std::optional<double>, kGroupMeasures> values{};  // as group_measures(); factors, mm
};
struct ResetGroup {
  std::string group;
};
struct AddJoint {
  std::string name, parent, at, to, child, paired;
};
struct RemoveJoint {
  std::string joint, muscles;
};
struct RestoreJoint {
  std::string joint;
};
struct SnapJoint {
  std::string joint;
};
struct AddBone {
  std::string name, joint, file, unit, up;
  Vec3 at = Vec3::Zero(), turn = Vec3::Zero();  // mm, deg
  double scale = 1;
};
struct SetBone {
  std::string bone;
  Vec3 by = Vec3::Zero(), turn = Vec3::Zero();  // more: mm, deg
  std::optional<double> scale;
};
struct RemoveBone {
  std::string bone;
};

void arguments(Arguments& a, SetGroup& x);
void arguments(Arguments& a, ResetGroup& x);
void arguments(Arguments& a, AddJoint& x);
void arguments(Arguments& a, RemoveJoint& x);
void arguments(Arguments& a, RestoreJoint& x);
void arguments(Arguments& a, SnapJoint& x);
void arguments(Arguments& a, AddBone& x);
void arguments(Arguments& a, SetBone& x);
void arguments(Arguments& a, RemoveBone& x);

Document apply(Workshop& workshop, const Document& document, const SetGroup& x);
Document apply(Workshop& workshop, const Document& document, const ResetGroup& x);
Document apply(Workshop& workshop, const Document& document, const AddJoint& x);
Document apply(Workshop& workshop, const Document& document, const RemoveJoint& x);
Document apply(Workshop& workshop, const Document& document, const RestoreJoint& x);
Document apply(Workshop& workshop, const Document& document, const SnapJoint& x);
Document apply(Workshop& workshop, const Document& document, const AddBone& x);
Document apply(Workshop& workshop, const Document& document, const SetBone& x);
Document apply(Workshop& workshop, const Document& document, const RemoveBone& x);

}  // namespace ecorche
