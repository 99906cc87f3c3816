#include "anatomy/geometry/overlap_volumes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

// Which side of the edge a -> b the point is on, the same bits whichever way the edge is given: > 0
// left.
double side_of(const Vec3& a, const Vec3& b, double x, double y) {
  const bool ordered = a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  const Vec3 &p = ordered ? a : b, &q = ordered ? b : a;
  const double side = (q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x());
  return ordered ? side : -side;
}

// How the triangle, seen along z, winds about (x, y): +1 counter-clockwise, -1 clockwise, 0 not at
// all. Edges count where the point's y lies in [lower, upper) and it lies left of them (on them:
// not), so that neighbours share no point and miss none.
int winding_in_plane(const Vec3& a, const Vec3& b, const Vec3& c, double x, double y) {
  const Vec3* corner[] = {&a, &b, &c};
  int winding = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &p = *corner[i], &q = *corner[(i + 1) % 3];
    if (p.y() <= y && q.y() > y && side_of(p, q, x, y) > 0)
      ++winding;
    else if (q.y() <= y && p.y() > y && side_of(p, q, x, y) < 0)
      --winding;
  }
  return winding;
}

// Height of the triangle's plane over a point that it winds about.
double height_at(const Vec3& a, const Vec3& b, const Vec3& c, double x, double y) {
  const Vec3 n = (b - a).cross(c - a);
  const double low = std::min({a.z(), b.z(), c.z()}), high = std::max({a.z(), b.z(), c.z()});
  return n.z() == 0
             ? low
             : std::clamp(a.z() - (n.x() * (x - a.x()) + n.y() * (y - a.y())) / n.z(), low, high);
}

struct Grid {
  double x0 = 0, y0 = 0, spacing = 1;
  int nx = 0, ny = 0;

  // First and last line within an interval, cut to the grid.
  int first(double at, double from) const {
    return std::max(0, int(std::ceil((at - from) / spacing)));
  }
  int last(double at, double from, int n) const {
    return std::min(n - 1, int(std::floor((at - from) / spacing)));
  }
};

struct Crossing {
  float z = 0;
  std::int32_t solid = 0;  // -1 - solid: the line leaves it
  std::uint32_t column = 0;
};

Grid grid_over(std::span<const Solid> solids, double spacing) {
  constexpr double kOffX = 0.3719,
                   kOffY = 0.6137;  // so that symmetric bodies do not lie on the lines
  Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
  for (const Solid& solid : solids) {
    if (solid.face_begin < 0 || solid.face_end > solid.F->rows() ||
        solid.face_begin > solid.face_end)
      throw std::invalid_argument("measure_solids: faces out of range");
    for (int f = solid.face_begin; f < solid.face_end; ++f)
      for (int i = 0; i < 3; ++i) {
        const Vec3 p = solid.V->row((*solid.F)(f, i));
        if (!p.allFinite())
          throw std::invalid_argument("measure_solids: coordinates that are not finite");
        low = low.cwiseMin(p.head<2>());
        high = high.cwiseMax(p.head<2>());
      }
  }
  Grid grid;
  grid.spacing = spacing;
  if (!(high.x() >= low.x())) return grid;
  grid.x0 = (std::floor(low.x() / spacing) + kOffX) * spacing;
  grid.y0 = (std::floor(low.y() / spacing) + kOffY) * spacing;
  const double nx = std::ceil((high.x() - grid.x0) / spacing) + 1,
               ny = std::ceil((high.y() - grid.y0) / spacing) + 1;
  if (!(nx * ny <= 67108864.0))
    throw LimitError(fmt::format(
        "measure_solids: {:.0f} x {:.0f} lines are too many; measure more coarsely", nx, ny));
  grid.nx = int(std::max(nx, 0.0));
  grid.ny = int(std::max(ny, 0.0));
  return grid;
}

