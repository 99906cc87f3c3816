// The one linear system of a step: velocities of the sheet's nodes and of the body at its end, by
// implicit Euler (Baraff and Witkin 1998, 10.1145/280814.280821).
//
// Rows of the sheet are sparse with the pattern of its edges, which contacts within a triangle do
// not change; they are eliminated first, and what is left is dense with one row a freedom of the
// body. Symmetric and positive definite.
#pragma once

#include <memory>

#include "anatomy/types.h"
#include "skinning/lift/sheet.h"
#include "skinning/multibody/articulated_body.h"

namespace ecorche::inline v1 {

class ContactSystem {
 public:
  // `sheet` null: the body alone.
  ContactSystem(const Sheet* sheet, int freedoms);
  ~ContactSystem();
  ContactSystem(ContactSystem&&) noexcept;
  ContactSystem& operator=(ContactSystem&&) noexcept;

  void clear();
  void add_body(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
  void add_node(int node, const Mat3& A, const Vec3& b);
  // A times the difference of the velocities of a spring's ends; b: on its node a, against it on b.
  void add_spring(int spring, const Mat3& A, const Vec3& b);
  // B times the velocity of a point of a joint, `arm` from its origin, world, less that of a point
  // of a triangle; r: on the body, against it on the triangle. triangle -1: on the body alone.
  void add_contact(int joint, const Vec3& arm, int triangle, const Vec3& corners, const Mat3& B,
                   const Vec3& r);
  // Adds what contacts have put on joints, eliminates, solves. nodes: #V x 3, body: #freedoms.
  void solve(const BodyFrames& frames, Points& nodes, Eigen::VectorXd& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche::inline v1
