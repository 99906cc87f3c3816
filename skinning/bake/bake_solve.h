// Curves and helpers of one frame, solved together. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche {

// What every frame is solved with: influences and shapes that no longer change.
class Settler {
 public:
  // `shapes`: 3 #V x #shapes, rest pose, m. `helpers`: rest places of the last bones of every
  // frame. `rest` and `influences` must outlive it.
  Settler(const Points& rest, const Eigen::MatrixXf& shapes,
          std::span<const std::array<Influence, 4>> influences, std::vector<Vec3> helpers);

  // Moves the helpers of `frame`, from where they are, and sets the curves, from zero, so that the
  // largest errors fall and then the rest: Newton's steps on the cost of bake_cost.h. Curves and
  // helpers that hardly help hardly move. A function of the frame alone.
  void settle(BakeFrame& frame, Eigen::VectorXf& curves) const;

  // The same by the sum of squares alone, in one step: settle()'s first, a tenth of the work.
  void settle_evenly(BakeFrame& frame, Eigen::VectorXf& curves) const;

  // How far each vertex is off. #V, m
  Eigen::VectorXd distances(const BakeFrame& frame, const Eigen::VectorXf& curves) const;

 private:
  struct Offset {
    Eigen::Index shape;
    Vec3 offset;
  };
  struct System;
  Vec3 shaped(std::size_t vertex, const Eigen::VectorXf& curves) const;
  void add_vertex(std::size_t vertex, const BakeFrame& frame, const Eigen::VectorXf& curves,
                  bool even, System& system) const;
  Eigen::VectorXd solve(const BakeFrame& frame, const Eigen::VectorXf& curves, bool even,
                        System& system) const;
  void step(const Eigen::VectorXd& by, double length, std::vector<Transform>& bones,
            Eigen::VectorXf& curves) const;

  const Points& rest_;
  std::span<const std::array<Influence, 4>> influences_;
  std::vector<Vec3> helpers_;
  Eigen::Index morphs_;
  std::vector<std::vector<Offset>> offsets_;  // by vertex
};

}  // namespace ecorche
