// Laws of the muscle table: both sides, mirrored, with the volumes it states, hanging on bones; and
// bad lines get exact errors.
#include "anatomy/authoring/muscle_table.h"
#include "anatomy/authoring/muscle_checks.h"
#include "anatomy/authoring/muscle_placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

constexpr double kMidPlane = -0.0251;

const MuscleTable& real_table() {
  static const MuscleTable table = read_muscle_table(test_assets().tables);
  return table;
}

// A skeleton that has every bone and joint the table names, each bone on a joint of its own and
// without a mesh.
Anatomy named_skeleton(const MuscleTable& table) {
  static const std::regex paired_by_name("rib.*");
  static const std::set<std::string> middle = {"skull", "mandible", "sacrum", "sternum"};
  Anatomy anatomy;
  const auto add = [&](const std::string& joint, const std::string& bone) {
    if (find_joint(anatomy.skeleton, joint) >= 0) return;
    Joint entry;
    entry.name = joint;
    entry.parent = anatomy.skeleton.joints.empty() ? -1 : 0;
    anatomy.skeleton.joints.push_back(entry);
    if (!bone.empty())
      anatomy.bones.push_back({bone, Side::middle, int(anatomy.skeleton.joints.size()) - 1, {}});
  };
  for (const SourceLandmark& landmark : table.landmarks) {
    const std::string& name = landmark.carrier;
    bool soft = false;
    for (const JointBlend& carrier : table.carriers) soft |= carrier.name == name;
    if (soft) continue;
    if (middle.contains(name) || std::regex_match(name, std::regex("[ctl][0-9]+"))) {
      add("joint of " + name, name);
    } else {
      for (const char* side : {"_l", "_r"}) add("joint of " + name + side, name + side);
    }
  }
  for (const JointBlend& carrier : table.carriers)
    for (const std::string& joint : carrier.joints) add(joint, "");
  return anatomy;
}

const Anatomy& placed() {
  static const Anatomy anatomy = [] {
    Anatomy a = named_skeleton(real_table());
    a.muscles = place_muscles(real_table(), a);
    return a;
  }();
  return anatomy;
}

TEST(MuscleTable, HasFourHundredMusclesOfSevenHundredLines) {
  int lines = 0;
  for (const Muscle& muscle : placed().muscles) lines += muscle.strips.size();
  EXPECT_GE(placed().muscles.size(), 400u);
  EXPECT_GE(lines, 700);
  EXPECT_NO_THROW(validate(placed()));
}

TEST(MuscleTable, TenseThicknessIsGivenWhereItWasMeasured) {
  const auto of = [](const char* name) {
    return placed().muscles.at(find_muscle(placed(), name)).tense_thickness;
  };
  EXPECT_NEAR(of("soleus_r"), 1.3, 1e-12);
  EXPECT_NEAR(of("gastrocnemius_medial_l"), 1, 1e-12);
  EXPECT_EQ(of("sartorius_l"), 0);
}

TEST(MuscleTable, EveryStripHasSlicesEnoughAndABelly) {
  for (const Muscle& muscle : placed().muscles) {
    for (const Strip& strip : muscle.strips) {
      // twelve, short ones one every 2.5 mm, six at least
      EXPECT_GE(double(strip.slices.size()),
                std::clamp(std::floor(strip.rest_length / 2.5e-3), 6.0, 12.0))
          << muscle.name;
      EXPECT_LE(strip.slices.size(), 24 + 3 * strip.intersections.size()) << muscle.name;
      EXPECT_LT(strip.belly_begin, strip.belly_end) << muscle.name;
      EXPECT_NEAR(strip.rest_length, line_length(strip.path), 1e-9) << muscle.name;
      EXPECT_EQ(strip.slices.front().s, 0) << muscle.name;
      EXPECT_EQ(strip.slices.back().s, 1) << muscle.name;
    }
  }
}

