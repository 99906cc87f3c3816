#include "anatomy/bones/bone_package.h"

#include <filesystem>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "anatomy/bones/bone_rules.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/mesh_files/stl_io.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {
namespace fs = std::filesystem;

// The package is read once for all tests.
class BonePackage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!anatomy_) {
      try {
        anatomy_ = new Anatomy(read_source_skeleton(test_assets()));
      } catch (const InputError& error) {
        GTEST_SKIP() << error.what();
      }
    }
  }
  const Anatomy& anatomy() const { return *anatomy_; }
  const TriMesh& mesh(const std::string& name) const {
    return anatomy().bones.at(find_bone(anatomy(), name)).mesh;
  }
  Vec3 rest(const std::string& joint) const {
    return rest_positions(anatomy().skeleton).at(find_joint(anatomy().skeleton, joint));
  }
  // Where a far point goes in a small positive turn about one of a joint's axes.
  Vec3 motion(const std::string& joint, int axis, const Vec3& far) const {
    return anatomy()
        .skeleton.joints.at(find_joint(anatomy().skeleton, joint))
        .axes.col(axis)
        .cross(far - rest(joint));
  }

 private:
  static const Anatomy* anatomy_;
};
const Anatomy* BonePackage::anatomy_ = nullptr;

double farthest_from_mirror(const TriMesh& a, const TriMesh& b) {
  double worst = 0;
  for (Eigen::Index i = 0; i < a.V.rows(); ++i) {
    const Vec3 m = mirror_point(a.V.row(i));
    worst = std::max(worst, (b.V.rowwise() - m.transpose()).rowwise().norm().minCoeff());
  }
  return worst;
}

double signed_volume(const TriMesh& mesh) {
  double six = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    six += a.dot(b.cross(c));
  }
  return six / 6;
}

TEST_F(BonePackage, Has178BonesEachNamedOnce) {
  std::set<std::string> names;
  for (const Bone& bone : anatomy().bones) names.insert(bone.name);
  EXPECT_EQ(anatomy().bones.size(), 178u);
  EXPECT_EQ(names.size(), 178u);
  for (const char* expected :
       {"skull", "mandible", "c1", "t12", "l5", "sacrum", "sternum", "rib12_r", "pisiform_l",
        "patella_r", "intermediate_cuneiform_l", "toe_distal_phalanx5_r", "middle_phalanx2_l"}) {
    EXPECT_TRUE(names.contains(expected)) << expected;
  }
}

TEST_F(BonePackage, LeftAndRightMirror) {
  for (const Bone& bone : anatomy().bones) {
    if (bone.side == Side::middle) continue;
    const std::string other = mirror_name(bone.name);
    ASSERT_GE(find_bone(anatomy(), other), 0) << other;
    EXPECT_GT(
        (bone.side == Side::left ? 1 : -1) * (surface_centroid(bone.mesh).x() - kSourceMidPlane),
        0.002)
        << bone.name;
    if (bone.mesh.V.rows() < 1000) {
      EXPECT_LT(farthest_from_mirror(bone.mesh, mesh(other)), 1e-3) << bone.name;
    }
    const auto& joints = anatomy().skeleton.joints;
    const std::string joint = joints.at(bone.joint).name;
    EXPECT_EQ(joints.at(anatomy().bones.at(find_bone(anatomy(), other)).joint).name,
              mirror_name(joint))
        << bone.name;
    EXPECT_LT((mirror_point(rest(joint)) - rest(mirror_name(joint))).norm(), 1e-9) << joint;
  }
}

TEST_F(BonePackage, BonesAreClosedAndHaveTheirOutsideOutside) {
  for (const Bone& bone : anatomy().bones) {
    EXPECT_TRUE(is_closed(bone.mesh)) << bone.name;
    EXPECT_GT(signed_volume(bone.mesh), 0) << bone.name;
  }
}

// The emblem on the chest has 15,180 triangles and reaches 15 mm in front of the sternum; slivers
// have fewer than 30.
TEST_F(BonePackage, HoldsNoJunk) {
  for (const Bone& bone : anatomy().bones) {
    EXPECT_LT(bone.mesh.F.rows(), 9000) << bone.name;
    for (const TriMesh& part : connected_components(bone.mesh))
      EXPECT_GT(surface_area(part), 0.9e-4) << bone.name;
  }
  EXPECT_EQ(mesh("sternum").F.rows(), 1450);
}

