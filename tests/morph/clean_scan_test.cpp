#include "morph/registration/clean_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/head_islands.h"
#include "anatomy/mesh_files/part_kind.h"
#include "morph/registration/scan_unit.h"
#include "morph/shapes/body.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

class CleanScanTest : public BodyFixture {
 protected:
  static const TriMesh& man() {
    static const TriMesh once = shape_body(package(), {}).body.skin;
    return once;
  }
};

MeshFile file_of(TriMesh mesh, const std::string& name = {}) {
  MeshFile file;
  file.parts.resize(1);
  file.parts[0].name = name;
  file.parts[0].mesh = std::move(mesh);
  return file;
}

double total_area(const Scan& scan) {
  return std::accumulate(scan.area.begin(), scan.area.end(), 0.0);
}

TriMesh scaled(TriMesh mesh, double factor) {
  mesh.V *= factor;
  return mesh;
}

TriMesh joined(const TriMesh& a, const TriMesh& b) {
  TriMesh out;
  out.V.resize(a.V.rows() + b.V.rows(), 3);
  out.V << a.V, b.V;
  out.F.resize(a.F.rows() + b.F.rows(), 3);
  out.F << a.F, (b.F.array() + int(a.V.rows())).matrix();
  return out;
}

// A square sheet of side 2 `half` at the height y, facing up.
TriMesh sheet(double half, double y) {
  constexpr int kCells = 60;
  TriMesh out;
  out.V.resize((kCells + 1) * (kCells + 1), 3);
  out.F.resize(2 * kCells * kCells, 3);
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j)
      out.V.row(i * (kCells + 1) + j) << half * (2.0 * i / kCells - 1), y,
          half * (2.0 * j / kCells - 1);
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const int a = i * (kCells + 1) + j, b = a + 1, c = a + kCells + 1, d = c + 1;
      out.F.row(2 * (i * kCells + j)) << a, b, c;
      out.F.row(2 * (i * kCells + j) + 1) << b, d, c;
    }
  }
  return out;
}

// Points on the surface, evenly by area.
Points cloud_of(const TriMesh& mesh, int count, double noise, std::mt19937& random) {
  std::vector<double> area(mesh.F.rows());
  const auto at = [&mesh](Eigen::Index f, int c) -> Vec3 { return mesh.V.row(mesh.F(f, c)); };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    area[f] = (at(f, 1) - at(f, 0)).cross(at(f, 2) - at(f, 0)).norm();
  std::discrete_distribution<int> face(area.begin(), area.end());
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> normal(0, noise);
  Points out(count, 3);
  for (int i = 0; i < count; ++i) {
    const int f = face(random);
    const double r = std::sqrt(share(random)), s = share(random);
    out.row(i) = (1 - r) * at(f, 0) + r * (1 - s) * at(f, 1) + r * s * at(f, 2) +
                 Vec3(normal(random), normal(random), normal(random));
  }
  return out;
}

bool says(const Scan& scan, const std::string& what) {
  for (const std::string& note : scan.notes)
    if (note.find(what) != std::string::npos) return true;
  return false;
}

TEST_F(CleanScanTest, SmallMeshesStayAsTheyAre) {
  const Scan scan = clean_scan(file_of(man()));
  EXPECT_EQ(scan.points, man().V);
  EXPECT_EQ(scan.F, man().F);
  EXPECT_TRUE(scan.unit_known);
  EXPECT_EQ(std::accumulate(scan.border.begin(), scan.border.end(), 0), 0);
}

TEST_F(CleanScanTest, AFlatBackIsNoFloor) {
  TriMesh flat = man();
  double back = 0;
  for (Eigen::Index v = 0; v < flat.V.rows(); ++v)
    if (flat.V(v, 1) > 1.2 && flat.V(v, 1) < 1.4) back = std::min(back, flat.V(v, 2));
  for (Eigen::Index v = 0; v < flat.V.rows(); ++v)
    if (flat.V(v, 1) > 0.8) flat.V(v, 2) = std::max(flat.V(v, 2), back + 0.03);
  const Scan scan = clean_scan(file_of(flat));
  EXPECT_FALSE(says(scan, "floor"));
  EXPECT_EQ(scan.points.rows(), flat.V.rows());
}

