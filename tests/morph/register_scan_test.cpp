// What registration makes of scans that lack something, wear something, or are nobody.
#include "morph/registration/register_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "morph/registration/body_proportions.h"
#include "morph/registration/clean_scan.h"
#include "morph/shapes/body.h"
#include "tests/body_fixture.h"
#include "tests/some_of.h"

namespace ecorche {
namespace {

class RegisterScanTest : public BodyFixture {
 protected:
  static const TriMesh& man() {
    static const TriMesh once = shape_body(package(), {}).body.skin;
    return once;
  }
  static const RegistrationModel& model() {
    static const RegistrationModel once = make_registration_model(test_assets());
    return once;
  }
  static Registration registered(const MeshFile& file, const RegistrationOptions& options = {}) {
    return register_scan(model(), clean_scan(file, {.unit = 1.0}), options);
  }
};

// Of triangles that `keep` takes by their first vertex.
template <class Keep>
TriMesh part_of(const TriMesh& mesh, const Keep& keep) {
  TriMesh out{mesh.V, Triangles(mesh.F.rows(), 3)};
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    if (keep(mesh.F(f, 0))) out.F.row(count++) = mesh.F.row(f);
  out.F.conservativeResize(count, 3);
  return out;
}

MeshFile file_with(TriMesh mesh, const std::string& name) {
  MeshFile out;
  out.parts.push_back({.name = name, .mesh = std::move(mesh)});
  return out;
}

bool says(const Registration& found, const std::string& word) {
  return std::ranges::any_of(found.report.doubts, [&](const std::string& doubt) {
    return doubt.find(word) != std::string::npos;
  });
}

// Turn of a joint from the rest pose, degrees.
double turn_of(const Registration& found, const std::string& joint) {
  const auto at = std::ranges::find(found.pose.joints, joint) - found.pose.joints.begin();
  return Eigen::AngleAxisd(found.pose.rotations[std::size_t(at)]).angle() * kDegreesPerRadian;
}

void add_box(const Vec3& low, const Vec3& high, TriMesh& mesh) {
  constexpr int kCells = 12;  // a side
  for (int axis = 0; axis < 3; ++axis)
    for (const bool far : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const int first = int(mesh.V.rows());
      mesh.V.conservativeResize(first + (kCells + 1) * (kCells + 1), 3);
      for (int i = 0; i <= kCells; ++i)
        for (int j = 0; j <= kCells; ++j) {
          Vec3 p;
          p[axis] = far ? high[axis] : low[axis];
          p[u] = low[u] + (high[u] - low[u]) * i / kCells;
          p[v] = low[v] + (high[v] - low[v]) * j / kCells;
          mesh.V.row(first + i * (kCells + 1) + j) = p.transpose();
        }
      Eigen::Index f = mesh.F.rows();
      mesh.F.conservativeResize(f + 2 * kCells * kCells, 3);
      for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j) {
          const int a = first + i * (kCells + 1) + j, b = a + kCells + 1;
          mesh.F.row(f++) << a, far ? b : a + 1, far ? a + 1 : b;
          mesh.F.row(f++) << b + 1, far ? a + 1 : b, far ? b : a + 1;
        }
    }
}

TEST_F(RegisterScanTest, FeetThatNobodySawStandAsAtRest) {
  const TriMesh& skin = man();
  const double floor = skin.V.col(1).minCoeff();
  const Registration found = registered(
      file_with(part_of(skin, [&](int v) { return skin.V(v, 1) > floor + 0.1; }), "scan"));
  EXPECT_TRUE(says(found, "left foot")) << found.report.doubts.size();
  EXPECT_TRUE(says(found, "right foot"));
  for (const char* joint : {"foot_l", "foot_r"}) EXPECT_LT(turn_of(found, joint), 1) << joint;
  EXPECT_NEAR(found.posed.col(1).maxCoeff(), skin.V.col(1).maxCoeff() - floor, 0.06);
}

// A limb that is not there could hide within what is.
TEST_F(RegisterScanTest, MissingLimbsAreRefusedByName) {
  const TriMesh& skin = man();
  const std::vector<VertexPart> parts = vertex_parts(package());
  const auto without = [&](Side side, std::initializer_list<BodyPart> gone) {
    return file_with(part_of(skin,
                             [&](int v) {
                               const VertexPart& at = parts[std::size_t(v)];
                               return at.side != side ||
                                      std::find(gone.begin(), gone.end(), at.part) == gone.end();
                             }),
                     "scan");
  };
  const auto refused_for = [&](const MeshFile& file) -> std::string {
    try {
      registered(file);
    } catch (const UnfitError& error) {
      return error.what();
    }
    return "";
  };
  const std::string arm = refused_for(without(Side::left, {BodyPart::forearm, BodyPart::hand}));
  EXPECT_NE(arm.find("left forearm, left hand"), std::string::npos) << arm;
  if (!thorough()) return;
  const std::string leg =
      refused_for(without(Side::right, {BodyPart::thigh, BodyPart::shank, BodyPart::foot}));
  EXPECT_NE(leg.find("right shank"), std::string::npos) << leg;
  EXPECT_NE(leg.find("right foot"), std::string::npos) << leg;
}

TEST_F(RegisterScanTest, ClothesStandOffWithoutADoubt) {
  const TriMesh& skin = man();
  const std::vector<VertexPart> parts = vertex_parts(package());
  const Points normals = vertex_normals(skin);
  TriMesh coat =
      part_of(skin, [&](int v) { return parts[std::size_t(v)].part == BodyPart::trunk; });
  coat.V += 0.04 * normals;
  MeshFile file = file_with(skin, "body");
  file.parts.push_back({.name = "coat", .mesh = std::move(coat)});
  const Registration found = registered(file);
  EXPECT_TRUE(found.report.doubts.empty()) << found.report.doubts.front();
  EXPECT_LT(found.report.scan_to_body.p95, 0.008);
}

TEST_F(RegisterScanTest, JointsThatTheFileNamesElsewhereAreNeverGood) {
  RegistrationOptions options;
  // A wrist where the other arm's is.
  const auto wrist = [&](Side side) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    const std::vector<VertexPart> parts = vertex_parts(package());
    for (std::size_t v = 0; v < parts.size(); ++v)
      if (parts[v].part == BodyPart::hand && parts[v].side == side)
        sum += man().V.row(Eigen::Index(v)).transpose(), ++count;
    return Vec3(sum / count);
  };
  options.joints = {{"wrist_l", wrist(Side::right)}};
  try {
    EXPECT_TRUE(says(registered(file_with(man(), "scan"), options), "hand_l"));
  } catch (const UnfitError&) {  // nor is it good where the arm was bent that far
  }
  if (!thorough()) return;
  options.joints = {{"wrist_l", wrist(Side::left)}};
  EXPECT_FALSE(says(registered(file_with(man(), "scan"), options), "hand_l"));
}

