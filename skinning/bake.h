// An exact skin as what engines play: four joint influences a vertex, and corrective shapes with their curves.
//
//   p = sum_k w_k T_k (X + sum_m c_m(frame) B_m)
//
// 1. Influences. Over sample frames, each vertex looks for non-negative weights of sum 1 over the joints about it that bring it closest to
//    where the exact skin has it (an active set after Lawson & Hanson; weights as in Le & Deng 2012, 10.1145/2366145.2366218). Joints
//    are dropped one by one, least harm first, and the rest solved again, until four are left.
//    Where that blend would fall flat in a frame, the vertex leans on its first joint instead, so that a shape can still move it.
// 2. Shapes. What is left over is turned back to the rest pose; its principal components over the sample frames are the shapes B, the
//    share of each in a frame is its curve. Vertices that stay far off are given more weight. Curves keep within -1 .. 1.
// 3. Normals. Engines turn the rest normals by the same blend, which jumps where neighbours hang on different joints. The shapes therefore
//    carry changes of the normals, solved with the curves as they are.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

struct BakeOptions {
  int morphs = 32;            // at most
  int sample_frames = 240;    // of all motions together, that weights and shapes are solved on; errors are of every frame
  double keep_weights = 5e-4; // m; a weight strays by 1 from the given ones only where that brings the skin closer by as much
  double normal_arm = 0.02;   // m; a normal that is off by an angle a counts like a vertex that is off by as much times a
  double least_offset = 1e-4; // m; smaller offsets of a shape are left out of it
  double least_turn = 0.03;   // of a unit normal; smaller changes of a shape's normals are left out of it
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
  Eigen::MatrixXf curves;  // #frames x #morphs
  BakeError error;
};

struct Bake {
  std::vector<std::array<Influence, 4>> influences;  // #V
  std::vector<Points> morphs;                        // each #V x 3, m, rest pose
  std::vector<Points> morph_normals;                 // each #V x 3, added to the rest normals like the shapes to the places
  std::vector<BakedMotion> motions;
  BakeError error;                // of all frames
  double influences_only_rms = 0;  // without the shapes, on the sample frames
};

// Where the exact skin has every vertex and its normal, and the world frames of the joints.
using ExactSkin = std::function<void(const Pose& pose, std::vector<Transform>& X_WJ, SkinFrame& out)>;

// Throws UnfitError for motions without frames. Preconditions: `start` are influences of the skin's vertices to begin from, and the
// motions belong to the skeleton. Same input, same bytes at any number of threads.
Bake bake_skin(const TriMesh& skin, const Skeleton& skeleton, std::span<const std::array<Influence, 4>> start, const ExactSkin& exact,
               std::vector<BakedMotion> motions, const BakeOptions& options = {});

// One frame as an engine plays it: plain linear blend of the shaped rest pose. `out` is resized once. #V x 3
void play_bake(const Bake& bake, const TriMesh& skin, const Skeleton& skeleton, std::span<const Transform> X_WJ,
               const Eigen::VectorXf& curves, Points& out);

}  // namespace ecorche