TEST_F(CleanScanTest, TellsTheUnitByHumanSize) {
  for (const double unit : {0.001, 0.01, 0.0254, 0.3048, 1.0}) {
    const Scan scan = clean_scan(file_of(scaled(man(), 1 / unit)));
    EXPECT_TRUE(scan.unit_known);
    EXPECT_DOUBLE_EQ(scan.unit, unit);
    EXPECT_NEAR((scan.points - man().V).cwiseAbs().maxCoeff(), 0, 1e-9);
  }
  const Scan odd = clean_scan(file_of(scaled(man(), 7)));
  EXPECT_FALSE(odd.unit_known);
  EXPECT_TRUE(says(odd, "unit unknown"));
  const double stature = man().V.col(1).maxCoeff();
  const Scan told = clean_scan(file_of(scaled(man(), 7)), {.stature = stature});
  EXPECT_NEAR(told.unit, 1.0 / 7, 0.01 / 7);
  EXPECT_NEAR(clean_scan(file_of(scaled(man(), 7)), {.unit = 1.0 / 7}).unit, 1.0 / 7, 1e-12);
}

TEST(ScanUnitTest, WeighsWhatTheFileSays) {
  EXPECT_EQ(guess_unit(1.7, 0, {}).metres, 1);
  EXPECT_EQ(guess_unit(1.7, 0, 0.01).metres, 1);  // the file is wrong
  EXPECT_EQ(guess_unit(70, 0, 0.01).metres, 0.01);
  // Sitting: the surface of 1.9 m^2 tells centimetres.
  EXPECT_EQ(guess_unit(115, 19000, {}).metres, 0.01);
}

TEST_F(CleanScanTest, TurnsMeshesOutwards) {
  TriMesh turned = man();
  for (Eigen::Index f = 0; f < turned.F.rows(); ++f)
    if (f % 5 != 0) std::swap(turned.F(f, 1), turned.F(f, 2));
  const Scan straight = clean_scan(file_of(man())), scan = clean_scan(file_of(turned));
  EXPECT_LT((scan.normals - straight.normals).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_TRUE(says(scan, "inside out"));
}

TEST_F(CleanScanTest, TakesFloorsAndKeepsSoles) {
  for (const double half : {0.4, 1.5}) {
    const Scan scan = clean_scan(file_of(joined(man(), sheet(half, 0))));
    EXPECT_EQ(scan.points.rows(), man().V.rows()) << half;
    EXPECT_LT(scan.points.col(1).minCoeff(), 1e-3);
    ASSERT_TRUE(scan.up.has_value());
    EXPECT_GT(scan.up->y(), 0.999);
  }
}

TEST_F(CleanScanTest, TakesTheInnerSkinOfAShell) {
  const Scan plain = clean_scan(file_of(man()));
  TriMesh inner{man().V - 0.004 * plain.normals, man().F};
  inner.F.col(1).swap(inner.F.col(2));
  const Scan scan = clean_scan(file_of(joined(man(), inner)));
  EXPECT_NEAR(total_area(scan), total_area(plain), 0.06 * total_area(plain));
}

TEST_F(CleanScanTest, TakesIslandsAndKeepsHands) {
  // A ring of 3 mm is cut off at the wrist.
  TriMesh cut = man();
  const double tip = cut.V.col(0).cwiseAbs().maxCoeff();
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < cut.F.rows(); ++f) {
    bool ring = false;
    for (int c = 0; c < 3; ++c) {
      const double away = tip - std::abs(cut.V(cut.F(f, c), 0));
      ring |= away > 0.19 && away < 0.193;
    }
    if (!ring) cut.F.row(kept++) = cut.F.row(f).eval();
  }
  cut.F.conservativeResize(kept, 3);
  TriMesh ball = scaled(man(), 0.05);
  ball.V.rowwise() += Eigen::RowVector3d(0.8, 1, 0);
  const Scan scan = clean_scan(file_of(joined(cut, ball)));
  EXPECT_NEAR(scan.points.col(0).maxCoeff(), tip, 0.01);
  EXPECT_NEAR(total_area(scan), total_area(clean_scan(file_of(man()))), 0.03);
  EXPECT_TRUE(says(scan, "island"));
}

