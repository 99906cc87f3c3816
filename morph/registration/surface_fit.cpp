#include "morph/registration/surface_fit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Round {
  double length;     // m
  double farthest;   // m, of matches
  double width;      // m, distances beyond count less
  double agreement;  // least cosine of normals
};
constexpr Round kRounds[] = {
    {0.12, 0.12, 0.05, 0.2},   {0.08, 0.10, 0.04, 0.3},   {0.05, 0.08, 0.03, 0.3},
    {0.03, 0.06, 0.02, 0.4},   {0.02, 0.04, 0.015, 0.5},  {0.013, 0.03, 0.01, 0.5},
    {0.009, 0.025, 0.01, 0.5}, {0.0065, 0.02, 0.01, 0.6}, {0.0065, 0.02, 0.01, 0.6}};
// Fine features of the mesh that scans do not show keep their shape, m.
constexpr double kHandLength = 0.015, kHeadLength = 0.008, kFootLength = 0.008;
constexpr double kOutsideShare = 0.05;  // of the weight, of clothes that stand off

// Laplacian weights over a surface, and areas.
struct Laplacian {
  Sparse C;              // symmetric, rows sum to 0
  Eigen::VectorXd area;  // m^2
};

Laplacian make_laplacian(const Triangles& F, const Points& V) {
  std::vector<Eigen::Triplet<double>> entries;
  Laplacian out;
  out.area.setZero(V.rows());
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int i = F(f, k), j = F(f, (k + 1) % 3), opposite = F(f, (k + 2) % 3);
      const Vec3 a = (V.row(i) - V.row(opposite)).transpose(),
                 b = (V.row(j) - V.row(opposite)).transpose();
      const double cross = a.cross(b).norm();
      const double cotangent = std::clamp(a.dot(b) / std::max(cross, 1e-12), 0.05, 5.0) / 2;
      entries.emplace_back(i, j, -cotangent);
      entries.emplace_back(j, i, -cotangent);
      entries.emplace_back(i, i, cotangent);
      entries.emplace_back(j, j, cotangent);
      out.area[opposite] += cross / 6;
    }
  }
  out.C.resize(V.rows(), V.rows());
  out.C.setFromTriplets(entries.begin(), entries.end());
  out.area = out.area.cwiseMax(out.area.mean() * 0.02);
  return out;
}

// C diag(length^4 / area) C.
Sparse stiffness(const Laplacian& laplacian, const Eigen::VectorXd& length) {
  const Eigen::VectorXd d = length.array().pow(4) / laplacian.area.array();
  return laplacian.C * d.asDiagonal() * laplacian.C;
}

double welsch(double distance, double width) {
  return std::exp(-distance * distance / (2 * width * width));
}

Eigen::VectorXd lengths(const ArticulatedBody& body, double length, double spacing) {
  Eigen::VectorXd out(Eigen::Index(body.parts.size()));
  for (std::size_t i = 0; i < body.parts.size(); ++i) {
    const BodyPart part = body.parts[i].part;
    const double least = part == BodyPart::hand   ? kHandLength
                         : part == BodyPart::head ? kHeadLength
                         : part == BodyPart::foot ? kFootLength
                                                  : 0;
    out[Eigen::Index(i)] = std::max({length, least, 0.7 * spacing});
    if (!body.outer[i]) out[Eigen::Index(i)] = std::max(out[Eigen::Index(i)], 0.05);
  }
  return out;
}

}  // namespace

