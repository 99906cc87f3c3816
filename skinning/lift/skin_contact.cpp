#include "skinning/lift/skin_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kReach = 0.10;        // m, deepest contact; deeper is the far side of a limb
constexpr double kFastest = 1.5;       // m/s, of skin and sheet towards each other
constexpr double kBeyondRim = 1e-3;    // m, beside the sheet's edge that still counts as on it
constexpr double kLeastFacing = 0.05;  // cosine between the skin and what it lies on
constexpr int kLongestWait = 30;       // steps

struct Nearest {
  int triangle = -1;
  double squared = std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
};

Vec3 node_of(const Points& nodes, int i) { return nodes.row(i).transpose(); }

void look_at(const Triangles& F, const Points& nodes, int triangle, const Vec3& p, Nearest& best) {
  const Vec3 at =
      nearest_in_triangle(p, node_of(nodes, F(triangle, 0)), node_of(nodes, F(triangle, 1)),
                          node_of(nodes, F(triangle, 2)));
  const double squared = (at - p).squaredNorm();
  if (squared < best.squared) best = {triangle, squared, at};
}

// From a triangle on to ever nearer ones around its corners.
Nearest descend(const Sheet& sheet, const Points& nodes, const Vec3& p, int start) {
  Nearest best;
  look_at(sheet.mesh.F, nodes, start, p, best);
  for (int from = -1; from != best.triangle;) {
    from = best.triangle;
    for (int k = 0; k < 3; ++k)
      for (const int t : sheet.around[std::size_t(sheet.mesh.F(from, k))])
        if (t != from) look_at(sheet.mesh.F, nodes, t, p, best);
  }
  return best;
}

Vec3 corner_shares(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double squared = std::max(n.squaredNorm(), 1e-30);
  const double v = (p - a).cross(c - a).dot(n) / squared, w = (b - a).cross(p - a).dot(n) / squared;
  return {1 - v - w, v, w};
}

void sheet_normals(const Sheet& sheet, const Points& nodes, Points& out) {
  out.setZero(nodes.rows(), 3);
  for (Eigen::Index f = 0; f < sheet.mesh.F.rows(); ++f) {
    const Eigen::RowVector3i t = sheet.mesh.F.row(f);
    const Vec3 a = node_of(nodes, t[0]);
    const Vec3 n = (node_of(nodes, t[1]) - a).cross(node_of(nodes, t[2]) - a);
    for (int k = 0; k < 3; ++k) out.row(t[k]) += n.transpose();
  }
  out.rowwise().normalize();
}

// Whether the nearest point is on the sheet, not beside it.
bool over_sheet(const Vec3& p, const Nearest& near, const Vec3& normal) {
  const Vec3 away = p - near.point;
  return (away - normal * normal.dot(away)).norm() <= kBeyondRim + 0.5 * std::abs(normal.dot(away));
}

void touch_mattress(const Patient& patient, const Vec3& p, const Vec3& n, const Mattress& mattress,
                    int vertex, std::vector<SkinContact>& out) {
  SkinContact contact;
  contact.vertex = vertex;
  contact.depth = mattress.height - p.y();
  const double facing = -n.y();
  if (contact.depth <= 0 || facing < kLeastFacing) return;
  const double thickness = patient.thickness[std::size_t(vertex)];
  const double tissue = patient.tissue.modulus / thickness;
  contact.area = facing * patient.area[std::size_t(vertex)];
  foundation(tissue * mattress.stiffness / (tissue + mattress.stiffness),
             mattress.bottom + thickness, contact.depth, contact.pressure, contact.slope);
  out.push_back(contact);
}

}  // namespace

void foundation(double stiffness, double thickness, double depth, double& pressure, double& slope) {
  const double share = 3 * depth / thickness, squared = share * share;
  pressure = stiffness * depth * (1 + squared / 3);
  slope = stiffness * (1 + squared);
}

void find_contacts(const Patient& patient, const Points& skin, const Points& normals,
                   const Sheet* sheet, const Points& nodes, const Mattress& mattress,
                   double seconds, ContactMemory& memory, std::vector<SkinContact>& out) {
  out.clear();
  const std::size_t count = std::size_t(skin.rows());
  Points up;
  if (sheet) sheet_normals(*sheet, nodes, up);
  if (memory.triangle.size() != count) {
    memory.triangle.assign(count, -1);
    memory.wait.assign(count, 0);
    if (sheet) {
      const NearestSurface surface({nodes, sheet->mesh.F});
      for (std::size_t i = 0; i < count; ++i)
        memory.triangle[i] =
            surface.nearest(skin.row(Eigen::Index(i)).transpose(), i ? memory.triangle[i - 1] : -1)
                .triangle;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (memory.wait[i] > 0) {
      --memory.wait[i];
      continue;
    }
    const Vec3 p = skin.row(Eigen::Index(i)).transpose(),
               n = normals.row(Eigen::Index(i)).transpose();
    double clear =
        mattress.present ? p.y() - mattress.height : std::numeric_limits<double>::infinity();
    bool on_sheet = false;
    if (sheet) {
      const Nearest near = descend(*sheet, nodes, p, memory.triangle[i]);
      memory.triangle[i] = near.triangle;
      const Eigen::RowVector3i t = sheet->mesh.F.row(near.triangle);
      const Vec3 shares = corner_shares(near.point, node_of(nodes, t[0]), node_of(nodes, t[1]),
                                        node_of(nodes, t[2]));
      const Vec3 normal =
          (shares[0] * up.row(t[0]) + shares[1] * up.row(t[1]) + shares[2] * up.row(t[2]))
              .transpose()
              .normalized();
      const double height = normal.dot(p - near.point);
      const double facing = -n.dot(normal);
      on_sheet = over_sheet(p, near, normal);
      clear = std::min(clear, std::sqrt(near.squared));
      if (on_sheet && height < 0 && height > -kReach) clear = 0;
      if (on_sheet && height < 0 && height > -kReach && facing > kLeastFacing) {
        SkinContact contact{
            int(i), near.triangle, shares, normal, -height, facing * patient.area[i], 0, 0};
        foundation(patient.tissue.modulus / patient.thickness[i], patient.thickness[i], -height,
                   contact.pressure, contact.slope);
        out.push_back(contact);
      }
    }
    if (mattress.present && !on_sheet) touch_mattress(patient, p, n, mattress, int(i), out);
    if (clear > 0)
      memory.wait[i] = std::clamp(int(clear / (kFastest * seconds)) - 1, 0, kLongestWait);
  }
}

}  // namespace ecorche::inline v1