std::vector<Crossing> find_crossings(std::span<const Solid> solids, const Grid& grid) {
  std::vector<Crossing> crossings;
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const Solid& solid = solids[s];
    for (int f = solid.face_begin; f < solid.face_end; ++f) {
      const Vec3 a = solid.V->row((*solid.F)(f, 0)), b = solid.V->row((*solid.F)(f, 1)),
                 c = solid.V->row((*solid.F)(f, 2));
      const int i1 = grid.last(std::max({a.x(), b.x(), c.x()}), grid.x0, grid.nx),
                j1 = grid.last(std::max({a.y(), b.y(), c.y()}), grid.y0, grid.ny);
      for (int j = grid.first(std::min({a.y(), b.y(), c.y()}), grid.y0); j <= j1; ++j)
        for (int i = grid.first(std::min({a.x(), b.x(), c.x()}), grid.x0); i <= i1; ++i) {
          const double x = grid.x0 + i * grid.spacing, y = grid.y0 + j * grid.spacing;
          const int winding = winding_in_plane(a, b, c, x, y);
          if (winding == 0) continue;
          const int index = s;
          crossings.push_back({float(height_at(a, b, c, x, y)), winding > 0 ? -1 - index : index,
                               std::uint32_t(j) * std::uint32_t(grid.nx) + std::uint32_t(i)});
        }
    }
  }
  return crossings;
}

// Grouped by column, in each by height; ties: by solid.
void sort_crossings(std::vector<Crossing>& crossings, const Grid& grid,
                    std::vector<std::size_t>& begin) {
  begin.assign(std::size_t(grid.nx) * std::size_t(grid.ny) + 1, 0);
  for (const Crossing& c : crossings) ++begin[c.column + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<Crossing> sorted(crossings.size());
  std::vector<std::size_t> at(begin.begin(), begin.end() - 1);
  for (const Crossing& c : crossings) sorted[at[c.column]++] = c;
  crossings.swap(sorted);
  for (std::size_t i = 0; i + 1 < begin.size(); ++i)
    std::sort(crossings.begin() + long(begin[i]), crossings.begin() + long(begin[i + 1]),
              [](const Crossing& a, const Crossing& b) {
                return a.z != b.z ? a.z < b.z : a.solid < b.solid;
              });
}

int solid_of(const Crossing& c) { return c.solid >= 0 ? c.solid : -1 - c.solid; }

class Walk {
 public:
  Walk(std::span<const Solid> solids, double area, SolidVolumes& out)
      : solids_(solids),
        area_(area),
        out_(out),
        winding_(solids.size(), 0),
        open_(solids.size(), 0) {
    for (const Solid& solid : solids) any_skin_ = any_skin_ || solid.kind == Solid::Kind::skin;
  }

  void column(std::span<const Crossing> crossings) {
    for (const Crossing& c : crossings) winding_[solid_of(c)] += c.solid >= 0 ? 1 : -1;
    bool skin_open = false;
    for (const Crossing& c : crossings) {
      const std::size_t s = solid_of(c);
      if (winding_[s] != 0) {
        open_[s] = 1;
        ++out_.open_columns;
        skin_open = skin_open || solids_[s].kind == Solid::Kind::skin;
      }
      winding_[s] = 0;
    }
    muscles_.clear();
    bones_.clear();
    skins_ = 0;
    double before = 0;
    for (const Crossing& c : crossings) {
      const std::size_t s = solid_of(c);
      if (open_[s]) continue;
      const double z = c.z;
      if (z > before) add((z - before) * area_, skin_open);
      before = z;
      const bool was = winding_[s] != 0;
      winding_[s] += c.solid >= 0 ? 1 : -1;
      const bool is = winding_[s] != 0;
      if (was != is) turn(int(s), is);
    }
    for (const Crossing& c : crossings) open_[solid_of(c)] = 0;
  }

  void finish() {
    for (const auto& [pair, volume] : pairs_)
      out_.pairs.push_back({pair.first, pair.second, volume});
    std::stable_sort(
        out_.pairs.begin(), out_.pairs.end(),
        [](const SharedVolume& l, const SharedVolume& r) { return l.volume > r.volume; });
  }

 private:
  void turn(int solid, bool on) {
    const Solid::Kind kind = solids_[solid].kind;
    if (kind == Solid::Kind::skin) {
      skins_ += on ? 1 : -1;
      return;
    }
    std::vector<int>& list = kind == Solid::Kind::bone ? bones_ : muscles_;
    if (on)
      list.insert(std::upper_bound(list.begin(), list.end(), solid), solid);
    else
      list.erase(std::find(list.begin(), list.end(), solid));
  }

  void add(double volume, bool skin_open) {
    const bool outside = any_skin_ && !skin_open && skins_ == 0;
    for (int b : bones_) {
      out_.volume[b] += volume;
      if (outside) out_.outside[b] += volume;
    }
    if (muscles_.empty()) return;
    out_.muscles += volume;
    out_.muscle_excess += double(muscles_.size() - 1) * volume;
    if (!bones_.empty()) out_.muscle_bone += volume;
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
      const std::size_t m = muscles_[i];
      out_.volume[m] += volume;
      if (outside) out_.outside[m] += volume;
      if (muscles_.size() > 1) out_.in_muscle[m] += volume;
      if (!bones_.empty()) out_.in_bone[m] += volume;
      for (std::size_t k = i + 1; k < muscles_.size(); ++k)
        pairs_[{muscles_[i], muscles_[k]}] += volume;
      for (int b : bones_) pairs_[std::minmax(muscles_[i], b)] += volume;
    }
  }

  std::span<const Solid> solids_;
  double area_;
  SolidVolumes& out_;
  std::vector<int> winding_;
  std::vector<char> open_;
  std::vector<int> muscles_, bones_;  // that the line is in
  int skins_ = 0;
  bool any_skin_ = false;
  std::map<std::pair<int, int>, double> pairs_;
};

}  // namespace

