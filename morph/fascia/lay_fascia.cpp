#include "morph/fascia/lay_fascia.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/muscles/muscle_surface.h"
#include "morph/fascia/lay_sleeve.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kCell = 4e-3;           // m, between points of the grid
constexpr int kFewest = 9, kMost = 120;  // points a row or column
constexpr double kUnderSkin = 1.0e-3;    // m that a sheet keeps from the skin
constexpr double kDeepest = 0.03;        // m below the patch that muscle and bone are looked for
constexpr double kRoom = 0.12;           // m, skin farther above the patch is that of another part
constexpr double kTuck = 0.7e-3;         // m that an edge lies in what is below
constexpr int kSweeps = 300;
constexpr double kRelaxation = 1.6;
constexpr int kNormalRounds = 6;

// What sheets lie on.
struct Tissue {
  SkinRays rays;
  std::vector<float> belly;  // of its mesh, #V, 1 on a muscle's belly
};

Tissue tissue_of(const Anatomy& anatomy) {
  TriMesh muscles;
  std::vector<float> belly;
  if (!anatomy.muscles.empty()) {
    const MuscleSurface surface = make_muscle_surface(anatomy);
    update_muscle_surface(surface, rest_slices(anatomy), muscles.V);
    muscles.F = surface.F;
    belly = surface.belly;
  }
  std::vector<const TriMesh*> parts{&muscles};
  for (const Bone& bone : anatomy.bones) parts.push_back(&bone.mesh);
  const TriMesh all = join_meshes(parts);
  belly.resize(std::size_t(all.V.rows()), 0);
  return {SkinRays(all, RayBuild::quick), std::move(belly)};
}

// Points along a row or column of any number of points.
struct Grid {
  int rows = 0, columns = 0;
  std::vector<Vec3> at;
  Vec3& operator()(int r, int c) { return at[std::size_t(r) * columns + c]; }
  const Vec3& operator()(int r, int c) const { return at[std::size_t(r) * columns + c]; }
};

// Catmull and Rom's spline through points at whole numbers, with straight ends.
Vec3 spline(std::span<const Vec3> points, double t) {
  const int n = int(points.size()), i = std::clamp(int(t), 0, n - 2);
  const double u = t - i, u2 = u * u, u3 = u2 * u;
  const Vec3 &p1 = points[i], &p2 = points[i + 1];
  const Vec3 p0 = i > 0 ? points[i - 1] : Vec3(2 * p1 - p2),
             p3 = i + 2 < n ? points[i + 2] : Vec3(2 * p2 - p1);
  return 0.5 * (2 * p1 + (p2 - p0) * u + (2 * p0 - 5 * p1 + 4 * p2 - p3) * u2 +
                (3 * p1 - p0 - 3 * p2 + p3) * u3);
}

Grid resampled_rows(const Grid& from, int columns) {
  Grid out{from.rows, columns, std::vector<Vec3>(std::size_t(from.rows) * columns)};
  for (int r = 0; r < from.rows; ++r)
    for (int c = 0; c < columns; ++c)
      out(r, c) = spline({&from(r, 0), std::size_t(from.columns)},
                         double(c) * (from.columns - 1) / (columns - 1));
  return out;
}

Grid turned(const Grid& from) {
  Grid out{from.columns, from.rows, std::vector<Vec3>(from.at.size())};
  for (int r = 0; r < from.rows; ++r)
    for (int c = 0; c < from.columns; ++c) out(c, r) = from(r, c);
  return out;
}

double longest_row(const Grid& grid) {
  double out = 0;
  for (int r = 0; r < grid.rows; ++r) {
    double length = 0;
    for (int c = 0; c + 1 < grid.columns; ++c) length += (grid(r, c + 1) - grid(r, c)).norm();
    out = std::max(out, length);
  }
  return out;
}

int cells_for(double length) { return std::clamp(int(length / kCell) + 1, kFewest, kMost); }

