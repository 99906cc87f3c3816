// A motion file whose rig sits in the very body that it moves, as the body package's rigs do.
//
// Such a file is taken over as it is: rotation for rotation (retarget.h), and the body goes where
// the rig takes it. A rig's joints need not be where the anatomy has them (its hip lies up to 5 cm
// beside ours, its spine in the middle of the body), so with the same rotations a part ends
// elsewhere by some of that. The vertebrae between pelvis and thorax, thorax and head, which are
// more than the rig's, bend so that thorax and head come near to where the rig has them, and the
// root is put where the parts of the body, each as large as its skin, are nearest to there. In the
// file's rest pose that is the rest pose of ours to the last millimetre, wherever the rig's own
// root lies.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/rest_alignment.h"

namespace ecorche {

// A place of ours that a joint of the file carries.
struct CarriedPlace {
  int joint = 0;              // ours, whose place at rest it is
  int part = 0;               // ours, with which it moves
  int carrier = 0;            // the file's
  Vec3 there = Vec3::Zero();  // in the carrier's rest frame, file units
  double share = 0;           // of the body
};

// Joints of ours one upon the other, between two parts that the file turns.
struct CarriedChain {
  std::vector<int> joints;  // those that bend, from below
  // of the first one, as the part below has it; of the joint after the last one, as the part above
  // has it
  CarriedPlace begin, end;
};

struct OwnRig {
  double metres = 1;  // a unit of the file
  Mat3 W = Mat3::Identity();
  std::vector<CarriedPlace> places;
  std::vector<CarriedChain> chains;  // spine, neck, unless the file turns their joints itself
};

// None where the file's rest pose is not ours, where limbs' joints lie more than 3 cm beside ours
// (hips: 6 cm), or where that takes another unit than one of length. Throws std::invalid_argument
// for a skeleton that is not ours.
std::optional<OwnRig> find_own_rig(const BvhMotion& source, const SourceRig& rig,
                                   const RestAlignment& alignment, const Skeleton& ours);

// Where the file has a place of ours, m, our axes. X: bvh_kinematics of the frame.
Vec3 carried(const OwnRig& rig, const std::vector<Transform>& X, const CarriedPlace& place);

// Turns the joints of a chain, whose world rotations R has by joint, so that its end comes nearer
// to where the rig has it, by bending alone: the middle most, ends not. `rest`: places of our
// joints at rest.
void bend_to_rig(const OwnRig& rig, const CarriedChain& chain, const std::vector<Transform>& X,
                 const std::vector<Vec3>& rest, std::vector<Mat3>& R);

// By how much the root has to move so that the body is nearest to where the rig has it. X_WJ: of
// our pose.
Vec3 shift_to_rig(const OwnRig& rig, const std::vector<Transform>& X, const std::vector<Vec3>& rest,
                  const std::vector<Transform>& X_WJ);

}  // namespace ecorche
