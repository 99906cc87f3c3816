// Bakes an exact skin for engines: four joint influences a vertex, and corrective shapes with their
// curves (skinning decomposition).
//
//   p = sum_k w_k T_k (X + sum_m c_m(frame) B_m)
//
// 1. Influences. Over sample frames, each vertex gets non-negative weights of sum 1 for the joints
//    around it, by least squares against the exact skin (an active set after Lawson & Hanson;
//    weights as in Le & Deng 2012, 10.1145/2366145.2366218). Joints are dropped one by one, least
//    harm first, and the rest solved again, until four are left. Where the error is largest, helper
//    joints are added as children of the joint with the largest weight there. A helper's frame is
//    the rigid map that brings the skin around it closest, which neither joints nor sums of shapes
//    can express.
// 2. Shapes. The residual is approximated by shapes in the rest pose, solved in alternation with
//    their curves by their effect in the posed world. Vertices with a large error in a frame get
//    rising weights. Then the helpers are solved again, the frames with the largest errors join the
//    samples, and the shapes are refined; finally those of the vertices with the largest errors.
// 3. Normals. Engines rotate the rest normals by the same blend, which is discontinuous where
//    neighbours have different joints. The shapes therefore carry changes of the normals, solved
//    with the curves fixed.
// 4. Curves and helpers of every frame are finally solved together for the twelfth power of the
//    errors, since the largest errors are the visible ones. Curves keep within -1 .. 1.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/bake/baked_rig.h"
#include "skinning/binding.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

// Progress of a bake: the stage, and the finished fraction of the whole. Rising, from one thread.
using BakeProgress = std::function<void(const char* stage, double share)>;

// Evaluates the exact skin: positions and normals of every vertex.
using ExactSkin = std::function<void(const Pose& pose, SkinFrame& out)>;

// Throws UnfitError for motions without frames. Preconditions: `start` are influences of the skin's
// vertices to begin from, and the motions belong to the skeleton. Same input, same bytes at any
// number of threads.
Bake bake_skin(const TriMesh& skin, const Skeleton& skeleton,
               std::span<const std::array<Influence, 4>> start, const ExactSkin& exact,
               std::vector<BakedMotion> motions, const BakeOptions& options = {},
               const BakeProgress& progress = {});

// One frame as an engine plays it: plain linear blend of the shaped rest pose. X_WJ: the joints'
// world frames, with rotations as the file has them (quantized_rotations.h). `out`: #V x 3, resized
// once.
void play_bake(const Bake& bake, const TriMesh& skin, const Skeleton& skeleton,
               std::span<const Transform> X_WJ, std::span<const Transform> helpers,
               const Eigen::VectorXf& curves, Points& out);

}  // namespace ecorche::inline v1
