#include "anatomy/muscles/bone_reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

constexpr int kLatitudes = 24, kLongitudes = 48;
constexpr double kSample = 0.03;  // of `most`, between samples of a triangle
constexpr int kFillRounds = 2;
constexpr float kHalfTurn = std::numbers::pi_v<float>;

struct SphereCell {
  float row = 0, column = 0;  // of cells whose centres are whole numbers
};
SphereCell sphere_cell(const Eigen::Vector3f& unit) {
  const float latitude = std::acos(std::clamp(unit.z(), -1.0f, 1.0f)) / kHalfTurn,
              longitude = std::atan2(unit.y(), unit.x()) / (2 * kHalfTurn);
  return {latitude * kLatitudes - 0.5f, (longitude - std::floor(longitude)) * kLongitudes - 0.5f};
}

float& cell_at(std::vector<float>& reach, int row, int column) {
  return reach[std::size_t(std::clamp(row, 0, kLatitudes - 1) * kLongitudes +
                           (column + kLongitudes) % kLongitudes)];
}

// Cells that no sample has met take the mean of their neighbours that one has.
void fill_misses(std::vector<float>& reach) {
  std::vector<float> before = reach;
  for (int r = 0; r < kLatitudes; ++r)
    for (int c = 0; c < kLongitudes; ++c) {
      if (cell_at(before, r, c) > 0) continue;
      float sum = 0;
      int met = 0;
      for (const auto& [dr, dc] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const float next = cell_at(before, r + dr, c + dc);
        sum += next;
        met += next > 0;
      }
      if (met >= 2) cell_at(reach, r, c) = sum / float(met);
    }
}

}  // namespace

BoneReach bone_reach(const TriMesh& bone, int joint, const Vec3& joint_at, const Vec3& centre,
                     const Vec3& pole, double most) {
  BoneReach out;
  out.joint = joint;
  out.centre = (centre - joint_at).cast<float>();
  out.most = float(most);
  Vec3 across = pole.unitOrthogonal();
  out.axes.row(0) = across.cast<float>();
  out.axes.row(1) = pole.cross(across).cast<float>();
  out.axes.row(2) = pole.cast<float>();
  out.reach.assign(std::size_t(kLatitudes * kLongitudes), 0);
  for (Eigen::Index f = 0; f < bone.F.rows(); ++f) {
    Eigen::Vector3f at[3];
    float nearest = out.most * 2, longest = 0;
    for (int k = 0; k < 3; ++k) {
      at[k] = out.axes * (bone.V.row(bone.F(f, k)).transpose() - centre).cast<float>();
      nearest = std::min(nearest, at[k].norm());
    }
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (at[k] - at[(k + 1) % 3]).norm());
    if (nearest - longest > out.most) continue;
    const int steps = std::clamp(int(longest / (float(kSample) * out.most)) + 1, 1, 64);
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const float u = float(i) / float(steps), v = float(j) / float(steps);
        const Eigen::Vector3f p = at[0] + u * (at[1] - at[0]) + v * (at[2] - at[0]);
        const float far = p.norm();
        if (far > out.most || far < 1e-6f) continue;
        const SphereCell cell = sphere_cell(p / far);
        float& reach =
            cell_at(out.reach, int(std::lround(cell.row)), int(std::lround(cell.column)));
        reach = std::max(reach, far);
      }
  }
  for (int round = 0; round < kFillRounds; ++round) fill_misses(out.reach);
  return out;
}

float reach_toward(const BoneReach& bone, const Eigen::Vector3f& direction) {
  const float length = direction.norm();
  if (length < 1e-9f) return 0;
  const SphereCell cell = sphere_cell(bone.axes * direction / length);
  const float row = std::floor(cell.row), column = std::floor(cell.column), u = cell.row - row,
              v = cell.column - column;
  const auto at = [&](int r, int c) {
    return bone.reach[std::size_t(std::clamp(r, 0, kLatitudes - 1) * kLongitudes +
                                  (c + kLongitudes) % kLongitudes)];
  };
  const int r = int(row), c = int(column);
  return (1 - u) * ((1 - v) * at(r, c) + v * at(r, c + 1)) +
         u * ((1 - v) * at(r + 1, c) + v * at(r + 1, c + 1));
}

}  // namespace ecorche::inline v1
