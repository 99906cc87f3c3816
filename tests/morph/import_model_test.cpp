// Other people's models as templates, and ours as models of other programs: what goes out comes
// back.
#include "morph/template/import_model.h"
#include "anatomy/model_files/mjcf_reader.h"
#include "anatomy/model_files/mjcf_writer.h"
#include "anatomy/model_files/model_reader.h"
#include "anatomy/model_files/osim_writer.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <filesystem>
#include <map>

#include "anatomy/errors.h"
#include "anatomy/model_files/model_export.h"
#include "anatomy/model_files/model_xml.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/morph/built_template.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("ecorche_import_test_" + std::to_string(getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

MusculoskeletalModel written_and_read(const ExportModel& model, const fs::path& folder,
                                      const std::string& kind) {
  const fs::path file = folder / ("model" + kind);
  if (kind == ".osim")
    write_osim(file, model);
  else
    write_mjcf(file, model);
  return read_muscle_model(file);
}

class RoundTrip : public ::testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, KeepsNamesPathsAndForces) {
  NEED_TEMPLATE();
  Folder folder;
  ExportModel out = make_export_model(tmpl.anatomy, tmpl.body, test_assets().tables);
  out.meshes.clear();
  const MusculoskeletalModel model = written_and_read(out, folder.path, GetParam());
  ASSERT_EQ(model.bodies.size(), tmpl.anatomy.skeleton.joints.size());
  ASSERT_EQ(model.muscles.size(), out.strips.size());
  size_t at = 0;
  double worst = 0;
  for (const Muscle& muscle : tmpl.anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      const ModelMuscle& back = model.muscles[at];
      const ExportStrip& sent = out.strips[at++];
      EXPECT_EQ(back.name, sent.name);
      EXPECT_TRUE(back.name.starts_with(muscle.name)) << back.name;
      EXPECT_NEAR(back.max_force, sent.max_force, 1e-9 * sent.max_force) << back.name;
      EXPECT_NEAR(back.fibre_length, sent.fibre_length, 1e-9) << back.name;
      EXPECT_NEAR(back.tendon_slack, sent.tendon_slack, 1e-9) << back.name;
      EXPECT_NEAR(back.pennation, sent.pennation, 1e-12) << back.name;
      ASSERT_EQ(back.points.size(), strip.path.size()) << back.name;
      for (size_t k = 0; k < strip.path.size(); ++k) {
        const ModelPoint& p = back.points[k];
        worst = std::max(worst, (model.bodies[p.body].X_WB[kDefaultPose] * p.place[kDefaultPose] -
                                 strip.path[k].rest)
                                    .norm());
      }
    }
  EXPECT_LT(worst, 1e-6);
}

TEST_P(RoundTrip, ComesBackAsTheSameTemplate) {
  NEED_TEMPLATE();
  Folder folder;
  ExportModel out = make_export_model(tmpl.anatomy, tmpl.body, test_assets().tables);
  out.meshes.clear();
  const Imported in =
      import_model(written_and_read(out, folder.path, GetParam()), tmpl, test_assets());
  EXPECT_TRUE(in.report.match.same);
  EXPECT_FALSE(in.report.upright);
  ASSERT_EQ(in.anatomy.muscles.size(), tmpl.anatomy.muscles.size());
  double worst = 0;
  for (size_t m = 0; m < in.anatomy.muscles.size(); ++m) {
    const Muscle &a = tmpl.anatomy.muscles[m], &b = in.anatomy.muscles[m];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.side, b.side) << a.name;
    ASSERT_EQ(a.strips.size(), b.strips.size()) << a.name;
    for (size_t s = 0; s < a.strips.size(); ++s) {
      worst =
          std::max(worst, (a.strips[s].path.front().rest - b.strips[s].path.front().rest).norm());
      worst = std::max(worst, (a.strips[s].path.back().rest - b.strips[s].path.back().rest).norm());
    }
  }
  EXPECT_LT(worst, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, ::testing::Values(".osim", ".xml"),
                         [](const auto& format) {
                           return format.param[1] == 'o' ? "OpenSim" : "Mujoco";
                         });

TEST(Export, MassesAddUpAndInertiasArePossible) {
  NEED_TEMPLATE();
  const ExportModel model = make_export_model(tmpl.anatomy, tmpl.body, test_assets().tables);
  double mass = 0;
  for (const ExportBody& body : model.bodies) {
    EXPECT_GT(body.mass, 0) << body.name;
    mass += body.mass;
    const Vec3 I = Eigen::SelfAdjointEigenSolver<Mat3>(body.inertia).eigenvalues();
    EXPECT_GT(I[0], 0) << body.name;
    EXPECT_LE(I[2], I[0] + I[1] + 1e-12) << body.name;
  }
  EXPECT_NEAR(mass, tmpl.body.mass, 1e-6 * mass);
}

