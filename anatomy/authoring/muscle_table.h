// The muscle table: attachments, paths, bellies and architecture of the muscles of one side, as
// written in data/muscles.
//
// Everything hangs on named landmarks of bones (data/landmarks/*.csv). A path point is a landmark
// and a small offset, so that the table survives a change of bones: whoever moves the landmarks
// moves the muscles. data/muscles/README.md describes the text format. In memory: metres and
// radians in the source frame, the frame of the bone package's neutral pose (left is +x, the
// mid-plane lies at x = kSourceMidPlane); the files give millimetres to the left of the mid-plane,
// up and forward.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// A named point on a bone or on a joint blend of the left side.
struct SourceLandmark {
  std::string id;       // "acromion_front"
  std::string carrier;  // bone without side suffix, or the name of a joint blend
  std::string rule;     // how to find it, in words
  Vec3 position = Vec3::Zero();
  std::string where;  // "arm.csv:17", for messages
};

// A blend of two joints that carries points which no bone carries (keyword `carrier` of
// data/muscles). The first joint's weight is constant, or falls with height.
struct JointBlend {
  std::string name;
  std::array<std::string, 2> joints;  // without side suffix
  double share = 1;
  double high = 0,
         low = 0;  // share 1 at and above `high`, 0 at and below `low`; both 0: constant share
  std::string where;
};

struct TableWrap {
  std::string name;
  Wrap::Kind kind = Wrap::Kind::sphere;
  int landmark = 0;
  Vec3 offset = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  // of a cylinder
  Vec3 radii = Vec3::Zero();  // as in Wrap
  std::string where;
};

struct TablePoint {
  int landmark = 0;
  Vec3 offset = Vec3::Zero();
  std::string glides = {};  // the joint blend that carries it; empty: its landmark's carrier
};

struct TableSection {
  double s = 0;               // fraction of the length of the polyline through the path points
  Vec2 radii = Vec2::Zero();  // half width, half thickness
  // direction of the width axis; the length and the part along the line mean nothing
  Vec3 width = Vec3::UnitX();
};

struct TableStrip {
  struct WrapUse {
    int wrap = 0;
    double radius = 0;  // replaces the wrap's radius if positive
  };
  std::vector<TablePoint> path;
  std::vector<TableSection> sections;  // rising s from 0 to 1
  std::vector<WrapUse> wraps;
  double belly_begin = 0, belly_end = 1;  // fractions as in TableSection
  std::vector<double> intersections;      // rising, within the belly
  double raphe = 0;                       // as in Strip
  std::string where;
};

struct TableMuscle {
  std::string name;  // without side suffix
  std::string label, group, layer, shape, origin, insertion, action, note;
  std::vector<std::string> sources;
  std::vector<std::string>
      compare;  // paths of the MJCF that take the same way, without side; for comparison only
  double volume_male = 0, volume_female = 0;  // one side, m^3
  double fibre_length = 0;                    // m
  double pennation = 0;                       // rad
  double tendon_fraction = 0;                 // of the length of muscle and tendon
  double tense_thickness = 0;                 // over the relaxed; 0: not measured
  double max_force = 0;                       // isometric, N; 0: that of volume and fibre length
  bool sheet = false;
  std::vector<TableStrip> strips;
  std::string where;
};

struct MuscleTable {
  std::vector<SourceLandmark> landmarks;
  std::vector<JointBlend> carriers;
  std::vector<TableWrap> wraps;
  std::vector<TableMuscle> muscles;
};

int find_landmark(const MuscleTable& table, std::string_view id);  // index or -1
Vec3 position(const MuscleTable& table, const TablePoint& point);  // source frame, left side

// Reads `data_dir`/landmarks/*.csv and `data_dir`/muscles/*.txt, files in alphabetical order.
// Throws InputError "thigh.txt:12: sartorius: ..." for anything that is not what the format says:
// unknown keywords, landmarks, wraps or carriers, numbers that are missing or not finite, values
// out of range, paths of one point, an origin that is the insertion, names given twice, sections
// that do not run from 0 to 1.
MuscleTable read_muscle_table(const std::filesystem::path& data_dir);

// Adds the content of one muscle file to a table; `name` stands for the file in messages.
// References are to what is in the table already.
void read_muscle_text(std::string_view text, const std::string& name, MuscleTable& table);
void read_landmark_text(std::string_view text, const std::string& name, MuscleTable& table);

}  // namespace ecorche::inline v1