TEST(MuscleTable, RectusIsOneMuscleWithThreeIntersections) {
  for (const char* name : {"rectus_abdominis_l", "rectus_abdominis_r"}) {
    const Muscle& rectus = placed().muscles.at(find_muscle(placed(), name));
    ASSERT_EQ(rectus.strips.size(), 1u);
    const Strip& strip = rectus.strips[0];
    ASSERT_EQ(strip.intersections.size(), 3u);
    for (const double place : strip.intersections) {
      EXPECT_EQ(flesh_weight(strip, place), 0);
      EXPECT_EQ(belly_weight(strip, place), 1);
      EXPECT_GT(flesh_weight(strip, place + 1.1 * kIntersection), 0.99);
      // sections lie on it, so that it is drawn
      EXPECT_TRUE(std::any_of(strip.slices.begin(), strip.slices.end(), [&](const Slice& slice) {
        return std::abs(slice.s - place) < 1e-9;
      }));
    }
  }
}

// Frustums of elliptic sections, summed here without the library's own volume.
TEST(MuscleTable, TubesHoldTheVolumesOfTheTable) {
  const auto& muscles = placed().muscles;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    double volume = 0;
    for (const Strip& strip : muscles[m].strips) {
      const std::vector<Ellipse> slices = rest_slices(strip);
      for (std::size_t k = 0; k + 1 < slices.size(); ++k) {
        const double area = (slices[k].radii.prod() + slices[k + 1].radii.prod()) / 2 +
                            (slices[k].radii.x() - slices[k + 1].radii.x()) *
                                (slices[k + 1].radii.y() - slices[k].radii.y()) / 6;
        volume += std::numbers::pi * area * (slices[k + 1].center - slices[k].center).norm();
      }
    }
    const double stated = real_table().muscles[m / 2].volume_male;
    EXPECT_EQ(muscles[m].volume, stated) << muscles[m].name;
    EXPECT_NEAR(rest_volume(muscles[m]) / stated, 1, 1e-9) << muscles[m].name;
    EXPECT_NEAR(volume / stated, 1, 0.06)
        << muscles[m].name;  // bends and twists cost straight frustums a few per cent
  }
}

TEST(MuscleTable, FemaleVolumesAreTheTablesToo) {
  const std::vector<Muscle> female =
      place_muscles(real_table(), named_skeleton(real_table()), {.sex = Sex::female});
  for (std::size_t m = 0; m < female.size(); ++m)
    EXPECT_NEAR(rest_volume(female[m]) / real_table().muscles[m / 2].volume_female, 1, 1e-9)
        << female[m].name;
}

TEST(MuscleTable, RightIsTheMirrorOfLeft) {
  const auto& muscles = placed().muscles;
  for (std::size_t m = 0; m + 1 < muscles.size(); m += 2) {
    const Muscle &left = muscles[m], &right = muscles[m + 1];
    ASSERT_EQ(left.name, real_table().muscles[m / 2].name + "_l");
    ASSERT_EQ(right.name, real_table().muscles[m / 2].name + "_r");
    for (std::size_t i = 0; i < left.strips.size(); ++i) {
      const std::vector<Ellipse> a = rest_slices(left.strips[i]), b = rest_slices(right.strips[i]);
      ASSERT_EQ(a.size(), b.size()) << left.name;
      for (std::size_t k = 0; k < a.size(); ++k) {
        const Vec3 mirrored(2 * kMidPlane - b[k].center.x(), b[k].center.y(), b[k].center.z());
        EXPECT_LT((a[k].center - mirrored).norm(), 1e-6) << left.name;
        const Vec3 width(-b[k].axes(0, 0), b[k].axes(1, 0), b[k].axes(2, 0));
        EXPECT_GT(std::abs(width.dot(a[k].axes.col(0))), 1 - 1e-6) << left.name;
        EXPECT_LT((a[k].radii - b[k].radii).norm(), 1e-6) << left.name;
      }
    }
  }
}

