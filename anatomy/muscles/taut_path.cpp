#include "anatomy/muscles/taut_path.h"

#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr int kLinks = 32, kRounds = 400;
constexpr double kTouch = 1.002;  // of the radius: points this near are in contact
// rad between the ends' normals: beyond it a third point holds the arc
constexpr double kLongArc = 0.35;

class Object {
 public:
  Object(const Wrap& wrap, double clear)
      : cylinder_(wrap.kind == Wrap::Kind::cylinder), half_(wrap.radii.z()) {
    radii_ = wrap.radii.array() + clear;
    if (cylinder_) radii_.z() = 1;  // not used
  }
  // 1 on the surface, less inside.
  double level(const Vec3& p) const {
    const Vec3 q = p.cwiseQuotient(radii_);
    if (!cylinder_) return q.norm();
    return std::abs(p.z()) > half_ ? 2 : q.head<2>().norm();
  }
  Vec3 out(const Vec3& p) const {
    Vec3 q = p.cwiseQuotient(radii_);
    if (cylinder_) {
      q.head<2>().normalize();
      return {q.x() * radii_.x(), q.y() * radii_.y(), p.z()};
    }
    return q.normalized().cwiseProduct(radii_);
  }
  Vec3 normal(const Vec3& p) const {
    Vec3 n = p.cwiseQuotient(radii_).cwiseQuotient(radii_);
    if (cylinder_) n.z() = 0;
    return n.normalized();
  }
  Vec3 flat(Vec3 v) const {
    if (cylinder_) v.z() = 0;
    return v;
  }
  double largest() const { return cylinder_ ? radii_.head<2>().maxCoeff() : radii_.maxCoeff(); }

 private:
  bool cylinder_;
  double half_;
  Vec3 radii_;
};

}  // namespace

std::vector<Vec3> taut_points(const Vec3& a_world, const Vec3& b_world, const Wrap& wrap,
                              const Vec3& side, double clear) {
  const Transform X_OW = wrap.X_WO.inverse();
  const Vec3 a = X_OW * a_world, b = X_OW * b_world;
  const Object object(wrap, clear);
  if (object.level(a) <= 1 || object.level(b) <= 1) return {};
  std::vector<Vec3> chain;
  int deepest = 0;
  for (int i = 0; i <= kLinks; ++i) {
    chain.push_back(a + (b - a) * i / kLinks);
    if (object.level(chain[i]) < object.level(chain[deepest])) deepest = i;
  }
  if (object.level(chain[deepest]) >= 1) return {};
  // Across the line, to the side that is asked for, or else the one the line is on already.
  const Vec3 along = (b - a).normalized();
  const auto across = [&](const Vec3& v) {
    return Vec3(object.flat(v) - along * along.dot(object.flat(v)));
  };
  Vec3 lift = across(side.isZero() ? chain[deepest] : side);
  if (lift.norm() < 1e-9) lift = across(along.unitOrthogonal());
  lift.normalize();
  for (int i = 1; i < kLinks; ++i)
    chain[i] += 2 * object.largest() * std::sin(3.14159265358979323846 * i / kLinks) * lift;
  for (int round = 0; round < kRounds; ++round)
    for (int i = 1; i < kLinks; ++i) {
      chain[i] = (chain[i - 1] + chain[i + 1]) / 2;
      if (object.level(chain[i]) < 1) chain[i] = object.out(chain[i]);
    }
  int first = -1, last = -1;
  for (int i = 1; i < kLinks; ++i)
    if (object.level(chain[i]) < kTouch) {
      if (first < 0) first = i;
      last = i;
    }
  if (first < 0) return {};
  std::vector<int> kept{first};
  const double arc =
      std::acos(std::clamp(object.normal(chain[first]).dot(object.normal(chain[last])), -1.0, 1.0));
  if (arc > kLongArc && last - first >= 2) kept.push_back((first + last) / 2);
  if (last > first) kept.push_back(last);
  if (arc <= kLongArc) kept = {(first + last) / 2};
  std::vector<Vec3> out;
  for (int i : kept) out.push_back(wrap.X_WO * chain[i]);
  return out;
}

}  // namespace ecorche::inline v1
