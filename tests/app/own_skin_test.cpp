// Strangers' meshes: attached, fitted, written, read back, moved, and handed back by their own rig.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "app/files/character_file.h"
#include "app/files/stranger.h"
#include "morph/registration/attached_skin.h"
#include "skinning/files/character_read.h"
#include "skinning/motion_files/gltf_motion.h"
#include "skinning/retarget/retarget.h"
#include "skinning/rigs/own_rig.h"
#include "skinning/rigs/standing_pose.h"
#include "tests/app/stranger.h"
#include "tests/body_fixture.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

double largest(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

Points in_world(const Registration& registration, const Points& V) {
  return (registration.scale * V * registration.axes.transpose()).rowwise() +
         registration.shift.transpose();
}

class OwnSkinTest : public BodyFixture {
 protected:
  void SetUp() override {
    BodyFixture::SetUp();
    if (IsSkipped()) return;
    registration = test::posed_package(package());
    stranger = make_stranger(test::stranger_glb(package(), registration), "stranger.glb");
  }
  StandingMesh standing() const {
    return {{in_world(registration, stranger.rig.mesh.V), stranger.rig.mesh.F},
            rigid_pieces(stranger.rig)};
  }

  Registration registration;
  Stranger stranger;
};

TEST_F(OwnSkinTest, TheRigReaderTellsPiecesAndJoints) {
  ASSERT_EQ(stranger.rig.pieces.size(), 3u);
  EXPECT_EQ(stranger.rig.pieces[0].kind, PartKind::body);
  EXPECT_EQ(stranger.rig.pieces[1].kind, PartKind::clothes);
  EXPECT_EQ(stranger.rig.pieces[2].kind, PartKind::eyes);
  EXPECT_EQ(stranger.rig.joints.size(), 52u);
  EXPECT_EQ(body_mesh(stranger.rig).V.rows(), package().skin_size + 12);  // and the toecaps
  std::map<std::string, Vec3> places;
  for (const Landmark& joint : stranger.joints) places[joint.name] = joint.position;
  for (const char* name : {"pelvis", "head", "shoulder_l", "elbow_l", "wrist_r", "hip_l", "knee_r",
                           "ankle_l", "clavicle_r", "pip2_l"})
    EXPECT_TRUE(places.contains(name)) << name;
  // In the file's axes: z up, left is x.
  EXPECT_GT(places["hip_l"].x(), places["hip_r"].x());
  EXPECT_GT(places["head"].z(), places["pelvis"].z());
}

TEST_F(OwnSkinTest, AttachedVerticesStandAgainWhereTheyStood) {
  const StandingMesh mesh = standing();
  const AttachedSkin skin =
      attach_skin(registration, package().triangles, vertex_parts(package()), mesh);
  EXPECT_LT(largest(stand_again(registration, skin.map, skin.rest), mesh.mesh.V), 1e-6);
  for (Eigen::Index i = 0; i < skin.map.rows(); ++i)
    ASSERT_NEAR(skin.map.row(i).sum(), 1, 1e-9) << i;

  // The body's own piece lies on the base skin at rest, as it did standing, but for a few places in
  // folds (eyelids, lips).
  const Points base = registration.body.skin.V;
  double worst = 0;
  int off = 0;
  for (int i = 0; i < package().skin_size; ++i) {
    const double way = (skin.rest.row(i) - base.row(i)).norm();
    worst = std::max(worst, way);
    off += way > 0.004;
  }
  EXPECT_LT(off, 40);
  EXPECT_LT(worst, 0.025);
  // The body does not tear, nor does the coat but where the arm is pressed into its trunk.
  std::array<int, 2> torn{};
  for (Eigen::Index f = 0; f < mesh.mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.mesh.F(f, k), b = mesh.mesh.F(f, (k + 1) % 3);
      const double before = (mesh.mesh.V.row(a) - mesh.mesh.V.row(b)).norm(),
                   after = (skin.rest.row(a) - skin.rest.row(b)).norm();
      torn[a < package().skin_size ? 0 : 1] += after > 2.5 * before + 0.003;
    }
  EXPECT_LT(torn[0], 20);
  EXPECT_LT(torn[1], 200);
  // Eyes move as one.
  const SourcePiece& eyes = stranger.rig.pieces[2];
  for (int i = 1; i < 6; ++i)
    EXPECT_NEAR(
        (skin.rest.row(eyes.first_vertex) - skin.rest.row(eyes.first_vertex + i)).norm(),
        (mesh.mesh.V.row(eyes.first_vertex) - mesh.mesh.V.row(eyes.first_vertex + i)).norm(), 1e-3);
}

TEST_F(OwnSkinTest, WhatSharesTheEyesMeshAtTheFeetBendsWithTheBody) {
  const SourcePiece& eyes = stranger.rig.pieces[2];
  ASSERT_EQ(eyes.vertex_count, 24);
  const std::vector<int> rigid = rigid_pieces(stranger.rig);
  for (int i = 0; i < 24; ++i) {
    EXPECT_EQ(rigid[std::size_t(eyes.first_vertex + i)],
              i < 12 ? eyes.first_vertex + i / 6 * 6 : -1);
    EXPECT_EQ(stranger.rig.kinds[std::size_t(eyes.first_vertex + i)],
              i < 12 ? PartKind::eyes : PartKind::body);
  }
}

TEST_F(OwnSkinTest, TheRigTellsThePartsOfVertices) {
  const std::vector<VertexPart> parts = vertex_parts(package());
  const auto told = told_parts(stranger.rig);
  ASSERT_EQ(Eigen::Index(told.size()), stranger.rig.mesh.V.rows());
  int agree = 0, other_side = 0;
  std::map<BodyPart, int> seen;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!told[i]) continue;
    ++seen[told[i]->part];
    agree += told[i]->part == parts[i].part && told[i]->side == parts[i].side;
    const bool paired = told[i]->side != Side::middle && parts[i].side != Side::middle;
    other_side += paired && told[i]->side != parts[i].side;
  }
  EXPECT_EQ(seen.size(), 9u);
  EXPECT_GT(agree, 0.9 * double(parts.size()));
  EXPECT_LT(other_side, 10);  // between the legs
  // A coat hangs on the trunk wherever it reaches; eyes hang on no joint.
  const SourcePiece &coat = stranger.rig.pieces[1], &eyes = stranger.rig.pieces[2];
  for (int i = 0; i < coat.vertex_count; ++i)
    if (const auto& part = told[std::size_t(coat.first_vertex + i)]) {
      EXPECT_NE(part->part, BodyPart::trunk);
    }
  EXPECT_FALSE(told[std::size_t(eyes.first_vertex)]);
}

