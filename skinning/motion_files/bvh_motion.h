// A Biovision hierarchy (.bvh) as the file has it: channels in degrees, its own units and axes.
#pragma once

#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

enum class BvhChannel { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct BvhJoint {
  std::string name;
  int parent = -1;             // parents precede children; -1 for a ROOT
  Vec3 offset = Vec3::Zero();  // from the parent, file units
  // in the file's order, which is the order of the rotations: R = R1 R2 R3, column vectors
  std::vector<BvhChannel> channels;
  int first_channel = 0;        // column of the first one in a frame
  std::vector<Vec3> end_sites;  // offsets from this joint, file units
};

struct BvhMotion {
  std::string name;  // of the file, for messages
  std::vector<BvhJoint> joints;
  // the rational rate that a rounded `Frame Time` stands for: .0083333 is 120, 0.041708 is
  // 24000/1001
  double fps = 30;
  double frame_time = 1.0 / 30;  // as written, s
  int channels = 0;              // columns of a frame
  int frames = 0;
  std::vector<double> samples;  // frames x channels, degrees and file units
  std::vector<std::string> warnings;
};

}  // namespace ecorche::inline v1
