#include "skinning/lift/skin_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kReach = 0.08;   // m, deepest contact; deeper is the far side of a limb
constexpr double kFastest = 1.5;  // m/s, of skin and sheet towards each other
// The hem is padded: it presses on skin that is so far from it along the skin, less by the
// roundness of this radius, and never deeper than the last, m. Narrower: few vertices carry what it
// presses on.
constexpr double kHemWidth = 0.03, kHemRadius = 0.02, kHemReach = 0.04;
constexpr double kHemFacing = 0.3;     // cosine
constexpr double kBeside = 1e-3;       // m, beyond the sheet's edge
constexpr double kMostBulge = 0.004;   // m, by which the curved sheet leaves its triangle
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

Vec3 corner_shares(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double squared = std::max(n.squaredNorm(), 1e-30);
  const double v = (p - a).cross(c - a).dot(n) / squared, w = (b - a).cross(p - a).dot(n) / squared;
  return {1 - v - w, v, w};
}

// From a triangle on to ever nearer ones around its corners.
Nearest descend(const Sheet& sheet, const Points& nodes, const Vec3& p, int start) {
  Nearest best;
  look_at(sheet.mesh.F, nodes, start, p, best);
  // Beneath the inside of the triangle: none is nearer on a sheet that is not folded.
  const Eigen::RowVector3i first = sheet.mesh.F.row(start);
  if (corner_shares(p, node_of(nodes, first[0]), node_of(nodes, first[1]), node_of(nodes, first[2]))
          .minCoeff() > 0)
    return best;
  for (int from = -1; from != best.triangle;) {
    from = best.triangle;
    for (int k = 0; k < 3; ++k)
      for (const int t : sheet.around[std::size_t(sheet.mesh.F(from, k))])
        if (t != from) look_at(sheet.mesh.F, nodes, t, p, best);
  }
  return best;
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

// How far the nearest point is from the foot of the vertex, along the sheet: above 0 beside it, m.
double beside_sheet(const Vec3& p, const Nearest& near, const Vec3& normal) {
  const Vec3 away = p - near.point;
  return (away - normal * normal.dot(away)).norm();
}

// Height of the smooth sheet over its triangle, m: exact where it is curved evenly (after Boubekeur
// and Alexa 2008, 10.1145/1409060.1409094, with half of their projection).
double bulge_of(const Points& nodes, const Points& up, const Eigen::RowVector3i& t,
                const Vec3& corners, const Vec3& at, const Vec3& normal) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 n = node_of(up, t[k]);
    sum += 0.5 * corners[k] * (node_of(nodes, t[k]) - at).dot(n) * n.dot(normal);
  }
  return std::clamp(sum, -kMostBulge, kMostBulge);
}

// Skin beside the sheet's edge: the hem is a round line that is pressed into it. Only from outside:
// the skin faces the sheet, or back along it. `area`: of the vertex.
void press_hem(const Vec3& p, const Vec3& n, const Vec3& hem, double area, SkinContact& contact) {
  const Vec3 away = p - hem, beyond = away - contact.normal * contact.normal.dot(away);
  const double facing = -n.dot(contact.normal), back = -n.dot(beyond.normalized());
  const double depth = n.dot(away), along = (away - depth * n).norm();
  contact.depth = depth - 0.5 * along * along / kHemRadius;
  const bool wrong_side =
      std::max(facing, back) < kHemFacing || std::min(facing, back) < -kHemFacing;
  if (wrong_side || along > kHemWidth || depth > kHemReach) contact.depth = 0;
  contact.area = std::clamp(std::max(facing, back), 0.0, 1.0) * area;
  contact.normal = -n;
}

