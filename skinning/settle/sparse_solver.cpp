#include "skinning/settle/sparse_solver.h"

#include <oneapi/tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "anatomy/compute/simd.h"

namespace ecorche {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kWidest = 8;
// of a panel, at least; the rest are zeros that are worth their place
constexpr double kFilled = 0.75;

struct Column {
  std::vector<int> rows;  // beneath the diagonal, ascending
  std::vector<float> values;
};

std::vector<Column> columns_of(const Sparse& L) {
  std::vector<Column> out(L.cols());
  for (Eigen::Index c = 0; c < L.cols(); ++c)
    for (Sparse::InnerIterator it(L, c); it; ++it) {
      if (it.row() <= c) continue;
      out[c].rows.push_back(int(it.row()));
      out[c].values.push_back(float(it.value()));
    }
  return out;
}

// How many columns from `first` on make one panel: each is the first row beneath the one before it,
// so that their rows are nested.
int panel_width(const std::vector<Column>& columns, std::size_t first) {
  std::size_t filled = columns[first].rows.size();
  int width = 1;
  for (std::size_t c = first + 1; c < columns.size() && width < kWidest; ++c, ++width) {
    const std::vector<int>& above = columns[c - 1].rows;
    if (above.empty() || above.front() != int(c)) break;
    filled += columns[c].rows.size();
    const double inside = 0.5 * width * (width + 1),
                 whole = inside + double(columns[c].rows.size()) * (width + 1);
    if (double(filled) < kFilled * whole) break;
  }
  return width;
}

void add_panel(const std::vector<Column>& columns, int first, int width, SheetFactor& out) {
  const int end = first + width;
  const std::vector<int>& rows = columns[end - 1].rows;
  SheetFactor::Panel panel{first,
                           width,
                           int(out.row.size()),
                           int(rows.size()),
                           int(out.value.size()),
                           int(out.corner.size())};
  out.row.insert(out.row.end(), rows.begin(), rows.end());
  out.value.resize(out.value.size() + rows.size() * std::size_t(width));
  out.corner.resize(out.corner.size() + std::size_t(width * width));
  for (int k = 0; k < width; ++k) {
    const Column& column = columns[first + k];
    for (std::size_t e = 0; e < column.rows.size(); ++e) {
      const int r = column.rows[e];
      if (r < end) {
        out.corner[panel.corner + (r - first) * width + k] = column.values[e];
      } else {
        const auto at = std::lower_bound(rows.begin(), rows.end(), r) - rows.begin();
        out.value[panel.value + at * width + k] = column.values[e];
      }
    }
  }
  out.panels.push_back(panel);
}

template <int kWidth>
void go_down(const SheetFactor& m, const SheetFactor::Panel& panel, float* x) {
  Float4 own[kWidth];
  const float* corner = &m.corner[panel.corner];
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
  for (int k = 0; k < kWidth; ++k)
    own[k] = load4(x + 4 * (panel.first + k)) * m.inverse_diagonal[panel.first + k];
  const float* value = m.value.data() + panel.value;
  const int* row = m.row.data() + panel.row;
  for (int r = 0; r < panel.rows; ++r, value += kWidth) {
    const Float4 beneath = load4(x + 4 * row[r]);
    for (int k = 0; k < kWidth; ++k) own[k] -= value[k] * beneath;
  }
  const float* corner = &m.corner[panel.corner];
  for (int k = kWidth - 1; k >= 0; --k) {
    for (int j = k + 1; j < kWidth; ++j) own[k] -= corner[j * kWidth + k] * own[j];
    store4(x + 4 * (panel.first + k), own[k]);
  }
}

using Step = void (*)(const SheetFactor&, const SheetFactor::Panel&, float*);
constexpr Step kDown[] = {go_down<1>, go_down<2>, go_down<3>, go_down<4>,
                          go_down<5>, go_down<6>, go_down<7>, go_down<8>};
constexpr Step kUp[] = {go_up<1>, go_up<2>, go_up<3>, go_up<4>,
                        go_up<5>, go_up<6>, go_up<7>, go_up<8>};
static_assert(std::size(kDown) == kWidest && std::size(kUp) == kWidest);

// Which panel hangs on which: the one with the first row beneath it; -1: none.
std::vector<int> parents_of(const SheetFactor& m) {
  std::vector<int> panel_of(m.rows), out;
  for (std::size_t p = 0; p < m.panels.size(); ++p)
    for (int k = 0; k < m.panels[p].width; ++k) panel_of[m.panels[p].first + k] = int(p);
  for (const SheetFactor::Panel& panel : m.panels)
    out.push_back(panel.rows > 0 ? panel_of[m.row[panel.row]] : -1);
  return out;
}

// A panel's branch, or kBranches for the crown: the largest trees of panels are taken apart from
// above until all are small, and dealt out.
std::vector<int> branches_of(const SheetFactor& m) {
  constexpr double kSmall = 0.1;  // of all the work
  const std::vector<int> parents = parents_of(m);
  const std::size_t count = m.panels.size();
  std::vector<double> work(count);
  double all = 0;
  for (std::size_t p = 0; p < count; ++p) {
    const double own = m.panels[p].width * (m.panels[p].rows + 1.0);
    all += own;
    work[p] += own;
    if (parents[p] >= 0) work[parents[p]] += work[p];  // a panel comes before what it hangs on
  }
  std::vector<int> out(count, SheetFactor::kBranches), roots;
  for (std::size_t p = count; p-- > 0;) {
    const bool below_crown = parents[p] < 0 || work[parents[p]] > kSmall * all;
    if (below_crown && work[p] <= kSmall * all) roots.push_back(int(p));
  }
  std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return work[a] > work[b]; });
  std::array<double, SheetFactor::kBranches> load{};
  for (const int root : roots) {
    const auto lightest = std::min_element(load.begin(), load.end());
    *lightest += work[root];
    out[root] = int(lightest - load.begin());
  }
  for (std::size_t p = count; p-- > 0;)
    if (parents[p] >= 0 && out[parents[p]] < SheetFactor::kBranches) out[p] = out[parents[p]];
  return out;
}

