// A factored sparse matrix that is solved for three right sides at once, every frame. Private to the room.
//
// L D L^T by columns; columns of nearly the same rows lie together as a panel, stored by rows, so that a row's place in memory is
// looked up once for all of them (Liu, Ng & Peyton 1993, 10.1137/0614019).
#pragma once

#include <span>
#include <vector>

#include <Eigen/SparseCore>

namespace ecorche {

struct SheetFactor {
  struct Panel {
    int first = 0, width = 0;      // columns
    int row = 0, rows = 0;         // into `row`: the rows beneath the panel
    int value = 0, corner = 0;     // into `value`: rows x width; `corner`: the triangle within the panel, width x width
  };
  std::vector<int> place;          // row of the matrix -> row of the factor
  std::vector<Panel> panels;
  std::vector<int> row;
  std::vector<float> value, corner, inverse_diagonal;
};

// Precondition: symmetric and positive definite.
SheetFactor factor_sheet(const Eigen::SparseMatrix<double>& A);

// In place; `x`: four floats a row, in the factor's order.
void solve_sheet(const SheetFactor& factor, float* x);

}  // namespace ecorche
