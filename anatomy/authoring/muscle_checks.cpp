#include "anatomy/authoring/muscle_checks.h"

// What the placed muscles are measured by: distances of their ends from bones, and of their lines
// from others' paths.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kLineSamples = 60;  // of a strip's line, for distances to it

// The bone on this side; unpaired bones keep their name. Empty for a soft carrier.
std::string sided_bone(const Anatomy& anatomy, const std::string& carrier, Side side) {
  const std::string sided = carrier + side_suffix(side);
  if (find_bone(anatomy, sided) >= 0) return sided;
  return find_bone(anatomy, carrier) >= 0 ? carrier : "";
}

double distance_to_line(const Vec3& p, const std::vector<Vec3>& line) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vec3 e = line[k + 1] - line[k];
    const double t =
        e.squaredNorm() > 0 ? std::clamp((p - line[k]).dot(e) / e.squaredNorm(), 0.0, 1.0) : 0;
    nearest = std::min(nearest, (p - line[k] - t * e).norm());
  }
  return nearest;
}

std::vector<std::vector<Vec3>> lines_of(const Muscle& muscle) {
  std::vector<double> s;
  for (int k = 0; k <= kLineSamples; ++k) s.push_back(double(k) / kLineSamples);
  std::vector<std::vector<Vec3>> lines;
  for (const Strip& strip : muscle.strips) lines.push_back(line_points(strip.path, s));
  return lines;
}

}  // namespace

std::vector<Attachment> measure_attachments(const MuscleTable& table, const Anatomy& anatomy) {
  if (anatomy.muscles.size() != 2 * table.muscles.size())
    throw std::invalid_argument(
        fmt::format("measure_attachments: {} muscles, but the table has {} a side",
                    anatomy.muscles.size(), table.muscles.size()));
  std::vector<Attachment> out;
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    const Muscle& muscle = anatomy.muscles[m];
    const TableMuscle& from = table.muscles[m / 2];
    for (std::size_t i = 0; i < muscle.strips.size(); ++i) {
      for (const bool origin : {true, false}) {
        const auto& path = from.strips[i].path;
        const TablePoint& end = origin ? path.front() : path.back();
        const std::string bone =
            sided_bone(anatomy, table.landmarks[end.landmark].carrier, muscle.side);
        if (bone.empty()) continue;
        const auto& placed = muscle.strips[i].path;
        const TriMesh& mesh = anatomy.bones[find_bone(anatomy, bone)].mesh;
        out.push_back({int(m), int(i), origin, bone,
                       distance_to_mesh(origin ? placed.front().rest : placed.back().rest, mesh)});
      }
    }
  }
  return out;
}

std::vector<PathComparison> compare_paths(const MuscleTable& table, const Anatomy& anatomy,
                                          const std::vector<TendonPath>& paths) {
  std::vector<PathComparison> out;
  for (std::size_t m = 0; m < table.muscles.size(); ++m) {
    PathComparison comparison;
    comparison.muscle = int(2 * m);
    const auto lines = lines_of(anatomy.muscles[2 * m]);
    for (const std::string& name : table.muscles[m].compare) {
      const auto path = std::find_if(paths.begin(), paths.end(),
                                     [&](const TendonPath& p) { return p.name == name + "_l"; });
      if (path == paths.end()) continue;
      comparison.paths.push_back(path->name);
      for (const Vec3& point : path->points) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& line : lines) nearest = std::min(nearest, distance_to_line(point, line));
        comparison.mean += nearest;
        comparison.worst = std::max(comparison.worst, nearest);
        ++comparison.points;
      }
    }
    if (comparison.points == 0) continue;
    comparison.mean /= comparison.points;
    out.push_back(std::move(comparison));
  }
  return out;
}

}  // namespace ecorche::inline v1
