#include "skinning/settle/volume_preservation.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "anatomy/compute/simd.h"
#include "anatomy/compute/smooth_step.h"
#include "skinning/settle/swelling_limits.h"
#include "skinning/settle/weights_below.h"

namespace ecorche::inline v1 {
namespace {

constexpr VolumeParameters kParametersVolumePreservation;
constexpr std::size_t kMostRegions = 12;  // body, lower body, limbs, their hinges, shoulders
constexpr std::size_t kBlockVolumePreservation = 1024;  // vertices a task

// Six times the volume of the cones over the region's triangles.
double region_volume(const VolumeRegion& region, std::span<const float> positions,
                     const Vec3& apex) {
  const Float4 o{float(apex.x()), float(apex.y()), float(apex.z()), 1};
  double sum = 0;
  for (std::size_t t = 0; t < region.share.size(); ++t) {
    const Float4 a = load4(&positions[4 * region.corners[3 * t]]) - o;
    const Float4 b = load4(&positions[4 * region.corners[3 * t + 1]]) - o;
    const Float4 c = load4(&positions[4 * region.corners[3 * t + 2]]) - o;
    sum += double(region.share[t] * sum4(a * cross(b, c))[0]);
  }
  for (const auto& rim : region.rims) {
    Float4 middle{}, around{};
    for (const auto& [from, to] : rim) {
      const Float4 a = load4(&positions[4 * from]) - o;
      middle += a;
      around += cross(a, load4(&positions[4 * to]) - o);
    }
    sum += double(sum4(middle * around)[0]) / double(rim.size());
  }
  return sum / 6;
}

std::vector<double> vertex_areas(std::span<const float> positions, std::span<const int> triangles) {
  std::vector<double> areas(positions.size() / 4, 0);
  for (std::size_t f = 0; f < triangles.size(); f += 3) {
    const Float4 a = load4(&positions[4 * triangles[f]]);
    const Float4 n = cross(load4(&positions[4 * triangles[f + 1]]) - a,
                           load4(&positions[4 * triangles[f + 2]]) - a);
    for (std::size_t k = 0; k < 3; ++k) areas[triangles[f + k]] += std::sqrt(sum4(n * n)[0]) / 6;
  }
  return areas;
}

// 1 about the hinge, falling to 0 between a half and three quarters of the way along both segments.
double about_hinge(const Vec3& upper, const Vec3& hinge, const Vec3& lower, const Vec3& p) {
  const auto fall = [](double t) { return smooth_step((0.75 - t) / 0.25); };
  const Vec3 up = upper - hinge, down = lower - hinge;
  return fall((p - hinge).dot(up) / up.squaredNorm()) *
         fall((p - hinge).dot(down) / down.squaredNorm());
}

VolumeRegion make_region(int origin, const Vec3& apex, std::span<const float> positions,
                         std::span<const int> triangles, std::span<const double> share,
                         std::span<const double> swelling, std::span<const double> areas) {
  VolumeRegion out;
  out.origin = origin;
  out.most_swelling = kParametersVolumePreservation.most_swelling;
  for (std::size_t f = 0; f < triangles.size(); f += 3) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += share[triangles[f + k]] / 3;
    if (sum <= 0) continue;
    out.corners.insert(out.corners.end(), triangles.begin() + std::ptrdiff_t(f),
                       triangles.begin() + std::ptrdiff_t(f) + 3);
    out.share.push_back(float(sum));
  }
  for (std::size_t i = 0; i < swelling.size(); ++i) {
    if (swelling[i] <= 0) continue;
    out.vertices.push_back(int(i));
    out.swelling.push_back(float(swelling[i]));
    out.area.push_back(float(areas[i]));
  }
  out.volume = region_volume(out, positions, apex);
  return out;
}

// 0 at the shoulder, 1 at the elbow.
double down_arm(const Vec3& shoulder, const Vec3& elbow, const Vec3& p) {
  return (p - shoulder).dot(elbow - shoulder) / (elbow - shoulder).squaredNorm();
}

// Whole triangles that are more than half the region's; its cuts are far from the joint.
VolumeRegion make_closed_region(int origin, const Vec3& apex, std::span<const float> positions,
                                std::span<const int> triangles, std::span<const double> share,
                                std::span<const double> swelling, std::span<const double> areas) {
  std::vector<int> inside;
  Triangles F(triangles.size() / 3, 3);
  std::copy(triangles.begin(), triangles.end(), F.data());
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    if (share[F(f, 0)] + share[F(f, 1)] + share[F(f, 2)] > 1.5) inside.push_back(int(f));
  std::vector<int> corners;
  for (const int f : inside)
    corners.insert(corners.end(), triangles.begin() + 3 * f, triangles.begin() + 3 * f + 3);
  VolumeRegion out = make_region(origin, apex, positions, corners,
                                 std::vector<double>(share.size(), 1), swelling, areas);
  out.rims = open_rims(inside, F);
  out.volume = region_volume(out, positions, apex);
  return out;
}

template <class Do>
void each_vertex_volume_preservation(std::size_t count, const Do& act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kBlockVolumePreservation),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) act(i);
                    });
}

}  // namespace

