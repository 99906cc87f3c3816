#include "skinning/interior/map_points.h"

#include <cmath>

#include "anatomy/compute/simd.h"

namespace ecorche::inline v1 {
namespace {

// x y z w of the rotation, then of the dual part.
std::array<float, 8> dual_quaternion(const Transform& X) {
  const Quat q = Quat(X.linear()).normalized();
  const Vec3 t = X.translation();
  const Quat dual = Quat(0, t.x(), t.y(), t.z()) * q;
  std::array<float, 8> out;
  for (std::size_t k = 0; k < 4; ++k) {
    out[k] = float(q.coeffs()[Eigen::Index(k)]);
    out[4 + k] = float(0.5 * dual.coeffs()[Eigen::Index(k)]);
  }
  return out;
}

Vec3 weighted(std::span<const MapPoints::Share> shares, std::span<const float> rows) {
  Float4 sum{};
  for (const MapPoints::Share& share : shares)
    sum += share.weight * load4(&rows[4 * std::size_t(share.source)]);
  return {double(sum[0]), double(sum[1]), double(sum[2])};
}

std::span<const MapPoints::Share> shares_of(const MapPoints& points, int begin, int end) {
  return std::span(points.shares).subspan(std::size_t(begin), std::size_t(end - begin));
}

std::span<const MapPoints::Share> joints_of(const MapPoints& points, std::size_t i) {
  return shares_of(points, points.heads[i].joints, points.heads[i].skin);
}
std::span<const MapPoints::Share> skin_of(const MapPoints& points, std::size_t i) {
  return shares_of(points, points.heads[i].skin, points.heads[i].cells);
}
std::span<const MapPoints::Share> cells_of(const MapPoints& points, std::size_t i) {
  return shares_of(points, points.heads[i].cells, points.heads[i + 1].joints);
}

Float4 low_half(Float8 v) { return __builtin_shufflevector(v, v, 0, 1, 2, 3); }
Float4 high_half(Float8 v) { return __builtin_shufflevector(v, v, 4, 5, 6, 7); }

Float8 blended(const JointMotions& motions, const MapPoints& points, std::size_t i) {
  Float8 sum{};
  for (const MapPoints::Share& share : joints_of(points, i))
    sum += share.weight * load8(motions.rotations[std::size_t(share.source)].data());
  const Float4 q = low_half(sum);
  return sum * (1 / std::sqrt(sum4(q * q)[0]));
}

}  // namespace

MapPoints pack_points(std::span<const MapPoint> points) { return pack_points(points, {}, {}); }

MapPoints pack_points(std::span<const MapPoint> points, std::span<const int> was,
                      const MapPoints& before) {
  MapPoints out;
  const auto add = [&](const SourceWeights& weights) {
    const int begin = int(out.shares.size());
    for (int k = 0; k < weights.count; ++k)
      out.shares.push_back({weights.source[std::size_t(k)], weights.weight[std::size_t(k)]});
    return begin;
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    MapPoints::Head head;
    if (!was.empty() && was[i] >= 0) {
      const std::size_t k = std::size_t(was[i]);
      const int shift = int(out.shares.size()) - before.heads[k].joints;
      head = before.heads[k];
      for (int* begin : {&head.joints, &head.skin, &head.cells}) *begin += shift;
      out.shares.insert(out.shares.end(), before.shares.begin() + before.heads[k].joints,
                        before.shares.begin() + before.heads[k + 1].joints);
    } else {
      const MapPoint& point = points[i];
      head.rest = point.rest.cast<float>();
      head.joints = add(point.joints);
      head.skin = add(point.skin);
      head.cells = int(out.shares.size());
      for (const LatticeShare& share : point.cells)
        out.shares.push_back({share.node, float(share.weight)});
    }
    out.heads.push_back(head);
  }
  MapPoints::Head end;
  end.joints = end.skin = end.cells = int(out.shares.size());
  out.heads.push_back(end);
  return out;
}

void set_motions(std::span<const Vec3> joints, std::span<const int> parents,
                 const PosedAnatomy& posed, JointMotions& out) {
  out.root = posed.X_WJ[0] * Eigen::Translation3d(-joints[0]);
  const Transform back = out.root.inverse();
  out.rotations.resize(joints.size());
  out.motions.resize(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Transform motion = back * posed.X_WJ[j] * Eigen::Translation3d(-joints[j]);
    Eigen::Map<Eigen::Matrix4f>(out.motions[j].data()) = motion.matrix().cast<float>();
    std::array<float, 8>& own = out.rotations[j];
    own = dual_quaternion(motion);
    if (parents[j] < 0) continue;
    const std::array<float, 8>& before = out.rotations[std::size_t(parents[j])];
    if (sum4(load4(own.data()) * load4(before.data()))[0] < 0)  // the way round that is shorter
      for (float& value : own) value = -value;
  }
}

Vec3 moved(const JointMotions& motions, const MapPoints& points, std::size_t i, float straight) {
  const Float8 dual = blended(motions, points, i);
  const Float4 q = low_half(dual), e = high_half(dual);
  const Eigen::Vector3f& at = points.heads[i].rest;
  const Float4 rest{at.x(), at.y(), at.z(), 0};
  Float4 out =
      rest + 2 * cross(q, cross(q, rest) + q[3] * rest) + 2 * (q[3] * e - e[3] * q + cross(q, e));
  if (straight > 0) {
    Float8 first{}, second{};  // columns of the motions' mean
    for (const MapPoints::Share& share : joints_of(points, i)) {
      const float* motion = motions.motions[std::size_t(share.source)].data();
      first += share.weight * load8(motion);
      second += share.weight * load8(motion + 8);
    }
    const Float4 linear = at.x() * low_half(first) + at.y() * high_half(first) +
                          at.z() * low_half(second) + high_half(second);
    out += straight * (linear - out);
  }
  return motions.root * Vec3(double(out[0]), double(out[1]), double(out[2]));
}

Mat3 turned(const JointMotions& motions, const MapPoints& points, std::size_t i) {
  const Float8 q = blended(motions, points, i);
  return motions.root.linear() *
         Eigen::Quaternionf(q[3], q[0], q[1], q[2]).toRotationMatrix().cast<double>();
}

Vec3 skin_mean(const MapPoints& points, std::size_t i, std::span<const float> rows) {
  return weighted(skin_of(points, i), rows);
}

Vec3 cell_mean(const MapPoints& points, std::size_t i, std::span<const float> rows) {
  return weighted(cells_of(points, i), rows);
}

float cell_value(const MapPoints& points, std::size_t i, std::span<const float> values) {
  float sum = 0;
  for (const MapPoints::Share& share : cells_of(points, i))
    sum += share.weight * values[std::size_t(share.source)];
  return sum;
}

}  // namespace ecorche::inline v1