TEST_F(BonePackage, EachBoneIsNearItsJoint) {
  // Along a rigid chain (metacarpals on the wrist, ribs on the thorax) the reach is the chain's.
  const std::map<std::string, double> reach{
      {"thorax", 0.25}, {"pelvis", 0.12},    {"subtalar_l", 0.15}, {"wrist_l", 0.05}, {"t11", 0.05},
      {"t12", 0.05},    {"patella_l", 0.06}, {"jaw", 0.06},        {"knee_l", 0.06}};
  for (const Bone& bone : anatomy().bones) {
    if (bone.side == Side::right) continue;
    const std::string joint = anatomy().skeleton.joints.at(bone.joint).name;
    const auto known = reach.find(joint);
    const double distance =
        (bone.mesh.V.rowwise() - rest(joint).transpose()).rowwise().norm().minCoeff();
    EXPECT_LT(distance, known == reach.end() ? 0.025 : known->second)
        << bone.name << " on " << joint;
  }
}

TEST_F(BonePackage, ThePatellaLiesBeforeTheCondylesWhereTheCouplingsPutIt) {
  const Vec3 patella = surface_centroid(mesh("patella_l")), knee = rest("knee_l");
  EXPECT_GT(patella.z() - knee.z(), 0.03);
  EXPECT_LT(patella.z() - knee.z(), 0.06);
  EXPECT_NEAR(patella.x(), knee.x(), 0.01);
}

TEST_F(BonePackage, JointsMoveTheWayTheirAxesSay) {
  const Vec3 down(0, -1, 0);
  struct Case {
    const char *joint, *far;
    int axis;
    Vec3 way;
  };
  const Vec3 left = Vec3::UnitX(), up = Vec3::UnitY(), forward = Vec3::UnitZ();
  for (const Case& c :
       {Case{"hip_l", "knee_l", 0, forward}, Case{"hip_l", "knee_l", 1, left},
        Case{"hip_r", "knee_r", 1, -left}, Case{"knee_l", "ankle_l", 0, -forward},
        Case{"ankle_r", "mtp2_r", 0, up}, Case{"mtp1_l", "toe_ip1_l", 0, -up},
        Case{"shoulder_r", "elbow_r", 0, forward}, Case{"shoulder_r", "elbow_r", 1, -left},
        Case{"elbow_l", "wrist_l", 0, forward}, Case{"wrist_l", "mcp3_l", 0, -left},
        Case{"wrist_r", "mcp3_r", 0, left}, Case{"wrist_l", "mcp3_l", 1, forward},
        Case{"mcp3_r", "pip3_r", 0, left}, Case{"clavicle_l", "scapula_l", 0, forward},
        Case{"clavicle_l", "scapula_l", 1, up}, Case{"l3", "head", 0, forward},
        Case{"l3", "head", 1, left}, Case{"c5", "head", 0, forward}}) {
    const Vec3 way = motion(c.joint, c.axis, rest(c.far)).normalized();
    EXPECT_GT(way.dot(c.way), 0.5) << c.joint << " axis " << c.axis;
  }
  // Opening the jaw lowers the chin; hip, shoulder and forearm turn outwards, the shin inwards, the
  // collar bone backwards, the foot's sole to the middle.
  EXPECT_LT(motion("jaw", 0, surface_centroid(mesh("mandible"))).y(), 0);
  EXPECT_GT(motion("hip_l", 2, rest("hip_l") + forward).x(), 0);
  EXPECT_LT(motion("shoulder_r", 2, rest("shoulder_r") + forward).x(), 0);
  EXPECT_GT(motion("forearm_l", 2, rest("forearm_l") + forward).x(), 0);
  EXPECT_GT(motion("scapula_l", 2, rest("scapula_l") + forward).x(), 0);
  EXPECT_LT(motion("knee_l", 2, rest("knee_l") + forward).x(), 0);
  EXPECT_LT(motion("clavicle_l", 2, rest("clavicle_l") + up).z(), 0);
  EXPECT_LT(motion("subtalar_l", 2, rest("subtalar_l") + down).x(), 0);
}

TEST_F(BonePackage, AxesAreOrthonormalAndMirrorAsTurns) {
  for (const Joint& joint : anatomy().skeleton.joints) {
    EXPECT_TRUE(joint.axes.isUnitary(1e-9)) << joint.name;
    EXPECT_NEAR(joint.axes.determinant(), 1, 1e-9) << joint.name;
    const Joint& other =
        anatomy().skeleton.joints.at(find_joint(anatomy().skeleton, mirror_name(joint.name)));
    if (&other == &joint) continue;
    EXPECT_LT((joint.axes.row(0) - other.axes.row(0)).norm() +
                  (joint.axes.bottomRows(2) + other.axes.bottomRows(2)).norm(),
              1e-9)
        << joint.name;
  }
}