TEST(MuscleTable, PathsFollowTheirLandmarks) {
  MuscleTable moved = real_table();
  const Vec3 shift(0.01, -0.02, 0.03);
  for (SourceLandmark& landmark : moved.landmarks)
    if (landmark.carrier == "femur") landmark.position += shift;
  const std::vector<Muscle> muscles = place_muscles(moved, named_skeleton(moved));
  int on_femur = 0;
  for (std::size_t m = 0; m < muscles.size(); m += 2) {
    for (std::size_t i = 0; i < muscles[m].strips.size(); ++i) {
      const auto& before = placed().muscles[m].strips[i].path;
      const auto& after = muscles[m].strips[i].path;
      for (std::size_t k = 0; k < before.size(); ++k) {
        const int landmark = real_table().muscles[m / 2].strips[i].path[k].landmark;
        const bool femur = real_table().landmarks[landmark].carrier == "femur";
        on_femur += femur;
        EXPECT_LT((after[k].rest - before[k].rest - (femur ? shift : Vec3::Zero())).norm(), 1e-12)
            << muscles[m].name;
      }
    }
  }
  EXPECT_GT(on_femur, 100);
}

TEST(MuscleTable, BellyWallFollowsThoraxAboveAndPelvisBelow) {
  const Anatomy& anatomy = placed();
  const int thorax = find_joint(anatomy.skeleton, "thorax"),
            pelvis = find_joint(anatomy.skeleton, "pelvis");
  int blended = 0;
  for (const Muscle& muscle : anatomy.muscles) {
    for (const Strip& strip : muscle.strips) {
      for (const PathPoint& point : strip.path) {
        if (point.joints[0] != thorax || point.joints[1] != pelvis) continue;
        ++blended;
        EXPECT_NEAR(point.share, (point.rest.y() - 1.04) / 0.24, 1e-9) << muscle.name;
      }
    }
  }
  EXPECT_GT(blended, 50);
}

// ---- on the real bones ----------------------------------------------------------------

bool have_bones() {
  try {
    PackageArchive(test_assets().packages, "musclemimic-models");
    return true;
  } catch (const Error&) {
    return false;
  }
}

const Anatomy& on_bones() {
  static const Anatomy anatomy = [] {
    Anatomy a = read_source_skeleton(test_assets());
    a.muscles = place_muscles(real_table(), a);
    return a;
  }();
  return anatomy;
}

TEST(MusclesOnBones, EndsLieOnTheBonesTheyName) {
  if (!have_bones()) GTEST_SKIP() << "the bone package is not installed";
  const std::vector<Attachment> ends = measure_attachments(real_table(), on_bones());
  EXPECT_GT(ends.size(), 1400u);
  for (const Attachment& end : ends) {
    // The nearest vertex is never nearer than the surface.
    const TriMesh& mesh = on_bones().bones[find_bone(on_bones(), end.bone)].mesh;
    const auto& path = on_bones().muscles[end.muscle].strips[end.strip].path;
    const Vec3 p = end.origin ? path.front().rest : path.back().rest;
    const double vertex = (mesh.V.rowwise() - p.transpose()).rowwise().norm().minCoeff();
    EXPECT_LE(end.distance, vertex + 1e-12);
    EXPECT_LE(end.distance, 0.010) << on_bones().muscles[end.muscle].name << " on " << end.bone;
  }
}

TEST(MusclesOnBones, FewEndsLieOnFascia) {
  int soft = 0, all = 0;
  for (const TableMuscle& muscle : real_table().muscles) {
    if (muscle.layer == "subcutaneous") continue;  // they end in the skin
    for (const TableStrip& strip : muscle.strips) {
      for (const TablePoint* end : {&strip.path.front(), &strip.path.back()}) {
        const std::string& carrier = real_table().landmarks[end->landmark].carrier;
        for (const JointBlend& c : real_table().carriers) soft += c.name == carrier;
        ++all;
      }
    }
  }
  EXPECT_LE(soft, all / 10);
}

