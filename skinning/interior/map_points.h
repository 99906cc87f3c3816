// Points of a body's inside and what moves them in a pose, packed for reading every frame: joints,
// controls of the skin and cells of a lattice, with their weights, one point after the other.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/posed_anatomy.h"
#include "skinning/interior/harmonic_weights.h"

namespace ecorche::inline v1 {

// A point before it is packed.
struct MapPoint {
  Vec3 rest = Vec3::Zero();
  SourceWeights joints;
  SourceWeights skin;               // of controls; one source beyond them is bone
  std::vector<LatticeShare> cells;  // of the pressure's lattice
};

struct MapPoints {
  struct Share {
    int source = 0;
    float weight = 0;
  };
  struct Head {
    Eigen::Vector3f rest = Eigen::Vector3f::Zero();
    int joints = 0, skin = 0, cells = 0;  // where its shares begin; the next head ends them
  };
  std::vector<Head> heads;    // #points + 1
  std::vector<Share> shares;  // joints, skin and cells of each point

  std::size_t size() const { return heads.empty() ? 0 : heads.size() - 1; }
};

MapPoints pack_points(std::span<const MapPoint> points);
// The same; `was`, #points: which of `before` a point is in all, -1: none.
MapPoints pack_points(std::span<const MapPoint> points, std::span<const int> was,
                      const MapPoints& before);

// How joints have moved from rest, against the root's motion in single precision: as exact far from
// the world's origin.
struct JointMotions {
  Transform root = Transform::Identity();
  std::vector<std::array<float, 8>> rotations;  // dual quaternions: x y z w, then the dual part
  std::vector<std::array<float, 16>> motions;   // columns of four
};

// `joints`: at rest; `parents` of them.
void set_motions(std::span<const Vec3> joints, std::span<const int> parents,
                 const PosedAnatomy& posed, JointMotions& out);

// Where the joints' motions bring a point, blended as dual quaternions, and by the share `straight`
// linearly; and how they turn it.
Vec3 moved(const JointMotions& motions, const MapPoints& points, std::size_t i, float straight);
Mat3 turned(const JointMotions& motions, const MapPoints& points, std::size_t i);

// The weighted mean of the controls' rows, four floats each, and of the cells' rows or values.
Vec3 skin_mean(const MapPoints& points, std::size_t i, std::span<const float> rows);
Vec3 cell_mean(const MapPoints& points, std::size_t i, std::span<const float> rows);
float cell_value(const MapPoints& points, std::size_t i, std::span<const float> values);

}  // namespace ecorche::inline v1
