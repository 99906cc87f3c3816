// Models of other programs: small ones written here, real ones from ../shared, damaged ones from
// tests/corpus/model.
#include "anatomy/model_files/mjcf_reader.h"
#include "anatomy/model_files/model_reader.h"
#include "anatomy/model_files/musculoskeletal_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/model_files/model_export.h"
#include "anatomy/model_files/model_xml.h"
#include "anatomy/model_files/osim_functions.h"
#include "anatomy/model_files/osim_reader.h"
#include "anatomy/muscles/taut_path.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

const fs::path kCorpus = fs::path(ECORCHE_TEST_DIR) / "corpus/model";
const fs::path kShared = fs::path(ECORCHE_SHARED_DIR) / "testdata/osim";

// Two bodies and a muscle; `joint` is what moves the second body, `extra` what follows the bodies.
std::string osim(const std::string& joint, const std::string& extra = "",
                 const std::string& points = "") {
  return R"(<OpenSimDocument Version="40000"><Model name="two"><BodySet name="b"><objects>
    <Body name="thigh"><WrapObjectSet><objects><WrapCylinder name="knee_w">
      <active>true</active><xyz_body_rotation>0 0 0</xyz_body_rotation>
      <translation>0 -0.4 0</translation><quadrant>+x</quadrant>
      <radius>0.03</radius><length>0.1</length></WrapCylinder></objects></WrapObjectSet></Body>
    <Body name="shank"/></objects></BodySet><JointSet name="j"><objects>
    <WeldJoint name="root"><socket_parent_frame>/ground</socket_parent_frame>
      <socket_child_frame>/bodyset/thigh</socket_child_frame></WeldJoint>)" +
         joint + "</objects></JointSet>" + extra +
         R"(<ForceSet name="f"><objects><Thelen2003Muscle name="quad">
    <GeometryPath name="p"><PathPointSet><objects>
    <PathPoint name="a"><socket_parent_frame>/bodyset/thigh</socket_parent_frame>
      <location>0.05 0 0</location></PathPoint>)" +
         points +
         R"(<PathPoint name="b"><socket_parent_frame>/bodyset/shank</socket_parent_frame>
      <location>0.04 -0.1 0.01</location></PathPoint>
    </objects></PathPointSet><PathWrapSet><objects><PathWrap name="w">
      <wrap_object>knee_w</wrap_object><range>-1 -1</range></PathWrap></objects></PathWrapSet>
    </GeometryPath>
    <max_isometric_force>1000</max_isometric_force>
    <optimal_fiber_length>0.08</optimal_fiber_length><tendon_slack_length>0.3</tendon_slack_length>
    <pennation_angle_at_optimal>0.2</pennation_angle_at_optimal>
    </Thelen2003Muscle></objects></ForceSet></Model></OpenSimDocument>)";
}

std::string pin(double value, const std::string& range = "") {
  return R"(<PinJoint name="knee"><socket_parent_frame>up</socket_parent_frame>
    <socket_child_frame>/bodyset/shank</socket_child_frame><coordinates>
    <Coordinate name="angle"><default_value>)" +
         std::to_string(value) + "</default_value>" + range + R"(</Coordinate></coordinates><frames>
    <PhysicalOffsetFrame name="up"><socket_parent>/bodyset/thigh</socket_parent>
      <translation>0 -0.4 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>
    </frames></PinJoint>)";
}

