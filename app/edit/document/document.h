// What the studio changes, as one value: the muscle table, joints, bones, body, fit and trial.
//
// A copy shares all that is not changed, so that a session keeps every state it has been in.
// Muscles are kept as their text in data/muscles says them, rounded as it is: a document that is
// saved and read again is the same.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy/authoring/muscle_table.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/placement/scale_groups.h"

namespace ecorche {

template <class T>
using Shared = std::shared_ptr<const T>;

struct EditedMuscle {
  TableMuscle left;
  // where the sides differ, as seen in a mirror; none: the left one's mirror image
  std::optional<TableMuscle> right;
};

// The angles of a joint, in the order of its axes.
inline constexpr std::array<const char*, 3> kAngleNames{"flexion", "abduction", "rotation"};
int angle_index(std::string_view name);  // precondition: one of them

// What was changed of a joint, in the units of scripts; both sides under the name without side, one
// under its own.
struct EditedJoint {
  Vec3 moved = Vec3::Zero();   // of its centre: left (of a right joint, right), up, front, mm
  Vec3 turned = Vec3::Zero();  // of its axes, about flexion, abduction and rotation in turn, deg
  std::optional<std::pair<double, double>> limits[3];  // flexion, abduction, rotation, deg
};

// What a hand has added to the skeleton, taken from it, or scaled. Places are of the left side.
struct OwnJoint {
  std::string name;     // without side, or with the only side that has it
  std::string parent;   // likewise
  std::string child;    // of the parent, between which and it the joint stands; may be empty
  bool paired = false;  // _l and _r
  TablePoint at;        // its centre
  std::optional<TablePoint> to{};  // where its long axis points to; none: away from its parent
};

struct OwnBone {
  std::string name, joint;   // as OwnJoint::name; on both sides where the joint is
  Shared<TriMesh> mesh;      // as in its file, in m and +Y up
  std::string file;          // for people
  Vec3 at = Vec3::Zero();    // of the mesh's origin, from the joint's centre: left, up, front, mm
  Vec3 turn = Vec3::Zero();  // about left, up, front in turn, deg
  double scale = 1;
};

struct EditedSkeleton {
  // by group of bones: its measures, in the order of group_measures(), factors and mm
  std::map<std::string, std::array<double, kGroupMeasures>> groups;
  std::vector<OwnJoint> joints;  // parents first
  std::vector<OwnBone> bones;
  std::set<std::string>
      removed;  // built-in joints, as EditedJoint's names; with what hangs on them
};

struct EditedBody {
  std::filesystem::path file;             // empty: the template's own
  std::map<std::string, double> targets;  // by measure, m or kg; beside those of the file's body
  double layer = 1;                       // times the fat that the build lets expect
  std::map<std::string, double> layer_sites;  // on top of it, around sites of data/fat.csv
};

struct FitSettings {
  DilateMethod method = DilateMethod::ecorche;
  int rays = DilateOptions{}.rays;
  double alpha = DilateOptions{}.alpha;
  double clearance = 1e3 * DilateOptions{}.clearance;  // mm
  int slices = 0;                                      // of every strip; 0: 12 .. 24 by its length

  bool operator==(const FitSettings&) const = default;
};

// How hard muscles are tried.
struct TriedEffort {
  double value = 0;               // where there are no keys
  std::map<double, double> keys;  // by s of the motion; straight between, constant beyond

  bool operator==(const TriedEffort&) const = default;
};

// What is seen beside it, in the same pose (comparison.h).
struct Comparison {
  std::string with;    // empty: nothing
  bool wiped = false;  // one over the other; else halves of the picture
  double share = 0.5;  // of the picture's width that shows the document's own

  bool operator==(const Comparison&) const = default;
};

// What it is tried in. `angles` come on top of the pose.
struct Trial {
  std::string pose;  // of the pose book; empty: rest
  // by joint: flexion, abduction, rotation, deg; not a number: as the pose has it
  std::map<std::string, Vec3> angles;
  std::map<std::string, TriedEffort> activations;  // by name as muscles_meant() takes it
  std::filesystem::path motion;
  double seconds = 0;  // of the motion
  Comparison comparison;
};

struct Document {
  Shared<MuscleTable> frame;  // landmarks, carriers and wraps; no muscles
  std::vector<Shared<EditedMuscle>> muscles;
  Shared<std::map<std::string, EditedJoint>> joints;
  Shared<EditedSkeleton> skeleton;
  Shared<EditedBody> body;
  Shared<Trial> trial;
  FitSettings fit;
  std::string picked;  // the muscle that actions without one mean; may be empty

  bool operator==(const Document&) const = default;  // shares all
};

// The built-in table. `tables`: Assets::tables. Throws as read_muscle_table.
Document built_in_document(const std::filesystem::path& tables);

int find_entry(const Document& document, std::string_view name);  // without side; index or -1

// The document with one of its shared parts changed: joints, skeleton, body, trial or frame.
template <class Part, class Change>
Document with_part(const Document& document, Shared<Part> Document::*part, const Change& change) {
  auto changed = std::make_shared<Part>(*(document.*part));
  change(*changed);
  Document out = document;
  out.*part = std::move(changed);
  return out;
}

// Puts a muscle where the built-in table has one of that name, at the end where it has none, in
// place of one of that name that is there. So the order of a document follows from its muscles.
void place_entry(Document& document, const Document& built_in, Shared<EditedMuscle> muscle);

int find_wrap(const MuscleTable& table, std::string_view name);  // index or -1
// Adds a wrap, or puts it in place of the one of its name.
void place_wrap(MuscleTable& table, TableWrap wrap);
// Lines of wraps.txt by the landmarks of the table. Throws as read_muscle_text.
std::vector<TableWrap> read_wraps(const MuscleTable& table, std::string_view text,
                                  const std::string& name);
// A place as scripts write it: LANDMARK+LEFT,UP,FRONT, mm.
std::string place_text(const MuscleTable& table, const TablePoint& point);
std::set<int> wraps_of(const EditedMuscle& muscle);  // that its lines of either side slide over

// The muscles of `from` as text would give them back: one block, or that of the right side as well.
// `right`: empty where it is the mirror image.
struct MuscleBlocks {
  std::string left, right;
  bool operator==(const MuscleBlocks&) const = default;
};
MuscleBlocks blocks_of(const Document& document, const EditedMuscle& muscle);

// A block read back, with its numbers as they are when it is written again. Throws InputError, of
// which `name` says what was read.
TableMuscle read_block(const Document& document, std::string_view text, const std::string& name);

// All that a document says, as text: two documents with the same text are the same.
std::string document_text(const Document& document);

}  // namespace ecorche
