#include "anatomy/queries/signed_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "anatomy/queries/solid_angle.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kLeafSize = 4;
constexpr double kFarField = 4;  // a ball is seen as a dipole beyond this many radii

// Which part of the triangle the nearest point lies on: corners 0..2, edges 3..5 (opposite corner
// feature - 3), face 6.
struct Nearest {
  Vec3 point;
  int feature;
};

// Ericson, Real-Time Collision Detection, 5.1.5.
Nearest nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {a, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {b, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, 5};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, 4};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b), 3};
  const double sum = va + vb + vc;
  return {a + ab * (vb / sum) + ac * (vc / sum), 6};
}

double box_distance2(const Vec3& low, const Vec3& high, const Vec3& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

SkinField::SkinField(const TriMesh& skin) : V_(skin.V), F_(skin.F) {
  const int count = F_.rows();
  if (count == 0) throw std::invalid_argument("skin field: the skin has no triangles");
  if (F_.minCoeff() < 0 || F_.maxCoeff() >= V_.rows())
    throw std::invalid_argument("skin field: triangle index out of range");
  std::vector<Vec3> centroids(count);
  order_.resize(count);
  for (int f = 0; f < count; ++f) {
    centroids[f] = (V_.row(F_(f, 0)) + V_.row(F_(f, 1)) + V_.row(F_(f, 2))).transpose() / 3;
    order_[f] = f;
  }
  nodes_.reserve(2 * count / kLeafSize + 2);
  build(0, count, centroids);
  place_.resize(count);
  for (int k = 0; k < count; ++k) {
    F_.row(k) = skin.F.row(order_[k]);
    place_[order_[k]] = k;
  }
  // Normals: faces weighted by their angle at a corner, summed at edges.
  vertex_normals_.assign(V_.rows(), Vec3::Zero());
  edge_normals_.assign(3 * count, Vec3::Zero());
  struct Edge {
    int a, b, slot;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * count);
  for (int k = 0; k < count; ++k) {
    const Vec3 p[3] = {V_.row(F_(k, 0)).transpose(), V_.row(F_(k, 1)).transpose(),
                       V_.row(F_(k, 2)).transpose()};
    const Vec3 n = (p[1] - p[0]).cross(p[2] - p[0]).stableNormalized();
    for (int c = 0; c < 3; ++c) {
      const Vec3 u = (p[(c + 1) % 3] - p[c]).stableNormalized(),
                 v = (p[(c + 2) % 3] - p[c]).stableNormalized();
      vertex_normals_[F_(k, c)] += std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * n;
      edge_normals_[3 * k + c] = n;
      const int a = F_(k, (c + 1) % 3), b = F_(k, (c + 2) % 3);
      edges.push_back({std::min(a, b), std::max(a, b), 3 * k + c});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.a, x.b, x.slot) < std::tie(y.a, y.b, y.slot);
  });
  for (size_t i = 0; i < edges.size(); i += 2) {
    if (i + 1 >= edges.size() || edges[i].a != edges[i + 1].a || edges[i].b != edges[i + 1].b)
      throw std::invalid_argument("skin field: the skin is not closed");
    const Vec3 sum =
        (edge_normals_[edges[i].slot] + edge_normals_[edges[i + 1].slot]).stableNormalized();
    edge_normals_[edges[i].slot] = edge_normals_[edges[i + 1].slot] = sum;
  }
  for (Vec3& n : vertex_normals_) n = n.stableNormalized();
}

int SkinField::build(int begin, int end, const std::vector<Vec3>& centroids) {
  const int index = nodes_.size();
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  node.low = Vec3::Constant(std::numeric_limits<double>::infinity());
  node.high = -node.low;
  Vec3 low = node.low, high = node.high;
  double total = 0;
  for (int k = begin; k < end; ++k) {
    const int f = order_[k];
    for (int c = 0; c < 3; ++c) {
      node.low = node.low.cwiseMin(V_.row(F_(f, c)).transpose());
      node.high = node.high.cwiseMax(V_.row(F_(f, c)).transpose());
    }
    low = low.cwiseMin(centroids[f]);
    high = high.cwiseMax(centroids[f]);
    const Vec3 a = V_.row(F_(f, 0)), b = V_.row(F_(f, 1)), c = V_.row(F_(f, 2));
    const Vec3 area = 0.5 * (b - a).cross(c - a);
    node.area += area;
    node.center += area.norm() * centroids[f];
    total += area.norm();
  }
  node.center = total > 0 ? Vec3(node.center / total) : Vec3((low + high) / 2);
  for (int k = begin; k < end; ++k)
    for (int c = 0; c < 3; ++c)
      node.radius =
          std::max(node.radius, (V_.row(F_(order_[k], c)).transpose() - node.center).norm());
  if (end - begin > kLeafSize) {
    int axis;
    (high - low).maxCoeff(&axis);
    const int middle = (begin + end) / 2;
    std::nth_element(
        order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int f, int g) {
          return std::make_pair(centroids[f][axis], f) < std::make_pair(centroids[g][axis], g);
        });
    build(begin, middle, centroids);
    node.right = build(middle, end, centroids);
  }
  nodes_[index] = node;
  return index;
}

