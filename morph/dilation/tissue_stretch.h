// How the flesh between bones and skin has to stretch so that it fills its room.
//
// At samples of the skin a ray goes inwards: it meets the outermost muscle at depth g, and bone at
// depth d (or nothing: d is then a fixed depth). Muscles have the height H = d - g above the bone
// and the room D = d - layer. Smooth means over the neighbourhood tell how far the outermost
// muscles have to go, D - H; what lies at a height h above the bone goes h / H of it: deep muscles
// little, the outermost ones up to the layer, all in proportion, so that neighbours stay
// neighbours.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

struct TissuePull {
  Vec3 outwards = Vec3::UnitY();  // unit
  double stretch = 1;             // of lengths along `outwards`
  double shift = 0;               // of this point along `outwards`, m
  double free = 0;                // from this point to the layer, m
  // over bone, m: this point, the outermost muscle, and the layer
  double height = 0, tall = 0, room = 0;
};

class TissueStretch {
 public:
  // `anatomy`: bones, and which joints the muscles ride on, inside the skin of `rays`. Bones do not
  // change between the calls.
  TissueStretch(const Anatomy& anatomy, const SkinRays& rays, const FatLayer& fat);

  // Finds out how far the muscles reach. `slices`: all sections of the anatomy's muscles in order,
  // wherever they are by now.
  void look_at(std::span<const Ellipse> slices);

  // For a point of a muscle: samples over bones that the muscle has nothing to do with (the other
  // thigh, the arm beside the trunk) do not count. Precondition: look_at was called.
  TissuePull at(const Vec3& point, int muscle) const;

  long long rays() const { return rays_; }

 private:
  struct Sample {
    Vec3 position, normal;
    double bone = 0;    // depth d, m
    double layer = 0;   // of fat and skin; thinner where the bone is near
    double room = 0;    // D
    double height = 0;  // H
    double weight = 0;  // 0 where there is no muscle
    int region = -1;    // of the bone below; -1 where none is met
  };
  struct Near {
    const Sample* sample;
    double squared;  // distance from the point
  };
  void sort_into_cells();
  void collect(const Vec3& point, double radius, const std::vector<char>& concerns,
               std::vector<Near>& found) const;

  std::vector<Sample> samples_;  // in the order of their cells
  Vec3 corner_ = Vec3::Zero();   // of the search grid
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<int> cell_begin_;              // #cells + 1
  std::vector<std::vector<char>> concerns_;  // #muscles x #regions
  // slices of strips, from and to; those of muscles in the layer of fat are left out
  std::vector<std::pair<int, int>> strips_;
  long long rays_ = 0;
};

}  // namespace ecorche::inline v1
