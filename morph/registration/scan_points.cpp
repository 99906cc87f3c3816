#include "morph/registration/scan_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace ecorche::inline v1 {
namespace {

constexpr int kWhole = 400'000;  // faces or bare points that are kept as they are

// Cells of space by number, 21 bits an axis.
std::uint64_t cell_key(const Vec3& p, double width) {
  constexpr std::int64_t kHalf = 1 << 20;
  const auto axis = [&](double x) {
    return std::uint64_t(
        std::clamp<std::int64_t>(std::int64_t(std::floor(x / width)) + kHalf, 0, 2 * kHalf - 1));
  };
  return axis(p.x()) << 42 | axis(p.y()) << 21 | axis(p.z());
}

// Sums of what falls into each cell; cells grow when they get too many.
class ThinningGrid {
 public:
  explicit ThinningGrid(double width) : width_(width) { cells_.reserve(1 << 19); }

  // A bit of surface (normal as long as its area) or a bare point (zero normal, weight 1).
  void add(const Vec3& p, const Vec3& normal, double weight, bool covering) {
    Cell& cell = cells_[key_of(p, normal, covering)];
    cell.weight += weight;
    cell.sum += weight * p;
    cell.normal += normal;
    if (cells_.size() > kMost) widen();
  }

  double width() const { return width_; }

  void write(Scan& scan) const {
    std::vector<std::uint64_t> keys;
    keys.reserve(cells_.size());
    for (const auto& [key, cell] : cells_) keys.push_back(key);
    std::ranges::sort(keys);
    const Eigen::Index n = keys.size();
    scan.points.resize(n, 3);
    scan.normals.resize(n, 3);
    scan.area.resize(n);
    scan.covering.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Cell& cell = cells_.at(keys[i]);
      scan.points.row(i) = cell.sum / cell.weight;
      scan.normals.row(i) = cell.normal.stableNormalized();
      scan.area[i] = float(cell.normal.norm());
      scan.covering[i] = char(keys[i] & 1);
    }
  }

 private:
  struct Cell {
    double weight = 0;
    Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
  };
  struct Mix {
    std::size_t operator()(std::uint64_t x) const {
      x = (x ^ (x >> 31)) * 0x9E3779B97F4A7C15u;
      return x ^ (x >> 29);
    }
  };
  static constexpr std::size_t kMost = 2'000'000;

  // 20 bits an axis, 3 for the side that a surface faces, 1 for covering
  std::uint64_t key_of(const Vec3& p, const Vec3& normal, bool covering) const {
    std::uint64_t side = 0;
    if (normal.squaredNorm() > 0) {
      int axis = 0;
      normal.cwiseAbs().maxCoeff(&axis);
      side = 1 + 2 * axis + (normal[axis] < 0 ? 1 : 0);
    }
    constexpr std::int64_t kHalf = 1 << 19;
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis)
      key = key << 20 | std::uint64_t(std::clamp<std::int64_t>(
                            std::int64_t(std::floor(p[axis] / width_)) + kHalf, 0, 2 * kHalf - 1));
    return key << 4 | side << 1 | std::uint64_t(covering ? 1 : 0);
  }

  void widen() {
    width_ *= 2;
    std::unordered_map<std::uint64_t, Cell, Mix> old;
    old.swap(cells_);
    cells_.reserve(old.size() / 2);
    for (const auto& [key, cell] : old) {
      Cell& into = cells_[key_of(cell.sum / cell.weight, cell.normal, (key & 1) != 0)];
      into.weight += cell.weight;
      into.sum += cell.sum;
      into.normal += cell.normal;
    }
  }

  double width_;
  std::unordered_map<std::uint64_t, Cell, Mix> cells_;
};