// Straight arms swung forward until the hands are `deep` metres within each other.
Registration with_hands_together(const BodyPackage& package, double deep) {
  const std::vector<VertexPart> parts = vertex_parts(package);
  Registration out;
  double low = 60, high = 150;  // degrees
  for (int round = 0; round < 12; ++round) {
    const double swing = 0.5 * (low + high);
    out = test::turned_package(package, [&](const std::string& name) -> Quat {
      if (name.ends_with("LeftArm")) return test::turn_about(-swing, Vec3::UnitY());
      if (name.ends_with("RightArm")) return test::turn_about(swing, Vec3::UnitY());
      return Quat::Identity();
    });
    double inmost = 1;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].part == BodyPart::hand && parts[i].side == Side::left)
        inmost = std::min(inmost, out.posed(Eigen::Index(i), 0));
    (inmost < -0.5 * deep ? high : low) = swing;
  }
  return out;
}

TEST_F(OwnSkinTest, HandsHeldTogetherStayTwo) {
  const Registration held = with_hands_together(package(), 0.06);
  const std::vector<VertexPart> parts = vertex_parts(package());
  StandingMesh mesh{{held.posed, package().triangles}, {}};
  const auto wrong = [&](const AttachedSkin& skin) {
    int out = 0;
    for (int i = 0; i < skin.map.outerSize(); ++i) {
      const VertexPart& own = parts[std::size_t(i)];
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(skin.map, i); it; ++it)
        if (own.part == BodyPart::hand && parts[std::size_t(it.col())].side != own.side) {
          ++out;
          break;
        }
    }
    return out;
  };
  // A mesh a little off the base mesh that was found in it.
  mesh.mesh.V.rowwise() += Eigen::RowVector3d(0.025, 0, 0);
  const AttachedSkin blind = attach_skin(held, package().triangles, parts, mesh);
  EXPECT_GT(wrong(blind), 20);
  mesh.parts.assign(parts.begin(), parts.end());
  const AttachedSkin skin = attach_skin(held, package().triangles, parts, mesh);
  EXPECT_EQ(wrong(skin), 0);
  double longest = 0;
  for (Eigen::Index f = 0; f < mesh.mesh.F.rows(); ++f) {
    const int a = mesh.mesh.F(f, 0), b = mesh.mesh.F(f, 1);
    longest = std::max(longest, (skin.rest.row(a) - skin.rest.row(b)).norm() -
                                    (mesh.mesh.V.row(a) - mesh.mesh.V.row(b)).norm());
  }
  EXPECT_LT(longest, 0.1);

  // Names whose left is our right tell nothing.
  for (auto& part : mesh.parts)
    if (part->side != Side::middle)
      part->side = part->side == Side::left ? Side::right : Side::left;
  const AttachedSkin swapped = attach_skin(held, package().triangles, parts, mesh);
  EXPECT_LT(largest(swapped.rest, blind.rest), 1e-12);
}

