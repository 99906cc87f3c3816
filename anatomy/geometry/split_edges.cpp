#include "anatomy/geometry/split_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace ecorche::inline v1 {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// The corner across each edge of a triangle mesh. An edge is found by its smaller vertex.
class EdgeTable {
 public:
  struct Edge {
    int other = 0;                      // the larger vertex
    std::array<int, 2> across{-1, -1};  // -1: a boundary
    int middle = -1;
  };

  EdgeTable(const Triangles& F, int vertices) : edges_(std::size_t(vertices)) {
    for (Eigen::Index f = 0; f < F.rows(); ++f)
      for (int k = 0; k < 3; ++k) add(F(f, k), F(f, (k + 1) % 3), F(f, (k + 2) % 3));
  }

  Edge* find(int a, int b) {
    if (b < a) std::swap(a, b);
    for (Edge& edge : edges_[std::size_t(a)])
      if (edge.other == b) return &edge;
    return nullptr;
  }

  // The corner across an edge that is not `but`; -1 where there is none.
  int across(int a, int b, int but) {
    const Edge* edge = find(a, b);
    return edge->across[0] == but ? edge->across[1] : edge->across[0];
  }

  template <class Do>
  void each(const Do& act) {
    for (std::size_t a = 0; a < edges_.size(); ++a)
      for (Edge& edge : edges_[a]) act(int(a), edge);
  }

 private:
  void add(int a, int b, int c) {
    if (Edge* edge = find(a, b)) {
      edge->across[1] = c;
      return;
    }
    edges_[std::size_t(std::min(a, b))].push_back({std::max(a, b), {c, -1}});
  }

  std::vector<std::vector<Edge>> edges_;
};

void add_middle(EdgeTable& table, int a, const EdgeTable::Edge& edge,
                std::vector<Eigen::Triplet<double>>& entries) {
  const int b = edge.other, row = edge.middle;
  std::vector<std::pair<int, double>> stencil{{a, 0.5}, {b, 0.5}};
  bool whole = true;
  for (const int c : edge.across) {
    if (c < 0) {
      whole = false;
      break;
    }
    stencil.emplace_back(c, 0.125);
    for (const int end : {a, b}) {
      const int wing = table.across(end, c, end == a ? b : a);
      whole = whole && wing >= 0;
      stencil.emplace_back(wing, -0.0625);
    }
  }
  if (!whole) stencil.resize(2);
  for (const auto& [vertex, weight] : stencil) entries.emplace_back(row, vertex, weight);
}

using Three = std::array<int, 3>;

// The triangles of one of whose edges 01, 12, 20 some are halved: 0 .. 2 are its corners, 3 .. 5
// the edges' middles. `at`: of these, where they are.
std::vector<Three> parts_of(const std::array<bool, 3>& halved, const std::array<Vec3, 6>& at) {
  const int count = int(std::count(halved.begin(), halved.end(), true));
  if (count == 0) return {{0, 1, 2}};
  if (count == 3) return {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}};
  // Turned so that of one middle it is on 01, and of two they are on 01 and 12.
  std::size_t t = 0;
  while (!halved[t] || (count == 2 && !halved[(t + 1) % 3])) ++t;
  const int a = int(t), b = int((t + 1) % 3), c = int((t + 2) % 3), m = 3 + a, n = 3 + b;
  if (count == 1) return {{a, m, c}, {m, b, c}};
  const auto far = [&](int i, int j) { return (at[std::size_t(i)] - at[std::size_t(j)]).norm(); };
  if (far(a, n) < far(m, c)) return {{m, b, n}, {a, m, n}, {a, n, c}};
  return {{m, b, n}, {a, m, c}, {m, n, c}};
}

// Of the corners and the edges' middles.
std::array<TextureCorner, 6> with_middles(const TextureCorner* corner) {
  return {corner[0],
          corner[1],
          corner[2],
          0.5f * (corner[0] + corner[1]),
          0.5f * (corner[1] + corner[2]),
          0.5f * (corner[2] + corner[0])};
}

void split_triangles(EdgeTable& table, const Points& V, Refinement& refinement,
                     std::vector<TextureCorner>& corners) {
  std::vector<int> triangles, parents;
  std::vector<TextureCorner> finer;
  for (Eigen::Index f = 0; f < refinement.F.rows(); ++f) {
    std::array<int, 6> vertex{};
    std::array<Vec3, 6> at;
    std::array<bool, 3> halved{};
    for (std::size_t k = 0; k < 3; ++k) vertex[k] = refinement.F(f, Eigen::Index(k));
    for (std::size_t k = 0; k < 3; ++k) {
      vertex[3 + k] = table.find(vertex[k], vertex[(k + 1) % 3])->middle;
      halved[k] = vertex[3 + k] >= 0;
    }
    for (std::size_t k = 0; k < 6; ++k)
      if (vertex[k] >= 0) at[k] = V.row(vertex[k]);
    std::array<TextureCorner, 6> places;
    if (!corners.empty()) places = with_middles(&corners[3 * std::size_t(f)]);
    for (const Three& part : parts_of(halved, at)) {
      for (const int k : part) triangles.push_back(vertex[std::size_t(k)]);
      if (!corners.empty())
        for (const int k : part) finer.push_back(places[std::size_t(k)]);
      if (!refinement.parents.empty()) parents.push_back(refinement.parents[std::size_t(f)]);
    }
  }
  refinement.F =
      Eigen::Map<const Triangles>(triangles.data(), Eigen::Index(triangles.size() / 3), 3);
  refinement.parents = std::move(parents);
  corners = std::move(finer);
}

// False where no edge was too long.
bool split_once(Refinement& refinement, Points& V,
                const std::function<double(const Vec3&)>& longest,
                std::vector<TextureCorner>& corners) {
  const int vertices = int(V.rows());
  EdgeTable table(refinement.F, vertices);
  int next = vertices;
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < vertices; ++v) entries.emplace_back(v, v, 1);
  table.each([&](int a, EdgeTable::Edge& edge) {
    const Vec3 p = V.row(a), q = V.row(edge.other);
    if ((p - q).norm() > longest(0.5 * (p + q))) edge.middle = next++;
  });
  if (next == vertices) return false;
  table.each([&](int a, const EdgeTable::Edge& edge) {
    if (edge.middle >= 0) add_middle(table, a, edge, entries);
  });
  Matrix step(next, vertices);
  step.setFromTriplets(entries.begin(), entries.end());
  V = Points(step * V);
  refinement.map = Matrix(step * refinement.map);
  split_triangles(table, V, refinement, corners);
  return true;
}

}  // namespace

Refinement split_long_edges(const Refinement& refinement, Points& fine,
                            const std::function<double(const Vec3&)>& longest,
                            std::vector<TextureCorner>& corners, int rounds) {
  Refinement out = refinement;
  for (int round = 0; round < rounds; ++round)
    if (!split_once(out, fine, longest, corners)) break;
  return out;
}

}  // namespace ecorche::inline v1