TEST(OsimModel, PosesBodiesAndKeepsForces) {
  const MusculoskeletalModel model = parse_osim(osim(pin(0.5)), "two.osim");
  ASSERT_EQ(model.bodies.size(), 2u);
  const ModelBody& shank = model.bodies[1];
  // OpenSim's (x, y, z) = (forward, up, right) is our (-z, y, x).
  EXPECT_LT((shank.center[kZeroPose] - Vec3(0, -0.4, 0)).norm(), 1e-12);
  const ModelPoint& end = model.muscles[0].points[1];
  EXPECT_LT((shank.X_WB[kZeroPose] * end.place[kZeroPose] - Vec3(-0.01, -0.5, 0.04)).norm(), 1e-12);
  const double c = std::cos(0.5), s = std::sin(0.5);
  EXPECT_LT((shank.X_WB[kDefaultPose] * end.place[kDefaultPose] -
             Vec3(-0.01, -0.4 + s * 0.04 - c * 0.1, c * 0.04 + s * 0.1))
                .norm(),
            1e-12);
  EXPECT_EQ(model.muscles[0].max_force, 1000);
  EXPECT_EQ(model.muscles[0].fibre_length, 0.08);
  EXPECT_EQ(model.muscles[0].tendon_slack, 0.3);
  EXPECT_EQ(model.muscles[0].pennation, 0.2);
  ASSERT_EQ(model.wraps.size(), 1u);
  EXPECT_EQ(model.wraps[0].side, Vec3(1, 0, 0));
  EXPECT_EQ(model.wraps[0].radii, Vec3(0.03, 0.03, 0.05));
}

TEST(OsimModel, ZeroPoseStaysWithinLimits) {
  const MusculoskeletalModel model =
      parse_osim(osim(pin(0.9, "<range>0.3 1</range><clamped>true</clamped>")), "two.osim");
  const Mat3 R = model.bodies[0].X_WB[kZeroPose].linear().transpose() *
                 model.bodies[1].X_WB[kZeroPose].linear();
  EXPECT_NEAR(std::atan2(R(1, 0), R(0, 0)), 0.3, 1e-12);
}

TEST(OsimModel, ConditionalAndMovingPointsFollowTheirCoordinates) {
  const std::string points =
      R"(<ConditionalPathPoint name="c"><socket_parent_frame>/bodyset/thigh</socket_parent_frame>
      <location>0.06 -0.35 0</location><socket_coordinate>/jointset/knee/angle</socket_coordinate>
      <range>0.2 2</range></ConditionalPathPoint>
    <MovingPathPoint name="m"><socket_parent_frame>/bodyset/shank</socket_parent_frame>
      <socket_x_coordinate>/jointset/knee/angle</socket_x_coordinate>
      <socket_y_coordinate>/jointset/knee/angle</socket_y_coordinate>
      <socket_z_coordinate>/jointset/knee/angle</socket_z_coordinate>
      <x_location><LinearFunction><coefficients>0.02 0.05</coefficients></LinearFunction>
      </x_location>
      <y_location><Constant><value>-0.02</value></Constant></y_location>
      <z_location><MultiplierFunction><function><PiecewiseLinearFunction>
        <x>0 1</x><y>0 0.01</y></PiecewiseLinearFunction></function>
        <scale>2</scale></MultiplierFunction></z_location></MovingPathPoint>)";
  const MusculoskeletalModel model = parse_osim(osim(pin(0.5), "", points), "two.osim");
  const auto& p = model.muscles[0].points;
  ASSERT_EQ(p.size(), 4u);
  EXPECT_FALSE(p[1].active[kZeroPose]);
  EXPECT_TRUE(p[1].active[kDefaultPose]);
  EXPECT_LT((p[2].place[kZeroPose] - Vec3(0.05, -0.02, 0)).norm(), 1e-12);
  EXPECT_LT((p[2].place[kDefaultPose] - Vec3(0.06, -0.02, 0.01)).norm(), 1e-12);
}