TEST(MusclesOnBones, RunWhereTheMjcfRunsThemInLegAndBack) {
  if (!have_bones()) GTEST_SKIP() << "the bone package is not installed";
  const auto compared =
      compare_paths(real_table(), on_bones(), read_tendon_paths(test_assets(), on_bones()));
  EXPECT_GE(compared.size(), 45u);
  std::vector<double> means;
  for (const PathComparison& c : compared) {
    const Muscle& muscle = on_bones().muscles[c.muscle];
    EXPECT_LE(c.mean, c.worst) << muscle.name;
    // The MJCF's belly wall is one chord a muscle, to a point in the air.
    if (muscle.group == "trunk_abdomen") continue;
    // Our vasti end on the patella, the MJCF's on the tibia; the ligament between is some 90 mm.
    EXPECT_LE(c.mean, muscle.name.starts_with("vastus") ? 0.045 : 0.030) << muscle.name;
    means.push_back(c.mean);
  }
  std::sort(means.begin(), means.end());
  EXPECT_LE(means[means.size() / 2], 0.015);
}

// ---- bad lines ------------------------------------------------------------------------

constexpr const char* kLandmarks =
    "id,bone,left_mm,up_mm,front_mm,rule\n"
    "high,femur,80,900,0,top\n"
    "low,femur,80,500,0,bottom\n"
    "shin,tibia,80,480,0,top\n";

constexpr const char* kHeadMuscleTable =
    "wrap knob sphere at low 0 0 0 radius 12\n"
    "muscle one\n"
    "  label one\n  group thigh\n  layer deep\n  from femur: top\n  to tibia: top\n"
    "  volume 100 70\n  fibre 10\n  pennation 5\n  tendon 0.2\n";

constexpr const char* kSections = "    section 0 10 10  0 0 1\n    section 1 10 10  0 0 1\n";

constexpr const char* kGliding =
    "carrier bed between hip knee share 0.5\n"
    "muscle two\n"
    "  label two\n  group thigh\n  layer deep\n  from femur: top\n  to tibia: top\n"
    "  volume 100 70\n  fibre 10\n  pennation 5\n  tendon 0.2\n"
    "  strip\n    origin high\n    via low 1 2 3 with bed\n    insertion shin\n";

MuscleTable read_text(const std::string& text) {
  MuscleTable table;
  read_landmark_text(kLandmarks, "marks.csv", table);
  read_muscle_text(text, "bad.txt", table);
  return table;
}

TEST(MuscleText, ReadsItsOwnFormat) {
  const MuscleTable table = read_text(
      std::string(kHeadMuscleTable) +
      "  tense 1.4\n  strip  # remark\n    origin high\n    via low 1 2 3  # beside\n    insertion "
      "shin\n    over knob 8\n    belly 0.1 0.9\n    intersection 0.3\n    "
      "intersection 0.6\n    raphe 0.1\n" +
      kSections);
  ASSERT_EQ(table.muscles.size(), 1u);
  const TableStrip& strip = table.muscles[0].strips.at(0);
  EXPECT_NEAR(position(table, strip.path[1]).x(), 0.081 + kMidPlane, 1e-12);
  EXPECT_NEAR(position(table, strip.path[1]).y(), 0.502, 1e-12);
  EXPECT_EQ(strip.wraps.at(0).radius, 0.008);
  EXPECT_EQ(strip.intersections, (std::vector<double>{0.3, 0.6}));
  EXPECT_EQ(strip.raphe, 0.1);
  EXPECT_EQ(strip.sections.at(0).radii.x(), 0.005);
  EXPECT_EQ(table.muscles[0].tense_thickness, 1.4);
}