class WrittenStranger : public OwnSkinTest {
 protected:
  void SetUp() override {
    OwnSkinTest::SetUp();
    if (IsSkipped()) return;
    NEED_TEMPLATE();
    if (!file.empty()) return;  // once for all tests
    Report report;
    fitted = fit_stranger(test_assets(), tmpl, stranger, registration, package(),
                          {.fitting = {.tissues = false}}, report);
    // Where a person wants to look at it.
    const char* kept = std::getenv("ECORCHE_KEEP");
    file = kept ? fs::path(kept) : fs::temp_directory_path() / "ecorche_own_skin_test.glb";
    write_character_file(test_assets(), file, fitted.bound.character, fitted.bound.binding,
                         Detail::full, package());
  }
  static void TearDownTestSuite() {
    if (!file.empty() && !std::getenv("ECORCHE_KEEP")) fs::remove(file);
  }

  static inline FittedForFile fitted;
  static inline fs::path file;
};

TEST_F(WrittenStranger, TheMeshThatGoesOutIsTheOneThatCameIn) {
  const std::string bytes = read_input_file(file);
  const SourceRig out = read_source_rig(bytes, "out");  // as any viewer shows it
  const Points in = in_world(registration, stranger.rig.mesh.V);
  ASSERT_GE(out.mesh.V.rows(), in.rows());
  EXPECT_LT(largest(out.mesh.V.topRows(in.rows()), in), 1e-5);
  EXPECT_EQ(out.mesh.F.topRows(stranger.rig.mesh.F.rows()), stranger.rig.mesh.F);

  const GlbParts theirs = split_glb(*stranger.source, "in"), ours = split_glb(bytes, "out");
  EXPECT_TRUE(ours.binary.starts_with(theirs.binary));
  const auto before = nlohmann::json::parse(theirs.json), after = nlohmann::json::parse(ours.json);
  for (const char* list : {"materials", "images", "textures", "bufferViews", "accessors"})
    for (std::size_t k = 0; before.contains(list) && k < before.at(list).size(); ++k)
      EXPECT_EQ(before.at(list)[k], after.at(list)[k]) << list << " " << k;
  for (std::size_t m = 0; m < before.at("meshes").size(); ++m) {
    const auto &was = before.at("meshes")[m]["primitives"][0],
               &is = after.at("meshes")[m]["primitives"][0];
    for (const char* name : {"POSITION", "TEXCOORD_0"})
      EXPECT_EQ(was["attributes"][name], is["attributes"][name]);
    EXPECT_EQ(was["indices"], is["indices"]);
    EXPECT_EQ(was["material"], is["material"]);
  }
}

TEST_F(WrittenStranger, ReadsBackAndMoves) {
  const Character& written = fitted.bound.character;
  const Character read = read_character(file);
  ASSERT_TRUE(read.own);
  EXPECT_EQ(*read.own->source, *stranger.source);
  EXPECT_LT(largest(read.body.skin.V, written.body.skin.V), 1e-6);
  EXPECT_EQ(read.body.skin.F, written.body.skin.F);
  EXPECT_LT(largest(read.own->base.V, written.own->base.V), 1e-6);
  EXPECT_EQ(read.anatomy.bones.size(), written.anatomy.bones.size());
  EXPECT_EQ(read.anatomy.muscles.size(), written.anatomy.muscles.size());
  const auto rest = rest_positions(read.anatomy.skeleton),
             rest_before = rest_positions(written.anatomy.skeleton);
  for (std::size_t j = 0; j < rest.size(); ++j)
    EXPECT_LT((rest[j] - rest_before[j]).norm(), 1e-6) << j;
  EXPECT_EQ(read_body(file).skin.V.rows(), package().skin_size);

  Report report;
  const Actor actor = make_actor(test_assets(), read, report);
  ActorState state(actor);
  Points moved;
  to_points(evaluate_skin(actor, rest_pose(actor.character.anatomy.skeleton), {}, state), moved);
  EXPECT_LT(largest(moved, read.body.skin.V), 2e-3);
  // Where it stood, bones and muscles bring it near to where it stood.
  to_points(evaluate_skin(actor, read.own->pose, {}, state), moved);
  const Points in = in_world(registration, stranger.rig.mesh.V);
  const Eigen::VectorXd miss = (moved - in).rowwise().norm();
  RecordProperty("standing_rms_mm",
                 std::to_string(1e3 * std::sqrt(miss.squaredNorm() / double(miss.size()))));
  EXPECT_LT(std::sqrt(miss.squaredNorm() / double(miss.size())), 0.03);
}

