// Pieces of limb about elbows and knees, whose volume binding and measurements look at.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "anatomy/geometry/mesh_rims.h"
#include "anatomy/skeleton.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// A piece of limb about a joint, from half way along the segment above to half way along the
// segment below. Its two ends are closed by fans about the centroids of their rims.
struct LimbSection {
  std::string name;            // "elbow_l"
  std::vector<int> triangles;  // of the skin
  std::vector<MeshRim> rims;   // of each open end
};

// Sections of the elbows and knees ("elbow_l", "elbow_r", "knee_l", "knee_r"); a joint that the
// skeleton lacks is left out. `joint_weights`: #V of the skin.
std::vector<LimbSection> limb_sections(const Skeleton& skeleton, const TriMesh& skin,
                                       std::span<const JointWeights> joint_weights);

// Volume of a section in the shape V, m^3.
double section_volume(const LimbSection& section, const Triangles& F, const Points& V);

}  // namespace ecorche::inline v1