// Tissue and foam in series, `depth` along the normal.
void press_foam(const Patient& patient, double depth, const Vec3& n, double stiffness,
                double bottom, SkinContact& contact, std::vector<SkinContact>& out) {
  const int vertex = contact.vertex;
  contact.depth = depth;
  const double facing = -n.dot(contact.normal);
  if (contact.depth <= 0 || facing < kLeastFacing) return;
  const double thickness = patient.thickness[std::size_t(vertex)];
  const double tissue = patient.tissue.modulus / thickness;
  contact.area = facing * patient.area[std::size_t(vertex)];
  foundation(tissue * stiffness / (tissue + stiffness), bottom + thickness, contact.depth,
             contact.pressure, contact.slope);
  out.push_back(contact);
}

void touch_mattress(const Patient& patient, const Vec3& p, const Vec3& n, const Mattress& mattress,
                    int vertex, std::vector<SkinContact>& out) {
  SkinContact contact;
  contact.vertex = vertex;
  press_foam(patient, mattress.height - p.y(), n, mattress.stiffness, mattress.bottom, contact,
             out);
}

// How far the pad's surface falls beside its middle part, `over` m beyond that.
double fallen(double over, double edge) { return over > 0 ? 0.5 * over * over / edge : 0; }

// A lower bound of the distance from the pad, m.
double touch_pad(const Patient& patient, const Vec3& p, const Vec3& n, const Pad& pad, int index,
                 int vertex, std::vector<SkinContact>& out) {
  const Vec3 at = pad.X_WP.inverse(Eigen::Isometry) * p;
  const double beside_x = std::abs(at.x()) - pad.half_width,
               beside_z = std::abs(at.z()) - pad.half_length, beside = std::max(beside_x, beside_z);
  if (at.y() > 0 || beside > 0) return std::max({at.y(), beside, 0.0});
  const double depth =
      -at.y() - fallen(beside_x + pad.edge, pad.edge) - fallen(beside_z + pad.edge, pad.edge);
  if (depth > kReach) return 0;
  SkinContact contact;
  contact.vertex = vertex;
  contact.pad = index;
  contact.normal = pad.X_WP.linear().col(1);
  press_foam(patient, depth, n, pad.stiffness, pad.bottom, contact, out);
  return 0;
}

}  // namespace

void foundation(double stiffness, double thickness, double depth, double& pressure, double& slope) {
  const double share = 3 * depth / thickness, squared = share * share;
  pressure = stiffness * depth * (1 + squared / 3);
  slope = stiffness * (1 + squared);
}

void find_contacts(const Patient& patient, const Points& skin, const Points& normals,
                   const Sheet* sheet, const Points& nodes, const Mattress& mattress,
                   std::span<const Pad> pads, double seconds, ContactMemory& memory,
                   std::vector<SkinContact>& out) {
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
      clear = std::min(clear, std::sqrt(near.squared));
      SkinContact contact{int(i), near.triangle, -1, shares, normal, 0, 0, 0, 0};
      const double beside = beside_sheet(p, near, normal);
      on_sheet = beside < kHemWidth;
      if (beside > kBeside) {
        press_hem(p, n, near.point, patient.area[i], contact);
      } else {
        contact.depth =
            bulge_of(nodes, up, t, shares, near.point, normal) - normal.dot(p - near.point);
        if (contact.depth > kReach) contact.depth = 0;
        contact.area = std::max(0.0, -n.dot(normal)) * patient.area[i];
      }
      if (contact.depth > 0) clear = 0;
      if (contact.depth > 0 && contact.area > kLeastFacing * patient.area[i]) {
        foundation(patient.tissue.modulus / patient.thickness[i], patient.thickness[i],
                   contact.depth, contact.pressure, contact.slope);
        out.push_back(contact);
      }
    }
    if (mattress.present && !on_sheet) touch_mattress(patient, p, n, mattress, int(i), out);
    for (std::size_t k = 0; k < pads.size(); ++k)
      clear = std::min(clear, touch_pad(patient, p, n, pads[k], int(k), int(i), out));
    if (clear > 0)
      memory.wait[i] = std::clamp(int(clear / (kFastest * seconds)) - 1, 0, kLongestWait);
  }
}

}  // namespace ecorche::inline v1
