// What viewers do with four joint influences a vertex, and what they would have to start from.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "anatomy/types.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// A mesh at rest as a file has it: x, y, z vertex after vertex.
struct BlendedMesh {
  std::vector<float> positions, normals;  // 3 #V; normals of unit length, or none
  std::vector<JointWeights> influences;   // #V
};

// Weights scaled to a sum of 1, as files have them.
JointWeights scaled_weights(JointWeights weights);

// How far each joint has moved from rest: X_WJ(pose) X_WJ(rest)^-1. `out` is resized once.
void find_joint_moves(std::span<const Transform> X_WJ, std::span<const Vec3> joint_rest,
                      std::vector<Affine>& out);

// A vertex where viewers show it, when `offset` is added to it at rest.
Vec3 blend_vertex(const BlendedMesh& mesh, std::span<const Affine> moves, std::size_t vertex,
                  const Vec3& offset);

// Offsets of the rest pose that bring vertices to the given positions: #V of them, `stride` floats
// each. Where joints are twisted against each other so far that the blend has nearly collapsed,
// they only come near: returns how far the furthest stays away, m. `out`: 3 #V, resized once.
double offsets_at_rest(const BlendedMesh& mesh, std::span<const Affine> moves,
                       std::span<const float> positions, int stride, Eigen::VectorXf& out);

// The same of normals, as changes of those at rest. Precondition: the mesh has normals.
void turns_at_rest(const BlendedMesh& mesh, std::span<const Affine> moves,
                   std::span<const float> normals, int stride, Eigen::VectorXf& out);

}  // namespace ecorche::inline v1