SurfaceFit fit_surface(const SurfaceFitInput& input, const Points& start) {
  const ArticulatedBody& body = input.body;
  const Eigen::Index n = start.rows();
  const Laplacian laplacian = make_laplacian(body.F, start);
  // Triangles of the outer skin alone answer the scan.
  std::vector<std::vector<int>> faces_of;
  faces_of.resize(std::size_t(n));
  for (Eigen::Index f = 0; f < body.F.rows(); ++f)
    if (body.outer[std::size_t(body.F(f, 0))] && body.outer[std::size_t(body.F(f, 1))] &&
        body.outer[std::size_t(body.F(f, 2))])
      for (int k = 0; k < 3; ++k) faces_of[std::size_t(body.F(f, k))].push_back(int(f));
  const PointTree scan_tree(input.scan, 0.05);
  Points displacement = Points::Zero(n, 3);
  SurfaceFit out;
  out.seen.assign(std::size_t(n), 0);
  for (const Round& round : kRounds) {
    const Points now = start + displacement;
    const Points normals = vertex_normals({now, body.F});
    std::vector<Eigen::Triplet<double>> entries;
    Points right = Points::Zero(n, 3);
    std::vector<char> seen(std::size_t(n), 0);
    // Body to scan.
    std::vector<double> weight(std::size_t(n), 0);
    Points goal(n, 3);
    parallel_for_ranges(
        std::size_t(n), 256, Threads::all, [&](std::size_t first, std::size_t last) {
          for (std::size_t i = first; i < last; ++i) {
            if (!body.outer[i]) continue;
            const Eigen::Index row = Eigen::Index(i);
            const Vec3 x = now.row(row), normal = normals.row(row);
            const NearPoint near = scan_tree.nearest(x, normal);
            const Vec3 y = input.scan.points.row(near.index),
                       m = input.scan.normals.row(near.index);
            if ((x - y).norm() > round.farthest || m.dot(normal) < round.agreement) continue;
            if (!input.border.empty() && input.border[std::size_t(near.index)]) continue;
            const double off = m.dot(y - x);
            // Far along the surface: what lies there is a neighbour's.
            if ((x - y).norm() > std::abs(off) + 2.5 * input.spacing + 0.004) continue;
            double w = welsch(off, round.width);
            if (!input.covering.empty() && input.covering[std::size_t(near.index)] && off > 0.003)
              w *= kOutsideShare;
            weight[i] = w;
            goal.row(row) = displacement.row(row) + off * m.transpose();
          }
        });
    for (Eigen::Index i = 0; i < n; ++i) {
      const double w = laplacian.area[i] * weight[std::size_t(i)];
      entries.emplace_back(i, i, w + 1e-6 * laplacian.area[i]);
      if (w <= 0) continue;
      right.row(i) += w * goal.row(i);
      seen[std::size_t(i)] = 1;
    }
    // Scan to body.
    const SurfacePoints skin{now, normals};
    const PointTree skin_tree(skin, 0.05);
    struct Answer {
      int face = -1;
      Vec3 shares = Vec3::Zero(), step = Vec3::Zero();
      double weight = 0;
    };
    const std::size_t count = std::size_t(input.scan.points.rows());
    std::vector<Answer> answers(count);
    parallel_for_ranges(count, 256, Threads::all, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        if (!input.border.empty() && input.border[i]) continue;
        const Vec3 y = input.scan.points.row(Eigen::Index(i)),
                   m = input.scan.normals.row(Eigen::Index(i));
        const NearPoint near = skin_tree.nearest(y, m);
        Answer best;
        double distance = round.farthest;
        Vec3 foot = Vec3::Zero();
        for (const int f : faces_of[std::size_t(near.index)]) {
          const Vec3 p = nearest_in_triangle(y, now.row(body.F(f, 0)), now.row(body.F(f, 1)),
                                             now.row(body.F(f, 2)));
          if ((p - y).norm() < distance) {
            distance = (p - y).norm();
            best.face = f;
            foot = p;
          }
        }
        if (best.face < 0) continue;
        const Vec3 a = now.row(body.F(best.face, 0)), b = now.row(body.F(best.face, 1)),
                   c = now.row(body.F(best.face, 2));
        const Vec3 across = (b - a).cross(c - a);
        const double twice = across.norm();
        if (twice < 1e-12) continue;
        const Vec3 normal = across / twice;
        if (m.squaredNorm() > 0.5 && normal.dot(m) < round.agreement) continue;
        best.shares =
            Vec3((b - foot).cross(c - foot).dot(normal), (c - foot).cross(a - foot).dot(normal),
                 (a - foot).cross(b - foot).dot(normal)) /
            twice;
        const double off = normal.dot(y - foot);
        best.step = off * normal;
        best.weight = welsch((y - foot).norm(), round.width) * double(input.area[i]);
        if (!input.covering.empty() && input.covering[i] && off > 0.003)
          best.weight *= kOutsideShare;
        answers[i] = best;
      }
    });
    for (const Answer& answer : answers) {
      if (answer.face < 0) continue;
      Vec3 here = Vec3::Zero();
      for (int k = 0; k < 3; ++k)
        here += answer.shares[k] * displacement.row(body.F(answer.face, k)).transpose();
      const Vec3 wanted = here + answer.step;
      for (int k = 0; k < 3; ++k) {
        const int i = body.F(answer.face, k);
        seen[std::size_t(i)] = 1;
        right.row(i) += answer.weight * answer.shares[k] * wanted.transpose();
        for (int l = 0; l < 3; ++l)
          entries.emplace_back(i, body.F(answer.face, l),
                               answer.weight * answer.shares[k] * answer.shares[l]);
      }
    }
    Sparse A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    A += stiffness(laplacian, lengths(body, round.length, input.spacing));
    const Eigen::SimplicialLDLT<Sparse> factor(A);
    const Eigen::MatrixXd solved = factor.solve(Eigen::MatrixXd(right));
    if (factor.info() != Eigen::Success || !solved.allFinite()) break;
    displacement = solved;
    out.seen = std::move(seen);
  }
  out.posed = start + displacement;
  return out;
}

Points smooth_over_skin(const ArticulatedBody& body, const Points& surface, const Points& given,
                        const std::vector<double>& weight, double length) {
  const Laplacian laplacian = make_laplacian(body.F, surface);
  const Eigen::VectorXd w =
      Eigen::Map<const Eigen::VectorXd>(weight.data(), Eigen::Index(weight.size()))
          .cwiseProduct(laplacian.area);
  Sparse A = stiffness(laplacian, Eigen::VectorXd::Constant(surface.rows(), length));
  Sparse D(surface.rows(), surface.rows());
  D.setIdentity();
  A += Sparse(D * (w + 1e-6 * laplacian.area).asDiagonal());
  const Eigen::SimplicialLDLT<Sparse> factor(A);
  return factor.solve(Eigen::MatrixXd(w.asDiagonal() * given));
}

}  // namespace ecorche::inline v1
