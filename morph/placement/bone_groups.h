// The rules by which a skeleton is placed in a skin: our tables of bone groups, contacts, palpable
// landmarks and joint marks.
//
// Everything is stated for the left side and the middle; the right side is the mirror image. Names
// carry no suffix.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/types.h"
#include "morph/placement/bone_warp.h"

namespace ecorche::inline v1 {

struct GroupRule {  // data/bone_groups.csv
  std::string name;
  bool paired = false;
  std::vector<std::string> bones;
  std::string near, far, across;
  double width = 1;
  // how far the group is turned about z from the package's pose, in which arms hang, to that of
  // skins, rad
  double raised = 0;
  bool shaft = false;
  std::array<double, BoneMap::way_count> freedom{};  // SI
};

struct ContactRule {  // data/bone_contacts.csv
  std::string point;
  int a = 0, b = 0;           // groups
  double tolerance = 0;       // m
  std::string along;          // "", "x", "z", "hinge"
  double spread = 0;          // m
  double loose = 0;           // m
  Vec3 close = Vec3::Zero();  // of a in b, to narrow a gap that the bones are delivered with, m
};

struct LandmarkRule {  // data/palpable.csv
  std::string name, bone;
  Vec3 direction = Vec3::Zero();
  Vec3 from = Vec3::Zero(), to = Vec3::Ones();  // limits in the bone's bounding box
  double low = 0, high = 0;                     // tissue over it in lean men, m
  std::string fat_site;                         // of data/fat.csv: what grows over it in others
  double tolerance = 0;                         // m
  bool checked = true;                          // its depth is reported; else it is only aimed at
};

struct CubeRule {  // data/joint_cubes.csv
  std::string joint, cube, toward;
  int vertex = -1;  // of the skin that stands for the cube, -1: none does
  Vec3 male = Vec3::Zero(), female = Vec3::Zero();  // m
  double tolerance = 0;                             // m
};

struct FitRules {
  std::vector<GroupRule> groups;
  std::vector<ContactRule> contacts;
  std::vector<LandmarkRule> landmarks;
  std::vector<CubeRule> cubes;
  std::map<std::string, int, std::less<>> group_of_bone;  // bone without suffix -> group
};

// Reads the four tables of the folder. Throws InputError that names file and line.
FitRules read_fit_rules(const std::filesystem::path& folder);

// "femur_l" -> {"femur", left}; "skull" -> {"skull", middle}.
std::pair<std::string, Side> split_side(const std::string& name);

}  // namespace ecorche::inline v1