TEST_F(CleanScanTest, ReadsCloudsThroughNoiseAndStrays) {
  std::mt19937 random(5);
  for (const int count : {3000, 40000}) {
    const Points clean = cloud_of(man(), count, 0.002, random);
    const Eigen::RowVector3d low = clean.colwise().minCoeff(), high = clean.colwise().maxCoeff();
    std::uniform_real_distribution<double> share(-0.05, 1.05);
    TriMesh cloud;
    cloud.V.resize(count + count / 20, 3);
    cloud.V.topRows(count) = clean;
    for (Eigen::Index i = count; i < cloud.V.rows(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        cloud.V(i, axis) = std::lerp(low[axis], high[axis], share(random));
    const Scan scan = clean_scan(file_of(cloud));
    EXPECT_GT(scan.points.rows(), 0.95 * count);
    EXPECT_LT(scan.points.rows(), 1.025 * count);
    // Sides: normals of the nearest vertices of the mesh.
    const Scan mesh = clean_scan(file_of(man()));
    int right = 0, looked = 0;
    for (Eigen::Index i = 0; i < scan.points.rows(); i += 37, ++looked) {
      Eigen::Index nearest = 0;
      (mesh.points.rowwise() - scan.points.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
      right += scan.normals.row(i).dot(mesh.normals.row(nearest)) > 0 ? 1 : 0;
    }
    EXPECT_GT(right, 0.96 * looked) << count;
    EXPECT_NEAR(total_area(scan), total_area(mesh), 0.25 * total_area(mesh)) << count;
  }
}

TEST_F(CleanScanTest, ThinsWhatIsLarge) {
  TriMesh large = man();
  while (large.F.rows() <= 400'000) {  // every triangle in four, corners apart
    TriMesh finer{Points(6 * large.F.rows(), 3), Triangles(4 * large.F.rows(), 3)};
    for (Eigen::Index f = 0; f < large.F.rows(); ++f) {
      const int v = int(6 * f);
      for (int c = 0; c < 3; ++c) {
        finer.V.row(v + c) = large.V.row(large.F(f, c));
        finer.V.row(v + 3 + c) =
            0.5 * (large.V.row(large.F(f, c)) + large.V.row(large.F(f, (c + 1) % 3)));
      }
      finer.F.middleRows(4 * f, 4) << v, v + 3, v + 5, v + 3, v + 1, v + 4, v + 5, v + 4, v + 2,
          v + 3, v + 4, v + 5;
    }
    large = finer;
  }
  const Scan scan = clean_scan(file_of(large)), whole = clean_scan(file_of(man()));
  EXPECT_EQ(scan.F.rows(), 0);
  EXPECT_LE(scan.points.rows(), 400'000);
  EXPECT_NEAR(total_area(scan), total_area(whole), 0.01 * total_area(whole));
  const std::vector<int> spread = spread_points(scan, 5000);
  EXPECT_LE(spread.size(), 5000U);
  EXPECT_GT(spread.size(), 4500U);
}

TEST_F(CleanScanTest, PartsAreToldByName) {
  EXPECT_EQ(kind_of_part("Body", {}), PartKind::body);
  EXPECT_EQ(kind_of_part("Hero_Shirt.001", {}), PartKind::clothes);
  EXPECT_EQ(kind_of_part("CC_Base_Eye", {}), PartKind::eyes);
  EXPECT_EQ(kind_of_part("CC_Base_EyeBrow", {}), PartKind::hair);
  EXPECT_EQ(kind_of_part("Knight_Helmet", {}), PartKind::headgear);
  EXPECT_EQ(kind_of_part("Landscaped", {}), PartKind::body);
  EXPECT_EQ(kind_of_part("Object_3", std::vector<std::string>{"M_Hair"}), PartKind::hair);
  EXPECT_EQ(kind_of_part("Body", std::vector<std::string>{"Eyes"}), PartKind::eyes);
  EXPECT_EQ(kind_of_part("Body", std::vector<std::string>{"Suit"}), PartKind::body);
  MeshFile file = file_of(man(), "body");
  file.parts.push_back({.name = "sword", .mesh = sheet(2, 1)});
  const Scan scan = clean_scan(file);
  EXPECT_EQ(scan.points.rows(), man().V.rows());
  EXPECT_EQ(scan.left_out, std::vector<std::string>{"sword"});
}

// An arched sheet of that side.
TriMesh lump(double size, const Vec3& middle) {
  TriMesh out = sheet(0.5 * size, 0);
  out.V.col(1) = 0.3 * (0.25 * size * size - out.V.col(0).array().square()) / size;
  out.V.rowwise() += middle.transpose();
  return out;
}

TEST_F(CleanScanTest, ShoesInTheMaterialOfTheEyesAreNoEyes) {
  const TriMesh &body = man(),
                eyes = joined(lump(0.03, {0.03, 1.68, 0.1}), lump(0.03, {-0.03, 1.68, 0.1})),
                shoes = joined(lump(0.3, {0.15, 0.05, 0.1}), lump(0.3, {-0.15, 0.05, 0.1}));
  MeshFile file = file_of(joined(joined(body, eyes), shoes), "BaseHuman");
  file.parts[0].materials = {"Skin", "Eyes"};
  file.parts[0].face_materials.assign(std::size_t(file.parts[0].mesh.F.rows()), 1);
  std::fill_n(file.parts[0].face_materials.begin(), body.F.rows(), 0);
  const double with_shoes = total_area(clean_scan(file_of(joined(body, shoes))));
  for (const bool upright : {true, false}) {
    if (upright) file.up = Vec3::UnitY();
    if (!upright) file.up.reset();
    const Scan scan = clean_scan(file);
    EXPECT_EQ(scan.left_out, std::vector<std::string>{"BaseHuman (Eyes)"});
    EXPECT_TRUE(says(scan, "no body by name: BaseHuman (Eyes)"));
    EXPECT_NEAR(total_area(scan), with_shoes, 1e-3);
  }
}

TEST(HeadIslandTest, PlaceSizeAndWeightsBearTheNameOut) {
  const auto cube = [](double side, const Vec3& middle) {
    return Eigen::AlignedBox3d(middle - Vec3::Constant(0.5 * side),
                               middle + Vec3::Constant(0.5 * side));
  };
  const Eigen::AlignedBox3d standing(Vec3(-0.8, 0, -0.2), Vec3(0.8, 1.8, 0.2));
  const std::vector<HeadIsland> islands{
      {PartKind::eyes, cube(0.03, {0.03, 1.7, 0.1})},       // an eye
      {PartKind::eyes, cube(0.03, {0.1, 0.1, 0.1})},        // a button of a shoe
      {PartKind::mouth, cube(0.3, {0.1, 1.6, 0.1})},        // too large
      {PartKind::hair, cube(0.3, {0, 1.75, 0})},            // hair may be large
      {PartKind::eyes, cube(0.3, {0, 1.7, 0}), true},       // large, and hangs on the head
      {PartKind::eyes, cube(0.03, {0.8, 1.4, 0}), false}};  // hangs on a hand
  const std::vector<char> expected{1, 0, 0, 1, 1, 0};
  EXPECT_EQ(lies_in_head(islands, standing, Vec3(Vec3::UnitY())), expected);
  EXPECT_EQ(lies_in_head(islands, standing, {}), expected);
  // It lies on its back: up tells nothing.
  const Eigen::AlignedBox3d lying(Vec3(-0.4, 0, -0.9), Vec3(0.4, 0.3, 0.9));
  const std::vector<HeadIsland> there{{PartKind::eyes, cube(0.03, {0.03, 0.1, 0.8})},
                                      {PartKind::eyes, cube(0.03, {-0.03, 0.1, 0.8})},
                                      {PartKind::eyes, cube(0.1, {0.1, 0.1, -0.8})}};
  EXPECT_EQ(lies_in_head(there, lying, Vec3(Vec3::UnitY())), (std::vector<char>{1, 1, 0}));
}

TEST_F(CleanScanTest, RefusesWhatIsNoPerson) {
  EXPECT_THROW(clean_scan({}), UnfitError);
  EXPECT_THROW(clean_scan(file_of(sheet(1, 0))), UnfitError);
  EXPECT_THROW(clean_scan(file_of({man().V.topRows(200), {}})), UnfitError);
  EXPECT_THROW(clean_scan(file_of({Points::Ones(1000, 3), {}})), UnfitError);
  const Points unreal = Points::Constant(1000, 3, std::nan(""));
  EXPECT_THROW(clean_scan(file_of({unreal, {}})), UnfitError);
}

// Binary PLY of three floats a vertex, as the sensors' tools write it.
MeshFile sensor_cloud(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const std::size_t head = bytes.find("end_header\n") + 11;
  std::vector<float> values((bytes.size() - head) / sizeof(float));
  std::memcpy(values.data(), bytes.data() + head, values.size() * sizeof(float));
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  TriMesh cloud;
  cloud.V = Eigen::Map<Rows>(values.data(), Eigen::Index(values.size() / 3), 3).cast<double>();
  return file_of(cloud);
}

TEST(CleanSensorScanTest, FindsPeopleInRealScans) {
  const std::filesystem::path scans =
      std::filesystem::path(ECORCHE_SHARED_DIR) / "testdata" / "scans";
  if (!std::filesystem::exists(scans)) GTEST_SKIP() << scans << " is not there";
  const Scan fused = clean_scan(sensor_cloud(scans / "kinect_full_body_GPL3" / "scan1.ply"));
  EXPECT_EQ(fused.unit, 1);
  EXPECT_FALSE(fused.one_view);
  EXPECT_GT(fused.points.rows(), 60'000);
  // One view of head and shoulders, 0.6 to 1 m away, before a room that begins at 1.2 m.
  const Scan view = clean_scan(sensor_cloud(scans / "pcl_person_kinect" / "person_full_view.ply"));
  EXPECT_TRUE(view.one_view);
  EXPECT_LT(view.points.col(2).maxCoeff(), 1.1);
  EXPECT_GT(view.points.rows(), 45'000);
}

}  // namespace
}  // namespace ecorche
