#include "skinning/constraints/self_collision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche::inline v1 {
namespace {

// Tolerated penetration of soft tissue, as a fraction of both radii. More leaves visible overlap,
// less holds limbs off that would touch.
constexpr double kTissueYield = 0.08;
constexpr double kTrunkYield = 0.15;  // the same for an arm in the trunk, a rough set of ellipsoids
constexpr double kSmoothing = 0.05;   // s to either side of a shift
constexpr int kPasses = 12;           // of position based corrections, at most
// Over-relaxation: the mean over all pairs of a limb is less than its deepest pair needs.
constexpr double kOverRelaxation = 1.5;

// A proxy in the world.
struct Ellipsoid {
  Vec3 centre = Vec3::Zero();
  Mat3 axes = Mat3::Identity();
  Vec3 half = Vec3::Zero();
};

// Penetration of a sphere in another proxy, m, and the direction of separation.
double depth_of(const Vec3& centre, double radius, const Ellipsoid& other, Vec3& out) {
  const Vec3 half = other.half.array() + radius;
  const double reach = half.maxCoeff();
  if ((centre - other.centre).squaredNorm() >= reach * reach) return 0;
  const Vec3 p = other.axes.transpose() * (centre - other.centre);
  const Vec3 q = p.cwiseQuotient(half);
  const double inside = q.norm();
  if (inside >= 1) return 0;
  const Vec3 slope = q.cwiseQuotient(half);  // of inside^2 / 2
  const double steep = slope.norm();
  if (inside < 1e-6 || steep < 1e-9) return 0;  // at the centre no direction is given
  out = other.axes * (slope / steep);
  return std::min((1 - inside) * inside / steep, half.minCoeff());
}

// The proxies of one pose, limbs as far as they are shifted.
class PosedProxies {
 public:
  PosedProxies(const SelfCollisionTables& tables, const std::vector<Transform>& X)
      : tables_(tables) {
    for (std::size_t l = 0; l < tables.proxies.limbs.size(); ++l) {
      first_[l] = int(at_.size());
      for (const LimbSphere& sphere : tables.proxies.limbs[l])
        at_.push_back(X[std::size_t(sphere.joint)] * sphere.centre);
    }
    now_ = at_;
    for (const TrunkEllipsoid& one : tables.proxies.trunk) {
      const Transform& frame = X[std::size_t(one.joint)];
      trunk_.push_back({frame * one.centre, frame.linear(), one.half});
    }
  }

  const LimbSphere& sphere(int limb, int s) const { return tables_.proxies.limbs[limb][s]; }
  const Vec3& centre(int limb, int s) const { return now_[std::size_t(first_[limb] + s)]; }

  void shift(const LimbShifts& shifts) {
    std::size_t k = 0;
    for (std::size_t l = 0; l < tables_.proxies.limbs.size(); ++l)
      for (const LimbSphere& one : tables_.proxies.limbs[l]) {
        now_[k] = at_[k] + one.middle * shifts[l].middle + one.end * shifts[l].end;
        ++k;
      }
  }

  double depth(const ProxyPair& pair, Vec3& out) const {
    const Vec3& here = centre(pair.limb, pair.sphere);
    const double radius = sphere(pair.limb, pair.sphere).radius;
    if (pair.other_limb < 0) return depth_of(here, radius, trunk_[std::size_t(pair.other)], out);
    const Vec3 way = here - centre(pair.other_limb, pair.other);
    const double reach = radius + sphere(pair.other_limb, pair.other).radius,
                 squared = way.squaredNorm();
    // At the centre no direction is given.
    if (squared >= reach * reach || squared < 1e-12 * reach * reach) return 0;
    const double distance = std::sqrt(squared);
    out = way / distance;
    return reach - distance;
  }

 private:
  const SelfCollisionTables& tables_;
  std::array<int, 4> first_{};
  std::vector<Vec3> at_, now_;  // centres of all limbs' spheres
  std::vector<Ellipsoid> trunk_;
};

void add(const LimbSphere& sphere, const Vec3& move, double squares, LimbShift& shift) {
  shift.middle += sphere.middle / squares * move;
  shift.end += sphere.end / squares * move;
}

}  // namespace