TEST_F(BonePackage, SegmentsAreAsLongAsAPersonsOf171) {
  EXPECT_NEAR((rest("hip_l") - rest("knee_l")).norm(), 0.404, 0.005);
  EXPECT_NEAR((rest("knee_l") - rest("ankle_l")).norm(), 0.400, 0.005);
  EXPECT_NEAR((rest("hip_l") - rest("hip_r")).norm(), 0.1545, 0.002);
  EXPECT_NEAR((rest("shoulder_l") - rest("elbow_l")).norm(), 0.291, 0.005);
  EXPECT_NEAR((rest("elbow_l") - rest("wrist_l")).norm(), 0.258, 0.005);
}

TEST_F(BonePackage, LiesWhereTheFactTableSaysEachComponentLies) {
  const fs::path facts = fs::path(ECORCHE_SHARED_DIR) / "facts" / "bone_components.csv";
  if (!fs::exists(facts)) GTEST_SKIP() << facts << " is not there";
  const std::map<std::string, std::string> other_names{
      {"foot_phalanx_prox", "toe_proximal_phalanx"}, {"foot_phalanx_mid", "toe_middle_phalanx"},
      {"foot_phalanx_dist", "toe_distal_phalanx"},   {"hand_phalanx_prox", "proximal_phalanx"},
      {"hand_phalanx_mid", "middle_phalanx"},        {"hand_phalanx_dist", "distal_phalanx"},
      {"cuneiform_med", "medial_cuneiform"},         {"cuneiform_int", "intermediate_cuneiform"},
      {"cuneiform_lat", "lateral_cuneiform"}};
  const Table table(facts);
  int compared = 0;
  for (int row = 0; row < table.rows(); ++row) {
    std::string name = table.text(row, "bone_name");
    if (name.empty() || name.ends_with("_r") || table.text(row, "note") != "bone") continue;
    for (const auto& [theirs, ours] : other_names) {
      if (name.starts_with(theirs)) name = ours + name.substr(theirs.size());
    }
    // The table splits these two into a main part and patches of the joint surface.
    if (name == "scapula_l" || name == "radius_l") continue;
    ASSERT_GE(find_bone(anatomy(), name), 0) << name;
    const Vec3 expected(table.number(row, "world_x_left"), table.number(row, "world_y_up"),
                        table.number(row, "world_z_front"));
    // The table's are of the meshes as they come, of which some lack the ends.
    EXPECT_LT((surface_centroid(mesh(name)) - expected).norm(), 3e-3) << name;
    ++compared;
  }
  EXPECT_GT(compared, 70);
}

TEST_F(BonePackage, TendonPathsOfLegAndTrunkStartAndEndOnBones) {
  const auto paths = read_tendon_paths(test_assets(), anatomy());
  EXPECT_GT(paths.size(), 100u);
  int near = 0, points = 0;
  bool has_hamstring = false;
  for (const TendonPath& path : paths) {
    ASSERT_EQ(path.points.size(), path.bones.size());
    EXPECT_FALSE(path.name.ends_with("_r")) << path.name;
    has_hamstring = has_hamstring || (path.name == "bflh_l" && path.bones.front() == "hip_bone_l" &&
                                      path.bones.back() == "fibula_l");
    for (const std::size_t end : {std::size_t{0}, path.points.size() - 1}) {
      ++points;
      if (path.bones[end].empty()) continue;
      near += (mesh(path.bones[end]).V.rowwise() - path.points[end].transpose())
                  .rowwise()
                  .norm()
                  .minCoeff() < 0.03;
    }
  }
  EXPECT_TRUE(has_hamstring);
  EXPECT_GT(near, points / 2);
}

TEST(BoneRules, SayWhatIsWrongWithThem) {
  const std::vector<TriMesh> one{{Points::Random(3, 3), (Triangles(1, 3) << 0, 1, 2).finished()}};
  for (const char* rule : {"", "take 2 falling faces", "keep faces 5 9", "take 1 falling colour",
                           "keep faces 1", "take x falling x"}) {
    try {
      const TriMesh mesh = select_bone(one, rule, "bones.csv:3");
      EXPECT_EQ(std::string(rule), "");  // no step leaves everything
      EXPECT_EQ(mesh.F.rows(), 1);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("bones.csv:3"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace ecorche
