// Curves and helpers of one frame, solved together. Private to the room.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche::inline v1 {

// Solves frames with fixed influences and shapes.
class FrameSolver {
 public:
  // `shapes`: 3 #V x #shapes, rest pose, m. `helpers`: rest places of the last bones of every
  // frame. `rest` and `influences` must outlive it.
  FrameSolver(const Points& rest, const Eigen::MatrixXf& shapes,
              std::span<const std::array<Influence, 4>> influences, std::vector<Vec3> helpers);

  // Moves the helpers of `frame`, from their given frames, and sets the curves, from zero, by
  // damped Newton steps on the cost of bake_cost.h. A ridge holds curves and helpers with little
  // effect. Depends on the one frame alone.
  void solve(BakeFrame& frame, Eigen::VectorXf& curves) const;

  // The same for the sum of squares, in one step: the first of solve(), a tenth of the work.
  void solve_least_squares(BakeFrame& frame, Eigen::VectorXf& curves) const;

  // Error of each vertex. #V, m
  Eigen::VectorXd distances(const BakeFrame& frame, const Eigen::VectorXf& curves) const;

 private:
  struct Offset {
    Eigen::Index shape;
    Vec3 offset;
  };
  struct System;
  Vec3 shaped(std::size_t vertex, const Eigen::VectorXf& curves) const;
  void add_vertex(std::size_t vertex, const BakeFrame& frame, const Eigen::VectorXf& curves,
                  bool least_squares, System& system) const;
  Eigen::VectorXd newton_step(const BakeFrame& frame, const Eigen::VectorXf& curves,
                              bool least_squares, System& system) const;
  void step(const Eigen::VectorXd& by, double length, std::vector<Transform>& bones,
            Eigen::VectorXf& curves) const;

  const Points& rest_;
  std::span<const std::array<Influence, 4>> influences_;
  std::vector<Vec3> helpers_;
  Eigen::Index morphs_;
  std::vector<std::vector<Offset>> offsets_;  // by vertex
};

}  // namespace ecorche::inline v1
