// Placing one half of a skeleton inside a skin.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "morph/placement/bone_solver.h"
#include "morph/placement/build_regression.h"
#include "morph/placement/half_skeleton.h"

namespace ecorche::inline v1 {

struct Placement {
  std::vector<BoneMap> maps;      // one a group
  std::vector<BoneMap> expected;  // by joint centres and build, before correction
};

struct LandmarkTarget {
  BonePoint point;
  double wanted = 0;     // m below the skin
  double slack = 0;      // m
  double tolerance = 0;  // m
  double deeper = 1;     // weight of lying too deep
  // Where the point should end up at last, m below the skin: what misses that by little is aimed at
  // again, harder.
  double shallowest = -std::numeric_limits<double>::infinity(),
         deepest = std::numeric_limits<double>::infinity();
};

struct SurfaceSample {
  int bone = 0;  // of HalfSkeleton::bones
  int vertex = 0;
  double margin = 0;  // m below the skin
};

struct PlaceInput {
  const HalfSkeleton* source = nullptr;
  NamedPoints centres;                       // of the skin, left half
  std::map<std::string, double> tolerances;  // how well each is known, m; others are not aimed at
  double size = 1;                           // ratio of statures
  std::vector<LandmarkTarget> landmarks;
  double margin = 2.5e-3;  // bone vertices stay this far inside, m
  double hand_margin = 1.5e-3;
  double freedom = 1;  // factor on the tolerances of data/bone_groups.csv
  // the source is not yet fitted to skins: apply the tables' width shares and narrow gaps
  bool authored = true;
  // points to keep inside; null: samples of each bone at the margins above
  const std::vector<SurfaceSample>* margins = nullptr;
  const BuildPrior* build = nullptr;  // what the build says about the bones; null: nothing
  double stature = 0;                 // m, for `build`
  std::vector<GapPair>
      gaps;  // surfaces that glide; of an authored source they are found while placing
  const Placement* start = nullptr;  // where to start from; null: from the joint centres
  bool middle_fixed = false;         // groups of the middle stay as `start` has them
  // Of an uneven body: the skin seen in a mirror, which the middle's bones stay below, too
  const SkinField* mirrored = nullptr;
  int iterations = 40;
};

struct PlaceReport {
  int iterations = 0;
  std::vector<int> outside;  // of each bone: vertices outside the skin at the end
  double furthest = 0;       // the highest signed distance of any, m; negative inside
};

// Precondition: closed skin that reaches both sides of the mid-plane x = 0.
Placement place_bones(const PlaceInput& input, const FitRules& rules, const SkinField& skin,
                      PlaceReport* report = nullptr);

// The skeleton seen through its maps: the half, moved.
HalfSkeleton moved(const HalfSkeleton& half, const FitRules& rules, const Placement& placement);

// The pairs of points between shoulder blade and ribs of a placed skeleton, with the gaps that they
// have.
std::vector<GapPair> glide_pairs_at_rest(const HalfSkeleton& half, const FitRules& rules);

// Points of each bone's surface with the margins that `input` asks for, or less where the bones lie
// nearer to the skin.
std::vector<SurfaceSample> sample_margins(const HalfSkeleton& half, const FitRules& rules,
                                          const PlaceInput& input, const SkinField& skin);

}  // namespace ecorche::inline v1
