// Distances of placed muscles from the bones that they name and from the paths of others.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/muscle_table.h"
#include "anatomy/bones/bone_package.h"

namespace ecorche::inline v1 {

// How far the ends of the strips lie from the bones that their landmarks name. Ends on joint
// blends are left out.
struct Attachment {
  int muscle = 0, strip = 0;  // indices into the anatomy's muscles
  bool origin = true;
  std::string bone;
  double distance = 0;  // from the end of the path to the bone's surface, m
};

// Precondition: anatomy.muscles were placed from this table (in whatever body they are by now).
std::vector<Attachment> measure_attachments(const MuscleTable& table, const Anatomy& anatomy);

// How far a path of the MJCF runs from our muscle: its points' distances from the nearest of our
// strips' lines.
struct PathComparison {
  int muscle = 0;  // index into the anatomy's muscles
  std::vector<std::string> paths;
  int points = 0;
  double mean = 0, worst = 0;  // m
};

// For left muscles with paths to compare. Preconditions: anatomy.muscles were placed from this
// table on the source skeleton; `paths` are read_tendon_paths of it. Names that `paths` does not
// have are passed over.
std::vector<PathComparison> compare_paths(const MuscleTable& table, const Anatomy& anatomy,
                                          const std::vector<TendonPath>& paths);

}  // namespace ecorche::inline v1