TEST_F(RegisterScanTest, LargeHeadsAndShortLegsAreCalledStylised) {
  const ArticulatedBody& body = model().body;
  Scan scan;
  scan.points = body.mean;
  std::vector<PlaceHint> hints;
  for (const char* name :
       {"head", "thigh_l", "thigh_r", "shank_l", "shank_r", "foot_l", "foot_r"}) {
    const int joint = find_segment(body, name);
    hints.push_back({joint, -1, body.joint_mean.row(joint), 0.01});
  }
  EXPECT_TRUE(unusual_proportions(body, scan, hints).empty());
  const Vec3 head = hints[0].place;
  for (std::size_t v = 0; v < body.parts.size(); ++v)
    if (body.parts[v].part == BodyPart::head)
      scan.points.row(Eigen::Index(v)) =
          head.transpose() + 2.5 * (scan.points.row(Eigen::Index(v)) - head.transpose());
  for (std::size_t k = 3; k < hints.size(); ++k) {
    const Vec3 hip = hints[1 + (k - 1) % 2].place;
    hints[k].place = hip + 0.5 * (hints[k].place - hip);
  }
  const std::vector<std::string> unusual = unusual_proportions(body, scan, hints);
  ASSERT_EQ(unusual.size(), 2U);
  EXPECT_EQ(unusual[0], "the head is 2.5 times as long");
  EXPECT_EQ(unusual[1], "legs are 0.5 times as long");
}

TEST_F(RegisterScanTest, FurnitureIsRefused) {
  TriMesh table{Points(0, 3), Triangles(0, 3)};
  add_box({-0.8, 0.70, -0.45}, {0.8, 0.76, 0.45}, table);
  for (const double x : {-0.7, 0.7})
    for (const double z : {-0.35, 0.35})
      add_box({x - 0.04, 0, z - 0.04}, {x + 0.04, 0.7, z + 0.04}, table);
  EXPECT_THROW(registered(file_with(std::move(table), "scan")), UnfitError);
}

}  // namespace
}  // namespace ecorche
