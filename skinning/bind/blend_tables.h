// What deform_skin() reads every frame. Built by bind_skin(); private to the room.
//
// Carriers are linear maps of rest points, world to world:
//   0 .. #joints            T_j, the joint frames
//   then #twists            a joint without its rotation about the axis of its own bone (upper arm
//   and thigh turn gradually) then #pairs             D = 2 H - (T_a + T_b), H = the half-way
//   rotation of the two about `center`
// A vertex is sum w_a T_a X + sum w_ab D_ab X with w_ab = 2 w_a w_b: the parabola through T_a, H
// and T_b, which is smooth in the weights for any number of joints and keeps the girth that the
// plain sum loses.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

struct ElasticSkin;

struct TwistCarrier {
  int joint = 0;
  int parent = 0;
  Vec3 axis = Vec3::UnitY();  // world, rest
};

struct PairCarrier {
  int a = 0, b = 0;            // joints or twist carriers
  Vec3 center = Vec3::Zero();  // world, rest: the point about which a and b turn against each other
  int hinge = -1;              // joint that this is; -1 within one joint (twist)
};

// Where a node hangs on a strip.
struct MuscleAnchor {
  int first = 0, last = 0;  // flat range of the strip's slices, both inclusive
  double place = 0;         // flat index of the slice before the point plus the share of the next
};

// A point of the skin that keeps its height over the strip beneath it.
struct MuscleNode {
  int vertex = 0;                               // of the skin
  std::vector<std::pair<int, float>> carriers;  // as a vertex's
  Vec3 normal = Vec3::UnitY();                  // of the skin, rest
  Vec3 surface = Vec3::Zero();  // point of the strip's surface beneath it, world, rest
  MuscleAnchor anchor;
  double rest_height = 0;  // m, of the smooth tube over `surface` at rest
  // 1 close over the muscle, falling to 0 with the thickness of the tissue between
  double weight = 0;
  std::vector<int> ring;  // neighbouring nodes
  int ring_size = 0;      // neighbours with those that hang on no muscle, whose lift is zero
};

// Vertices of equal shape are evaluated together, so that loops have constant length.
struct VertexRun {
  int begin = 0, end = 0;       // evaluation order
  int carriers = 0, nodes = 0;  // a vertex
  std::size_t carrier_entry = 0, node_entry = 0;
};

struct SkinTables {
  int joint_count = 0, slice_count = 0, vertex_count = 0;
  std::vector<Vec3> origins;  // #joints, rest
  std::vector<int> parents;   // #joints, -1 for the root
  std::vector<Vec3>
      long_axes;  // #joints, world, rest: about which a joint's twist is told from its swing
  std::vector<TwistCarrier> twists;
  std::vector<PairCarrier> pairs;

  std::vector<VertexRun> runs;
  std::vector<float> rest;  // #V x 4, relative to origins[0], evaluation order
  std::vector<int> place;   // #V: evaluation order -> sorted order
  std::vector<std::uint16_t> carrier;
  std::vector<float> carrier_weight;
  std::vector<std::uint16_t> node;
  std::vector<float> node_weight;

  std::vector<int> order;      // sorted -> caller's vertex; empty when they agree
  std::vector<int> triangles;  // 3 indices each, sorted order

  std::vector<MuscleNode> nodes;
  double lift_limit = 0.03;  // m

  // The elastic skin of this mesh, or of the base mesh that a refined one follows; none: the skin
  // stays where the blend puts it.
  std::shared_ptr<const ElasticSkin> elastic;
  std::shared_ptr<const SkinTables> base;  // of a refined skin
  // #V + 1 into follow, follow_weight; places in the base's sorted order. In this one's sorted
  // order
  std::vector<int> follow_first, follow;
  std::vector<float> follow_weight;
};

}  // namespace ecorche
