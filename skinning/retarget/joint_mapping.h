// Which joint of a motion file stands for which of ours.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

// One joint of the file.
struct JointMatch {
  std::string source;  // the file's joint
  // "shoulder_l", or "spine" / "neck" for joints whose rotation is spread, or "" for an unused one
  std::string ours;
  std::string how;  // found by "map", "name", "tree"; "" for an unused one
};

struct JointMapping {
  // Our joint's name -> the file's joint at its position, and the file's joint whose world rotation
  // it takes. They differ where the file splits a limb into several bones: the first one sits at
  // the joint, the last one has the whole rotation.
  std::map<std::string, int> position_joint, rotation_joint;
  std::vector<int> spine, neck;  // between hips and chest, between chest and head, from below
  // Our scapulae for which only a further joint of the file's collar stands, no shoulder blade.
  std::set<std::string> outer_collars;
  bool ours = false;                // the file has our own joint names
  std::vector<JointMatch> matches;  // one a joint of the file
  std::vector<std::string> warnings;
};

// `joint_map` comes before any guess (joint_map_file.h). Throws UnfitError that lists the needed
// parts that were not found, with the table of matches so far.
JointMapping map_joints(const MotionClip& source, const Skeleton& ours,
                        const std::map<std::string, std::string>& joint_map);

// Far end of the bone of a joint without a mapped child, from the joint: its end site or its
// children's mean; false if there is none.
bool bone_end(const MotionClip& source, int joint, Vec3& offset);

// The matches as a table for people, one joint a line.
std::string format_matches(const std::vector<JointMatch>& matches);

}  // namespace ecorche::inline v1
