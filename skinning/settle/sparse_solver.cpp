#include "skinning/settle/sparse_solver.h"

#include <oneapi/tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "anatomy/compute/simd.h"

namespace ecorche::inline v1 {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kWidest = 8;  // columns of a supernode, at most
// Least fraction of a supernode that is not zero. Smaller: more arithmetic on zeros; larger: more
// rows are looked up.
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

// Number of columns from `first` on that make one supernode: each is the first row beneath the one
// before it, so that their rows are nested.
int supernode_width(const std::vector<Column>& columns, std::size_t first) {
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

void add_supernode(const std::vector<Column>& columns, int first, int width,
                   SupernodalFactor& out) {
  const int end = first + width;
  const std::vector<int>& rows = columns[end - 1].rows;
  SupernodalFactor::Supernode supernode{first,
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
        out.corner[supernode.corner + (r - first) * width + k] = column.values[e];
      } else {
        const auto at = std::lower_bound(rows.begin(), rows.end(), r) - rows.begin();
        out.value[supernode.value + at * width + k] = column.values[e];
      }
    }
  }
  out.supernodes.push_back(supernode);
}

template <int kWidth>
void forward_substitute(const SupernodalFactor& m, const SupernodalFactor::Supernode& supernode,
                        float* x) {
  Float4 own[kWidth];
  const float* corner = &m.corner[supernode.corner];
  for (int k = 0; k < kWidth; ++k) {
    own[k] = load4(x + 4 * (supernode.first + k));
    for (int j = 0; j < k; ++j) own[k] -= corner[k * kWidth + j] * own[j];
    if (k > 0) store4(x + 4 * (supernode.first + k), own[k]);
  }
  const float* value = m.value.data() + supernode.value;
  const int* row = m.row.data() + supernode.row;
  for (int r = 0; r < supernode.rows; ++r, value += kWidth) {
    float* target = x + 4 * row[r];
    Float4 sum = load4(target);
    for (int k = 0; k < kWidth; ++k) sum -= value[k] * own[k];
    store4(target, sum);
  }
}

template <int kWidth>
void back_substitute(const SupernodalFactor& m, const SupernodalFactor::Supernode& supernode,
                     float* x) {
  Float4 own[kWidth];
  for (int k = 0; k < kWidth; ++k)
    own[k] = load4(x + 4 * (supernode.first + k)) * m.inverse_diagonal[supernode.first + k];
  const float* value = m.value.data() + supernode.value;
  const int* row = m.row.data() + supernode.row;
  for (int r = 0; r < supernode.rows; ++r, value += kWidth) {
    const Float4 beneath = load4(x + 4 * row[r]);
    for (int k = 0; k < kWidth; ++k) own[k] -= value[k] * beneath;
  }
  const float* corner = &m.corner[supernode.corner];
  for (int k = kWidth - 1; k >= 0; --k) {
    for (int j = k + 1; j < kWidth; ++j) own[k] -= corner[j * kWidth + k] * own[j];
    store4(x + 4 * (supernode.first + k), own[k]);
  }
}

using Step = void (*)(const SupernodalFactor&, const SupernodalFactor::Supernode&, float*);
constexpr Step kForward[] = {forward_substitute<1>, forward_substitute<2>, forward_substitute<3>,
                             forward_substitute<4>, forward_substitute<5>, forward_substitute<6>,
                             forward_substitute<7>, forward_substitute<8>};
constexpr Step kBack[] = {back_substitute<1>, back_substitute<2>, back_substitute<3>,
                          back_substitute<4>, back_substitute<5>, back_substitute<6>,
                          back_substitute<7>, back_substitute<8>};
static_assert(std::size(kForward) == kWidest && std::size(kBack) == kWidest);

// The elimination tree: of each supernode the one with the first row beneath it; -1: a root.
std::vector<int> parents_of(const SupernodalFactor& m) {
  std::vector<int> supernode_of(m.rows), out;
  for (std::size_t p = 0; p < m.supernodes.size(); ++p)
    for (int k = 0; k < m.supernodes[p].width; ++k)
      supernode_of[m.supernodes[p].first + k] = int(p);
  for (const SupernodalFactor::Supernode& supernode : m.supernodes)
    out.push_back(supernode.rows > 0 ? supernode_of[m.row[supernode.row]] : -1);
  return out;
}

