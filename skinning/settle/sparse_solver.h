// Supernodal L D L^T factor of a sparse matrix, solved for three right sides at once in every
// frame. Private to the room.
//
// Columns with nearly the same rows form a supernode, stored by rows, so that a row's place in
// memory is looked up once for all of them (Liu, Ng & Peyton 1993, 10.1137/0614019). Columns that
// no chain of rows joins, as those of two limbs, are solved at the same time: the elimination tree
// is cut into subtrees; the separator that joins them comes last. A subtree's updates of the
// separator are kept apart and added in a fixed order.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/SparseCore>

namespace ecorche::inline v1 {

struct SupernodalFactor {
  struct Supernode {
    int first = 0, width = 0;  // columns
    int row = 0, rows = 0;     // into `row`: the rows beneath the supernode
    // into `value`: rows x width; `corner`: the triangle within the supernode, width x width
    int value = 0, corner = 0;
  };
  static constexpr int kSubtrees = 4;
  int rows = 0, separator = 0;  // rows of the matrix; of these the last ones are the separator's
  std::vector<int> place;       // row of the matrix -> row of the factor
  std::vector<Supernode> supernodes;               // by subtree, then the separator's
  std::array<int, kSubtrees + 2> subtree_begin{};  // into supernodes
  std::vector<int> row;
  std::vector<float> value, corner, inverse_diagonal;
};

// Precondition: symmetric and positive definite.
SupernodalFactor factor_supernodal(const Eigen::SparseMatrix<double>& A);

// Rows that solve_supernodal() works on: the matrix's, and a copy of the separator's for each
// subtree.
inline std::size_t work_rows(const SupernodalFactor& factor) {
  return std::size_t(factor.rows) + SupernodalFactor::kSubtrees * std::size_t(factor.separator);
}

// In place; `x`: four floats a row, work_rows() of them, the matrix's first, in the factor's order.
// Same bytes at any number of threads.
void solve_supernodal(const SupernodalFactor& factor, float* x);

}  // namespace ecorche::inline v1
