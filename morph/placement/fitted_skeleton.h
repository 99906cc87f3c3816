// From the maps of the bone groups to a whole skeleton: bones of both sides, joint centres and
// axes, and the way any point takes that rides on a bone.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/transform_muscles.h"
#include "morph/placement/head_turn.h"
#include "morph/placement/place_bones.h"
#include "morph/placement/settle_bones.h"

namespace ecorche::inline v1 {

// Maps of both sides, in left-hand coordinates: a right point is mirrored, mapped and mirrored
// back.
struct SidedPlacement {
  Placement left, right;
  double source_plane = 0;  // x of the planes of symmetry, m
  double target_plane = 0;
  HeadTurn turn{};  // after the maps, in the world
  // And after that: by group, left (and those of the middle, of both sides) and
  // right; empty: none
  std::vector<std::array<std::vector<LocalPush>, 2>> pushes{};
};

class SkeletonWarp {
 public:
  // Keeps references to `source` and `rules`.
  SkeletonWarp(const Anatomy& source, const FitRules& rules, SidedPlacement placement);

  Vec3 by_group(int group, Side side, const Vec3& x) const;
  Vec3 by_bone(int bone, const Vec3& x) const;
  // A point that rides on a joint: by the map of its bones; where several groups ride on one joint,
  // by those nearby.
  Vec3 by_joint(int joint, const Vec3& x) const;

  // The whole skeleton and its bones, moved; no muscles. Joint angles of the rest pose follow the
  // bones' turns.
  Anatomy skeleton() const;

 private:
  struct JointWarp {
    std::vector<int> groups;
    Side side = Side::middle;
    std::vector<Points> samples;  // of each group's bones on this joint, when there are several
  };

  const Anatomy& source_;
  const FitRules& rules_;
  SidedPlacement placement_;
  std::vector<JointWarp> joints_;
  std::vector<int> bone_groups_;
};

}  // namespace ecorche::inline v1