VolumeRegions make_volume_regions(const Skeleton& skeleton, std::span<const float> positions,
                                  std::span<const int> triangles,
                                  std::span<const JointWeights> joint_weights,
                                  std::span<const double> tissue) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const std::vector<double> areas = vertex_areas(positions, triangles);
  const std::vector<double> unit = find_swelling_limits(positions, triangles, tissue);
  std::vector<double> trunk(tissue.size(), 1), legs(tissue.size(), 0);
  const auto product = [&](const std::vector<double>& share) {
    std::vector<double> out(share.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = share[i] * unit[i];
    return out;
  };
  const int thorax = find_joint(skeleton, "thorax");
  const bool has_waist = thorax >= 0 && skeleton.joints[thorax].parent >= 0;
  VolumeRegions out;
  out.regions.resize(has_waist ? 2 : 1);  // filled when it is known what limbs leave of them
  const auto add = [&](int joint, int within, const std::vector<double>& share) {
    out.regions.push_back(
        make_region(joint, origins[joint], positions, triangles, share, product(share), areas));
    out.regions.back().within = within;
  };
  const auto add_shoulder = [&](int joint, const Vec3& shoulder, const Vec3& elbow,
                                const std::vector<double>& with_girdle) {
    std::vector<double> inside(tissue.size()), swelling(tissue.size());
    for (std::size_t i = 0; i < tissue.size(); ++i) {
      const double along = down_arm(
          shoulder, elbow, Vec3(positions[4 * i], positions[4 * i + 1], positions[4 * i + 2]));
      inside[i] = along < kParametersVolumePreservation.shoulder_end ? with_girdle[i] : 0;
      swelling[i] = with_girdle[i] * unit[i] *
                    std::clamp((kParametersVolumePreservation.shoulder_end - along) /
                                   kParametersVolumePreservation.shoulder_fade,
                               0.0, 1.0);
    }
    out.regions.push_back(
        make_closed_region(joint, shoulder, positions, triangles, inside, swelling, areas));
    out.regions.back().within = 0;
    out.regions.back().give = kParametersVolumePreservation.shoulder_give;
    out.regions.back().most_swelling = kParametersVolumePreservation.most_shoulder_swelling;
  };
  for (const auto& [root, hinge, end] :
       {std::array{"shoulder", "elbow", "wrist"}, std::array{"hip", "knee", "ankle"}})
    for (const std::string side : {"_l", "_r"}) {
      const int joint = find_joint(skeleton, root + side),
                middle = find_joint(skeleton, hinge + side),
                last = find_joint(skeleton, end + side);
      if (joint < 0) continue;
      const bool leg = root == std::string("hip");
      std::vector<double> share = weights_below(skeleton, joint, joint_weights);
      for (std::size_t i = 0; i < trunk.size(); ++i) {
        trunk[i] -= share[i];
        if (leg) legs[i] += share[i];
      }
      const int limb = out.regions.size();
      add(joint, leg && has_waist ? 1 : 0, share);
      if (middle < 0 || last < 0) continue;
      const auto at = [&](int j) { return origins[j]; };
      for (std::size_t i = 0; i < share.size(); ++i)
        share[i] *= about_hinge(at(joint), at(middle), at(last),
                                Vec3(positions[4 * i], positions[4 * i + 1], positions[4 * i + 2]));
      add(middle, limb, share);
      out.regions.back().hinge = true;
    }
  for (const std::string side : {"_l", "_r"}) {
    const int clavicle = find_joint(skeleton, "clavicle" + side),
              arm = find_joint(skeleton, "shoulder" + side),
              elbow = find_joint(skeleton, "elbow" + side);
    if (clavicle < 0 || arm < 0 || elbow < 0) continue;
    const std::vector<double> with_girdle = weights_below(skeleton, clavicle, joint_weights),
                              of_arm = weights_below(skeleton, arm, joint_weights);
    for (std::size_t i = 0; i < trunk.size(); ++i) trunk[i] -= with_girdle[i] - of_arm[i];
    add_shoulder(arm, origins[arm], origins[elbow], with_girdle);
  }
  const std::vector<double> all(tissue.size(), 1);
  if (const int neck = find_joint(skeleton, "c5"); neck >= 0) {  // the head is mostly bone
    const std::vector<double> head = weights_below(skeleton, neck, joint_weights);
    for (std::size_t i = 0; i < trunk.size(); ++i) trunk[i] -= head[i];
  }
  if (has_waist) {
    std::vector<double> lower = weights_below(skeleton, thorax, joint_weights), own(lower.size());
    for (std::size_t i = 0; i < lower.size(); ++i) {
      lower[i] = 1 - lower[i];
      own[i] = std::min(trunk[i], (lower[i] - legs[i]) / kParametersVolumePreservation.belly_share);
      trunk[i] -= own[i];
    }
    out.regions[1] =
        make_region(thorax, origins[thorax], positions, triangles, lower, product(own), areas);
    out.regions[1].within = 0;
    out.regions[1].take = kParametersVolumePreservation.lower_body_take;
  }
  out.regions[0] = make_region(0, origins[0], positions, triangles, all, product(trunk), areas);
  out.regions[0].take = kParametersVolumePreservation.body_take;
  return out;
}

