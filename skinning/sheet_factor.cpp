#include "skinning/sheet_factor.h"

#include <algorithm>

#include <Eigen/SparseCholesky>

#include "skinning/float4.h"

namespace ecorche {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kWidest = 8;
constexpr double kFilled = 0.75;  // of a panel, at least; the rest are zeros that are worth their place

struct Column {
  std::vector<int> rows;  // beneath the diagonal, ascending
  std::vector<float> values;
};

std::vector<Column> columns_of(const Sparse& L) {
  std::vector<Column> out(static_cast<std::size_t>(L.cols()));
  for (Eigen::Index c = 0; c < L.cols(); ++c)
    for (Sparse::InnerIterator it(L, c); it; ++it) {
      if (it.row() <= c) continue;
      out[static_cast<std::size_t>(c)].rows.push_back(static_cast<int>(it.row()));
      out[static_cast<std::size_t>(c)].values.push_back(static_cast<float>(it.value()));
    }
  return out;
}

// How many columns from `first` on make one panel: each is the first row beneath the one before it, so that their rows are nested.
int panel_width(const std::vector<Column>& columns, std::size_t first) {
  std::size_t filled = columns[first].rows.size();
  int width = 1;
  for (std::size_t c = first + 1; c < columns.size() && width < kWidest; ++c, ++width) {
    const std::vector<int>& above = columns[c - 1].rows;
    if (above.empty() || above.front() != static_cast<int>(c)) break;
    filled += columns[c].rows.size();
    const double inside = 0.5 * width * (width + 1), whole = inside + static_cast<double>(columns[c].rows.size()) * (width + 1);
    if (static_cast<double>(filled) < kFilled * whole) break;
  }
  return width;
}

void add_panel(const std::vector<Column>& columns, int first, int width, SheetFactor& out) {
  const int end = first + width;
  const std::vector<int>& rows = columns[static_cast<std::size_t>(end - 1)].rows;
  SheetFactor::Panel panel{first, width, static_cast<int>(out.row.size()), static_cast<int>(rows.size()), static_cast<int>(out.value.size()),
                           static_cast<int>(out.corner.size())};
  out.row.insert(out.row.end(), rows.begin(), rows.end());
  out.value.resize(out.value.size() + rows.size() * static_cast<std::size_t>(width));
  out.corner.resize(out.corner.size() + static_cast<std::size_t>(width * width));
  for (int k = 0; k < width; ++k) {
    const Column& column = columns[static_cast<std::size_t>(first + k)];
    for (std::size_t e = 0; e < column.rows.size(); ++e) {
      const int r = column.rows[e];
      if (r < end) {
        out.corner[static_cast<std::size_t>(panel.corner + (r - first) * width + k)] = column.values[e];
      } else {
        const auto at = std::lower_bound(rows.begin(), rows.end(), r) - rows.begin();
        out.value[static_cast<std::size_t>(panel.value + at * width + k)] = column.values[e];
      }
    }
  }
  out.panels.push_back(panel);
}

template <int kWidth>
void go_down(const SheetFactor& m, const SheetFactor::Panel& panel, float* x) {
  Float4 own[kWidth];
  const float* corner = &m.corner[static_cast<std::size_t>(panel.corner)];
  for (int k = 0; k < kWidth; ++k) {
    own[k] = load4(x + 4 * (panel.first + k));
    for (int j = 0; j < k; ++j) own[k] -= corner[k * kWidth + j] * own[j];
    if (k > 0) store4(x + 4 * (panel.first + k), own[k]);
  }
  const float* value = m.value.data() + panel.value;
  const int* row = m.row.data() + panel.row;
  for (int r = 0; r < panel.rows; ++r, value += kWidth) {
    float* target = x + 4 * row[r];
    Float4 sum = load4(target);
    for (int k = 0; k < kWidth; ++k) sum -= value[k] * own[k];
    store4(target, sum);
  }
}

template <int kWidth>
void go_up(const SheetFactor& m, const SheetFactor::Panel& panel, float* x) {
  Float4 own[kWidth];
  for (int k = 0; k < kWidth; ++k) own[k] = load4(x + 4 * (panel.first + k)) * m.inverse_diagonal[static_cast<std::size_t>(panel.first + k)];
  const float* value = m.value.data() + panel.value;
  const int* row = m.row.data() + panel.row;
  for (int r = 0; r < panel.rows; ++r, value += kWidth) {
    const Float4 beneath = load4(x + 4 * row[r]);
    for (int k = 0; k < kWidth; ++k) own[k] -= value[k] * beneath;
  }
  const float* corner = &m.corner[static_cast<std::size_t>(panel.corner)];
  for (int k = kWidth - 1; k >= 0; --k) {
    for (int j = k + 1; j < kWidth; ++j) own[k] -= corner[j * kWidth + k] * own[j];
    store4(x + 4 * (panel.first + k), own[k]);
  }
}

using Step = void (*)(const SheetFactor&, const SheetFactor::Panel&, float*);
constexpr Step kDown[] = {go_down<1>, go_down<2>, go_down<3>, go_down<4>, go_down<5>, go_down<6>, go_down<7>, go_down<8>};
constexpr Step kUp[] = {go_up<1>, go_up<2>, go_up<3>, go_up<4>, go_up<5>, go_up<6>, go_up<7>, go_up<8>};
static_assert(std::size(kDown) == kWidest && std::size(kUp) == kWidest);

}  // namespace

SheetFactor factor_sheet(const Sparse& A) {
  const Eigen::SimplicialLDLT<Sparse> solver(A);
  const auto lower = solver.matrixL();
  const std::vector<Column> columns = columns_of(lower.nestedExpression());
  SheetFactor out;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    out.place.push_back(solver.permutationP().indices()[i]);
    out.inverse_diagonal.push_back(static_cast<float>(1 / solver.vectorD()[i]));
  }
  for (int c = 0; c < static_cast<int>(A.cols());) {
    const int width = panel_width(columns, static_cast<std::size_t>(c));
    add_panel(columns, c, width, out);
    c += width;
  }
  return out;
}

void solve_sheet(const SheetFactor& factor, float* x) {
  for (const SheetFactor::Panel& panel : factor.panels) kDown[panel.width - 1](factor, panel, x);
  for (auto panel = factor.panels.rbegin(); panel != factor.panels.rend(); ++panel) kUp[panel->width - 1](factor, *panel, x);
}

}  // namespace ecorche
