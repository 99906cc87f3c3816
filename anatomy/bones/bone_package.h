// The bone package: 178 named bones on our joint tree, assembled from the package's STL files and
// the MJCF that places them.
//
// Frame: the MJCF's neutral pose in our axes, (x, y, z) = (x, z, -y) of the MJCF, metres. The body
// stands with its arms hanging, palms to the thighs; that is the anatomical zero of every joint
// (Joint::zero = 0). Its mid-plane is x = kSourceMidPlane, not 0, so that coordinates agree with
// tables that were authored on the package. The left side is read from the package; the right side
// is its exact mirror image.
//
// data/bones.csv says which component of which mesh is which bone, data/joints.csv where each joint
// sits, how it is oriented and how far it goes.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/bones/mirror.h"
#include "anatomy/files/assets.h"

namespace ecorche::inline v1 {

// Skeleton and bones; no muscles. Bones follow data/bones.csv: unpaired and left ones in its order,
// each left one followed by its right one. Throws InputError when the package or a table is
// missing, altered or inconsistent.
Anatomy read_source_skeleton(const Assets& assets);

// A line of the MJCF's model: where others have put a muscle. For comparison only.
struct TendonPath {
  std::string name;          // the MJCF's, without "_tendon": "bflh_l"
  std::vector<Vec3> points;  // as the bones lie, m
  std::vector<std::string>
      bones;  // the bone that each point rides on: the nearest one of its MJCF body
};

// Left side and mid-line tendons of leg and trunk (the arm's stem from a model with other terms and
// are not read). `skeleton` is what read_source_skeleton returned.
std::vector<TendonPath> read_tendon_paths(const Assets& assets, const Anatomy& skeleton);

}  // namespace ecorche::inline v1
