#include "app/edit/session_actions.h"

namespace ecorche {
namespace {

constexpr int kMostSteps = 1000000;

// What pictures and films show, and how.
void looks(Arguments& a, Render& x) {
  a.text("only", "parts", x.only, Need::optional, "the only parts that are shown");
  a.text("hide", "parts", x.hide, Need::optional, "parts that are left away");
  a.text("layers", "layers", x.layers, Need::optional, "skin, muscles, bones");
  a.text("size", "size", x.size, Need::optional, "WIDTHxHEIGHT in pixels");
  a.text("background", "colour", x.background, Need::optional,
         "white, outdoors, transparent or #RRGGBB");
  a.text("section", "plane", x.section, Need::optional,
         "transverse:HEIGHT, frontal:BEFORE, sagittal:LEFT or JOINT-JOINT:SHARE");
  a.text("labels", "parts", x.labels, Need::optional,
         "names with lines to them, as on an atlas' plate: parts, or picked");
  a.choice("colour", x.colour, {"flesh", "length", "activation"}, Need::optional,
           "what muscles' colours say");
}

}  // namespace

void arguments(Arguments& a, Undo& x) {
  a.whole("steps", x.steps, 1, kMostSteps, Need::optional, "how many actions are taken back");
}

void arguments(Arguments& a, Redo& x) {
  a.whole("steps", x.steps, 1, kMostSteps, Need::optional, "how many are done again");
}

void arguments(Arguments& a, Save& x) {
  a.text("folder", "folder", x.folder, Need::optional, "of the project; the one it came from");
}

void arguments(Arguments& a, ExportMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::required, "that goes to another project");
  a.text("file", "file", x.file, Need::required, "text to write (.txt), for import_muscle");
}

void arguments(Arguments& a, WriteCharacter& x) {
  a.text("file", "file", x.file, Need::required, "character to write (.glb), fitted and bound");
}

void arguments(Arguments& a, Render& x) {
  a.text("file", "file", x.file, Need::required, "picture to write (.png)");
  a.text("camera", "view", x.camera, Need::optional, "front, left, ... or AZIMUTH,ELEVATION");
  a.text("look_at", "part", x.look_at, Need::optional, "bone, muscle, region or joint, closely");
  looks(a, x);
}

void arguments(Arguments& a, Film& x) {
  a.text("file", "file", x.picture.file, Need::required,
         "film (.mp4) or numbered pictures (DIR/%04d.png)");
  a.text("shots", "shots", x.shots, Need::optional,
         "CAMERA[@PART] [FROM-TO] [SECONDSs] with ; between: front 0-1.5; left@knee_l 1-2 4s; "
         "around 8s");
  a.number("fps", x.fps, {ArgumentUnit::none, 1, 240}, Need::optional, "pictures a second");
  looks(a, x.picture);
}

void arguments(Arguments& a, WriteTemplate& x) {
  a.text("file", "file", x.file, Need::required, "template to write (.glb)");
}

void arguments(Arguments& a, WriteModel& x) {
  a.text("file", "file", x.file, Need::required, "model to write: .osim or .xml (MuJoCo)");
  a.choice("ground", x.ground, {"no", "yes"}, Need::optional,
           "a floor, and balls under the feet that meet it");
  a.choice("meshes", x.meshes, {"yes", "no"}, Need::optional, "bones, in a folder beside it");
}

void arguments(Arguments& a, ReportMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "whose figures are printed");
  a.text("joint", "joint", x.joint, Need::optional, "about which it has a moment arm");
  a.choice("angle", x.angle, {"flexion", "abduction", "rotation"}, Need::optional,
           "the axis of it");
}

void arguments(Arguments&, CheckBones&) {}

void arguments(Arguments& a, WriteCurves& x) {
  a.text("file", "file", x.file, Need::required, "table to write (.csv), a row a frame");
  a.text("muscle", "muscle", x.muscle, Need::optional, "whose length and speed are written");
  a.text("joint", "joint", x.joint, Need::optional, "about which it has a moment arm");
  a.choice("angle", x.angle, {"flexion", "abduction", "rotation"}, Need::optional,
           "the axis of it");
}

}  // namespace ecorche
