// Actions on a muscle's strips: points of the action line, sections, bellies, and the wraps that
// lines slide over. Conventions as in muscle_actions.h; strips and points count from 1.
#pragma once

#include <optional>
#include <string>

#include "app/edit/document/arguments.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

struct MovePoint {
  std::string muscle, to, snap;
  int strip = 1, point = 1;
  Vec3 by = Vec3::Zero();  // mm
};
struct AddPoint {
  std::string muscle, at;
  int strip = 1, after = 0;  // 0: where the line becomes least longer
};
struct RemovePoint {
  std::string muscle;
  int strip = 1, point = 2;
};
struct SetSection {
  std::string muscle;
  int strip = 1;
  double at = 0.5;
  std::optional<double> width, thickness, roll;  // mm, mm, deg
};
struct RemoveSection {
  std::string muscle;
  int strip = 1;
  double at = 0.5;
};
struct ScaleSections {
  std::string muscle;
  int strip = 0;  // 0: all
  double width = 1, thickness = 1, roll = 0;
};
struct SetBelly {
  std::string muscle;
  int strip = 1;
  std::optional<double> begin, end;
};
struct AddStrip {
  std::string muscle;
  int like = 1;
  Vec3 by = Vec3(5, 0, 0);  // mm
};
struct RemoveStrip {
  std::string muscle;
  int strip = 1;
};
struct NewWrap {
  std::string name, kind = "sphere", at;
  double radius = 10, half = 30;  // mm
  Vec3 axis = Vec3::UnitY();      // of a cylinder
  Vec3 axes = Vec3(10, 10, 10);   // of an ellipsoid, mm
};
struct SetWrap {
  std::string wrap, at;
  Vec3 by = Vec3::Zero();  // mm
  std::optional<double> radius, half;
  Vec3 axis = Vec3::Zero(), axes = Vec3::Zero();  // zero: as they are
};
struct RemoveWrap {
  std::string wrap;
};
struct UseWrap {
  std::string muscle, wrap;
  int strip = 1;
  double radius = 0;  // mm; 0: the wrap's own
};
struct LeaveWrap {
  std::string muscle, wrap;
  int strip = 1;
};

void arguments(Arguments& a, MovePoint& x);
void arguments(Arguments& a, AddPoint& x);
void arguments(Arguments& a, RemovePoint& x);
void arguments(Arguments& a, SetSection& x);
void arguments(Arguments& a, RemoveSection& x);
void arguments(Arguments& a, ScaleSections& x);
void arguments(Arguments& a, SetBelly& x);
void arguments(Arguments& a, AddStrip& x);
void arguments(Arguments& a, RemoveStrip& x);
void arguments(Arguments& a, NewWrap& x);
void arguments(Arguments& a, SetWrap& x);
void arguments(Arguments& a, RemoveWrap& x);
void arguments(Arguments& a, UseWrap& x);
void arguments(Arguments& a, LeaveWrap& x);

Document apply(Workshop& workshop, const Document& document, const MovePoint& x);
Document apply(Workshop& workshop, const Document& document, const AddPoint& x);
Document apply(Workshop& workshop, const Document& document, const RemovePoint& x);
Document apply(Workshop& workshop, const Document& document, const SetSection& x);
Document apply(Workshop& workshop, const Document& document, const RemoveSection& x);
Document apply(Workshop& workshop, const Document& document, const ScaleSections& x);
Document apply(Workshop& workshop, const Document& document, const SetBelly& x);
Document apply(Workshop& workshop, const Document& document, const AddStrip& x);
Document apply(Workshop& workshop, const Document& document, const RemoveStrip& x);
Document apply(Workshop& workshop, const Document& document, const NewWrap& x);
Document apply(Workshop& workshop, const Document& document, const SetWrap& x);
Document apply(Workshop& workshop, const Document& document, const RemoveWrap& x);
Document apply(Workshop& workshop, const Document& document, const UseWrap& x);
Document apply(Workshop& workshop, const Document& document, const LeaveWrap& x);

}  // namespace ecorche