Grid patch_of(const FasciaPlan& plan) {
  Grid control{plan.rows, plan.columns, {}};
  for (const PathPoint& point : plan.points) control.at.push_back(point.rest);
  const Grid wide = resampled_rows(control, cells_for(longest_row(control)));
  const Grid across = turned(wide);
  return turned(resampled_rows(across, cells_for(longest_row(across))));
}

// Unit normals, smoothed: along a row times to the next row.
std::vector<Vec3> normals_of(const Grid& grid) {
  const int R = grid.rows, C = grid.columns;
  std::vector<Vec3> out(grid.at.size()), before;
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) {
      const Vec3 along = grid(r, std::min(c + 1, C - 1)) - grid(r, std::max(c - 1, 0)),
                 down = grid(std::min(r + 1, R - 1), c) - grid(std::max(r - 1, 0), c);
      out[std::size_t(r) * C + c] = along.cross(down).normalized();
    }
  for (int round = 0; round < kNormalRounds; ++round) {
    before = out;
    const auto old = [&](int r, int c) -> const Vec3& {
      return before[std::size_t(std::clamp(r, 0, R - 1)) * C + std::clamp(c, 0, C - 1)];
    };
    for (int r = 0; r < R; ++r)
      for (int c = 0; c < C; ++c)
        out[std::size_t(r) * C + c] =
            (2 * old(r, c) + old(r - 1, c) + old(r + 1, c) + old(r, c - 1) + old(r, c + 1))
                .normalized();
  }
  return out;
}

// How far the skin is above a point of the patch; negative where that point lies outside.
double room_above(const SkinRays& skin, const Vec3& p, const Vec3& n) {
  const RayHit up = skin.first_hit(p, n, kRoom);
  if (up.triangle >= 0 && up.facing > 0) return up.distance;
  const RayHit down = skin.first_hit(p, -n, kRoom);
  return down.triangle >= 0 && down.facing < 0 ? -double(down.distance) : kRoom;
}

// The patch turned over so that its normals point to the nearer skin.
void turn_outwards(const SkinRays& skin, Grid& grid, std::vector<Vec3>& normals) {
  int outwards = 0;
  for (std::size_t i = 0; i < grid.at.size(); ++i)
    outwards += room_above(skin, grid.at[i], normals[i]) < room_above(skin, grid.at[i], -normals[i])
                    ? 1
                    : -1;
  if (outwards >= 0) return;
  for (int r = 0; r < grid.rows; ++r) std::reverse(&grid(r, 0), &grid(r, 0) + grid.columns);
  normals = normals_of(grid);
}

struct Laid {
  std::vector<double> floor, ceiling, height;  // m along the normals
  std::vector<char> free;                      // nothing is below
  std::vector<float> belly;                    // of what is below
};

Laid look_down(const Tissue& tissue, const SkinRays& skin, const Grid& grid,
               const std::vector<Vec3>& normals) {
  Laid out;
  for (std::size_t i = 0; i < grid.at.size(); ++i) {
    const double room = room_above(skin, grid.at[i], normals[i]), top = room - kUnderSkin;
    const Vec3 start = grid.at[i] + top * normals[i];
    const RayHit hit =
        tissue.rays.first_hit(start, -normals[i], std::max(top + kDeepest, kDeepest));
    out.ceiling.push_back(top);
    out.floor.push_back(hit.triangle < 0 ? -kDeepest : top - hit.distance);
    out.free.push_back(hit.triangle < 0);
    out.belly.push_back(hit.triangle < 0 ? 0 : value_at(tissue.rays.mesh().F, hit, tissue.belly));
  }
  return out;
}