SolidVolumes measure_solids(std::span<const Solid> solids, double spacing) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw std::invalid_argument("measure_solids: the spacing must be above 0");
  const Grid grid = grid_over(solids, spacing);
  SolidVolumes out;
  for (std::vector<double>* list : {&out.volume, &out.in_muscle, &out.in_bone, &out.outside})
    list->assign(solids.size(), 0.0);
  std::vector<Crossing> crossings = find_crossings(solids, grid);
  std::vector<std::size_t> begin;
  sort_crossings(crossings, grid, begin);
  Walk walk(solids, spacing * spacing, out);
  for (std::size_t i = 0; i + 1 < begin.size(); ++i)
    if (begin[i + 1] > begin[i])
      walk.column(std::span(crossings).subspan(begin[i], begin[i + 1] - begin[i]));
  walk.finish();
  return out;
}

std::vector<int> winding_numbers(const TriMesh& mesh, const Points& points) {
  std::vector<int> winding(points.rows(), 0);
  if (points.rows() == 0 || mesh.F.rows() == 0) return winding;
  const Vec3 low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
  // Points by cell, about as many cells as points.
  const double size =
      std::max({std::sqrt(std::max((high.x() - low.x()) * (high.y() - low.y()), 0.0) /
                          double(points.rows())),
                (high - low).head<2>().maxCoeff() / 4096, 1e-9});
  const int nx = int((high.x() - low.x()) / size) + 1, ny = int((high.y() - low.y()) / size) + 1;
  const auto cell = [size](double at, double from, int n) {
    return std::clamp(int(std::floor((at - from) / size)), 0, n - 1);
  };
  std::vector<std::vector<int>> cells(std::size_t(nx) * std::size_t(ny));
  for (Eigen::Index p = 0; p < points.rows(); ++p)
    cells[std::size_t(cell(points(p, 1), low.y(), ny)) * std::size_t(nx) +
          cell(points(p, 0), low.x(), nx)]
        .push_back(int(p));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    const Vec3 from = a.cwiseMin(b).cwiseMin(c), to = a.cwiseMax(b).cwiseMax(c);
    if (to.x() < low.x() || from.x() > high.x() || to.y() < low.y() || from.y() > high.y())
      continue;
    for (int j = cell(from.y(), low.y(), ny); j <= cell(to.y(), low.y(), ny); ++j)
      for (int i = cell(from.x(), low.x(), nx); i <= cell(to.x(), low.x(), nx); ++i)
        for (int p : cells[std::size_t(j) * std::size_t(nx) + i]) {
          if (points(p, 2) > to.z()) continue;
          const int w = winding_in_plane(a, b, c, points(p, 0), points(p, 1));
          if (w != 0 && height_at(a, b, c, points(p, 0), points(p, 1)) > points(p, 2))
            winding[p] += w;
        }
  }
  return winding;
}

}  // namespace ecorche::inline v1