TEST(OsimModel, ReadsJointsInsideBodies) {  // as OpenSim 3 wrote them
  const std::string text =
      R"(<OpenSimDocument Version="30000"><Model name="old"><BodySet><objects>
    <Body name="ground"/><Body name="thigh"><Joint><FreeJoint name="r">
    <parent_body>ground</parent_body><location_in_parent>0 1 0</location_in_parent>
    <orientation_in_parent>0 0 0</orientation_in_parent><location>0 0 0</location>
    <orientation>0 0 0</orientation><CoordinateSet><objects>
    <Coordinate name="a"/><Coordinate name="b"/><Coordinate name="c"/>
    <Coordinate name="d"/><Coordinate name="e"/><Coordinate name="f"/></objects></CoordinateSet>
    </FreeJoint></Joint></Body></objects></BodySet>
    <ForceSet><objects><Thelen2003Muscle name="m"><GeometryPath><PathPointSet><objects>
    <PathPoint name="1"><location>0 0 0</location><body>thigh</body></PathPoint>
    <PathPoint name="2"><location>0 0.1 0</location><body>thigh</body></PathPoint></objects>
    </PathPointSet></GeometryPath><max_isometric_force>10</max_isometric_force>
    </Thelen2003Muscle></objects></ForceSet></Model></OpenSimDocument>)";
  const MusculoskeletalModel model = parse_osim(text, "old.osim");
  EXPECT_LT((model.bodies[0].X_WB[kDefaultPose].translation() - Vec3(0, 1, 0)).norm(), 1e-12);
}

TEST(OsimFunction, SplinesGoThroughTheirPointsAndGiveBackCubics) {
  pugi::xml_document document;
  document.load_string("<SimmSpline><x>-1 0 1 2 4</x><y>-1 0 1 8 64</y></SimmSpline>");
  for (double x : {-1.0, -0.5, 0.3, 1.7, 3.1, 4.0})
    EXPECT_NEAR(osim_function(document.first_child(), x, "f"), x * x * x, 1e-9) << x;
}

TEST(Mjcf, ReadsClassesCouplingsSidesAndMuscles) {
  const std::string text =
      R"(<mujoco model="m"><compiler angle="degree"/><default><default class="c">
      <joint axis="0 1 0" range="0 90"/><geom type="cylinder"/></default></default>
    <worldbody><body name="thigh" pos="0 0 1" childclass="c"><site name="a" pos="0.05 0 0"/>
    <geom name="w" size="0.03 0.05" pos="0 0 -0.4" euler="90 0 0"/>
    <site name="side" pos="0.1 0 -0.4"/><body name="shank" pos="0 0 -0.4">
    <joint name="knee" ref="30"/><site name="b" pos="0.04 0 -0.1"/>
    <body name="cap"><joint name="cap"/></body></body></body></worldbody>
    <equality><joint joint1="cap" joint2="knee" polycoef="0 0.5 0 0 0"/></equality>
    <tendon><spatial name="t"><site site="a"/><geom geom="w" sidesite="side"/>
      <site site="b"/></spatial></tendon>
    <actuator><muscle name="q" tendon="t" force="700" range="0.5 1.5" lengthrange="0.34 0.44"/>
      <motor joint="knee"/></actuator></mujoco>)";
  const MusculoskeletalModel model =
      parse_mjcf_model({[&](const std::string&) { return text; }}, "m.xml");
  ASSERT_EQ(model.bodies.size(), 3u);
  ASSERT_EQ(model.muscles.size(), 1u);
  EXPECT_EQ(model.muscles[0].max_force, 700);
  EXPECT_NEAR(model.muscles[0].fibre_length, 0.1, 1e-12);
  EXPECT_NEAR(model.muscles[0].tendon_slack, 0.29, 1e-12);
  // At the default (30 degrees) the body stands as written; at zero it has turned back, and the cap
  // half as far.
  EXPECT_LT(
      (model.bodies[1].X_WB[kDefaultPose].linear() - model.bodies[0].X_WB[kDefaultPose].linear())
          .norm(),
      1e-12);
  const Mat3 knee = model.bodies[0].X_WB[kZeroPose].linear().transpose() *
                    model.bodies[1].X_WB[kZeroPose].linear();
  EXPECT_NEAR(std::atan2(knee(0, 2), knee(0, 0)), -3.14159265358979 / 6, 1e-12);
  const Mat3 cap = model.bodies[1].X_WB[kZeroPose].linear().transpose() *
                   model.bodies[2].X_WB[kZeroPose].linear();
  EXPECT_NEAR(std::atan2(cap(0, 2), cap(0, 0)), -3.14159265358979 / 12, 1e-12);
  ASSERT_EQ(model.muscles[0].wraps.size(), 1u);
  EXPECT_GT(model.muscles[0].wraps[0].side.x(), 0.05);
}

