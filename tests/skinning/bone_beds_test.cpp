// Laws of beds of bone: at rest nothing moves; a bone that comes up through a sheet that glides on
// it lifts it, and the sheet beside it along; ends stay; it does so step by step.
#include "skinning/interior/bone_beds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anatomy/muscles/action_line.h"

namespace ecorche {
namespace {

constexpr int kSections = 11;
constexpr int kSheet = 0, kBeside = 1, kBelow = 2;

// A plate of 12 x 12 cm, 4 mm thick, in the plane of x and y, in two layers of points.
TriMesh plate() {
  constexpr int n = 13;
  TriMesh out;
  out.V.resize(2 * n * n, 3);
  std::vector<Eigen::RowVector3i> faces;
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const int v = (layer * n + i) * n + j;
        out.V.row(v) << 0.01 * (i - 6), 0.01 * (j - 6), layer == 0 ? -0.002 : 0.002;
        if (i + 1 == n || j + 1 == n) continue;
        faces.emplace_back(v, v + n, v + n + 1);
        faces.emplace_back(v, v + n + 1, v + 1);
      }
  out.F.resize(Eigen::Index(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) out.F.row(Eigen::Index(f)) = faces[f];
  return out;
}

// From 14 cm beside the plate's middle to its far part, `height` above it, at y.
Strip strip_at(double y, double height) {
  Strip strip;
  strip.path = {{{-0.14, y, height}, {0, -1}, 1},
                {{-0.02, y, height}, {0, -1}, 1, 1},
                {{0.05, y, height}, {1, -1}, 1}};
  strip.reference = Vec3::UnitY();
  for (int k = 0; k < kSections; ++k) {
    Slice slice;
    slice.s = k / (kSections - 1.0);
    slice.radii = {0.012, 0.003};
    strip.slices.push_back(slice);
  }
  return strip;
}

// Two sheets side by side over the plate, a deeper one below, none of which the pose itself moves.
Anatomy sheets() {
  Anatomy out;
  out.skeleton.joints.resize(2);
  out.skeleton.joints[0].name = "chest";
  out.skeleton.joints[1].name = "blade";
  out.skeleton.joints[1].parent = 0;
  out.bones.push_back({"blade_l", Side::left, 1, plate()});
  for (const auto& [name, layer, first, height] :
       {std::tuple("sheet_l", "superficial", -0.02, 0.010),
        {"beside_l", "superficial", 0.02, 0.010},
        {"below_l", "intermediate", 0.02, 0.006}}) {
    Muscle muscle;
    muscle.name = name;
    muscle.layer = layer;
    muscle.sheet = true;
    for (const double y : {first, first + 0.02}) muscle.strips.push_back(strip_at(y, height));
    if (muscle.name != "sheet_l")
      for (Strip& strip : muscle.strips) {
        strip.path[1].placing_joint = -1;
        strip.path[2].joints[0] = 0;
      }
    out.muscles.push_back(muscle);
  }
  return out;
}

// The sheets over the plate turned about y, so that its near edge comes up through them.
std::vector<Ellipse> lifted(const Anatomy& anatomy, double turn) {
  const std::vector<Ellipse> rest = rest_slices(anatomy);
  const BoneBeds beds = make_bone_beds(anatomy, rest);
  Pose pose = rest_pose(anatomy.skeleton);
  pose.rotations[1] = Quat(Eigen::AngleAxisd(turn, Vec3::UnitY()));
  std::vector<Transform> X_WJ;
  forward_kinematics(anatomy.skeleton, pose, X_WJ);
  std::vector<Ellipse> out = rest;
  BoneBedWorkspace workspace;
  lift_over_bones(beds, X_WJ, out, workspace);
  return out;
}

// The height of the plate's upper side at x, turned about y.
double plate_height(double x, double turn) { return (0.002 - std::sin(turn) * x) / std::cos(turn); }

std::vector<Ellipse> of_muscle(const Anatomy& anatomy, int muscle,
                               const std::vector<Ellipse>& slices) {
  std::vector<Ellipse> out;
  for (const SliceRange& strip : slice_ranges(anatomy))
    if (strip.muscle == muscle)
      out.insert(out.end(), slices.begin() + strip.begin, slices.begin() + strip.end);
  return out;
}

TEST(BoneBeds, LeaveTheRestPose) {
  const Anatomy anatomy = sheets();
  const std::vector<Ellipse> rest = rest_slices(anatomy), now = lifted(anatomy, 0);
  for (std::size_t k = 0; k < rest.size(); ++k) {
    EXPECT_EQ(now[k].center, rest[k].center) << k;
    EXPECT_EQ(now[k].axes, rest[k].axes) << k;
  }
}

TEST(BoneBeds, LiftASheetOverABoneThatComesThrough) {
  const Anatomy anatomy = sheets();
  constexpr double kTurn = 0.5;
  const std::vector<Ellipse> rest = of_muscle(anatomy, kSheet, rest_slices(anatomy)),
                             now = of_muscle(anatomy, kSheet, lifted(anatomy, kTurn));
  int through = 0;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    if (k % kSections == 0 || k % kSections == kSections - 1) {
      EXPECT_EQ(now[k].center, rest[k].center) << "an end";
      continue;
    }
    const auto below = [&](const Ellipse& section) {
      return std::abs(section.center.x()) < 0.045 &&
             section.center.z() - section.radii.y() < plate_height(section.center.x(), kTurn);
    };
    through += below(rest[k]);
    EXPECT_FALSE(below(now[k])) << k << ": " << now[k].center.transpose();
    EXPECT_LT((now[k].center - rest[k].center).norm(), 0.05) << k;
  }
  EXPECT_GE(through, 4) << "the plate comes through";
}

TEST(BoneBeds, TakeTheSheetBesideAlongAndNoDeeperOne) {
  const Anatomy anatomy = sheets();
  const auto most = [&](int muscle) {
    const std::vector<Ellipse> rest = of_muscle(anatomy, muscle, rest_slices(anatomy)),
                               now = of_muscle(anatomy, muscle, lifted(anatomy, 0.5));
    double out = 0;
    for (std::size_t k = 0; k < rest.size(); ++k)
      out = std::max(out, (now[k].center - rest[k].center).norm());
    return out;
  };
  EXPECT_GT(most(kBeside), 0.25 * most(kSheet));
  EXPECT_LT(most(kBeside), most(kSheet));
  EXPECT_EQ(most(kBelow), 0);
}

TEST(BoneBeds, RiseStepByStep) {
  const Anatomy anatomy = sheets();
  constexpr double kStep = 0.01;  // rad: the plate's edge moves by 0.6 mm
  std::vector<Ellipse> before = lifted(anatomy, 0);
  for (double turn = kStep; turn < 0.9; turn += kStep) {
    const std::vector<Ellipse> now = lifted(anatomy, turn);
    for (std::size_t k = 0; k < now.size(); ++k)
      EXPECT_LT((now[k].center - before[k].center).norm(), 3.5e-3) << turn << ' ' << k;
    before = now;
  }
}

// Bones that are not flat, as a rib cage, are no bed.
TEST(BoneBeds, AreFlatBones) {
  Anatomy anatomy = sheets();
  Points& points = anatomy.bones[0].mesh.V;
  points.col(2) *= 40;
  EXPECT_TRUE(make_bone_beds(anatomy, rest_slices(anatomy)).sheets.empty());
  anatomy.bones.clear();
  EXPECT_TRUE(make_bone_beds(anatomy, rest_slices(anatomy)).sheets.empty());
}

}  // namespace
}  // namespace ecorche
