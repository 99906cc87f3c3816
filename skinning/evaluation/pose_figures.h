// Figures of a skin in one pose, for the pose book: the same yardstick for every method.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "skinning/binding.h"
#include "skinning/evaluation/skin_quality.h"

namespace ecorche::inline v1 {

struct PoseFigures {
  int flipped = 0;             // triangles that face against their turned rest normal
  int flipped_outside = 0;     // those of them that do not lie in a contact fold (contact_folds.h)
  double edge_change_p99 = 0;  // 99th percentile of |length / rest length - 1|
  double body_volume_change = 0;  // (V - V0) / V0 of the whole skin
};

// Precondition: as of measure_skin().
PoseFigures measure_pose(const TriMesh& rest, const BlendTables& tables,
                         std::span<const Transform> X_WJ, const SkinFrame& frame);

// "arm_l", "arm_r", "leg_l", "leg_r": all of the skin beyond the shoulder or the hip, closed by a
// fan over the cut; "shoulder_l", "shoulder_r": the skin of the girdle and the upper arm, from
// deltoid to armpit, closed at the trunk and above the elbow.
std::vector<LimbSection> whole_limbs(const Skeleton& skeleton, const TriMesh& skin,
                                     const Binding& binding);

// (V - V0) / V0 of a section, rest to posed.
double section_change(const LimbSection& section, const TriMesh& rest, const SkinFrame& frame);

// Poses in which limb and body volumes are measured: both sides at once, all else at rest.
struct VolumePose {
  std::string name;                   // "elbow_135"
  std::string label;                  // "whole arm, elbow bent 135 deg"
  std::vector<std::string> sections;  // of whole_limbs(); empty: the whole body
  double asked = 0.01;                // largest relative change that is accepted
  Pose pose;
};

// Elbow 135 deg, forearm turned 150 deg from rest, upper arm turned 80 deg, arm raised 180 deg,
// knee 120 deg, hip 90 deg.
std::vector<VolumePose> volume_poses(const Skeleton& skeleton);

}  // namespace ecorche::inline v1
