// Laws of capsules and discs, in the template and in bent joints: a sleeve shuts the room between
// its bones, its ends lie on them, it stays within the skin, and it neither tears nor vanishes
// where the joint turns to its limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/posed_anatomy.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/fascia/lay_fascia.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

std::vector<const FasciaSheet*> sleeves(const Anatomy& anatomy) {
  std::vector<const FasciaSheet*> out;
  for (const FasciaSheet& sheet : anatomy.fascia)
    if (is_sleeve(sheet)) out.push_back(&sheet);
  return out;
}

const TriMesh& mesh_of(const Anatomy& anatomy, const std::string& bone) {
  return anatomy.bones[std::size_t(find_bone(anatomy, bone))].mesh;
}

TEST(LaidSleeve, ShutsTheRoomBetweenItsBones) {
  NEED_TEMPLATE();
  ASSERT_GE(sleeves(tmpl.anatomy).size(), 100u);
  int leaky = 0;
  for (const FasciaSheet* sheet : sleeves(tmpl.anatomy)) {
    const TriMesh own{sheet->V, grid_triangles(sheet->rows, sheet->columns)};
    std::vector<const TriMesh*> parts{&own};
    for (const std::string& bone : sheet->bones) parts.push_back(&mesh_of(tmpl.anatomy, bone));
    const NearestSurface around(join_meshes(parts));
    const Vec3 middle = sheet->V.colwise().mean();
    int out = 0;
    constexpr int kRays = 300;
    for (int i = 0; i < kRays; ++i) {
      const double z = 1 - (2 * i + 1) / double(kRays), r = std::sqrt(1 - z * z),
                   turn = 2.399963 * i;
      out += !around.cast(middle, Vec3(r * std::cos(turn), r * std::sin(turn), z));
    }
    EXPECT_LE(out, kRays / 10) << sheet->name;
    leaky += out > kRays / 100;
  }
  EXPECT_LE(leaky, 4);  // where five bases of metatarsals, and the sacrum, leave gaps in the ring
}

TEST(LaidSleeve, EndsOnItsBonesAndStaysWithinTheSkin) {
  NEED_TEMPLATE();
  const TriMesh skin = capped_skin(tmpl.tables.topology, tmpl.body.skin.V);
  int all = 0, all_off = 0;
  for (const FasciaSheet* sheet : sleeves(tmpl.anatomy)) {
    const std::vector<int> inside = winding_numbers(skin, sheet->V);
    EXPECT_EQ(std::count(inside.begin(), inside.end(), 0), 0) << sheet->name;
    std::vector<const TriMesh*> parts;
    for (const std::string& bone : sheet->bones) parts.push_back(&mesh_of(tmpl.anatomy, bone));
    const NearestSurface bones(join_meshes(parts));
    int off = 0;
    for (const int row : {0, sheet->rows - 1})
      for (int c = 0; c < sheet->columns; ++c)
        off += bones.nearest(sheet->V.row(row * sheet->columns + c)).distance > 2e-3;
    EXPECT_LE(off, 0.5 * 2 * sheet->columns) << sheet->name;
    all += 2 * sheet->columns;
    all_off += off;
  }
  EXPECT_LE(all_off, 0.05 * all);
}

// The anatomy with one joint turned about its flexion axis.
PosedAnatomy flexed(const Anatomy& anatomy, const std::string& joint, double angle) {
  PosedAnatomy posed;
  Pose pose;
  pose.rotations.assign(anatomy.skeleton.joints.size(), Quat::Identity());
  const int index = find_joint(anatomy.skeleton, joint);
  const Joint& turned = anatomy.skeleton.joints[std::size_t(index)];
  pose.root = anatomy.skeleton.joints[0].X_PJ.translation();
  pose.rotations[std::size_t(index)] = Quat(Eigen::AngleAxisd(angle, turned.axes.col(0)));
  forward_kinematics(anatomy.skeleton, pose, posed.X_WJ);
  posed.slices = rest_slices(anatomy);
  return posed;
}

TEST(LaidSleeve, HoldsAtTheLimitsOfItsJoint) {
  NEED_TEMPLATE();
  const Anatomy& anatomy = tmpl.anatomy;
  const FasciaSurface surface = make_fascia_surface(anatomy);
  const struct {
    const char *sheet, *joint;
    double degrees;
  } cases[] = {{"knee_capsule_l", "knee_l", 140},         {"hip_capsule_l", "hip_l", 120},
               {"elbow_capsule_l", "elbow_l", 145},       {"ankle_capsule_l", "ankle_l", -45},
               {"finger3_mcp_capsule_l", "mcp3_l", 90},   {"finger3_pip_capsule_l", "pip3_l", 100},
               {"shoulder_capsule_l", "shoulder_l", 120}, {"wrist_capsule_l", "wrist_l", 70}};
  for (const auto& [name, joint, degrees] : cases) {
    PointsF rest, at;
    PosedAnatomy still = flexed(anatomy, joint, 0);
    update_fascia_surface(surface, still, rest);
    update_fascia_surface(surface, flexed(anatomy, joint, degrees * 3.14159265 / 180), at);
    for (const FasciaSurface::Part& part : surface.parts) {
      if (anatomy.fascia[std::size_t(part.sheet)].name != name) continue;
      const auto extent = [&](const PointsF& points) {
        const auto own = points.middleRows(part.vertex_begin, part.vertex_end - part.vertex_begin);
        const Eigen::RowVector3f middle = own.colwise().mean();
        return (own.rowwise() - middle).rowwise().norm().maxCoeff();
      };
      EXPECT_TRUE(at.allFinite()) << name;
      EXPECT_GT(extent(at), 0.5f * extent(rest)) << name;
      EXPECT_LT(extent(at), 1.5f * extent(rest)) << name;
    }
  }
}

}  // namespace
}  // namespace ecorche
