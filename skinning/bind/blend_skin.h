// The skin as the blend of frames and the muscle handles place it.
#pragma once

#include <span>

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/blend_frames.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/muscle_offsets.h"

namespace ecorche::inline v1 {

// Frames and handle offsets of one pose.
struct BlendPose {
  FrameWorkspace frames;
  HandleWorkspace handles;
  Vec3 root = Vec3::Zero();  // posed, world
};

// Throws std::invalid_argument for a pose with other numbers of joints or slices than the tables.
void pose_blend(const BlendTables& tables, const PosedAnatomy& posed, BlendPose& out);

// Positions of the mesh, #V x 4, sorted order. Precondition: the mesh was bound with the frames and
// handles of the pose. Same input, same bytes, at any number of threads.
void blend_skin(const BlendMesh& mesh, const BlendPose& pose, std::span<float> positions);

// Adds offsets from the mesh, turned as the frames at each vertex turn, to positions in the sorted
// order. `offsets`: #V x 4, rest pose, evaluation order.
void add_blended_offsets(const BlendMesh& mesh, const BlendPose& pose,
                         std::span<const float> offsets, std::span<float> positions);

}  // namespace ecorche::inline v1
