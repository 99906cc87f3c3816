// Actions on joints, and on the body that muscles are fitted into and how. Conventions as in
// muscle_actions.h; a joint without _l or _r is both.
#pragma once

#include <optional>
#include <string>

#include "app/edit/document/arguments.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

struct MoveJoint {
  std::string joint;
  Vec3 by = Vec3::Zero();  // mm
};
struct TurnAxes {
  std::string joint;
  double flexion = 0, abduction = 0, rotation = 0;  // deg
};
struct SetLimits {
  std::string joint, angle;
  double min = 0, max = 0;  // deg
};
struct ResetJoint {
  std::string joint;
};
struct SetBody {
  std::string file;
};
struct SetMeasure {
  std::string measure;
  std::string value;  // with a unit
};
struct FreeMeasure {
  std::string measure;
};
struct SetLayer {
  double factor = 1;
  std::string site;  // of data/fat.csv; empty: all of it
};
struct SetFit {
  std::string method;
  std::optional<double> alpha, clearance, rays, slices;
};

void arguments(Arguments& a, MoveJoint& x);
void arguments(Arguments& a, TurnAxes& x);
void arguments(Arguments& a, SetLimits& x);
void arguments(Arguments& a, ResetJoint& x);
void arguments(Arguments& a, SetBody& x);
void arguments(Arguments& a, SetMeasure& x);
void arguments(Arguments& a, FreeMeasure& x);
void arguments(Arguments& a, SetLayer& x);
void arguments(Arguments& a, SetFit& x);

Document apply(Workshop& workshop, const Document& document, const MoveJoint& x);
Document apply(Workshop& workshop, const Document& document, const TurnAxes& x);
Document apply(Workshop& workshop, const Document& document, const SetLimits& x);
Document apply(Workshop& workshop, const Document& document, const ResetJoint& x);
Document apply(Workshop& workshop, const Document& document, const SetBody& x);
Document apply(Workshop& workshop, const Document& document, const SetMeasure& x);
Document apply(Workshop& workshop, const Document& document, const FreeMeasure& x);
Document apply(Workshop& workshop, const Document& document, const SetLayer& x);
Document apply(Workshop& workshop, const Document& document, const SetFit& x);

}  // namespace ecorche
