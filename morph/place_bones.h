// Placing one half of a skeleton inside a skin.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "morph/bone_solver.h"
#include "morph/half_skeleton.h"

namespace ecorche {

struct Placement {
  std::vector<BoneMap> maps;  // one a group
};

struct LandmarkTarget {
  BonePoint point;
  double wanted = 0;      // m below the skin
  double slack = 0;       // m
  double tolerance = 0;   // m
  double deeper = 1;      // weight of lying too deep
};

struct PlaceInput {
  const HalfSkeleton* source = nullptr;
  NamedPoints centres;                          // of the skin, left half
  std::map<std::string, double> tolerances;     // how well each is known, m; others are not aimed at
  double size = 1;                              // ratio of statures
  std::vector<LandmarkTarget> landmarks;
  double margin = 2.5e-3;                       // bone vertices stay this far inside, m
  double hand_margin = 1.5e-3;
  double freedom = 1;                           // factor on the tolerances of data/bone_groups.csv
  int iterations = 40;
};

struct PlaceReport {
  int iterations = 0;
  double cost = 0;
  int outside = 0;          // bone vertices outside the skin at the end
  double furthest = 0;      // the highest signed distance of any, m
};

// Precondition: closed skin that reaches both sides of the mid-plane x = 0.
Placement place_bones(const PlaceInput& input, const FitRules& rules, const SkinField& skin, PlaceReport* report = nullptr);

// The skeleton seen through its maps: the half, moved.
HalfSkeleton moved(const HalfSkeleton& half, const FitRules& rules, const Placement& placement);

// Samples that stand for a bone's surface: far points in 26 directions, then furthest from those already chosen.
std::vector<int> surface_samples(const TriMesh& mesh, int count);

}  // namespace ecorche
