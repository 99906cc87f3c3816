// Which joint of a motion file moves which of ours.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/motion_files/bvh_io.h"
#include "skinning/retarget/retarget.h"

namespace ecorche {

struct SourceRig {
  // Our joint's name -> the file's joint that sits there / whose world rotation it takes. They
  // differ where the file splits a limb into several bones: the first one sits at the joint, the
  // last one has turned all the way.
  std::map<std::string, int> pivot, turner;
  std::vector<int> spine, neck;  // between hips and chest, between chest and head, from below
  bool ours = false;             // the file has our own joint names
  std::vector<JointMatch> matches;
  std::vector<std::string> warnings;
};

// Throws UnfitError listing the needed parts that were not found, with the table of what was.
SourceRig match_joints(const BvhMotion& source, const Skeleton& ours,
                       const std::map<std::string, std::string>& joint_map);

// Position of the bone's far end for a joint without a mapped child: its End Site or its children's
// mean; false if there is none.
bool bone_end(const BvhMotion& source, int joint, Vec3& offset);

}  // namespace ecorche
