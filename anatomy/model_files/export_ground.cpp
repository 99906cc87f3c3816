#include "anatomy/model_files/export_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kLeastBall = 0.008, kMostBall = 0.03;  // m, radii
constexpr double kUnder = 0.015;                        // m: skin so far aside is the pad's

enum class Part { whole, front, back };

// A ball a foot: what it is called, the bone it lies under, and which part of that.
struct Pad {
  const char* name;
  const char* bone;
  Part part;
};
constexpr Pad kPads[] = {{"heel", "calcaneus", Part::back},
                         {"ball_medial", "metatarsal1", Part::front},
                         {"ball_lateral", "metatarsal5", Part::front},
                         {"edge", "metatarsal5", Part::back},
                         {"toe1", "toe_distal_phalanx1", Part::whole},
                         {"toe2", "toe_distal_phalanx2", Part::whole},
                         {"toe3", "toe_distal_phalanx3", Part::whole},
                         {"toe4", "toe_distal_phalanx4", Part::whole},
                         {"toe5", "toe_distal_phalanx5", Part::whole}};

// The lowest vertex of the front or the rear third.
Vec3 lowest(const Points& V, Part part) {
  const double back = V.col(2).minCoeff(), front = V.col(2).maxCoeff(), third = (front - back) / 3;
  Vec3 best(0, std::numeric_limits<double>::infinity(), 0);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    if ((part == Part::front && V(i, 2) < front - third) ||
        (part == Part::back && V(i, 2) > back + third))
      continue;
    if (V(i, 1) < best.y()) best = V.row(i);
  }
  return best;
}

// The skin's lowest point under a place; the place itself where there is none.
double sole_under(const Points& skin, const Vec3& place) {
  double low = place.y();
  for (Eigen::Index i = 0; i < skin.rows(); ++i)
    if (std::hypot(skin(i, 0) - place.x(), skin(i, 2) - place.z()) < kUnder)
      low = std::min(low, skin(i, 1));
  return low;
}

}  // namespace

void add_ground(const Anatomy& anatomy, const Body& body, ExportModel& model) {
  const auto rest = rest_positions(anatomy.skeleton);
  double floor = std::numeric_limits<double>::infinity();
  for (const char* side : {"_l", "_r"})
    for (const Pad& pad : kPads) {
      const int index = find_bone(anatomy, std::string(pad.bone) + side);
      if (index < 0)
        throw UnfitError(fmt::format("a ground needs feet to stand on: there is no bone '{}{}'",
                                     pad.bone, side));
      const Bone& bone = anatomy.bones[index];
      const Vec3 under = lowest(bone.mesh.V, pad.part);
      const double sole = sole_under(body.skin.V, under),
                   radius = std::clamp(under.y() - sole, kLeastBall, kMostBall);
      const Vec3 center(under.x(), sole + radius, under.z());
      model.contacts.push_back(
          {fmt::format("{}{}", pad.name, side), bone.joint, center - rest[bone.joint], radius});
      floor = std::min(floor, sole);
    }
  model.ground = floor;
}

void add_markers(const Anatomy& anatomy, const std::vector<std::string>& names,
                 const Points& places, ExportModel& model) {
  const auto rest = rest_positions(anatomy.skeleton);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Eigen::RowVector3d place = places.row(i);
    double least = std::numeric_limits<double>::infinity();
    int joint = 0;
    for (const Bone& bone : anatomy.bones) {
      if (bone.mesh.V.rows() == 0) continue;
      const double near = (bone.mesh.V.rowwise() - place).rowwise().squaredNorm().minCoeff();
      if (near >= least) continue;
      least = near;
      joint = bone.joint;
    }
    model.markers.push_back({names[i], joint, place.transpose() - rest[joint]});
  }
}

}  // namespace ecorche::inline v1
