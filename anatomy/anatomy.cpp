#include "anatomy/anatomy.h"

#include <cmath>
#include <stdexcept>

namespace ecorche::inline v1 {
namespace {

void require(bool ok, const std::string& message) {
  if (!ok) throw std::invalid_argument("anatomy: " + message);
}

void validate_strip(const std::string& where, const Strip& strip, int joints) {
  require(strip.path.size() >= 2,
          where + ": " + std::to_string(strip.path.size()) + " path points, need two");
  for (const PathPoint& p : strip.path) {
    require(p.joints[0] >= 0 && p.joints[0] < joints,
            where + ": joint " + std::to_string(p.joints[0]) + " of " + std::to_string(joints));
    require(p.joints[1] >= -1 && p.joints[1] < joints,
            where + ": joint " + std::to_string(p.joints[1]) + " of " + std::to_string(joints));
    require(p.placing_joint >= -1 && p.placing_joint < joints,
            where + ": joint " + std::to_string(p.placing_joint) + " of " + std::to_string(joints));
    require(p.rest.allFinite() && std::isfinite(p.share), where + ": path point is not finite");
  }
  double last = -1;
  for (const Slice& slice : strip.slices) {
    require(
        slice.s >= 0 && slice.s <= 1 && slice.s > last,
        where + ": slice parameter " + std::to_string(slice.s) + " after " + std::to_string(last));
    require(slice.radii.allFinite() && slice.radii.minCoeff() >= 0,
            where + ": slice radius is negative or not finite");
    for (const float factor : slice.outline)
      require(std::isfinite(factor) && factor >= 0,
              where + ": slice outline is negative or not finite");
    require(slice.offset.allFinite() && std::isfinite(slice.roll), where + ": slice is not finite");
    last = slice.s;
  }
  last = 0;
  for (const double s : strip.intersections) {
    require(s > last && s < 1,
            where + ": intersection at " + std::to_string(s) + " after " + std::to_string(last));
    last = s;
  }
  require(strip.raphe >= 0 && strip.raphe <= 0.5,
          where + ": raphe of " + std::to_string(strip.raphe) + " of the width");
  for (const Wrap& wrap : strip.wraps)
    require(wrap.joint >= 0 && wrap.joint < joints && wrap.radii.allFinite(),
            where + ": wrap is broken");
}

}  // namespace

void validate(const Anatomy& anatomy) {
  const int joints = anatomy.skeleton.joints.size();
  for (int j = 0; j < joints; ++j) {
    const Joint& joint = anatomy.skeleton.joints[j];
    require(joint.parent < j && (joint.parent >= 0 || j == 0),
            "joint '" + joint.name + "': parent " + std::to_string(joint.parent) +
                " does not precede it");
    require(joint.X_PJ.matrix().allFinite(), "joint '" + joint.name + "' is not finite");
  }
  for (const Bone& bone : anatomy.bones) {
    require(bone.joint >= 0 && bone.joint < joints, "bone '" + bone.name + "': joint " +
                                                        std::to_string(bone.joint) + " of " +
                                                        std::to_string(joints));
    require(bone.mesh.V.allFinite(), "bone '" + bone.name + "': a vertex is not finite");
    require(bone.mesh.F.size() == 0 ||
                (bone.mesh.F.minCoeff() >= 0 && bone.mesh.F.maxCoeff() < bone.mesh.V.rows()),
            "bone '" + bone.name + "': a triangle names a vertex out of range");
  }
  for (const Muscle& muscle : anatomy.muscles) {
    require(!muscle.strips.empty(), "muscle '" + muscle.name + "' has no strip");
    for (size_t i = 0; i < muscle.strips.size(); ++i)
      validate_strip("muscle '" + muscle.name + "': strip " + std::to_string(i + 1),
                     muscle.strips[i], joints);
  }
  for (const FasciaSheet& sheet : anatomy.fascia) {
    const std::string where = "fascia '" + sheet.name + "'";
    require(sheet.rows >= 2 && sheet.columns >= 2, where + ": fewer than two rows or columns");
    require(sheet.V.rows() == Eigen::Index(sheet.rows) * sheet.columns &&
                sheet.belly.size() == std::size_t(sheet.V.rows()),
            where + ": its points are no grid of " + std::to_string(sheet.rows) + " x " +
                std::to_string(sheet.columns));
    require(sheet.V.allFinite(), where + ": a point is not finite");
    for (const std::string& bone : sheet.bones)
      require(find_bone(anatomy, bone) >= 0, where + ": there is no bone '" + bone + "'");
  }
}

Triangles grid_triangles(int rows, int columns) {
  Triangles F(2 * (rows - 1) * (columns - 1), 3);
  Eigen::Index f = 0;
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      const int a = r * columns + c, b = a + columns;
      F.row(f++) << a, a + 1, b + 1;
      F.row(f++) << a, b + 1, b;
    }
  return F;
}

int find_bone(const Anatomy& anatomy, std::string_view name) {
  for (size_t i = 0; i < anatomy.bones.size(); ++i)
    if (anatomy.bones[i].name == name) return int(i);
  return -1;
}

int find_muscle(const Anatomy& anatomy, std::string_view name) {
  for (size_t i = 0; i < anatomy.muscles.size(); ++i)
    if (anatomy.muscles[i].name == name) return int(i);
  return -1;
}

bool lies_in_fat(const Muscle& muscle) { return muscle.layer == "subcutaneous"; }

std::array<int, 2> end_joints(const Muscle& muscle, const Strip& strip) {
  const auto joint = [](const PathPoint& end, const std::string& bone) {
    return bone.empty() || end.joints[1] >= 0 ? -1 : end.joints[0];
  };
  return {joint(strip.path.front(), muscle.origin_bone),
          joint(strip.path.back(), muscle.insertion_bone)};
}

int slice_count(const Anatomy& anatomy) {
  int count = 0;
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) count += strip.slices.size();
  return count;
}

}  // namespace ecorche::inline v1
