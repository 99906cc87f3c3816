#include "morph/fat/vein_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kPointsBetween = 12;      // of a vein, from site to site
constexpr double kFarthestSkin = 0.35;  // m from a site's place inside
constexpr double kLongestStep = 0.05;   // m: a farther point has met another part of the body

struct VeinSite {
  Vec3 inside, way;
};

int joint_of(const Table& table, int row, const char* column, Side side, const Skeleton& skeleton) {
  const std::string name = table.text(row, column);
  const int joint =
      std::max(find_joint(skeleton, name), find_joint(skeleton, name + side_suffix(side)));
  if (joint < 0)
    throw InputError(
        fmt::format("{}: column '{}': unknown joint '{}'; `ecorche list joints` has "
                    "the names",
                    table.where(row), column, name));
  return joint;
}

VeinSite site_at(const Table& table, int row, Side side, const Skeleton& skeleton,
                 const std::vector<Vec3>& positions) {
  const Joint& frame = skeleton.joints[joint_of(table, row, "frame", side, skeleton)];
  const Vec3 from = positions[joint_of(table, row, "from", side, skeleton)],
             to = positions[joint_of(table, row, "to", side, skeleton)];
  const Vec3 along = (to - from).normalized();
  const bool middle = find_joint(skeleton, table.text(row, "frame")) >= 0;
  const double mirror = side == Side::right && middle ? -1 : 1;
  const Vec3 way = table.number(row, "flex") * frame.axes.col(0).cross(along) +
                   mirror * table.number(row, "out") * frame.axes.col(1).cross(along) +
                   table.number(row, "along") * along;
  if (way.norm() < 1e-6)
    throw InputError(fmt::format("{}: flex, out and along are all 0; say which way the skin is",
                                 table.where(row)));
  return {from + table.number(row, "at") * (to - from), way.normalized()};
}

Vec3 catmull_rom(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double t) {
  return 0.5 * (2 * b + t * (c - a) + t * t * (2 * a - 5 * b + 4 * c - d) +
                t * t * t * (3 * (b - c) + d - a));
}

// Where the skin is met from inside, along the curve through the sites.
std::vector<Vec3> points_on_skin(const std::vector<VeinSite>& sites, const SkinRays& rays) {
  std::vector<Vec3> out;
  const int last = int(sites.size()) - 1;
  for (int i = 0; i <= last * kPointsBetween; ++i) {
    const int k = std::min(i / kPointsBetween, last - 1);
    const double t = double(i - k * kPointsBetween) / kPointsBetween;
    const VeinSite &a = sites[std::max(k - 1, 0)], &b = sites[k], &c = sites[k + 1],
                   &d = sites[std::min(k + 2, last)];
    const Vec3 inside = catmull_rom(a.inside, b.inside, c.inside, d.inside, t);
    const Vec3 way = catmull_rom(a.way, b.way, c.way, d.way, t).normalized();
    const RayHit hit = rays.first_hit(inside, way, kFarthestSkin);
    if (hit.triangle < 0) continue;
    const Vec3 at = inside + double(hit.distance) * way;
    if (out.empty() || (at - out.back()).norm() < kLongestStep) out.push_back(at);
  }
  return out;
}

}  // namespace

std::vector<VeinPath> vein_paths(const std::filesystem::path& tables, const Skeleton& skeleton,
                                 const TriMesh& skin) {
  const Table table(tables / "veins.csv");
  const SkinRays rays(skin);
  const std::vector<Vec3> positions = rest_positions(skeleton);
  std::vector<VeinPath> out;
  for (int row = 0, end = 0; row < table.rows(); row = end) {
    const std::string name = table.text(row, "vein");
    for (end = row; end < table.rows() && table.text(end, "vein") == name;) ++end;
    if (end - row < 2)
      throw InputError(
          fmt::format("{}: vein '{}' has one site; a vein needs two or more, one "
                      "under the other",
                      table.where(row), name));
    const double width = 1e-3 * table.number(row, "width_mm"),
                 height = 1e-3 * table.number(row, "height_mm");
    if (width <= 0 || height <= 0)
      throw InputError(fmt::format("{}: vein '{}': width_mm and height_mm must be above 0",
                                   table.where(row), name));
    for (const Side side : {Side::left, Side::right}) {
      std::vector<VeinSite> sites;
      for (int k = row; k < end; ++k) sites.push_back(site_at(table, k, side, skeleton, positions));
      out.push_back({name + side_suffix(side), points_on_skin(sites, rays), width, height});
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