// Puts panels in the order of their branches, and rows in that of the panels.
void part_branches(SheetFactor& m) {
  const std::vector<int> branches = branches_of(m);
  std::vector<SheetFactor::Panel> panels;
  std::vector<int> moved(m.rows);
  int row = 0;
  for (int branch = 0; branch <= SheetFactor::kBranches; ++branch) {
    m.branch_begin[branch] = panels.size();
    if (branch == SheetFactor::kBranches) m.crown = m.rows - row;
    for (std::size_t p = 0; p < branches.size(); ++p) {
      if (branches[p] != branch) continue;
      panels.push_back(m.panels[p]);
      for (int k = 0; k < m.panels[p].width; ++k) moved[m.panels[p].first + k] = row++;
    }
  }
  m.branch_begin.back() = panels.size();
  std::vector<float> inverse(m.inverse_diagonal.size());
  for (std::size_t k = 0; k < inverse.size(); ++k) inverse[moved[k]] = m.inverse_diagonal[k];
  m.inverse_diagonal.swap(inverse);
  for (int& place : m.place) place = moved[place];
  for (int branch = 0; branch <= SheetFactor::kBranches; ++branch)
    for (int p = m.branch_begin[branch]; p < m.branch_begin[branch + 1]; ++p) {
      SheetFactor::Panel& panel = panels[p];
      panel.first = moved[panel.first];
      for (int r = panel.row; r < panel.row + panel.rows; ++r) {
        int& target = m.row[r];
        target = moved[target];
        if (branch < SheetFactor::kBranches && target >= m.rows - m.crown)
          target += (branch + 1) * m.crown;
      }
    }
  m.panels.swap(panels);
}

}  // namespace

SheetFactor factor_sheet(const Sparse& A) {
  const Eigen::SimplicialLDLT<Sparse> solver(A);
  const auto lower = solver.matrixL();
  const std::vector<Column> columns = columns_of(lower.nestedExpression());
  SheetFactor out;
  out.rows = A.rows();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    out.place.push_back(solver.permutationP().indices()[i]);
    out.inverse_diagonal.push_back(float(1 / solver.vectorD()[i]));
  }
  for (int c = 0; c < int(A.cols());) {
    const int width = panel_width(columns, std::size_t(c));
    add_panel(columns, c, width, out);
    c += width;
  }
  part_branches(out);
  return out;
}

void solve_sheet(const SheetFactor& m, float* x) {
  const auto begin = [&](int branch) { return m.branch_begin[branch]; };
  const auto down = [&](int branch) {
    for (int p = begin(branch); p < begin(branch + 1); ++p)
      kDown[m.panels[p].width - 1](m, m.panels[p], x);
  };
  const auto up = [&](int branch) {
    for (int p = begin(branch + 1); p-- > begin(branch);)
      kUp[m.panels[p].width - 1](m, m.panels[p], x);
  };
  float* const crown = x + 4 * std::ptrdiff_t(m.rows - m.crown);
  const std::ptrdiff_t size = 4 * std::ptrdiff_t(m.crown);
  tbb::parallel_for(0, SheetFactor::kBranches, [&](int branch) {
    std::fill_n(crown + (branch + 1) * size, size, 0.0f);
    down(branch);
  });
  for (int branch = 1; branch <= SheetFactor::kBranches; ++branch)
    for (std::ptrdiff_t k = 0; k < size; k += 4)
      store4(crown + k, load4(crown + k) + load4(crown + branch * size + k));
  down(SheetFactor::kBranches);
  up(SheetFactor::kBranches);
  tbb::parallel_for(0, SheetFactor::kBranches, [&](int branch) {
    std::copy_n(crown, size, crown + (branch + 1) * size);
    up(branch);
  });
}

}  // namespace ecorche