void stretch(const Grid& grid, const std::vector<Vec3>& normals, double thickness, Laid& laid) {
  const int R = grid.rows, C = grid.columns;
  std::vector<Vec3> at(grid.at.size());
  laid.height.resize(at.size());
  const auto place = [&](std::size_t i, double h) {
    laid.height[i] = h;
    at[i] = grid.at[i] + h * normals[i];
  };
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) {
      const std::size_t i = std::size_t(r) * C + c;
      const int cells = cells_from_edge(R, C, int(i));
      laid.floor[i] += cells > 0 ? thickness * std::min(1.0, cells / 2.0) : -kTuck;
      laid.floor[i] = std::min(laid.floor[i], laid.ceiling[i]);
      place(i, laid.floor[i]);
    }
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int r = 0; r < R; ++r)
      for (int c = 0; c < C; ++c) {
        const std::size_t i = std::size_t(r) * C + c;
        // An edge lies where it does, but one over nothing goes with the sheet.
        if (cells_from_edge(R, C, int(i)) == 0 && !laid.free[i]) continue;
        const auto beyond = [&](int row, int column, int back) {
          const bool in = row >= 0 && row < R && column >= 0 && column < C;
          return in ? at[std::size_t(row) * C + column] : Vec3(2 * at[i] - at[std::size_t(back)]);
        };
        const int here = int(i);
        const Vec3 mean = (beyond(r, c - 1, here + 1) + beyond(r, c + 1, here - 1) +
                           beyond(r - 1, c, here + C) + beyond(r + 1, c, here - C)) /
                          4;
        const double wanted = normals[i].dot(mean - grid.at[i]);
        const double h = laid.height[i] + kRelaxation * (wanted - laid.height[i]);
        place(i, std::clamp(h, laid.floor[i], laid.ceiling[i]));
      }
}

FasciaSheet lay(const FasciaPlan& plan, const Tissue& tissue, const SkinRays& skin) {
  Grid grid = patch_of(plan);
  std::vector<Vec3> normals = normals_of(grid);
  turn_outwards(skin, grid, normals);
  Laid laid = look_down(tissue, skin, grid, normals);
  stretch(grid, normals, plan.thickness, laid);
  FasciaSheet out = empty_sheet(plan);
  out.rows = grid.rows;
  out.columns = grid.columns;
  out.V.resize(Eigen::Index(grid.at.size()), 3);
  for (int r = 0; r < grid.rows; ++r)
    for (int c = 0; c < grid.columns; ++c) {
      const std::size_t i = std::size_t(r) * grid.columns + c;
      out.V.row(Eigen::Index(i)) = grid.at[i] + laid.height[i] * normals[i];
      const double from_edge = kCell * cells_from_edge(grid.rows, grid.columns, int(i));
      const double faded = plan.fade > 0 ? 1 - smooth_step(from_edge / plan.fade) : 0;
      out.belly.push_back(float(faded * laid.belly[i]));
    }
  return out;
}

}  // namespace

std::vector<FasciaPlan> carry_fascia(const std::vector<FasciaPlan>& plans, const CarryMap& map) {
  std::vector<FasciaPlan> out = plans;
  for (FasciaPlan& plan : out)
    for (PathPoint& point : plan.points) point.rest = carry_point(point.rest, point, map);
  return out;
}

std::vector<FasciaSheet> lay_fascia(std::span<const FasciaPlan> plans, const Anatomy& anatomy,
                                    const SkinRays& skin) {
  if (plans.empty()) return {};
  std::vector<FasciaPlan> present(plans.begin(), plans.end());
  std::erase_if(present, [&](const FasciaPlan& plan) {
    return std::ranges::any_of(
        plan.bones, [&](const std::string& bone) { return find_bone(anatomy, bone) < 0; });
  });
  const Tissue tissue = tissue_of(anatomy);
  std::vector<FasciaSheet> out(present.size());
  tbb::parallel_for(std::size_t{0}, present.size(), [&](std::size_t i) {
    out[i] = present[i].form == FasciaPlan::Form::sheet
                 ? lay(present[i], tissue, skin)
                 : lay_sleeve(present[i], anatomy, tissue.rays, skin);
  });
  std::erase_if(out, [](const FasciaSheet& sheet) { return !sheet.V.allFinite(); });
  return out;
}

}  // namespace ecorche::inline v1