// A triangle as bits no larger than half a cell.
void thin_triangle(ThinningGrid& grid, const std::array<Vec3, 3>& p, bool covering) {
  const Vec3 area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
  const double weight = area.norm();
  if (!(weight > 0) || !std::isfinite(weight)) return;
  const double edge = std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
  constexpr double kMostParts = 400;
  const int n = int(std::clamp(std::ceil(edge / grid.width()), 1.0, kMostParts));
  const double part = 1.0 / (double(n) * n);
  for (int a = 0; a < n; ++a) {
    for (int b = 0; a + b < n; ++b) {
      for (const double third : {1.0 / 3, 2.0 / 3}) {
        if (third > 0.5 && a + b + 1 >= n) continue;
        const double u = (a + third) / n, v = (b + third) / n;
        grid.add(p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]), area * part, weight * part,
                 covering);
      }
    }
  }
}

bool has_faces(const MeshFile& file, std::span<const PartKind> kinds) {
  for (std::size_t p = 0; p < file.parts.size(); ++p)
    if (shows_body(kinds[p]) && file.parts[p].mesh.F.rows() > 0) return true;
  return false;
}

// Whether all corners of a triangle are there and finite.
bool sound(const TriMesh& mesh, Eigen::Index f) {
  for (int c = 0; c < 3; ++c) {
    const int v = mesh.F(f, c);
    if (v < 0 || v >= mesh.V.rows() || !mesh.V.row(v).allFinite()) return false;
  }
  return true;
}

Scan thin_parts(const MeshFile& file, std::span<const PartKind> kinds, double unit, bool faces) {
  constexpr double kWidth = 0.003;
  ThinningGrid grid(kWidth);
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    if (!shows_body(kinds[p])) continue;
    const TriMesh& mesh = file.parts[p].mesh;
    const bool covering = is_covering(kinds[p]);
    for (Eigen::Index f = 0; faces && f < mesh.F.rows(); ++f) {
      if (!sound(mesh, f)) continue;
      thin_triangle(
          grid,
          {unit * mesh.V.row(mesh.F(f, 0)).transpose(), unit * mesh.V.row(mesh.F(f, 1)).transpose(),
           unit * mesh.V.row(mesh.F(f, 2)).transpose()},
          covering);
    }
    for (Eigen::Index i = 0; !faces && i < mesh.V.rows(); ++i)
      if (mesh.V.row(i).allFinite())
        grid.add(unit * mesh.V.row(i).transpose(), Vec3::Zero(), 1, covering);
  }
  Scan scan;
  grid.write(scan);
  return scan;
}

// Numbers of the points with equal ones together; the first stands for all.
std::vector<int> weld(const Points& V) {
  std::vector<int> order(V.rows()), to(V.rows());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&V](int i) {
    return std::tuple(float(V(i, 0)), float(V(i, 1)), float(V(i, 2)));
  };
  std::ranges::sort(order, [&](int a, int b) {
    return std::tuple_cat(place(a), std::tuple(a)) < std::tuple_cat(place(b), std::tuple(b));
  });
  for (std::size_t k = 0; k < order.size(); ++k)
    to[order[k]] = k > 0 && place(order[k]) == place(order[k - 1]) ? to[order[k - 1]] : order[k];
  return to;
}

// Each triangle once, whichever way it is wound.
void drop_doubled(std::vector<std::array<int, 3>>& faces) {
  std::vector<std::pair<std::array<int, 3>, int>> sorted(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    sorted[f] = {faces[f], int(f)};
    std::ranges::sort(sorted[f].first);
  }
  std::ranges::sort(sorted);
  std::vector<char> keep(faces.size(), 1);
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (sorted[k].first == sorted[k - 1].first) keep[sorted[k].second] = 0;
  std::size_t kept = 0;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (keep[f] != 0) faces[kept++] = faces[f];
  faces.resize(kept);
}

