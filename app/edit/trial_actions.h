// Actions on what a document is tried in: pose, activation, motion, and what it is compared with.
#pragma once

#include <optional>
#include <string>

#include "app/edit/document/arguments.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

struct SetPose {
  std::string pose;
};
struct TurnJoint {
  std::string joint;
  std::optional<double> flexion, abduction, rotation;  // deg
};
struct Activate {
  std::string muscles;
  double value = 0;
  std::optional<double> at, from;  // s of the motion: a key of the curve, and where it was
};
struct Relax {
  std::string muscles;
  std::optional<double> at;  // the key there alone
};
struct PlayMotion {
  std::string file;
};
struct ShowMoment {
  double seconds = 0;
};
struct Compare {
  std::string with, how = "beside";
  double share = 0.5;
};

void arguments(Arguments& a, SetPose& x);
void arguments(Arguments& a, TurnJoint& x);
void arguments(Arguments& a, Activate& x);
void arguments(Arguments& a, Relax& x);
void arguments(Arguments& a, PlayMotion& x);
void arguments(Arguments& a, ShowMoment& x);
void arguments(Arguments& a, Compare& x);

Document apply(Workshop& workshop, const Document& document, const SetPose& x);
Document apply(Workshop& workshop, const Document& document, const TurnJoint& x);
Document apply(Workshop& workshop, const Document& document, const Activate& x);
Document apply(Workshop& workshop, const Document& document, const Relax& x);
Document apply(Workshop& workshop, const Document& document, const PlayMotion& x);
Document apply(Workshop& workshop, const Document& document, const ShowMoment& x);
Document apply(Workshop& workshop, const Document& document, const Compare& x);

}  // namespace ecorche