TEST(MuscleText, AViaPointMayGlideOnItsBone) {
  const MuscleTable table = read_text(std::string(kGliding) + kSections);
  const Anatomy anatomy = named_skeleton(table);
  for (const Muscle& muscle : place_muscles(table, anatomy)) {
    const char* side = side_suffix(muscle.side);
    const PathPoint& via = muscle.strips[0].path[1];
    EXPECT_EQ(via.joints, (std::array{find_joint(anatomy.skeleton, "hip"),
                                      find_joint(anatomy.skeleton, "knee")}));
    EXPECT_EQ(via.share, 0.5);
    const int femur = find_bone(anatomy, std::string("femur") + side);
    EXPECT_EQ(via.placing_joint, anatomy.bones[femur].joint);
    EXPECT_EQ(muscle.strips[0].path[0].placing_joint, -1);
    // Another body places it as it places its bone.
    const Vec3 moved = carry_point(via.rest, via, [&](const Vec3& p, int j) -> Vec3 {
      return p + (j == via.placing_joint ? Vec3(0, 1, 0) : Vec3(9, 9, 9));
    });
    EXPECT_EQ(moved, via.rest + Vec3(0, 1, 0));
  }
}

struct BadText {
  std::string body;     // what follows kHead
  std::string message;  // what the error must contain
};

class BadMuscleText : public ::testing::TestWithParam<BadText> {};

TEST_P(BadMuscleText, IsRefusedWithFileLineMuscleAndValue) {
  try {
    read_text(kHeadMuscleTable + GetParam().body);
    FAIL() << "accepted:\n" << GetParam().body;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
        << error.what();
  }
}

const std::string kGood = std::string("  strip\n    origin high\n    insertion shin\n") + kSections;

INSTANTIATE_TEST_SUITE_P(
    Corpus, BadMuscleText,
    ::testing::Values(
        BadText{"  strip\n    origin high\n" + std::string(kSections),
                "one: a strip with 1 path point"},
        BadText{"  strip\n    origin high\n    insertion shinn\n" + std::string(kSections),
                "bad.txt:14: one: unknown landmark 'shinn'"},
        BadText{
            "  strip\n    origin high\n    via low\n    insertion high\n" + std::string(kSections),
            "the origin is the insertion"},
        BadText{"  strip\n    origin high\n    insertion high\n" + std::string(kSections),
                "bad.txt:14: one: the insertion lies on the point before it"},
        BadText{"  strip\n    origin high\n    insertion shin\n    belly 0.2 0.8\n    intersection "
                "0.1\n" +
                    std::string(kSections) + "muscle two\n",
                "intersection at 0.1: it lies within the belly"},
        BadText{"  strip\n    origin high\n    intersection 0.5\n    intersection 0.4\n",
                "bad.txt:15: one: intersection at 0.4: they rise along the strip"},
        BadText{"  strip\n    origin high\n    raphe 0.7\n",
                "bad.txt:14: one: width of the raphe: 0.7 is not within 0 .. 0.5"},
        BadText{"  strip\n    origin high nan 0 0\n",
                "bad.txt:13: one: offset: 'nan' is not a finite number"},
        BadText{"  strip\n    origin high 1 2\n", "bad.txt:13: one: offset is missing"},
        BadText{"  strip\n    origin high 1 2 inf\n", "'inf' is not a finite number"},
        BadText{"  strip\n    origin high 1 2 3 4\n", "unexpected '4'"},
        BadText{"  strip\n    origin high 9999 0 0\n", "offset: 9999 is not within"},
        BadText{"  strip\n    via high\n", "the path must begin with an origin"},
        BadText{"  strip\n    origin high\n    origin low\n", "a path has one origin"},
        BadText{"  strip\n    origin high\n    insertion shin\n    via low\n",
                "a point after the insertion"},
        BadText{"  strip\n    origin high\n    insertion shin\n    over elbow\n",
                "bad.txt:15: one: unknown wrap 'elbow'"},
        BadText{"  strip\n    origin high\n    insertion shin\n    over knob -3\n",
                "'-3' is not a radius"},
        BadText{"  strip\n    origin high\n    insertion shin\n    belly 0.8 0.2\n",
                "the belly ends before it begins"},
        BadText{"  strip\n    origin high\n    insertion shin\n    section 0.5 1 1 1 0 0\n",
                "section at 0.5: sections rise from 0 to 1"},
        BadText{"  strip\n    origin high\n    insertion shin\n    section 0 1 0 1 0 0\n",
                "thickness in mm: 0 is not within"},
        BadText{"  strip\n    origin high\n    insertion shin\n    section 0 1 1 0 0 0\n",
                "the width direction has no length"},
        BadText{"  strip\n    origin high\n    insertion shin\n    section 0 1 1 1 0 0\n",
                "one: a strip needs sections from 0 to 1"},
        BadText{"  volume -1 3\n", "male volume in ml: -1 is not within"},
        BadText{"  volume 1e999 3\n", "'1e999' is not a finite number"},
        BadText{"  compare\n", "'compare' needs names"},
        BadText{"  tense 0\n", "thickness at full effort over the relaxed: 0 is not within"},
        BadText{"  colour red\n", "bad.txt:12: one: unknown keyword 'colour'"},
        BadText{"", "one: no strip"},
        BadText{kGood + "muscle one\n" + kGood, "bad.txt:17: one: the muscle is given twice"},
        BadText{kGood + "muscle two\n" + kGood, "two: no volume"},
        BadText{kGood + "wrap knob sphere at low 0 0 0 radius 12\n", "wrap 'knob' is given twice"},
        BadText{"  strip\n    origin high\n    via low with moon\n    insertion shin\n" +
                    std::string(kSections),
                "unknown carrier 'moon'; carriers.txt lists them"},
        BadText{"wrap \n", "one: no strip"}));