Scan whole_parts(const MeshFile& file, std::span<const PartKind> kinds, double unit, bool faces) {
  Scan scan;
  Eigen::Index rows = 0, first = 0;
  for (std::size_t p = 0; p < file.parts.size(); ++p)
    if (shows_body(kinds[p])) rows += file.parts[p].mesh.V.rows();
  scan.points.resize(rows, 3);
  scan.covering.resize(rows);
  scan.normals = Points::Zero(rows, 3);
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    if (!shows_body(kinds[p])) continue;
    const TriMesh& mesh = file.parts[p].mesh;
    scan.points.middleRows(first, mesh.V.rows()) = unit * mesh.V;
    const Points& told = file.parts[p].normals;
    if (told.rows() == mesh.V.rows() && told.allFinite())
      scan.normals.middleRows(first, told.rows()) = told;
    std::fill_n(scan.covering.begin() + first, mesh.V.rows(), char(is_covering(kinds[p]) ? 1 : 0));
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      if (!sound(mesh, f)) continue;
      triangles.push_back(
          {int(first) + mesh.F(f, 0), int(first) + mesh.F(f, 1), int(first) + mesh.F(f, 2)});
    }
    first += mesh.V.rows();
  }
  std::vector<char> keep(rows, 1);
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (scan.points.row(i).allFinite()) continue;
    keep[i] = 0;
    scan.points.row(i).setZero();
  }
  const std::vector<int> to = weld(scan.points);
  for (Eigen::Index i = 0; i < rows; ++i)
    if (to[i] != int(i)) keep[i] = 0;
  if (faces) {
    for (auto& t : triangles)
      for (int& v : t) v = to[v];
    std::erase_if(triangles,
                  [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    drop_doubled(triangles);
    std::ranges::fill(keep, 1);  // what has no faces goes
    scan.F.resize(Eigen::Index(triangles.size()), 3);
    for (std::size_t f = 0; f < triangles.size(); ++f)
      for (int c = 0; c < 3; ++c) scan.F(Eigen::Index(f), c) = triangles[f][c];
  }
  scan.area.assign(rows, 0);
  keep_points(scan, keep);
  if (faces) measure_faces(scan);
  return scan;
}

// How often normals of a mesh that is finer than its noise must be smoothed: faces that meet at
// much of an angle over short edges are no shape of a body.
int smoothing_rounds(const Scan& scan) {
  constexpr double kRough = 0.35, kOver = 0.01;  // rad, m
  constexpr int kMost = 12;
  double angle = 0, edges = 0, length = 0;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const int a = scan.F(f, c), b = scan.F(f, (c + 1) % 3);
      const double cosine = scan.normals.row(a).dot(scan.normals.row(b));
      const double edge = (scan.points.row(a) - scan.points.row(b)).norm();
      angle += edge * std::acos(std::clamp(cosine, -1.0, 1.0));
      length += edge;
      edges += 1;
    }
  }
  if (edges == 0 || angle < kRough * length || length > kOver * edges) return 0;
  return std::clamp(int(std::round(kOver * edges / length)), 1, kMost);
}

void smooth_normals(Scan& scan) {
  Points sum = scan.normals;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f)
    for (int c = 0; c < 3; ++c)
      sum.row(scan.F(f, c)) +=
          scan.normals.row(scan.F(f, (c + 1) % 3)) + scan.normals.row(scan.F(f, (c + 2) % 3));
  for (Eigen::Index i = 0; i < sum.rows(); ++i) scan.normals.row(i) = sum.row(i).stableNormalized();
}

}  // namespace

void measure_faces(Scan& scan) {
  const Eigen::Index n = scan.points.rows();
  scan.normals = Points::Zero(n, 3);
  std::vector<double> area(n, 0.0);
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    const Vec3 a = scan.points.row(scan.F(f, 0)), b = scan.points.row(scan.F(f, 1)),
               c = scan.points.row(scan.F(f, 2)), cross = 0.5 * (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) {
      scan.normals.row(scan.F(f, k)) += cross.transpose();
      area[scan.F(f, k)] += cross.norm() / 3;
    }
  }
  for (Eigen::Index i = 0; i < n; ++i)
    scan.normals.row(i) = scan.normals.row(i).stableNormalized().eval();
  scan.area.assign(area.begin(), area.end());
  const int rounds = smoothing_rounds(scan);
  for (int round = 0; round < rounds; ++round) smooth_normals(scan);
}

Scan gather_points(const MeshFile& file, std::span<const PartKind> kinds, double unit) {
  const bool faces = has_faces(file, kinds);
  Eigen::Index size = 0;
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    const TriMesh& mesh = file.parts[p].mesh;
    if (shows_body(kinds[p])) size += faces ? mesh.F.rows() : mesh.V.rows();
  }
  Scan scan =
      size > kWhole ? thin_parts(file, kinds, unit, faces) : whole_parts(file, kinds, unit, faces);
  scan.border.assign(scan.points.rows(), 0);
  scan.unit = unit;
  return scan;
}

