#include "tests/muscles/shells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <thread>

#include "anatomy/authoring/muscle_ends.h"
#include "anatomy/authoring/resample_mesh.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche {
namespace {

constexpr double kOpen = 0.03;    // share of the area that fans may add
constexpr double kWhole = 0.99;   // share of the area that the largest piece has
constexpr double kMean = 1.5e-3;  // m
constexpr double kVolume = 0.02;
constexpr double kForked = 0.05;  // share of the outlines' length that other branches may have
constexpr int kLeastClean = 100;

double area_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

double area_of(const TriMesh& mesh, Eigen::Index f) {
  return area_of(Vec3(mesh.V.row(mesh.F(f, 0))), Vec3(mesh.V.row(mesh.F(f, 1))),
                 Vec3(mesh.V.row(mesh.F(f, 2))));
}

double largest_piece(const TriMesh& mesh) {
  std::vector<int> parent(mesh.V.rows());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int i : {1, 2}) parent[root(mesh.F(f, i))] = root(mesh.F(f, 0));
  std::map<int, double> areas;
  double all = 0, most = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const double area = area_of(mesh, f);
    all += area;
    most = std::max(most, areas[root(mesh.F(f, 0))] += area);
  }
  return all > 0 ? most / all : 0;
}

}  // namespace

CappedMesh capped(const TriMesh& mesh) {
  // Directed edges that have no partner; followed backwards they bound what is missing.
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int i = 0; i < 3; ++i) {
      const int a = mesh.F(f, i), b = mesh.F(f, (i + 1) % 3);
      if (auto other = edges.find({b, a}); other != edges.end()) {
        if (--other->second == 0) edges.erase(other);
      } else {
        ++edges[{a, b}];
      }
    }
  std::multimap<int, int> next;  // of the missing surface: from an open edge's end to its start
  for (const auto& [edge, count] : edges)
    for (int i = 0; i < count; ++i) next.emplace(edge.second, edge.first);
  CappedMesh out{mesh, 0, largest_piece(mesh)};
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  double caps = 0;
  const auto close = [&](std::span<const int> loop) {
    Vec3 middle = Vec3::Zero();
    for (int i : loop) middle += mesh.V.row(i).transpose() / double(loop.size());
    const int center = mesh.V.rows() + Eigen::Index(points.size());
    points.push_back(middle);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int from = loop[i], to = loop[(i + 1) % loop.size()];
      faces.push_back({from, to, center});
      caps += area_of(Vec3(mesh.V.row(from)), Vec3(mesh.V.row(to)), middle);
    }
  };
  while (!next.empty()) {
    std::vector<int> walk{next.begin()->first};
    for (auto step = next.begin(); step != next.end(); step = next.find(walk.back())) {
      walk.push_back(step->second);
      next.erase(step);
      // Back where the walk has been: what lies between is a loop of its own, so that no fan uses
      // an edge twice.
      const auto begin = std::find(walk.begin(), walk.end(), walk.back());
      if (begin == walk.end() - 1) continue;
      close({begin, walk.end() - 1});
      walk.erase(begin + 1, walk.end());
    }
  }
  out.mesh.V.conservativeResize(mesh.V.rows() + Eigen::Index(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    out.mesh.V.row(mesh.V.rows() + Eigen::Index(i)) = points[i];
  out.mesh.F.conservativeResize(mesh.F.rows() + Eigen::Index(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i)
    out.mesh.F.row(mesh.F.rows() + Eigen::Index(i)) << faces[i][0], faces[i][1], faces[i][2];
  out.cap_share = caps / mesh_area(mesh);
  return out;
}

namespace {

struct Returned {
  CappedMesh shell;
  double mean = 0, error = 0, forked = 0;
  std::string flag;  // why it is no clean shell
};

Returned returned(const TriMesh& raw) {
  Returned out;
  out.shell = capped(raw);
  if (out.shell.piece_share < kWhole)
    out.flag = fmt::format("pieces: the largest is {:.0f} % of it", 100 * out.shell.piece_share);
  else if (out.shell.cap_share > kOpen)
    out.flag = fmt::format("open: {:.1f} % of its area is missing", 100 * out.shell.cap_share);
  if (!out.flag.empty()) return out;
  const ResampleReport report = resample_muscle(out.shell.mesh).report;
  out.mean = report.mean_distance();
  out.error = report.volume_error();
  out.forked = report.forked;
  if (out.forked > kForked)
    out.flag =
        fmt::format("forked: {:.0f} % of its outlines are of other branches", 100 * out.forked);
  return out;
}

}  // namespace

bool resample_shells(const std::vector<ShellMuscle>& muscles, const std::filesystem::path& csv) {
  std::vector<Returned> all(muscles.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < muscles.size(); i = next++) {
      try {
        all[i] = returned(muscles[i].mesh);
      } catch (const std::exception& failure) {
        all[i].mean = all[i].error = 1;  // clean, and not come back
        fmt::print("{}: {}\n", muscles[i].name, failure.what());
      }
    }
  };
  std::thread other(work);
  work();
  other.join();
  std::string rows =
      "muscle,volume_ml,mean_mm,volume_error_percent,cap_percent,largest_piece_percent,forked_"
      "percent,flag\n";
  int clean = 0, met = 0;
  double worst = 0, worst_volume = 0;
  fmt::print("\n{:<52} {:>8} {:>8} {:>9}  {}\n", "resampled", "ml", "mean mm", "volume %", "flag");
  for (std::size_t i = 0; i < muscles.size(); ++i) {
    const auto& [shell, mean, error, forked, why] = all[i];
    std::string flag = why;
    if (flag.empty()) {
      ++clean;
      const bool good = mean <= kMean && std::abs(error) <= kVolume;
      met += good;
      worst = std::max(worst, mean);
      worst_volume = std::max(worst_volume, std::abs(error));
      if (!good) flag = "MISSED";
    }
    const double volume = 1e6 * mesh_volume(shell.mesh);
    fmt::print("{:<52} {:>8.1f} {:>8.2f} {:>+9.1f}  {}\n", muscles[i].name, volume, 1e3 * mean,
               100 * error, flag);
    rows += fmt::format("{},{:.2f},{:.3f},{:.2f},{:.2f},{:.1f},{:.1f},\"{}\"\n", muscles[i].name,
                        volume, 1e3 * mean, 100 * error, 100 * shell.cap_share,
                        100 * shell.piece_share, 100 * forked, flag);
  }
  fmt::print(
      "\n{} muscles, {} of them single clean shells: {} within 1.5 mm and 2 % of volume (worst "
      "{:.2f} mm, {:.1f} %)\n",
      muscles.size(), clean, met, 1e3 * worst, 100 * worst_volume);
  if (!csv.empty()) write_file_atomically(csv, rows);
  return clean >= kLeastClean && met == clean;
}

}  // namespace ecorche