void find_openness(const Membrane& rings, RelaxedSkin& skin, std::vector<float>& working) {
  const std::vector<float>&positions = skin.positions, &normals = skin.normals;
  std::vector<float>& open = skin.openness;
  open.resize(positions.size() / 4);
  working.resize(open.size());
  each_vertex_volume_preservation(open.size(), [&](std::size_t i) {
    const Float4 p = load4(&positions[4 * i]), n = load4(&normals[4 * i]);
    float hollow = 0;
    for (int k = rings.first[i]; k < rings.first[i + 1]; ++k) {
      const std::size_t j = 4 * std::size_t(rings.neighbour[k]);
      const Float4 e = load4(&positions[j]) - p;
      hollow -= sum4((load4(&normals[j]) - n) * e)[0] / (sum4(e * e)[0] + 1e-8f);
    }
    const float count = std::max(1, rings.first[i + 1] - rings.first[i]);
    open[i] = std::clamp(1 - kParametersVolumePreservation.hollow * std::max(0.0f, hollow / count),
                         0.0f, 1.0f);
  });
  for (int round = 0; round < kParametersVolumePreservation.openness_rounds; ++round) {
    each_vertex_volume_preservation(open.size(), [&](std::size_t i) {
      float sum = 0, least = open[i];
      for (int k = rings.first[i]; k < rings.first[i + 1]; ++k) {
        const float other = open[rings.neighbour[k]];
        sum += other;
        least = std::min(least, other);
      }
      const int count = rings.first[i + 1] - rings.first[i];
      working[i] = count > 0 ? 0.5f * (least + std::min(open[i], sum / float(count))) : open[i];
    });
    open.swap(working);
  }
}

void restore_volumes(const VolumeRegions& volumes, std::span<const Transform> X_WJ,
                     RelaxedSkin& skin, HingeVolumes hinges) {
  std::vector<float>& positions = skin.positions;
  const std::vector<float>&open = skin.openness, &normals = skin.normals;
  std::array<double, kMostRegions> lost{}, reach{};
  tbb::parallel_for(std::size_t{0}, volumes.regions.size(), [&](std::size_t r) {
    const VolumeRegion& region = volumes.regions[r];
    if (hinges == HingeVolumes::free && region.hinge) return;
    for (std::size_t k = 0; k < region.vertices.size(); ++k)
      reach[r] += double(region.swelling[k] * region.area[k] * open[region.vertices[k]]);
    lost[r] = region.volume - region_volume(region, positions, X_WJ[region.origin].translation());
    lost[r] = lost[r] > 0 ? std::max(0.0, lost[r] - region.give * region.volume)
                          : std::min(0.0, lost[r] + region.take * region.volume);
  });
  std::array<double, kMostRegions> gained{};  // by the parts of a region, which come after it
  for (std::size_t r = volumes.regions.size(); r-- > 0;) {
    const VolumeRegion& region = volumes.regions[r];
    const double own = reach[r] > 0 ? lost[r] - gained[r] : 0;
    const double most = region.most_swelling,
                 units = own != 0 ? std::clamp(own / reach[r], -most, most) : 0;
    if (region.within >= 0) gained[region.within] += units * reach[r] + gained[r];
    if (units == 0) continue;
    each_vertex_volume_preservation(region.vertices.size(), [&](std::size_t k) {
      const std::size_t at = 4 * std::size_t(region.vertices[k]);
      store4(&positions[at], load4(&positions[at]) +
                                 (float(units) * region.swelling[k] * open[region.vertices[k]]) *
                                     load4(&normals[at]));
    });
  }
}

}  // namespace ecorche::inline v1
