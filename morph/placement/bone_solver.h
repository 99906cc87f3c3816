// Places all groups of bones at once: one nonlinear least-squares problem over their maps.
//
// Residuals, each divided by its tolerance:
//   inside    max(0, d + margin)     bone points stay below the skin, d = signed distance
//   depth     d + wanted             palpable points lie as deep as tissue there is thick
//   joint     |M_a(x_a) - M_b(x_b)|  the two sides of a joint meet
//   gap       n . (M_a(x_a) - M_b(x_b)) - gap   two surfaces glide on each other
//   anchor    |M(x) - target|        a point is known (a joint centre)
//   prior     way - expected         bones change no more than the rest asks for
// Gauss-Newton with Levenberg's damping, sparse Cholesky; block structure follows the joints, so a
// step costs milliseconds.
#pragma once

#include <array>
#include <vector>

#include "anatomy/queries/signed_distance.h"
#include "morph/placement/bone_warp.h"

namespace ecorche::inline v1 {

struct BoneGroup {
  BoneMap map;
  BoneMap expected;                                  // what the priors refer to
  std::array<double, BoneMap::way_count> freedom{};  // tolerance of each way; 0 = fixed
};

struct InsidePoint {
  int group;
  Vec3 x;         // in the source
  double margin;  // metres below the skin
  double tolerance;
  bool both = false;             // below the other skin of the problem, too
  int seed = -1;                 // triangle of the last answer,
  Vec3 asked_at = Vec3::Zero();  // where it was asked for,
  // and the distance: as distances change no faster than places, most need not be asked for again
  double answer = 1e300;
};

struct DepthPoint {
  int group;
  Vec3 x;
  double wanted;  // metres below the skin
  double tolerance;
  double slack = 0;   // deviations up to this are free
  double deeper = 1;  // weight of being deeper than wanted: 1 as bad as shallower, 0 free
  int seed = -1;
};

struct JointPair {
  int a, b;
  Vec3 x_a, x_b;
  double tolerance;
};

struct GapPair {
  int a, b;
  Vec3 x_a, x_b;
  Vec3 normal;  // world, from b's surface to a's
  double gap;   // metres
  double tolerance;
};

struct AnchorPoint {
  int group;
  Vec3 x;
  Vec3 target;
  Vec3 tolerance;  // by world axis
};

struct WayTie {  // shape ways of two groups stay alike: (way_a - expected_a) = (way_b - expected_b)
  int a, b;
  BoneMap::Way way;
  double tolerance;
};

struct BoneProblem {
  std::vector<BoneGroup> groups;
  std::vector<InsidePoint> inside;
  std::vector<DepthPoint> depths;
  std::vector<JointPair> joints;
  std::vector<GapPair> gaps;
  std::vector<AnchorPoint> anchors;
  std::vector<WayTie> ties;
  // The skin seen in a mirror, which groups of the middle stay below, too; null: skins are even
  const SkinField* mirrored = nullptr;
};

struct SolveSummary {
  int iterations = 0;
  double initial_cost = 0;
  double cost = 0;
};

// Moves the groups' maps to a minimum; deterministic at any thread count. `one_by_one`: where no
// step of all groups together leads down, steps of single groups are tried, too.
SolveSummary solve_bones(BoneProblem& problem, const SkinField& skin, int max_iterations,
                         bool one_by_one = false);

// Deviation of a map from another along a way: metres, radians (rotation vector), or difference of
// shape entries.
double deviation(const BoneMap& map, const BoneMap& expected, BoneMap::Way way);

}  // namespace ecorche::inline v1