// Of each supernode its subtree, or kSubtrees for the separator: the largest trees are cut from the
// root down until all are small, and distributed evenly by work.
std::vector<int> subtrees_of(const SupernodalFactor& m) {
  constexpr double kSmall = 0.1;  // of all the work
  const std::vector<int> parents = parents_of(m);
  const std::size_t count = m.supernodes.size();
  std::vector<double> work(count);
  double all = 0;
  for (std::size_t p = 0; p < count; ++p) {
    const double own = m.supernodes[p].width * (m.supernodes[p].rows + 1.0);
    all += own;
    work[p] += own;
    if (parents[p] >= 0) work[parents[p]] += work[p];  // a supernode comes before its parent
  }
  std::vector<int> out(count, SupernodalFactor::kSubtrees), roots;
  for (std::size_t p = count; p-- > 0;) {
    const bool below_separator = parents[p] < 0 || work[parents[p]] > kSmall * all;
    if (below_separator && work[p] <= kSmall * all) roots.push_back(int(p));
  }
  std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return work[a] > work[b]; });
  std::array<double, SupernodalFactor::kSubtrees> load{};
  for (const int root : roots) {
    const auto lightest = std::min_element(load.begin(), load.end());
    *lightest += work[root];
    out[root] = int(lightest - load.begin());
  }
  for (std::size_t p = count; p-- > 0;)
    if (parents[p] >= 0 && out[parents[p]] < SupernodalFactor::kSubtrees) out[p] = out[parents[p]];
  return out;
}

// Puts supernodes in the order of their subtrees, and rows in that of the supernodes.
void order_by_subtree(SupernodalFactor& m) {
  const std::vector<int> subtrees = subtrees_of(m);
  std::vector<SupernodalFactor::Supernode> supernodes;
  std::vector<int> moved(m.rows);
  int row = 0;
  for (int subtree = 0; subtree <= SupernodalFactor::kSubtrees; ++subtree) {
    m.subtree_begin[subtree] = supernodes.size();
    if (subtree == SupernodalFactor::kSubtrees) m.separator = m.rows - row;
    for (std::size_t p = 0; p < subtrees.size(); ++p) {
      if (subtrees[p] != subtree) continue;
      supernodes.push_back(m.supernodes[p]);
      for (int k = 0; k < m.supernodes[p].width; ++k) moved[m.supernodes[p].first + k] = row++;
    }
  }
  m.subtree_begin.back() = supernodes.size();
  std::vector<float> inverse(m.inverse_diagonal.size());
  for (std::size_t k = 0; k < inverse.size(); ++k) inverse[moved[k]] = m.inverse_diagonal[k];
  m.inverse_diagonal.swap(inverse);
  for (int& place : m.place) place = moved[place];
  for (int subtree = 0; subtree <= SupernodalFactor::kSubtrees; ++subtree)
    for (int p = m.subtree_begin[subtree]; p < m.subtree_begin[subtree + 1]; ++p) {
      SupernodalFactor::Supernode& supernode = supernodes[p];
      supernode.first = moved[supernode.first];
      for (int r = supernode.row; r < supernode.row + supernode.rows; ++r) {
        int& target = m.row[r];
        target = moved[target];
        if (subtree < SupernodalFactor::kSubtrees && target >= m.rows - m.separator)
          target += (subtree + 1) * m.separator;
      }
    }
  m.supernodes.swap(supernodes);
}

}  // namespace

SupernodalFactor factor_supernodal(const Sparse& A) {
  const Eigen::SimplicialLDLT<Sparse> solver(A);
  const auto lower = solver.matrixL();
  const std::vector<Column> columns = columns_of(lower.nestedExpression());
  SupernodalFactor out;
  out.rows = A.rows();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    out.place.push_back(solver.permutationP().indices()[i]);
    out.inverse_diagonal.push_back(float(1 / solver.vectorD()[i]));
  }
  for (int c = 0; c < int(A.cols());) {
    const int width = supernode_width(columns, std::size_t(c));
    add_supernode(columns, c, width, out);
    c += width;
  }
  order_by_subtree(out);
  return out;
}

void solve_supernodal(const SupernodalFactor& m, float* x) {
  const auto begin = [&](int subtree) { return m.subtree_begin[subtree]; };
  const auto forward = [&](int subtree) {
    for (int p = begin(subtree); p < begin(subtree + 1); ++p)
      kForward[m.supernodes[p].width - 1](m, m.supernodes[p], x);
  };
  const auto back = [&](int subtree) {
    for (int p = begin(subtree + 1); p-- > begin(subtree);)
      kBack[m.supernodes[p].width - 1](m, m.supernodes[p], x);
  };
  float* const separator = x + 4 * std::ptrdiff_t(m.rows - m.separator);
  const std::ptrdiff_t size = 4 * std::ptrdiff_t(m.separator);
  tbb::parallel_for(0, SupernodalFactor::kSubtrees, [&](int subtree) {
    std::fill_n(separator + (subtree + 1) * size, size, 0.0f);
    forward(subtree);
  });
  for (int subtree = 1; subtree <= SupernodalFactor::kSubtrees; ++subtree)
    for (std::ptrdiff_t k = 0; k < size; k += 4)
      store4(separator + k, load4(separator + k) + load4(separator + subtree * size + k));
  forward(SupernodalFactor::kSubtrees);
  back(SupernodalFactor::kSubtrees);
  tbb::parallel_for(0, SupernodalFactor::kSubtrees, [&](int subtree) {
    std::copy_n(separator, size, separator + (subtree + 1) * size);
    back(subtree);
  });
}

}  // namespace ecorche::inline v1
