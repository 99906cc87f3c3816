#include "anatomy/base_mesh/eyes.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <numbers>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

struct Rim {
  Vec3 center = Vec3::Zero();
  double radius = 0;  // root mean square
};

Rim rim_of(const std::vector<int>& loop, const Points& points) {
  Rim rim;
  for (const int v : loop) rim.center += points.row(v).transpose() / double(loop.size());
  for (const int v : loop)
    rim.radius += (points.row(v).transpose() - rim.center).squaredNorm() / double(loop.size());
  rim.radius = std::sqrt(rim.radius);
  return rim;
}

// The globe without its cornea: half the width of the helper geometry.
Eyeball globe(const std::vector<int>& vertices, const Points& points) {
  Vec3 low = points.row(vertices.front()), high = low;
  for (const int v : vertices)
    low = low.cwiseMin(points.row(v).transpose()), high = high.cwiseMax(points.row(v).transpose());
  const double radius = 0.5 * (high.x() - low.x());
  return {Vec3(0.5 * (low.x() + high.x()), 0.5 * (low.y() + high.y()), low.z() + radius), radius,
          0};
}

// Rings about the pole, which looks along +Z, at these angles from it in degrees.
EyePart band(const Eyeball& eye, const TissueLook& look, std::initializer_list<double> rings) {
  constexpr int around = 32;
  EyePart part{look, {}, {}};
  part.mesh.V.resize(Eigen::Index(rings.size()) * around, 3);
  part.normals.resize(part.mesh.V.rows(), 3);
  Eigen::Index row = 0;
  for (const double degrees : rings)
    for (int k = 0; k < around; ++k, ++row) {
      const double polar = degrees * std::numbers::pi / 180,
                   turn = 2 * std::numbers::pi * k / around;
      const Vec3 out(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                     std::cos(polar));
      part.mesh.V.row(row) = (eye.center + eye.radius * out).transpose();
      part.normals.row(row) = out.transpose();
    }
  std::vector<int> corners;
  for (int ring = 0; ring + 1 < int(rings.size()); ++ring)
    for (int k = 0; k < around; ++k) {
      const int a = ring * around + k, b = ring * around + (k + 1) % around;
      if (rings.begin()[ring] > 0) corners.insert(corners.end(), {a, a + around, b});
      if (rings.begin()[ring + 1] < 180) corners.insert(corners.end(), {b, a + around, b + around});
    }
  part.mesh.F = Eigen::Map<const Triangles>(corners.data(), Eigen::Index(corners.size() / 3), 3);
  return part;
}

}  // namespace

std::vector<Eyeball> find_eyes(const BodyPackage& package, const TriMesh& skin,
                               const Skeleton& skeleton) {
  const int head = find_joint(skeleton, "head");
  std::vector<Eyeball> eyes;
  if (skin.V.rows() != package.skin_size || head < 0) return eyes;
  for (const Cavity& cavity : package.cavities) {
    if (!cavity.name.starts_with("eye_")) continue;
    const std::string wanted = "helper-" + cavity.name.substr(4) + "-eye";
    const auto group = std::find_if(package.groups.begin(), package.groups.end(),
                                    [&](const auto& g) { return g.first == wanted; });
    if (group == package.groups.end() || group->second.empty()) continue;
    Eyeball eye = globe(group->second, package.points);
    const Rim from = rim_of(cavity.loop, package.points), to = rim_of(cavity.loop, skin.V);
    const double scale = to.radius / from.radius;
    eye.center = to.center + scale * (eye.center - from.center);
    eye.radius *= scale;
    eye.joint = head;
    eyes.push_back(eye);
  }
  return eyes;
}

std::vector<Eyeball> find_eyes(const Assets& assets, const TriMesh& skin,
                               const Skeleton& skeleton) {
  try {
    return find_eyes(read_body_package(assets), skin, skeleton);
  } catch (const InputError&) {
    return {};
  }
}

std::vector<EyePart> eye_parts(const Eyeball& eye) {
  return {band(eye, kPupilLook, {0, 11}), band(eye, kIrisLook, {11, 20, 28}),
          band(eye, kEyeWhiteLook, {28, 40, 60, 80, 105, 130, 155, 180})};
}

}  // namespace ecorche::inline v1
