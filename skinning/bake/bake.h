// An exact skin as what engines play: four joint influences a vertex, and corrective shapes with
// their curves.
//
//   p = sum_k w_k T_k (X + sum_m c_m(frame) B_m)
//
// 1. Influences. Over sample frames, each vertex looks for non-negative weights of sum 1 over the
// joints about it that bring it closest to
//    where the exact skin has it (an active set after Lawson & Hanson; weights as in Le & Deng
//    2012, 10.1145/2366145.2366218). Joints are dropped one by one, least harm first, and the rest
//    solved again, until four are left. Where that leaves the skin worst, helper joints are added,
//    children of the joint that moves the skin there most: a frame's rigid map that brings the skin
//    about the helper closest, which neither joints nor sums of shapes that other frames share can
//    express.
// 2. Shapes. What is left over is taken up by shapes in the rest pose, solved by turns with their
// curves for what they do in the posed world;
//    vertices that stay far off in a frame count more and more. Helpers then make room for what
//    shapes do better, frames that are missed most are added to the samples, and the shapes are
//    solved on; those of the vertices that are still far off for the largest errors.
// 3. Normals. Engines turn the rest normals by the same blend, which jumps where neighbours hang on
// different joints. The shapes therefore
//    carry changes of the normals, solved with the curves as they are.
// 4. Curves and helpers of every frame are solved together, at last, for the twelfth power of the
// errors: it is the largest that show.
//    Curves keep within -1 .. 1.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/bind/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

struct BakeOptions {
  int morphs = 32;             // at most
  int helpers = 96;            // joints added, at most
  double helper_error = 4e-3;  // m; helpers are added where the joints alone leave more
  // of all motions together, that weights and shapes are solved on; errors are of every frame
  int sample_frames = 450;
  // m; a weight strays by 1 from the given ones only where that brings the skin closer by as much
  double keep_weights = 5e-4;
  // m; a normal that is off by an angle a counts like a vertex that is off by as much times a
  double normal_arm = 0.01;
  double least_offset = 3e-4;  // m; smaller offsets of a shape are left out of it
  // of a unit normal; smaller changes of a shape's normals are left out of it
  double least_turn = 0.04;
};

// How far a bake is: what it is doing, and the share of the whole that is done. Rising, from one
// thread.
using BakeProgress = std::function<void(const char* stage, double share)>;

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

// A joint that is no anatomy's; world-aligned at rest like those of the skeleton.
struct BakeHelper {
  int parent = 0;            // joint
  Vec3 rest = Vec3::Zero();  // world
};

struct Bake {
  std::vector<BakeHelper> helpers;
  std::vector<std::array<Influence, 4>> influences;  // #V; joints, and then helpers, by index
  std::vector<Points> morphs;                        // each #V x 3, m, rest pose
  std::vector<Points>
      morph_normals;  // each #V x 3, added to the rest normals like the shapes to the places
  std::vector<BakedMotion> motions;
  BakeError error;                 // of all frames
  double influences_only_rms = 0;  // without the shapes, over all frames
};

// Where the exact skin has every vertex and its normal.
using ExactSkin = std::function<void(const Pose& pose, SkinFrame& out)>;

// Throws UnfitError for motions without frames. Preconditions: `start` are influences of the skin's
// vertices to begin from, and the motions belong to the skeleton. Same input, same bytes at any
// number of threads.
Bake bake_skin(const TriMesh& skin, const Skeleton& skeleton,
               std::span<const std::array<Influence, 4>> start, const ExactSkin& exact,
               std::vector<BakedMotion> motions, const BakeOptions& options = {},
               const BakeProgress& progress = {});

// One frame as an engine plays it: plain linear blend of the shaped rest pose. X_WJ: the joints'
// world frames, with turns as the file has them (quantized_rotations.h). `out` is resized once. #V
// x 3
void play_bake(const Bake& bake, const TriMesh& skin, const Skeleton& skeleton,
               std::span<const Transform> X_WJ, std::span<const Transform> helpers,
               const Eigen::VectorXf& curves, Points& out);

}  // namespace ecorche