void SkinField::closest_in_triangle(int f, const Vec3& p, double& best, SkinPoint& out,
                                    int& feature) const {
  const Nearest near = nearest_on_triangle(p, V_.row(F_(f, 0)), V_.row(F_(f, 1)), V_.row(F_(f, 2)));
  const double d2 = (p - near.point).squaredNorm();
  // Ties go to the lower triangle, so that the seed cannot change the answer.
  if (d2 < best || (d2 == best && f < out.triangle)) {
    best = d2;
    out.point = near.point;
    out.triangle = f;
    feature = near.feature;
  }
}

Vec3 SkinField::feature_normal(int f, int feature) const {
  if (feature < 3) return vertex_normals_[F_(f, feature)];
  if (feature < 6) return edge_normals_[3 * f + feature - 3];
  const Vec3 a = V_.row(F_(f, 0)), b = V_.row(F_(f, 1)), c = V_.row(F_(f, 2));
  return (b - a).cross(c - a).stableNormalized();
}

SkinPoint SkinField::nearest(const Vec3& p, int seed) const {
  SkinPoint out;
  int feature = 6;
  double best = std::numeric_limits<double>::infinity();
  out.triangle = std::numeric_limits<int>::max();
  if (seed >= 0 && seed < int(place_.size()))
    closest_in_triangle(place_[seed], p, best, out, feature);
  struct Entry {
    int node;
    double d2;
  };
  Entry stack[64];
  int size = 0;
  stack[size++] = {0, box_distance2(nodes_[0].low, nodes_[0].high, p)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.d2 > best) continue;
    const Node& node = nodes_[entry.node];
    if (node.right < 0) {
      for (int k = node.begin; k < node.end; ++k) closest_in_triangle(k, p, best, out, feature);
      continue;
    }
    Entry a{entry.node + 1, 0}, b{node.right, 0};
    a.d2 = box_distance2(nodes_[a.node].low, nodes_[a.node].high, p);
    b.d2 = box_distance2(nodes_[b.node].low, nodes_[b.node].high, p);
    if (a.d2 < b.d2) std::swap(a, b);  // the nearer one is looked at first
    stack[size++] = a;
    stack[size++] = b;
  }
  const Vec3 normal = feature_normal(out.triangle, feature);
  const Vec3 away = p - out.point;
  const double length = std::sqrt(best);
  const bool inside = away.dot(normal) < 0;
  out.distance = inside ? -length : length;
  // Very near the skin the direction to it is rounding; its normal is not.
  out.gradient = length > 1e-7 ? Vec3((inside ? -1.0 : 1.0) / length * away) : normal;
  out.triangle = order_[out.triangle];
  return out;
}

SkinPoint SkinField::nearest_judged(const Vec3& p, int seed) const {
  SkinPoint out = nearest(p, seed);
  if (out.distance > 0 && winding_number(p) > 0.5) {
    out.distance = -out.distance;
    out.gradient = -out.gradient;
  }
  return out;
}

double SkinField::winding_number(const Vec3& p) const {
  double sum = 0;
  int stack[64];
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const int index = stack[--size];
    const Node& node = nodes_[index];
    const Vec3 d = node.center - p;
    const double far = d.norm();
    if (far > kFarField * node.radius) {
      sum += node.area.dot(d) / (far * far * far);
    } else if (node.right < 0) {
      for (int k = node.begin; k < node.end; ++k)
        sum += solid_angle(p, V_.row(F_(k, 0)), V_.row(F_(k, 1)), V_.row(F_(k, 2)));
    } else {
      stack[size++] = node.right;
      stack[size++] = index + 1;
    }
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace ecorche::inline v1
