#include "skinning/constraints/collision_proxies.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kRing = 0.015;  // m; half length of the ring of skin that one sphere is fitted to
// What is wider than lean people's is fat, of which so much gives way where parts meet.
constexpr double kGives = 0.4, kGivesMost = 0.022;  // , m
constexpr double kLeanTrunk = 0.07;  // of the stature: half the depth of the trunk's ellipsoids
constexpr std::size_t kFewest = 6;   // vertices that a proxy is fitted to, at least

// A bone as a segment; each skin vertex belongs to the nearest.
struct Axis {
  Vec3 from, to;
};

double squared_distance(const Axis& axis, const Vec3& p) {
  const Vec3 along = axis.to - axis.from;
  const double t = std::clamp((p - axis.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - axis.from - t * along).squaredNorm();
}

class ProxyFitter {
 public:
  ProxyFitter(const Skeleton& skeleton, const Points& skin)
      : skeleton_(skeleton), skin_(skin), rest_(rest_positions(skeleton)) {}

  CollisionProxies run() {
    const Vec3 head = at("head");
    const Vec3 crown(head.x(), skin_.rows() > 0 ? skin_.col(1).maxCoeff() : head.y() + 0.2,
                     head.z());
    const int pelvis = axis(at("pelvis"), at("l1")), chest = axis(at("l1"), at("c7")),
              neck = axis(at("c7"), head), skull = axis(head, crown);
    std::array<int, 2> thigh{}, shank{}, foot{}, upper{}, fore{}, hand{};
    for (std::size_t s = 0; s < 2; ++s) {
      side_ = side_suffix(s == 0 ? Side::left : Side::right);
      thigh[s] = axis(at("hip" + side_), at("knee" + side_)),
      shank[s] = axis(at("knee" + side_), at("ankle" + side_));
      foot[s] = axis(at("ankle" + side_), at("mtp3" + side_));
      upper[s] = axis(at("shoulder" + side_), at("elbow" + side_)),
      fore[s] = axis(at("elbow" + side_), at("wrist" + side_));
      hand[s] = axis(at("wrist" + side_), at("dip3" + side_));
    }
    assign_vertices();
    CollisionProxies out;
    for (std::size_t s = 0; s < 2; ++s) {
      side_ = side_suffix(s == 0 ? Side::left : Side::right);
      std::vector<LimbSphere>&leg = out.limbs[s], &arm = out.limbs[2 + s];
      // Radii of lean people, as parts of the bone's length.
      for (const auto& [t, lean] : {std::pair{0.6, 0.185}, {0.8, 0.155}, {1.0, 0.135}})
        ring(thigh[s], t, "hip", t, 0, lean, leg);
      for (const auto& [t, lean] : {std::pair{0.2, 0.122}, {0.4, 0.122}, {0.6, 0.105}, {0.8, 0.08}})
        ring(shank[s], t, "knee", 1 - t, t, lean, leg);
      for (const double t : {0.0, 0.5, 1.0}) ring(foot[s], t, "subtalar", 0, 1, 1, leg);
      for (const auto& [t, lean] : {std::pair{0.25, 0.155}, {0.5, 0.125}, {0.75, 0.105}})
        ring(fore[s], t, t < 0.4 ? "elbow" : "forearm", 1 - t, t, lean, arm);
      for (const double t : {0.1, 0.35, 0.65}) ring(hand[s], t, "wrist", 0, 1, 1, arm);
    }
    const double hip = at("hip_l").y();
    slab({pelvis, chest, thigh[0], thigh[1]}, hip - 0.03, at("l5").y(), "pelvis", out);
    slab({pelvis, chest, thigh[0], thigh[1]}, at("l5").y(), at("l2").y(), "l3", out);
    slab({pelvis, chest}, at("l2").y(), at("thorax").y() + 0.03, "t12", out);
    slab({pelvis, chest}, at("thorax").y() + 0.03, at("c7").y() - 0.06, "thorax", out);
    whole({neck}, "c4", out);
    whole({skull}, "head", out);
    return out;
  }

 private:
  Vec3 at(const std::string& name) const { return rest_[joint_of(skeleton_, name)]; }

  int axis(const Vec3& from, const Vec3& to) {
    axes_.push_back({from, to});
    return int(axes_.size()) - 1;
  }

  void assign_vertices() {
    parts_.resize(axes_.size());
    for (Eigen::Index i = 0; i < skin_.rows(); ++i) {
      double least = std::numeric_limits<double>::infinity();
      std::size_t nearest = 0;
      for (std::size_t a = 0; a < axes_.size(); ++a) {
        const double d = squared_distance(axes_[a], skin_.row(i));
        if (d < least) least = d, nearest = a;
      }
      parts_[nearest].push_back(skin_.row(i));
    }
  }

  // A sphere from the ring of skin at fraction `t` of an axis. `lean`: its radius in lean people,
  // in lengths of the axis.
  void ring(int part, double t, const std::string& joint, double middle, double end, double lean,
            std::vector<LimbSphere>& out) const {
    const Axis& axis = axes_[part];
    const Vec3 way = axis.to - axis.from, along = way.normalized(), here = axis.from + t * way;
    std::vector<Vec3> points;
    for (const Vec3& p : parts_[part])
      if (std::abs((p - here).dot(along)) < kRing)
        points.push_back(p - (p - here).dot(along) * along);
    if (points.size() < kFewest) return;
    // The middle of the ring's extent, not of its vertices, whose density varies.
    const Vec3 across = along.unitOrthogonal(), third = along.cross(across);
    Vec3 centre = here;
    double radius = 0;
    for (const Vec3& u : {across, third}) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vec3& p : points)
        low = std::min(low, (p - here).dot(u)), high = std::max(high, (p - here).dot(u));
      centre += 0.5 * (low + high) * u;
    }
    for (const Vec3& p : points) radius += (p - centre).norm() / double(points.size());
    const int j = joint_of(skeleton_, joint + side_);
    out.push_back({j, centre - rest_[j], radius, middle, end, gives(radius, lean * way.norm())});
  }

  // The trunk between two heights: an ellipsoid 1.5 times as high.
  void slab(std::initializer_list<int> parts, double low, double high, const std::string& joint,
            CollisionProxies& out) const {
    std::vector<Vec3> points;
    for (const int part : parts)
      for (const Vec3& p : parts_[part])
        if (p.y() > low && p.y() < high) points.push_back(p);
    fit_ellipsoid(points, joint, {std::sqrt(2), 0, std::sqrt(2)}, 0.75 * (high - low), out);
  }
  void whole(std::initializer_list<int> parts, const std::string& joint,
             CollisionProxies& out) const {
    std::vector<Vec3> points;
    for (const int part : parts)
      points.insert(points.end(), parts_[part].begin(), parts_[part].end());
    fit_ellipsoid(points, joint, Vec3::Constant(std::sqrt(3)), 0, out);
  }

  // Half axes from the standard deviation of the surface: that of a ring is 1 / sqrt 2 of its
  // radius, that of a sphere 1 / sqrt 3.
  void fit_ellipsoid(const std::vector<Vec3>& points, const std::string& joint, const Vec3& spread,
                     double height, CollisionProxies& out) const {
    if (points.size() < kFewest) return;
    const double count = points.size();
    Vec3 low = points[0], high = points[0], sum = Vec3::Zero();
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vec3 centre = 0.5 * (low + high);
    for (const Vec3& p : points) sum += (p - centre).cwiseAbs2() / count;
    Vec3 half = spread.cwiseProduct(sum.cwiseSqrt());
    if (height > 0) half.y() = height;
    const int j = joint_of(skeleton_, joint);
    half = half.cwiseMin(0.5 * (high - low).cwiseMax(height));
    // Head and neck have little.
    const double lean =
        height > 0 ? kLeanTrunk * (skin_.col(1).maxCoeff() - skin_.col(1).minCoeff()) : HUGE_VAL;
    out.trunk.push_back({j, centre - rest_[j], half, gives(std::min(half.x(), half.z()), lean)});
  }

  static double gives(double half, double lean) {
    return std::clamp(kGives * (half - lean), 0.0, kGivesMost);
  }

  const Skeleton& skeleton_;
  const Points& skin_;
  const std::vector<Vec3> rest_;
  std::string side_;
  std::vector<Axis> axes_;
  std::vector<std::vector<Vec3>> parts_;  // an axis
};

}  // namespace

CollisionProxies measure_proxies(const Skeleton& skeleton, const Points& skin) {
  return ProxyFitter(skeleton, skin).run();
}

}  // namespace ecorche::inline v1