SelfCollisionTables make_collision_tables(const Skeleton& skeleton, CollisionProxies fitted) {
  SelfCollisionTables tables{std::move(fitted), {}};
  const auto& limbs = tables.proxies.limbs;
  const auto& trunk = tables.proxies.trunk;
  std::vector<Transform> X;
  forward_kinematics(skeleton, rest_pose(skeleton), X);
  const auto pair = [&](int limb, int other_limb, CollisionKind kind) {
    for (int b = 0; b < int(limbs[limb].size()); ++b) {
      const std::size_t others = other_limb >= 0 ? limbs[other_limb].size() : trunk.size();
      for (int o = 0; o < int(others); ++o)
        tables.pairs.push_back({limb, b, other_limb, o, 0, kind});
    }
  };
  pair(0, 1, CollisionKind::leg_leg);
  pair(2, 3, CollisionKind::arm_arm);
  for (const int arm : {2, 3}) {
    pair(arm, 0, CollisionKind::arm_leg), pair(arm, 1, CollisionKind::arm_leg);
    pair(arm, -1, CollisionKind::arm_trunk);
  }
  const int head = find_joint(skeleton, "head");
  const PosedProxies proxies{tables, X};
  for (ProxyPair& one : tables.pairs) {
    double yield = kTissueYield, size = proxies.sphere(one.limb, one.sphere).radius,
           gives = proxies.sphere(one.limb, one.sphere).gives;
    if (one.other_limb >= 0) {
      size += proxies.sphere(one.other_limb, one.other).radius;
      gives += proxies.sphere(one.other_limb, one.other).gives;
    } else {
      const TrunkEllipsoid& ellipsoid = trunk[one.other];
      if (ellipsoid.joint == head) one.kind = CollisionKind::arm_head;
      if (ellipsoid.joint != head) yield = kTrunkYield;
      size += ellipsoid.half.minCoeff();
      gives += ellipsoid.gives;
    }
    Vec3 out;
    one.allowed = std::max(yield * size + gives, proxies.depth(one, out));
  }
  return tables;
}

PenetrationDepths penetration_depths(const SelfCollisionTables& tables,
                                     const std::vector<Transform>& X) {
  const PosedProxies proxies{tables, X};
  PenetrationDepths depths{};
  Vec3 out;
  for (const ProxyPair& pair : tables.pairs) {
    double& deepest = depths[int(pair.kind)];
    deepest = std::max(deepest, proxies.depth(pair, out) - pair.allowed);
  }
  return depths;
}

void find_proxy_contacts(const SelfCollisionTables& tables, const std::vector<Transform>& X,
                         std::vector<ProxyContact>& out) {
  out.clear();
  const PosedProxies proxies{tables, X};
  for (const ProxyPair& pair : tables.pairs) {
    ProxyContact contact;
    const double depth = proxies.depth(pair, contact.out);
    if (depth <= pair.allowed) continue;
    const LimbSphere& mine = proxies.sphere(pair.limb, pair.sphere);
    contact.joint = mine.joint;
    contact.other_joint = pair.other_limb >= 0
                              ? proxies.sphere(pair.other_limb, pair.other).joint
                              : tables.proxies.trunk[std::size_t(pair.other)].joint;
    contact.depth = depth - pair.allowed;
    contact.point =
        proxies.centre(pair.limb, pair.sphere) - (mine.radius - 0.5 * depth) * contact.out;
    out.push_back(contact);
  }
}

LimbShifts separate_limbs(const SelfCollisionTables& tables, const std::vector<Transform>& X) {
  PosedProxies proxies{tables, X};
  LimbShifts own;
  for (int pass = 0; pass < kPasses; ++pass) {
    // All pairs at once, so that left and right are treated alike.
    LimbShifts step;
    std::array<int, 4> counts{};
    for (const ProxyPair& pair : tables.pairs) {
      Vec3 out;
      const double deep = proxies.depth(pair, out) - pair.allowed;
      if (deep <= 0) continue;
      const LimbSphere& mine = proxies.sphere(pair.limb, pair.sphere);
      double squares = mine.middle * mine.middle + mine.end * mine.end;
      const LimbSphere* theirs =
          pair.other_limb >= 0 ? &proxies.sphere(pair.other_limb, pair.other) : nullptr;
      if (theirs) squares += theirs->middle * theirs->middle + theirs->end * theirs->end;
      add(mine, deep * out, squares, step[pair.limb]);
      ++counts[pair.limb];
      if (!theirs) continue;
      add(*theirs, -deep * out, squares, step[pair.other_limb]);
      ++counts[pair.other_limb];
    }
    if (counts == std::array<int, 4>{}) break;
    for (std::size_t l = 0; l < 4; ++l) {
      if (counts[l] == 0) continue;
      own[l].middle += kOverRelaxation / counts[l] * step[l].middle;
      own[l].end += kOverRelaxation / counts[l] * step[l].end;
    }
    proxies.shift(own);
  }
  return own;
}

void smooth_shifts(double fps, std::vector<LimbShifts>& shifts) {
  using Both = Eigen::Vector<double, 6>;  // of a limb: middle, end
  std::vector<Both> limb(shifts.size());
  for (std::size_t l = 0; l < 4; ++l) {
    for (std::size_t f = 0; f < shifts.size(); ++f)
      limb[f] << shifts[f][l].middle, shifts[f][l].end;
    smooth_maximum(int(std::lround(kSmoothing * fps)), limb,
                   [](const Both& a, const Both& b) { return a.squaredNorm() > b.squaredNorm(); });
    for (std::size_t f = 0; f < shifts.size(); ++f)
      shifts[f][l] = {limb[f].head<3>(), limb[f].tail<3>()};
  }
}

}  // namespace ecorche::inline v1