TEST(ModelFiles, NothingOutsideTheFolderIsRead) {
  const fs::path folder = fs::temp_directory_path() / "ecorche_model_test";
  fs::create_directories(folder / "inner");
  std::ofstream(folder / "secret.xml") << "<mujocoinclude/>";
  for (const char* path : {"../secret.xml", "/etc/hostname", "a/../../secret.xml"}) {
    std::ofstream(folder / "inner/m.xml") << "<mujoco><include file=\"" << path << "\"/></mujoco>";
    EXPECT_THROW(read_muscle_model(folder / "inner/m.xml"), InputError) << path;
  }
  std::error_code error;
  fs::remove(folder / "inner/link.xml", error);
  fs::create_symlink("../secret.xml", folder / "inner/link.xml");
  std::ofstream(folder / "inner/m.xml") << "<mujoco><include file=\"link.xml\"/></mujoco>";
  EXPECT_THROW(read_muscle_model(folder / "inner/m.xml"), InputError);
  EXPECT_THROW(
      read_model_mesh(folder / "inner", {"../secret.obj", Vec3::Ones(), Transform::Identity()}),
      InputError);
  fs::remove_all(folder);
}

// corpus/model/expected.txt: file | type of error | text of its message
TEST(ModelFiles, BadFilesAreNamedForWhatTheyAre) {
  std::ifstream in(kCorpus / "expected.txt");
  int lines = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream parts(line);
    std::string file, type, what;
    std::getline(parts >> std::ws, file, '|');
    std::getline(parts >> std::ws, type, '|');
    std::getline(parts >> std::ws, what);
    file.erase(file.find_last_not_of(' ') + 1);
    type.erase(type.find_last_not_of(' ') + 1);
    ++lines;
    try {
      read_muscle_model(kCorpus / file);
      ADD_FAILURE() << file << " was read";
    } catch (const Error& e) {
      const std::string thrown = dynamic_cast<const InputError*>(&e)   ? "input"
                                 : dynamic_cast<const UnfitError*>(&e) ? "unfit"
                                 : dynamic_cast<const LimitError*>(&e) ? "limit"
                                                                       : "other";
      EXPECT_EQ(thrown, type) << file << ": " << e.what();
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << file << ": " << e.what();
    }
  }
  EXPECT_GE(lines, 20);
}

TEST(ModelFiles, CutAnywhereIsRefusedOrRead) {
  const std::string text = osim(pin(0.5));
  for (size_t size = 0; size < text.size(); size += 7) {
    try {
      parse_osim(text.substr(0, size), "cut.osim");
      ADD_FAILURE() << "read although cut at " << size;
    } catch (const Error&) {
    }
  }
}

TEST(RealModels, HaveWhatTheyHave) {
  if (!fs::exists(kShared)) GTEST_SKIP() << "no ../shared";
  struct Known {
    const char* file;
    size_t bodies, muscles;
  };
  for (const Known& k : {Known{"opensim_core/subject_walk_scaled.osim", 22, 80},
                         Known{"opensim_core/ThoracoscapularShoulderModel.osim", 7, 33},
                         Known{"biobuddy/MOBL_ARMS_41.osim", 12, 50},
                         Known{"biobuddy/Wu_Shoulder_Model_via_points.osim", 7, 31}}) {
    const MusculoskeletalModel model = read_muscle_model(kShared / k.file);
    EXPECT_EQ(model.bodies.size(), k.bodies) << k.file;
    EXPECT_EQ(model.muscles.size(), k.muscles) << k.file;
    for (const ModelMuscle& m : model.muscles)
      EXPECT_GT(m.fibre_length * m.max_force * m.points.size(), 0) << m.name;
  }
}

