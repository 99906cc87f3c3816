// A factored sparse matrix that is solved for three right sides at once, every frame. Private to
// the room.
//
// L D L^T by columns; columns of nearly the same rows lie together as a panel, stored by rows, so
// that a row's place in memory is looked up once for all of them (Liu, Ng & Peyton
// 1993, 10.1137/0614019). Columns that no chain of rows joins, as those of two limbs, are solved at
// the same time: they are dealt out to branches, and what joins these, the crown, comes last. What
// a branch takes from the crown is kept apart and summed up in a fixed order.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/SparseCore>

namespace ecorche {

struct SheetFactor {
  struct Panel {
    int first = 0, width = 0;  // columns
    int row = 0, rows = 0;     // into `row`: the rows beneath the panel
    // into `value`: rows x width; `corner`: the triangle within the panel, width x width
    int value = 0, corner = 0;
  };
  static constexpr int kBranches = 4;
  int rows = 0, crown = 0;                        // of the matrix; the crown are the last rows
  std::vector<int> place;                         // row of the matrix -> row of the factor
  std::vector<Panel> panels;                      // by branch, then the crown's
  std::array<int, kBranches + 2> branch_begin{};  // into panels
  std::vector<int> row;
  std::vector<float> value, corner, inverse_diagonal;
};

// Precondition: symmetric and positive definite.
SheetFactor factor_sheet(const Eigen::SparseMatrix<double>& A);

// Rows that solve_sheet() works on: the matrix's, and a copy of the crown's for each branch.
inline std::size_t work_rows(const SheetFactor& factor) {
  return std::size_t(factor.rows) + SheetFactor::kBranches * std::size_t(factor.crown);
}

// In place; `x`: four floats a row, work_rows() of them, the matrix's first, in the factor's order.
// Same bytes at any number of threads.
void solve_sheet(const SheetFactor& factor, float* x);

}  // namespace ecorche
