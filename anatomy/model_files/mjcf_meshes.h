// The part of a MuJoCo model file (MJCF) that says where meshes lie: bodies, joints, mesh geoms,
// sites, joint couplings.
//
// Read in the model's neutral pose: every joint at zero except those that an equality polynomial
// couples to another one, which take the polynomial's value (the stored default pose of the package
// violates its own couplings). Frames and units as in the file.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct MjcfMesh {
  std::string file;  // as written, relative to the model's mesh folder
  Vec3 scale = Vec3::Ones();
};

struct MjcfJoint {
  std::string body;
  bool slide = false;
  Vec3 center = Vec3::Zero();  // model frame, neutral pose
  Vec3 axis = Vec3::UnitZ();   // unit, model frame, neutral pose
};

struct MjcfGeom {
  std::string body, mesh;
  Transform X_WG = Transform::Identity();
};

struct MjcfSite {
  std::string body;
  Vec3 position = Vec3::Zero();  // model frame, neutral pose
};

struct MjcfTendon {
  std::string name, file;          // the file that defines it
  std::vector<std::string> sites;  // in order; wrapping geoms are left out
};

// q1 = sum c_i (q2)^i; joint2 empty: q1 = c_0.
struct MjcfCoupling {
  std::string joint1, joint2;
  std::array<double, 5> coefficients{};
};

struct Mjcf {
  std::map<std::string, Transform> bodies;  // X_WB by name
  std::map<std::string, MjcfJoint> joints;
  std::map<std::string, MjcfGeom> geoms;  // mesh geoms only
  std::map<std::string, MjcfSite> sites;
  std::map<std::string, MjcfMesh> meshes;
  std::vector<MjcfTendon> tendons;
  std::vector<MjcfCoupling> couplings;
};

// Text of a file of the model, by its normalised path relative to the folder that holds everything.
using MjcfFiles = std::function<std::string(const std::string& path)>;

// Reads `path` and what it includes. Angles in radians and Euler angles in order x, y, z, turning
// with the body, are understood; a model that states otherwise is refused. Throws InputError that
// names file, element and value.
Mjcf read_mjcf(const MjcfFiles& files, const std::string& path);

}  // namespace ecorche::inline v1
