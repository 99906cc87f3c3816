// Markers of a take laid on a character: a point of a joint's frame for each.
#pragma once

#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/markers/marker_tables.h"
#include "skinning/motion_files/marker_take.h"

namespace ecorche::inline v1 {

struct BodyMarker {
  std::string name, place;    // of the take; of the tables
  int column = 0;             // of the take
  int joint = 0;              // that carries it
  Vec3 local = Vec3::Zero();  // in the joint's frame at rest, m
  double spread = 0.02;       // m
  double height = 0;          // over the root when the body stands at attention, m
};

// Limbs at the anatomical zero: standing, arms hanging, palms to the thighs.
Pose attention_pose(const Skeleton& skeleton);

// The markers that a table knows. `skin`: at rest, world; without triangles a place lies 45 mm
// outside. Throws InputError for a joint that the skeleton does not have.
std::vector<BodyMarker> lay_markers(const MarkerTables& tables, const MarkerTake& take,
                                    const Skeleton& skeleton, const TriMesh& skin);

}  // namespace ecorche::inline v1