// A chain of turns about the exported axes is the joint's own turn by its anatomical angles.
TEST(Export, AnglesAreAnatomicalAngles) {
  NEED_TEMPLATE();
  const ExportModel model = make_export_model(tmpl.anatomy, tmpl.body, test_assets().tables);
  const auto turns = [](const Vec3& v) {
    return (Eigen::AngleAxisd(v.x(), Vec3::UnitX()) * Eigen::AngleAxisd(v.y(), Vec3::UnitY()) *
            Eigen::AngleAxisd(v.z(), Vec3::UnitZ()))
        .toRotationMatrix();
  };
  for (size_t j = 1; j < tmpl.anatomy.skeleton.joints.size(); ++j) {
    const Joint& joint = tmpl.anatomy.skeleton.joints[j];
    Vec3 angles = joint.zero;
    Mat3 chain = Mat3::Identity();
    for (const ExportAngle& a : model.angles) {
      if (a.body != int(j)) continue;
      const int i = a.name.ends_with("_flexion") ? 0 : a.name.ends_with("_abduction") ? 1 : 2;
      angles[i] += 0.1 * (i + 1);
      chain = chain * Eigen::AngleAxisd(0.1 * (i + 1), a.axis).toRotationMatrix();
    }
    const Mat3 wanted =
        joint.axes * turns(angles) * turns(joint.zero).transpose() * joint.axes.transpose();
    EXPECT_LT((chain - wanted).norm(), 1e-9) << joint.name;
  }
}

TEST(Import, TheWholeBodyOfThePackage) {
  NEED_TEMPLATE();
  const PackageArchive archive(test_assets().packages, "musclemimic-models");
  const MusculoskeletalModel model = parse_mjcf_model(
      {[&](const std::string& path) { return archive.read("musclemimic_models/model/" + path); }},
      "body/myofullbody.xml");
  ASSERT_EQ(model.muscles.size(), 416u);
  const Imported in = import_model(model, tmpl, test_assets());
  EXPECT_TRUE(in.report.match.same);  // our bones are the package's
  EXPECT_TRUE(in.report.upright);
  EXPECT_EQ(in.anatomy.muscles.size(), 416u);
  EXPECT_LT(in.report.attachment_median, 5e-3);
  const int soleus = find_muscle(in.anatomy, "soleus_r");
  ASSERT_GE(soleus, 0);
  EXPECT_EQ(in.anatomy.muscles[soleus].insertion_bone, "calcaneus_r");
}

TEST(Import, OpenSimModelsFitTheDefaultBody) {
  NEED_TEMPLATE();
  const fs::path folder = fs::path(ECORCHE_SHARED_DIR) / "testdata/osim";
  if (!fs::exists(folder)) GTEST_SKIP() << "no ../shared";
  for (const char* file :
       {"opensim_core/subject_walk_scaled.osim", "opensim_core/ThoracoscapularShoulderModel.osim",
        "biobuddy/MOBL_ARMS_41.osim", "biobuddy/Wu_Shoulder_Model_via_points.osim"}) {
    const MusculoskeletalModel model = read_muscle_model(folder / file);
    const Imported in = import_model(model, tmpl, test_assets());
    EXPECT_EQ(in.anatomy.muscles.size(), model.muscles.size()) << file;
    EXPECT_LT(in.report.match.center_error, 0.02) << file;
    EXPECT_LT(in.report.attachment_median, 0.015) << file;
    EXPECT_TRUE(in.report.match.unknown.empty()) << file << " " << in.report.match.unknown[0];
    for (const Muscle& muscle : in.anatomy.muscles)
      EXPECT_NEAR(rest_volume(muscle), muscle.volume, 1e-3 * muscle.volume) << muscle.name;
  }
}

TEST(Import, OneSideIsMirroredOnDemand) {
  NEED_TEMPLATE();
  const fs::path file = fs::path(ECORCHE_SHARED_DIR) / "testdata/osim/biobuddy/MOBL_ARMS_41.osim";
  if (!fs::exists(file)) GTEST_SKIP() << "no ../shared";
  ImportOptions options;
  options.mirror = true;
  const Imported in = import_model(read_muscle_model(file), tmpl, test_assets(), options);
  EXPECT_EQ(in.anatomy.muscles.size(), 100u);
  const int l = find_muscle(in.anatomy, "TRIlong_l"), r = find_muscle(in.anatomy, "TRIlong_r");
  ASSERT_TRUE(l >= 0 && r >= 0);
  const Vec3 left = in.anatomy.muscles[l].strips[0].path[0].rest,
             right = in.anatomy.muscles[r].strips[0].path[0].rest;
  EXPECT_LT((left - Vec3(-right.x(), right.y(), right.z())).norm(), 1e-9);
}

TEST(Import, AModelOfSomethingElseIsRefused) {
  NEED_TEMPLATE();
  MusculoskeletalModel model;
  model.file = "table.osim";
  model.bodies.resize(3);
  model.bodies[0].name = "leg_of_the_table";
  try {
    import_model(model, tmpl, test_assets());
    FAIL();
  } catch (const UnfitError& e) {
    EXPECT_NE(std::string(e.what()).find("model_bodies.csv"), std::string::npos);
  }
}

TEST(SideNames, AreFoundInFrontAndBehind) {
  EXPECT_EQ(split_model_side("femur_r"), std::make_pair(std::string("femur"), Side::right));
  EXPECT_EQ(split_model_side("Left-Thigh"), std::make_pair(std::string("thigh"), Side::left));
  EXPECT_EQ(split_model_side("R_Femur"), std::make_pair(std::string("femur"), Side::right));
  EXPECT_EQ(split_model_side("skull"), std::make_pair(std::string("skull"), Side::middle));
}

}  // namespace
}  // namespace ecorche
