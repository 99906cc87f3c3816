// A baked skin: joint influences, helper joints, corrective shapes and their curves, as engines
// play them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// Parameters of a bake.
struct BakeOptions {
  int morphs = 32;   // corrective shapes, at most
  int helpers = 96;  // helper joints, at most
  // m; helpers are added where the joints alone leave a larger error
  double helper_error = 4e-3;
  // of all motions together, for which weights and shapes are solved; errors are of every frame
  int sample_frames = 450;
  // m; regularisation: a weight departs from the given one by 1 only where that reduces the error
  // by as much. Larger: weights stay as given; smaller: weights follow noise.
  double keep_weights = 5e-4;
  // m; weight of the normals: an angle error of 1 rad counts as much as a position error of this
  // size
  double normal_arm = 0.01;
  double least_offset = 3e-4;  // m; smaller offsets of a shape are set to zero
  // of a unit normal; smaller changes of a shape's normals are set to zero
  double least_turn = 0.04;
};

// Distances from the exact skin over vertices and frames, m; angles between normals, degrees.
struct BakeError {
  int frames = 0;
  double mean = 0, rms = 0, p95 = 0, max = 0;
  double normal_rms = 0, normal_p95 = 0;
};

struct BakedMotion {
  std::string name;
  Motion motion;
  Eigen::MatrixXf curves;                       // #frames x #morphs
  std::vector<std::vector<Transform>> helpers;  // a frame: world frames, in the helpers' order
  BakeError error;
};

// A joint without anatomy, world-aligned at rest like those of the skeleton.
struct BakeHelper {
  int parent = 0;            // joint
  Vec3 rest = Vec3::Zero();  // world
};

struct Bake {
  std::vector<BakeHelper> helpers;
  std::vector<std::array<Influence, 4>> influences;  // #V; joints, and then helpers, by index
  std::vector<Points> morphs;                        // each #V x 3, m, rest pose
  // each #V x 3, added to the rest normals like the shapes to the positions
  std::vector<Points> morph_normals;
  std::vector<BakedMotion> motions;
  BakeError error;                 // of all frames
  double influences_only_rms = 0;  // without the shapes, over all frames
};

}  // namespace ecorche::inline v1
