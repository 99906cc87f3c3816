// A motion file whose rig matches the body that it moves, as the body package's rigs do.
//
// Such a file is taken over rotation for rotation (retarget.h), and the body goes where the rig
// goes. A rig's joints differ from the anatomical ones (its hip lies up to 5 cm beside ours, its
// spine in the middle of the body), so equal rotations displace a part. The vertebrae between
// pelvis and thorax, thorax and head, which are more than the rig's, bend so that thorax and head
// come near to their positions in the rig. Clavicles do so for the shoulders, where the rig's
// collar has several joints and no shoulder blade. The root is placed where the parts of the body,
// weighted by their area of skin, are nearest to the rig. In the file's rest pose that is our rest
// pose within rounding, wherever the rig's own root lies.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/rest_alignment.h"

namespace ecorche::inline v1 {

// A point of our body that moves with a joint of the file.
struct MatchedPoint {
  int joint = 0;              // ours, whose rest position it is
  int part = 0;               // ours, with which it moves
  int file_joint = 0;         // the file's, with which it moves
  Vec3 local = Vec3::Zero();  // in the file joint's rest frame, file units
  double weight = 0;          // fraction of the body's surface
};

// A chain of our joints between two parts that the file rotates.
struct MatchedChain {
  std::vector<int> joints;  // those that bend, from below
  // position of the first joint, moving with the part below; of the joint after the last one,
  // moving with the part above
  MatchedPoint begin, end;
};

// A collar of several joints in the file, none of which is a shoulder blade.
struct MatchedCollar {
  // position of our clavicle, moving with the thorax; of our shoulder, moving with what stands for
  // the scapula, the last joint of the file's collar
  MatchedPoint clavicle, shoulder;
};

struct MatchingRig {
  double metres = 1;  // a unit of the file
  Mat3 W = Mat3::Identity();
  std::vector<MatchedPoint> points;
  std::vector<MatchedChain> chains;  // spine, neck, unless the file rotates their joints itself
  std::vector<MatchedCollar> collars;
};

// None where the file's rest pose is not ours, where limbs' joints lie more than 3 cm beside ours
// (hips: 6 cm), or where that takes another unit than one of length. Throws std::invalid_argument
// for a skeleton that is not ours.
std::optional<MatchingRig> find_matching_rig(const MotionClip& source, const JointMapping& mapping,
                                             const RestAlignment& alignment, const Skeleton& ours);

// Points the clavicle so that, with the scapula as it is turned, the shoulder comes nearest to its
// position in the rig. R, `rest` as in bend_to_rig.
void reach_with_collar(const MatchingRig& rig, const MatchedCollar& collar,
                       const std::vector<Transform>& X, const std::vector<Vec3>& rest,
                       std::vector<Mat3>& R);

// Position of a point in the file, m, our axes. X: clip_kinematics of the frame.
Vec3 file_position(const MatchingRig& rig, const std::vector<Transform>& X,
                   const MatchedPoint& point);

// Bends a chain, without twist, so that its end comes nearer to its position in the rig: the middle
// bends most, the ends not at all. R: world rotations by joint, input and output. `rest`: positions
// of our joints at rest.
void bend_to_rig(const MatchingRig& rig, const MatchedChain& chain, const std::vector<Transform>& X,
                 const std::vector<Vec3>& rest, std::vector<Mat3>& R);

// Translation of the root that brings the body nearest to the rig. X_WJ: of
// our pose.
Vec3 shift_to_rig(const MatchingRig& rig, const std::vector<Transform>& X,
                  const std::vector<Vec3>& rest, const std::vector<Transform>& X_WJ);

}  // namespace ecorche::inline v1
