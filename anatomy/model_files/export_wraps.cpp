#include "anatomy/model_files/export_wraps.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr double kLeastRadius = 0.002;  // m

// How far a point is from the object's middle, 1 on its surface.
double depth_scale(const Wrap& wrap, const Vec3& world) {
  Vec3 p = wrap.X_WO.inverse() * world;
  if (wrap.kind != Wrap::Kind::cylinder) return p.cwiseQuotient(wrap.radii).norm();
  p.z() = std::max(0.0, std::abs(p.z()) - wrap.radii.z());  // past the ends
  return p.norm() / wrap.radii.x();
}

}  // namespace

std::vector<Vec3> origins_of(const ExportModel& model) {
  std::vector<Vec3> out;
  for (const ExportBody& body : model.bodies)
    out.push_back(body.parent < 0 ? body.place : Vec3(out[body.parent] + body.place));
  return out;
}

PlacedWrap place_wrap(const ExportStrip& strip, const Wrap& wrap,
                      const std::vector<Vec3>& origins) {
  constexpr int kSteps = 64;  // of a piece
  const auto point = [&](std::size_t k) {
    return Vec3(origins[strip.bodies[k]] + strip.points[k]);
  };
  PlacedWrap best;
  double least = 1e300;
  for (std::size_t k = 1; k < strip.points.size(); ++k) {
    const Vec3 a = point(k - 1), b = point(k);
    for (int step = 0; step <= kSteps; ++step) {
      const Vec3 p = a + (b - a) * step / kSteps;
      const double scale = depth_scale(wrap, p);
      if (scale >= least) continue;
      least = scale;
      best = {k, p, (b - a).normalized()};
    }
  }
  return best;
}

std::optional<Wrap> osculating_sphere(const Wrap& ellipsoid, const PlacedWrap& placed) {
  const Vec3 q = ellipsoid.X_WO.inverse() * placed.near,
             along = ellipsoid.X_WO.linear().transpose() * placed.along;
  const double scale = q.cwiseQuotient(ellipsoid.radii).norm();
  if (!(scale > 0)) return std::nullopt;
  const Vec3 p = q / scale, squares = ellipsoid.radii.cwiseAbs2();
  const Vec3 gradient = p.cwiseQuotient(squares), normal = gradient.normalized();
  Vec3 t = along - normal * normal.dot(along);
  if (t.norm() < 1e-9) t = normal.unitOrthogonal();
  t.normalize();
  const double radius =
      gradient.norm() /
      t.cwiseAbs2().cwiseQuotient(squares).sum();  // of the section along the line
  const double below = std::max(0.0, (p - q).dot(normal));
  if (radius - below < kLeastRadius) return std::nullopt;
  Wrap out;
  out.kind = Wrap::Kind::sphere;
  out.joint = ellipsoid.joint;
  out.X_WO.translation() = ellipsoid.X_WO * Vec3(p - radius * normal);
  out.radii = Vec3::Constant(radius - below);
  return out;
}

}  // namespace ecorche::inline v1