void keep_points(Scan& scan, std::vector<char> keep) {
  const Eigen::Index n = scan.points.rows();
  if (scan.F.rows() > 0) {
    std::vector<char> used(n, 0);
    for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
      const auto t = scan.F.row(f);
      if (keep[t[0]] != 0 && keep[t[1]] != 0 && keep[t[2]] != 0)
        used[t[0]] = used[t[1]] = used[t[2]] = 1;
    }
    keep = std::move(used);
  }
  std::vector<int> to(n, -1);
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (keep[i] == 0) continue;
    scan.points.row(kept) = scan.points.row(i).eval();
    if (scan.normals.rows() == n) scan.normals.row(kept) = scan.normals.row(i).eval();
    if (Eigen::Index(scan.area.size()) == n) scan.area[kept] = scan.area[i];
    if (Eigen::Index(scan.border.size()) == n) scan.border[kept] = scan.border[i];
    scan.covering[kept] = scan.covering[i];
    to[i] = int(kept++);
  }
  scan.points.conservativeResize(kept, 3);
  if (scan.normals.rows() == n) scan.normals.conservativeResize(kept, 3);
  if (Eigen::Index(scan.area.size()) == n) scan.area.resize(kept);
  if (Eigen::Index(scan.border.size()) == n) scan.border.resize(kept);
  scan.covering.resize(kept);
  Eigen::Index faces = 0;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    const int a = to[scan.F(f, 0)], b = to[scan.F(f, 1)], c = to[scan.F(f, 2)];
    if (a >= 0 && b >= 0 && c >= 0) scan.F.row(faces++) << a, b, c;
  }
  scan.F.conservativeResize(faces, 3);
}

std::vector<int> cell_points(const Points& points, double width) {
  const Eigen::Index n = points.rows();
  std::vector<std::pair<std::uint64_t, int>> cells(n);
  for (Eigen::Index i = 0; i < n; ++i) cells[i] = {cell_key(points.row(i), width), int(i)};
  std::ranges::sort(cells);
  std::vector<int> out;
  for (std::size_t first = 0, last = 0; first < cells.size(); first = last) {
    Vec3 mean = Vec3::Zero();
    for (last = first; last < cells.size() && cells[last].first == cells[first].first; ++last)
      mean += points.row(cells[last].second).transpose();
    mean /= double(last - first);
    int nearest = cells[first].second;
    for (std::size_t k = first; k < last; ++k) {
      const int i = cells[k].second;
      if ((points.row(i).transpose() - mean).squaredNorm() <
          (points.row(nearest).transpose() - mean).squaredNorm())
        nearest = i;
    }
    out.push_back(nearest);
  }
  std::ranges::sort(out);
  return out;
}

std::vector<int> spread_points(const Scan& scan, int count) {
  const Eigen::Index n = scan.points.rows();
  if (n <= count) {
    std::vector<int> all(n);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  // Cells of a surface: some 1.5 times area / width^2.
  const double area = std::accumulate(scan.area.begin(), scan.area.end(), 0.0);
  const double extent =
      (scan.points.colwise().maxCoeff() - scan.points.colwise().minCoeff()).maxCoeff();
  double low = 0, high = extent;
  double width = std::clamp(std::sqrt(1.5 * std::max(area, 1e-9) / count), 1e-6 * extent, extent);
  std::vector<int> best;
  constexpr int kRounds = 14;
  constexpr double kEnough = 0.97;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<int> found = cell_points(scan.points, width);
    const double share = double(found.size()) / count;
    (share > 1 ? low : high) = width;
    if (share <= 1 && found.size() > best.size()) best = std::move(found);
    if (share <= 1 && share > kEnough) break;
    const double guess = width * std::sqrt(share * 1.01);
    width = guess > low && guess < high ? guess : 0.5 * (low + high);
  }
  return best;
}

}  // namespace ecorche::inline v1