TEST_F(WrittenStranger, FollowsByItsOwnRig) {
  const Character read = read_character(file);
  const OwnRig rig(*read.own, "stranger");
  // As it stands, nothing has to move.
  const Points in = in_world(registration, stranger.rig.mesh.V);
  const auto frame_of = [](const Points& V) {
    std::vector<float> out;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      out.insert(out.end(), {float(V(i, 0)), float(V(i, 1)), float(V(i, 2)), 1.f});
    return out;
  };
  OwnRigMotion motion{"walk", 30, {}, 0, 0};
  rig.add_frame(frame_of(in), motion);
  EXPECT_LT(motion.max, 1e-4);
  rig.add_frame(frame_of(in.rowwise() + Eigen::RowVector3d(0, 0, 0.5)), motion);
  EXPECT_LT(motion.max, 1e-4);
  const std::string out = rig.with_motions({motion});
  const SourceRig again = read_source_rig(out, "out");
  EXPECT_EQ(again.joints.size(), stranger.rig.joints.size());
  EXPECT_EQ(again.takes[0], "walk");
  EXPECT_LT(largest(again.mesh.V, stranger.rig.mesh.V), 1e-6);
}

// Real rigs, where they are.
std::optional<std::string> shared_rig(const std::string& name) {
  const fs::path file = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "rigs" / name;
  if (!fs::exists(file)) return std::nullopt;
  return read_input_file(file);
}

TEST(RealRigs, AMixamoBodyHasHintsAndAMotion) {
  const auto bytes = shared_rig("sketchfab_basemeshes/free_rigged_male_basemesh.glb");
  if (!bytes) GTEST_SKIP() << "no real rigs beside the source";
  const SourceRig rig = read_source_rig(*bytes, "male");
  EXPECT_EQ(rig.joints.size(), 79u);
  std::map<std::string, Vec3> places;
  for (const Landmark& joint : joint_hints(rig)) places[joint.name] = joint.position;
  for (const char* name : {"pelvis", "head", "shoulder_l", "elbow_r", "wrist_l", "hip_r", "knee_l",
                           "ankle_r", "mcp2_l", "pip2_l"})
    EXPECT_TRUE(places.contains(name)) << name;
  for (const auto& [name, place] : places)  // within the mesh
    EXPECT_TRUE((place.transpose().array() > rig.mesh.V.colwise().minCoeff().array() - 0.2).all() &&
                (place.transpose().array() < rig.mesh.V.colwise().maxCoeff().array() + 0.2).all())
        << name << " " << place.transpose();
  const MotionClip clip = gltf_motion(*bytes, "male");
  EXPECT_GT(clip.frame_count, 10);
  std::vector<Transform> X;
  clip_kinematics(clip, 0, X);
  for (const Transform& x : X) EXPECT_TRUE(x.matrix().allFinite());
  NEED_TEMPLATE();
  RetargetReport report;
  const Motion motion = retarget(clip, tmpl.anatomy.skeleton, {}, report);
  EXPECT_GT(motion.frames.size(), 5u);
}

TEST(RealRigs, AKnightHasPropsAndManyTakes) {
  const auto bytes = shared_rig("kaykit_cc0/Knight.glb");
  if (!bytes) GTEST_SKIP() << "no real rigs beside the source";
  const SourceRig rig = read_source_rig(*bytes, "knight");
  EXPECT_EQ(rig.takes.size(), 76u);
  for (const SourcePiece& piece : rig.pieces) {
    if (piece.name == "1H_Sword") {
      EXPECT_EQ(piece.kind, PartKind::prop);
    }
    if (piece.name == "Knight_Body") {
      EXPECT_EQ(piece.kind, PartKind::body);
    }
  }
  EXPECT_GT(gltf_motion(*bytes, "knight", {.take = "Walking_A"}).frame_count, 5);
  EXPECT_THROW(gltf_motion(*bytes, "knight", {.take = "Dancing"}), UnfitError);
}

}  // namespace
}  // namespace ecorche