// Positions that OpenSim 4.6 gives for these models in their default pose (our axes, m).
TEST(RealModels, StandWhereOpenSimPutsThem) {
  if (!fs::exists(kShared)) GTEST_SKIP() << "no ../shared";
  struct Place {
    const char *file, *body;
    Vec3 position;
  };
  for (const Place& place : std::vector<Place>{
           {"opensim_core/subject_walk_scaled.osim", "patella_r",
            Vec3(-0.083559052, 0.433526212, -0.018268102)},
           {"opensim_core/subject_walk_scaled.osim", "toes_l",
            Vec3(0.094678860, -0.076934815, 0.047212980)},
           {"opensim_core/subject_walk_scaled.osim", "hand_l",
            Vec3(0.232164888, 0.838155853, -0.113983681)},
           {"opensim_core/ThoracoscapularShoulderModel.osim", "scapula",
            Vec3(-0.141653857, 0.020543790, -0.049553938)},
           {"opensim_core/ThoracoscapularShoulderModel.osim", "hand",
            Vec3(-0.265950429, -0.542653394, 0.013157237)},
           {"biobuddy/MOBL_ARMS_41.osim", "hand", Vec3(-0.275848817, -0.471152662, -0.192247260)},
           {"biobuddy/MOBL_ARMS_41.osim", "humerus", Vec3(0.027296994, 0.000083585, -0.169651701)},
           {"biobuddy/Wu_Shoulder_Model_via_points.osim", "hand_r",
            Vec3(-0.201469700, -0.539007712, 0.005953499)},
       }) {
    const MusculoskeletalModel model = read_muscle_model(kShared / place.file);
    for (const ModelBody& body : model.bodies) {
      if (body.name != place.body) continue;
      EXPECT_LT((body.X_WB[kDefaultPose].translation() - place.position).norm(), 1e-6)
          << place.file << " " << place.body;
    }
  }
}

// --- strings over objects --------------------------------------------------------------
TEST(TautPath, GoesOverASphereOnTheAskedSide) {
  Wrap ball;
  ball.radii.setConstant(0.05);
  for (double side : {1.0, -1.0}) {
    const auto points = taut_points({-0.2, 0.01, 0}, {0.2, 0.01, 0}, ball, {0, side, 0}, 0);
    ASSERT_EQ(points.size(), 3u);
    double length = 0;
    Vec3 last(-0.2, 0.01, 0);
    for (const Vec3& p : points) {
      EXPECT_NEAR(p.norm(), 0.05, 2e-4);
      EXPECT_GT(p.y() * side, 0.04);
      length += (p - last).norm();
      last = p;
    }
    length += (Vec3(0.2, 0.01, 0) - last).norm();
    // Tangents and arc, exactly.
    const double d = std::hypot(0.2, 0.01), tangent = std::sqrt(d * d - 0.0025);
    const double angle =
        3.14159265358979 - side * 2 * std::atan2(0.01, 0.2) - 2 * std::acos(0.05 / d);
    EXPECT_NEAR(length, 2 * tangent + 0.05 * angle, 2e-4);
  }
}

TEST(TautPath, LeavesFreeLinesAlone) {
  Wrap rod;
  rod.kind = Wrap::Kind::cylinder;
  rod.radii << 0.03, 0.03, 0.02;
  EXPECT_TRUE(taut_points({-0.2, 0.05, 0}, {0.2, 0.05, 0}, rod, Vec3::Zero()).empty());
  EXPECT_TRUE(
      taut_points({-0.2, 0, 0.03}, {0.2, 0, 0.03}, rod, Vec3::Zero()).empty());     // past its end
  EXPECT_TRUE(taut_points({-0.01, 0, 0}, {0.2, 0, 0}, rod, Vec3::Zero()).empty());  // begins inside
  EXPECT_FALSE(taut_points({-0.2, 0, 0}, {0.2, 0, 0}, rod, Vec3::Zero()).empty());
}

}  // namespace
}  // namespace ecorche
