// Actions on whole muscles: made, copied, removed, named, mirrored, and their figures.
//
// Each action is a value; arguments() describes what it is given by, apply() gives the document
// after it and throws InputError that names argument and value. Without _l or _r at a muscle's name
// both sides are meant; numbers are in the units of scripts.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/edit/document/arguments.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

struct Pick {
  std::string muscle;
};

struct NewMuscle {
  std::string name, from, to;
  std::string label, group = "own", layer = "superficial", shape = "fusiform";
  double volume = 0;                    // ml
  std::optional<double> female, fibre;  // ml; cm: three quarters of the belly where left out
  double width = 0, thickness = 0;      // mm in mid-belly; 0: round, by volume and length
  double belly_begin = 0.15, belly_end = 0.85;
};

struct CopyMuscle {
  std::string muscle, as;
};

struct RemoveMuscle {
  std::string muscle;
};

struct RenameMuscle {
  std::string muscle, as;
};

struct MirrorMuscle {
  std::string muscle, from = "left";
};

struct SetMuscle {
  std::string muscle;
  // ml, ml, cm, deg, N, share of the length, thickness at full effort over the relaxed
  std::optional<double> volume, female, fibre, pennation, force, tendon, tense;
};

struct DescribeMuscle {
  std::string muscle;
  std::string label, group, layer, shape, from, to, action, note, source;
};

struct ImportMuscle {
  std::string file;
};

void arguments(Arguments& a, Pick& x);
void arguments(Arguments& a, NewMuscle& x);
void arguments(Arguments& a, CopyMuscle& x);
void arguments(Arguments& a, RemoveMuscle& x);
void arguments(Arguments& a, RenameMuscle& x);
void arguments(Arguments& a, MirrorMuscle& x);
void arguments(Arguments& a, SetMuscle& x);
void arguments(Arguments& a, DescribeMuscle& x);
void arguments(Arguments& a, ImportMuscle& x);

Document apply(Workshop& workshop, const Document& document, const Pick& x);
Document apply(Workshop& workshop, const Document& document, const NewMuscle& x);
Document apply(Workshop& workshop, const Document& document, const CopyMuscle& x);
Document apply(Workshop& workshop, const Document& document, const RemoveMuscle& x);
Document apply(Workshop& workshop, const Document& document, const RenameMuscle& x);
Document apply(Workshop& workshop, const Document& document, const MirrorMuscle& x);
Document apply(Workshop& workshop, const Document& document, const SetMuscle& x);
Document apply(Workshop& workshop, const Document& document, const DescribeMuscle& x);
Document apply(Workshop& workshop, const Document& document, const ImportMuscle& x);

}  // namespace ecorche
