// Velocities of a body under contacts with Coulomb friction, and under limits.
//
// They minimise  1/2 (v - u)' A (v - u) + sum_b s_b(J_b v - t_b),  u what they would be without
// constraints. The penalty s_b of a block is half the squared distance, over its softness, from the
// velocities that need no force; its gradient is an impulse within the friction cone (the convex
// contact of Anitescu 2006, 10.1007/s10107-005-0590-7, softened as by Todorov 2014,
// 10.1109/ICRA.2014.6907751). By Newton's method with an exact search along the line: the order of
// the blocks does not matter, so that a symmetric body stays symmetric.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace ecorche::inline v1 {

// A limit (one column), or a contact: the normal's column, then two of the plane.
struct ConeBlock {
  int first = 0;  // column
  bool contact = false;
  double friction = 0;  // of a contact
  double softness = 0;  // m/s by N s, or rad/s by N m s; set by ConeSolver::soften()
};

class ConeSolver {
 public:
  // A #freedoms square, symmetric and positive definite; b = A u. Forgets all blocks.
  void begin(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
  // The velocity u without constraints.
  const Eigen::VectorXd& free_velocity() const { return free_; }
  // Columns of a new block: velocity along column k is column(k)' v. The impulse pushes along the
  // first column, as soon as the velocity there is below the target. Columns stay until begin().
  int add_limit(double target);
  int add_contact(double friction, const Eigen::Vector3d& target);
  auto column(int k) { return columns_.col(k); }
  // Minimises from `v` and puts the result there. Softness: as a share of what the body itself
  // yields along the first column. Returns how many steps it took.
  int solve(double softness, Eigen::VectorXd& v);
  const std::vector<ConeBlock>& blocks() const { return blocks_; }
  // Impulses of the last solve(), one a column, N s or N m s.
  const Eigen::VectorXd& impulses() const { return impulses_; }

 private:
  void reserve_columns(int count);
  void soften(double share);
  // Impulses at velocities of the columns; `curved`: also the factors of their slope.
  void press(const Eigen::VectorXd& along, bool curved);
  double search(const Eigen::VectorXd& step, const Eigen::VectorXd& along_v);

  Eigen::MatrixXd A_, factor_, columns_, curvature_, hessian_;
  Eigen::VectorXd free_, target_, impulses_, gradient_, along_, along_step_, trial_, step_, pull_;
  std::vector<ConeBlock> blocks_;
  int used_ = 0, curved_ = 0;
};

}  // namespace ecorche::inline v1
