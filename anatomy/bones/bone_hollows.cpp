#include "anatomy/bones/bone_hollows.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "anatomy/bones/mirror.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

// Deeper than this behind the rim's plane lies another face of the bone, m.
constexpr double kReach = 0.03;

struct Hollow {
  std::vector<Vec3> rim;
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();  // normal out of the bone
  double depth = 0, width = 0;  // m; width: from the rim to where the hollow has its depth
};

// Consecutive rows of one name.
Hollow read_hollow(const Table& table, int& row, std::string& bone) {
  Hollow out;
  const int first = row;
  const std::string& name = table.text(first, "hollow");
  bone = table.text(first, "bone");
  out.depth = 1e-3 * table.number(first, "depth_mm");
  out.width = 1e-3 * table.number(first, "rim_mm");
  for (; row < table.rows() && table.text(row, "hollow") == name; ++row)
    out.rim.push_back({kSourceMidPlane + 1e-3 * table.number(row, "left_mm"),
                       1e-3 * table.number(row, "up_mm"), 1e-3 * table.number(row, "front_mm")});
  if (out.rim.size() < 3)
    throw InputError(fmt::format("{}: the rim of hollow '{}' has {} points; give it three or more",
                                 table.where(first), name, out.rim.size()));
  for (const Vec3& point : out.rim) out.centre += point / double(out.rim.size());
  for (std::size_t i = 0; i < out.rim.size(); ++i)
    out.normal += (out.rim[i] - out.centre).cross(out.rim[(i + 1) % out.rim.size()] - out.centre);
  out.normal.normalize();
  if (out.normal.x() < 0) out.normal = -out.normal;
  return out;
}

Hollow mirrored(Hollow hollow) {
  for (Vec3& point : hollow.rim) point = mirror_point(point);
  hollow.centre = mirror_point(hollow.centre);
  hollow.normal.x() = -hollow.normal.x();
  return hollow;
}

// How far inside the rim a point lies, seen along the normal; negative outside, m.
double inside_rim(const Hollow& hollow, const Vec3& point) {
  const Vec3 across = hollow.normal.unitOrthogonal(), up = hollow.normal.cross(across);
  const auto flat = [&](const Vec3& p) {
    return Eigen::Vector2d((p - hollow.centre).dot(across), (p - hollow.centre).dot(up));
  };
  const Eigen::Vector2d p = flat(point);
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < hollow.rim.size(); ++i) {
    const Eigen::Vector2d a = flat(hollow.rim[i]),
                          b = flat(hollow.rim[(i + 1) % hollow.rim.size()]), ab = b - a;
    const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + t * ab - p).norm());
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / ab.y() * ab.x())
      inside = !inside;
  }
  return inside ? nearest : -nearest;
}

void press(const Hollow& hollow, TriMesh& mesh) {
  const Points normals = vertex_normals(mesh);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const Vec3 point = mesh.V.row(v);
    if (std::abs((point - hollow.centre).dot(hollow.normal)) > kReach ||
        normals.row(v).dot(hollow.normal) < 0.3)
      continue;
    mesh.V.row(v) -=
        hollow.depth * smooth_step(0, hollow.width, inside_rim(hollow, point)) * hollow.normal;
  }
}

}  // namespace

void press_hollows(const Table& table, std::vector<Bone>& bones) {
  for (int row = 0; row < table.rows();) {
    const int first = row;
    std::string name;
    const Hollow hollow = read_hollow(table, row, name);
    const auto bone = std::find_if(bones.begin(), bones.end(), [&](const Bone& b) {
      return b.name == name || b.name == name + "_l";
    });
    if (bone == bones.end())
      throw InputError(fmt::format("{}: unknown bone '{}'", table.where(first), name));
    press(hollow, bone->mesh);
    if (bone->side == Side::middle) press(mirrored(hollow), bone->mesh);
  }
}

}  // namespace ecorche::inline v1
