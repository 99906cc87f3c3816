// Actions that leave the document alone: back and forth in its history, files, pictures, figures.
// What they do is in session.h.
#pragma once

#include <string>

#include "app/edit/document/arguments.h"

namespace ecorche {

struct Undo {
  int steps = 1;
};
struct Redo {
  int steps = 1;
};
struct Save {
  std::string folder;  // empty: the project's own
};
struct ExportMuscle {
  std::string muscle, file;
};
struct WriteCharacter {
  std::string file;
};
struct Render {
  std::string file, camera, look_at, only, hide, layers = "skin,muscles,bones", size = "1280x720";
  std::string background = "white", section, labels, colour = "flesh";
};
// Shots one after another, as a film or numbered pictures.
struct Film {
  Render picture;
  std::string shots = "around 8s";
  double fps = 30;
};
struct WriteTemplate {
  std::string file;
};
struct WriteModel {
  std::string file, ground = "no", meshes = "yes";
};
struct ReportMuscle {
  std::string muscle, joint, angle = "flexion";
};

// Palpable points that leave their bracket.
struct CheckBones {};

struct WriteCurves {
  std::string file, muscle, joint, angle = "flexion";
};

void arguments(Arguments& a, Undo& x);
void arguments(Arguments& a, Redo& x);
void arguments(Arguments& a, Save& x);
void arguments(Arguments& a, ExportMuscle& x);
void arguments(Arguments& a, WriteCharacter& x);
void arguments(Arguments& a, Render& x);
void arguments(Arguments& a, Film& x);
void arguments(Arguments& a, WriteTemplate& x);
void arguments(Arguments& a, WriteModel& x);
void arguments(Arguments& a, ReportMuscle& x);
void arguments(Arguments& a, CheckBones& x);
void arguments(Arguments& a, WriteCurves& x);

}  // namespace ecorche
