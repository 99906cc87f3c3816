#include "app/studio/design/give_way.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace ecorche {
namespace {

constexpr float kReach = 0.08f, kDecay = 0.03f;  // m, from the muscle's surface
constexpr float kBlend = 0.012f;                 // m, between neighbouring sections
constexpr float kMost = 0.025f;                  // m
constexpr std::uint64_t kOwnRevisions = std::uint64_t{1} << 62;

// From the centre to the section's edge in a direction of its plane; of a ball about it otherwise.
float edge(const Ellipse& e, const Vec3f& direction) {
  const float x = float(e.axes.col(0).dot(direction.cast<double>())),
              y = float(e.axes.col(1).dot(direction.cast<double>()));
  const float a = x / std::max(float(e.radii.x()), 1e-4f),
              b = y / std::max(float(e.radii.y()), 1e-4f);
  const float along = std::max(1 - x * x - y * y, 0.0f);  // the muscle goes on
  const float mean = 0.5f * float(e.radii.x() + e.radii.y());
  return 1 / std::sqrt(a * a + b * b + along / std::max(mean * mean, 1e-8f));
}

}  // namespace

Vec3f given_way(const std::vector<MovedSection>& sections, const Vec3f& place) {
  float nearest = 1e30f;
  for (const MovedSection& s : sections)
    nearest = std::min(nearest, (place - s.was.center.cast<float>()).squaredNorm());
  if (nearest > (kReach + kMost) * (kReach + kMost) * 2) return Vec3f::Zero();
  Vec3f sum = Vec3f::Zero();
  float weights = 0;
  for (const MovedSection& s : sections) {
    const Vec3f from = place - s.was.center.cast<float>();
    const float square = from.squaredNorm(), blend = std::exp((nearest - square) / (kBlend * kBlend));
    if (blend < 1e-3f) continue;
    const float distance = std::max(std::sqrt(square), 1e-5f);
    const Vec3f out = from / distance;
    const float gap = std::max(distance - edge(s.was, out), 0.0f);
    weights += blend;
    if (gap > kReach) continue;
    const float step = float((s.is.center - s.was.center).dot(out.cast<double>())) +
                       edge(s.is, out) - edge(s.was, out);
    const float fade = 1 - gap / kReach;
    sum += blend * fade * std::exp(-gap / kDecay) * step * out;
  }
  if (weights <= 0) return Vec3f::Zero();
  sum /= weights;
  const float length = sum.norm();
  return length > kMost ? Vec3f(sum * (kMost / length)) : sum;
}

void GivingWay::move(const std::vector<MovedSection>& sections, DrawMesh& mesh) {
  static std::uint64_t revisions = 0;
  const bool own = mesh.revision == revision_;
  if (own)
    for (const auto& [v, place] : kept_) mesh.positions[v] = place;
  const bool moved_before = own && !kept_.empty();
  kept_.clear();
  Eigen::AlignedBox3f near;
  for (const MovedSection& s : sections) {
    near.extend(s.was.center.cast<float>());
    near.extend(s.is.center.cast<float>());
  }
  if (!near.isEmpty()) {
    const Vec3f reach = Vec3f::Constant(kReach + kMost);
    near = Eigen::AlignedBox3f(near.min() - reach, near.max() + reach);
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (!near.contains(mesh.positions[v])) continue;
    const Vec3f step = given_way(sections, mesh.positions[v]);
    if (step.squaredNorm() < 1e-10f) continue;
    kept_.emplace_back(std::uint32_t(v), mesh.positions[v]);
    mesh.positions[v] += step;
  }
  if (kept_.empty() && !moved_before) return;
  revision_ = kOwnRevisions + ++revisions;
  mesh.revision = revision_;
}

}  // namespace ecorche
