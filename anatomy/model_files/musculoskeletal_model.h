// A musculoskeletal model of another program (OpenSim, MuJoCo), read as it stands: bodies in two
// poses, muscle paths, wrap objects, forces.
//
// World axes are ours as far as the file says (OpenSim: +X forward, +Y up, +Z right; MJCF: up is
// against gravity, +X is taken as forward, and whoever matches the model with our skeleton finds
// out which way it faces). Frames of bodies are the model's own. Lengths in metres.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// The poses that a model is read in: every free angle at zero (or the limit nearest to it), and the
// file's own default. Coordinates that a constraint couples to others follow them in both.
inline constexpr int kZeroPose = 0, kDefaultPose = 1, kModelPoses = 2;
template <class T>
using PerPose = std::array<T, kModelPoses>;

struct ModelMesh {
  std::string file;  // relative to the model's folder, checked to lie inside it; may not exist
  Vec3 scale = Vec3::Ones();
  Transform X_BG = Transform::Identity();
};

struct ModelBody {
  std::string name;
  int parent = -1;  // parents precede children
  PerPose<Transform> X_WB;
  PerPose<Vec3> center;  // where the joint to the parent is, world
  bool loose = false;  // that centre is none: the body has no joint (MJCF), or glides on a surface
  std::vector<ModelMesh> meshes;
};

struct ModelPoint {
  enum class Kind { fixed, conditional, moving };
  std::string name;
  Kind kind = Kind::fixed;
  int body = 0;
  PerPose<Vec3> place;               // body frame; moving points differ from pose to pose
  PerPose<bool> active{true, true};  // conditional points: whether the path goes through it
};

struct ModelWrap {
  enum class Kind { sphere, cylinder, ellipsoid, torus };
  std::string name;
  Kind kind = Kind::sphere;
  int body = 0;
  Transform X_BO = Transform::Identity();  // a cylinder's and a torus's axis is z
  Vec3 radii = Vec3::Zero();               // as in Wrap; torus: (hole, hole, tube)
  Vec3 side = Vec3::Zero();  // direction in O that the path must pass on; zero: the nearer side
};

struct ModelWrapUse {
  int wrap = 0;
  int first = 0, last = -1;  // between these points of the path; last -1: anywhere
  Vec3 side = Vec3::Zero();  // in O; replaces the wrap's when not zero
};

struct ModelMuscle {
  std::string name;
  std::vector<ModelPoint> points;
  std::vector<ModelWrapUse> wraps;
  double max_force = 0;     // isometric, N; 0 unknown
  double fibre_length = 0;  // optimal, m; 0 unknown
  double tendon_slack = 0;  // m; 0 unknown or none
  double pennation = 0;     // at the optimal length, rad
};

struct MusculoskeletalModel {
  std::string name;               // of the model, as in the file
  std::string file;               // for messages
  std::string format;             // "OpenSim 40000", "MJCF"
  bool faces_forward = true;      // false: the file does not say which horizontal axis is forward
  std::vector<ModelBody> bodies;  // the ground or world is not among them
  std::vector<ModelWrap> wraps;
  std::vector<ModelMuscle> muscles;
  std::vector<std::string> notes;  // what was left out or taken to be something simpler, for people
};

// Throws InputError that names the first part which lies further than 100 m from the origin or its
// body, or has a length or force that no muscle has. Both parsers ask it of what they hand back.
void check_model(const MusculoskeletalModel& model);

}  // namespace ecorche::inline v1