TEST(BadMuscleTable, OutsideAMuscle) {
  EXPECT_THROW(read_text("strip\n"), InputError);
  EXPECT_THROW(read_text("wrap a sphere at low 0 0 0 radius 0\n"), InputError);
  EXPECT_THROW(read_text("wrap a cone at low 0 0 0 radius 3\n"), InputError);
  EXPECT_THROW(read_text("wrap a cylinder at low 0 0 0 radius 3 half 4 axis 0 0 0\n"), InputError);
  EXPECT_THROW(read_text("carrier wall between thorax pelvis heights 1 2\n"), InputError);
  EXPECT_THROW(read_text("carrier wall between thorax pelvis share 1.5\n"), InputError);
}

TEST(BadMuscleTable, LandmarksGivenTwiceOrWithoutNumbers) {
  MuscleTable table;
  EXPECT_THROW(
      read_landmark_text("id,bone,left_mm,up_mm,front_mm,rule\na,femur,1,2,3,x\na,femur,1,2,3,x\n",
                         "m.csv", table),
      InputError);
  EXPECT_THROW(read_landmark_text("id,bone,left_mm,up_mm,front_mm,rule\nb,femur,nan,2,3,x\n",
                                  "m.csv", table),
               InputError);
  EXPECT_THROW(
      read_landmark_text("id,bone,left_mm,up_mm,front_mm\nc,femur,1,2,3\n", "m.csv", table),
      InputError);
}

TEST(BadMuscleTable, BoneThatTheSkeletonDoesNotHave) {
  const MuscleTable table = read_text(kHeadMuscleTable + kGood);
  Anatomy anatomy = named_skeleton(table);
  std::erase_if(anatomy.bones, [](const Bone& bone) { return bone.name.starts_with("tibia"); });
  try {
    place_muscles(table, anatomy);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "marks.csv:4: no bone or carrier 'tibia' in the skeleton");
  }
}

}  // namespace
}  // namespace ecorche
