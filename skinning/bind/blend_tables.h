// Tables of the blended skin, built once by bind_skin() and read every frame. Private to the
// library.
//
// Blend frames are linear maps of rest points, world to world:
//   0 .. #joints  T_j, the joint frames
//   then #twists  a joint without its rotation about the axis of its own bone, so that upper arm
//                 and thigh turn gradually along their length
//   then #slides  a limb's joint across the limb and another one along it: skin that the trunk
//                 draws up, or the shin down, slides on the limb and does not sink into it
//   then #pairs   D = 2 H - (T_a + T_b), H = the half-way rotation of the two about `center`
// A vertex is sum w_a T_a X + sum w_ab D_ab X with w_ab = 2 w_a w_b: the parabola through T_a, H
// and T_b, which is smooth in the weights for any number of joints and keeps the girth that the
// plain sum loses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A joint's frame without the joint's own axial rotation.
struct TwistFrame {
  int joint = 0;
  int parent = 0;
  Vec3 axis = Vec3::UnitY();  // world, rest
};

// The frame of `limb` plus what the frame of `carrier` differs from it along the limb's axis.
struct SlideFrame {
  int limb = 0;               // joint that the skin lies on
  int carrier = 0;            // joint above or below it that draws the skin
  Vec3 axis = Vec3::UnitY();  // of the limb, world, rest
};

// The half-way correction of two blend frames.
struct FramePair {
  int a = 0, b = 0;            // joints or twist frames
  Vec3 center = Vec3::Zero();  // world, rest: the point about which a and b turn against each other
  int hinge = -1;              // the joint at `center`; -1 within one joint (twist)
};

// The joints at rest, and the frames that are derived from them.
struct FrameTables {
  std::vector<Vec3> origins;  // #joints, rest
  std::vector<int> parents;   // #joints, -1 for the root
  // #joints, world, rest: axes that tell a joint's twist from its swing
  std::vector<Vec3> long_axes;
  std::vector<TwistFrame> twists;
  std::vector<SlideFrame> slides;
  std::vector<FramePair> pairs;

  int joint_count() const { return int(origins.size()); }
  int first_slide() const { return joint_count() + int(twists.size()); }
  int first_pair() const { return first_slide() + int(slides.size()); }
  int frame_count() const { return first_pair() + int(pairs.size()); }

  // The joint that a frame's weight counts for: a twist's own, of a slide's two the one nearer to
  // the root. Precondition: frame < first_pair().
  int joint_of(int frame) const {
    if (frame < joint_count()) return frame;
    if (frame < first_slide()) return twists[frame - joint_count()].joint;
    const SlideFrame& slide = slides[frame - first_slide()];
    return std::min(slide.limb, slide.carrier);
  }
};

// A place on a strip of muscle.
struct MuscleAnchor {
  int first = 0, last = 0;  // flat range of the strip's slices, both inclusive
  double position = 0;  // flat index of the slice before the point plus the fraction to the next
};

// A point of the skin that keeps its height over the strip beneath it.
struct MuscleHandle {
  int vertex = 0;                             // of the skin
  std::vector<std::pair<int, float>> frames;  // weights of blend frames, as a vertex's
  Vec3 normal = Vec3::UnitY();                // of the skin, rest
  Vec3 surface = Vec3::Zero();  // point of the strip's surface beneath it, world, rest
  MuscleAnchor anchor;
  double rest_height = 0;  // m, of the smooth tube over `surface` at rest
  // 1 close over the muscle, falling to 0 with the thickness of the tissue between
  double weight = 0;
  std::vector<int> ring;  // neighbouring handles
  int ring_size = 0;      // neighbours, with those over no muscle, whose offset is zero
};

struct HandleTables {
  std::vector<MuscleHandle> handles;
  double lift_limit = 0.03;  // m, see BindOptions
};

// Consecutive vertices with equal numbers of frames and handles, so that loops over them have
// constant length.
struct VertexRun {
  int begin = 0, end = 0;       // evaluation order
  int frames = 0, handles = 0;  // a vertex
  std::size_t frame_entry = 0, handle_entry = 0;
};

// The weights of a mesh. Vertices have three orders: the caller's; the sorted one, in which
// neighbours in space are neighbours in memory; and the order of evaluation, by runs.
struct BlendMesh {
  int vertex_count = 0;
  std::vector<VertexRun> runs;
  std::vector<float> rest;        // #V x 4, relative to the root's origin, evaluation order
  std::vector<int> sorted_index;  // #V: evaluation order -> sorted order
  std::vector<std::uint16_t> frame;
  std::vector<float> frame_weight;
  std::vector<std::uint16_t> handle;
  std::vector<float> handle_weight;
  std::vector<int> order;      // sorted -> caller's vertex; empty when they agree
  std::vector<int> triangles;  // 3 indices each, sorted order
};

struct BlendTables {
  int slice_count = 0;
  FrameTables frames;
  HandleTables handles;
  BlendMesh mesh;
};

}  // namespace ecorche::inline v1
