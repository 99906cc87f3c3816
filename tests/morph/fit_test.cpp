// Laws of fitting: the template in its own body is the template; bones stay inside every skin, as
// deep as they should be, together at their joints, and even on both sides.
#include "anatomy/base_mesh/body_rig.h"
#include "morph/fit/fit_anatomy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/joint_angles.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/queries/mouth_line.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fat/body_composition.h"
#include "morph/shapes/shape_space.h"
#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/standard_bodies.h"
#include "morph/template/template_cache.h"
#include "tests/some_of.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

struct Given {
  Template body_template;
  BodyPackage package;
};

const Given* given() {
  static const std::shared_ptr<const Given> loaded = []() -> std::shared_ptr<const Given> {
    try {
      return std::make_shared<Given>(
          Given{read_template(test_assets()), read_body_package(test_assets())});
    } catch (const InputError&) {
      return nullptr;
    }
  }();
  return loaded.get();
}

#define NEED_PACKAGES()                                                   \
  if (!given()) GTEST_SKIP() << "the data packages are not there (make)"; \
  const Template& own = given()->body_template;                           \
  const BodyPackage& package = given()->package;                          \
  (void)package

double largest_move(const Anatomy& a, const Anatomy& b, const Vec3& shift) {
  double worst = 0;
  for (size_t k = 0; k < a.bones.size(); ++k)
    worst = std::max(worst, ((a.bones[k].mesh.V.rowwise() + shift.transpose()) - b.bones[k].mesh.V)
                                .rowwise()
                                .norm()
                                .maxCoeff());
  return worst;
}

double nearest_vertices(const Anatomy& anatomy, const char* a, const char* b) {
  const Points& A = anatomy.bones[find_bone(anatomy, a)].mesh.V;
  const Points& B = anatomy.bones[find_bone(anatomy, b)].mesh.V;
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    best = std::min(best, (B.rowwise() - A.row(i)).rowwise().norm().minCoeff());
  return best;
}

int outside(const Anatomy& anatomy, const SkinField& skin) {
  int count = 0;
  for (const Bone& bone : anatomy.bones)
    for (Eigen::Index i = 0; i < bone.mesh.V.rows(); i += 17)
      count += skin.winding_number(bone.mesh.V.row(i)) < 0.5;
  return count;
}

TEST(Fit, TheTemplateInItsOwnBodyIsTheTemplate) {
  NEED_PACKAGES();
  const Fit fit = fit_anatomy(own, own.body);
  EXPECT_LT(largest_move(own.anatomy, fit.anatomy, Vec3::Zero()), 1e-9);
  const auto before = rest_positions(own.anatomy.skeleton),
             after = rest_positions(fit.anatomy.skeleton);
  for (size_t j = 0; j < before.size(); ++j) {
    EXPECT_LT((before[j] - after[j]).norm(), 1e-9) << own.anatomy.skeleton.joints[j].name;
    EXPECT_LT((own.anatomy.skeleton.joints[j].zero - fit.anatomy.skeleton.joints[j].zero).norm(),
              1e-9);
  }
}

// Muscles carried into a body and grown to its skin.
Anatomy grown(const Template& own, const BodyPackage& package, const Body& body,
              DilateReport* report = nullptr) {
  const Fit fit = fit_anatomy(own, body);
  Anatomy anatomy = fit.anatomy;
  DilateOptions options;
  options.even_about = fit.report.even_about;
  const SkinRays rays(capped_skin(package, body.skin.V));
  const FatLayer fat = make_fat_layer(own.tables.fat, rays, anatomy, body);
  const DilateReport found =
      dilate_muscles(anatomy, anatomy.muscles, own.tables.muscles, rays, fat, options);
  if (report) *report = found;
  return anatomy;
}

// How far two sets of sections lie apart: centres and half axes, m.
double largest_change(const std::vector<Ellipse>& a, const std::vector<Ellipse>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (size_t k = 0; k < a.size(); ++k)
    worst = std::max({worst, (a[k].center - b[k].center).norm(), (a[k].radii - b[k].radii).norm()});
  return worst;
}

TEST(Fit, TheTemplatesMusclesInItsOwnBodyAreTheTemplates) {
  NEED_PACKAGES();
  DilateReport report;
  const Anatomy anatomy = grown(own, package, own.body, &report);
  EXPECT_LT(largest_change(rest_slices(own.anatomy), rest_slices(anatomy)), 1e-9);
  for (size_t m = 0; m < anatomy.muscles.size(); ++m)
    EXPECT_NEAR(anatomy.muscles[m].volume / own.anatomy.muscles[m].volume, 1, 1e-9)
        << anatomy.muscles[m].name;
  EXPECT_EQ(report.misses, 0);
  EXPECT_GT(report.volume, 1.05 * report.target_volume);  // they did grow
}

TEST(Fit, MovedAndMirroredBodiesGetMovedAndMirroredMuscles) {
  NEED_PACKAGES();
  const Vec3 shift(0.3, 0.1, -0.2);
  Body body = own.body;
  body.skin.V.rowwise() += shift.transpose();
  std::vector<Ellipse> moved = rest_slices(own.anatomy);
  for (Ellipse& slice : moved) slice.center += shift;
  // which of two neighbours gives way can hang on the last bit of a coordinate
  EXPECT_LT(largest_change(moved, rest_slices(grown(own, package, body))), 5e-4);
  // The body is even, so is its anatomy.
  const Anatomy& anatomy = own.anatomy;
  double worst = 0;
  for (const Muscle& muscle : anatomy.muscles) {
    if (muscle.side != Side::left) continue;
    const Muscle& other =
        anatomy.muscles[find_muscle(anatomy, muscle.name.substr(0, muscle.name.size() - 1) + "r")];
    for (size_t s = 0; s < muscle.strips.size(); ++s) {
      const auto left = rest_slices(muscle.strips[s]), right = rest_slices(other.strips[s]);
      for (size_t k = 0; k < left.size(); ++k)
        worst =
            std::max({worst, (left[k].center.cwiseProduct(Vec3(-1, 1, 1)) - right[k].center).norm(),
                      (left[k].radii - right[k].radii).norm()});
    }
  }
  EXPECT_LT(worst, 1e-3);
}

// Three points, 1.8 m high.
Body weighed(Sex sex, double age, double index) {
  Body body;
  body.skin.V = 0.9 * Points{{-1, 0, -1}, {1, 0, -1}, {0, 2, 1}};
  body.sex = sex;
  body.age = age;
  body.mass = index * 1.8 * 1.8;
  return body;
}

TEST(Fit, TheFatLayerFollowsTheShareOfFat) {
  // Deurenberg's regressions, by hand.
  EXPECT_NEAR(estimate_fat_share(weighed(Sex::male, 25, 22)), 0.1595, 1e-9);
  EXPECT_NEAR(estimate_fat_share(weighed(Sex::female, 60, 22)), 0.3480, 1e-9);
  EXPECT_NEAR(estimate_fat_share(weighed(Sex::male, 10, 17)), 0.1647, 1e-9);
  // Lean, but not athletes; as fat as the heavy builds of the table; no thicker under the skin for
  // age alone.
  EXPECT_NEAR(estimate_fatness(weighed(Sex::male, 25, 22)), 0.495, 1e-9);
  EXPECT_NEAR(estimate_fatness(weighed(Sex::female, 25, 19.5)), 0.0475 / 0.12, 1e-9);
  for (const Sex sex : {Sex::male, Sex::female}) {
    EXPECT_NEAR(estimate_fatness(weighed(sex, 40, 34)), 2, 1e-9);
    EXPECT_EQ(estimate_fatness(weighed(sex, 70, 22)), estimate_fatness(weighed(sex, 25, 22)));
    for (double index = 17; index < 40; index += 1)
      EXPECT_LT(estimate_fatness(weighed(sex, 30, index)),
                estimate_fatness(weighed(sex, 30, index + 1)));
  }
}

TEST(Fit, WhatAgeAddsToFatLiesInside) {
  const Body young = weighed(Sex::male, 25, 30), old = weighed(Sex::male, 75, 30);
  // By hand: 0.2555 of 97.2 kg, less marrow, muscles and viscera, at 0.85 x 950 kg/m^3.
  EXPECT_NEAR(subcutaneous_fat(young), 0.77 * 0.2555 * 97.2 / 807.5, 1e-6);
  EXPECT_NEAR(subcutaneous_fat(old), subcutaneous_fat(young), 1e-12);
  EXPECT_NEAR(fat_in_muscles(young), 0.05 * 0.0455 * 97.2 / 807.5, 1e-6);
  EXPECT_NEAR(fat_in_muscles(old) - fat_in_muscles(young), 0.3 * 0.115 * 97.2 / 807.5, 1e-6);
  EXPECT_EQ(fat_in_muscles(weighed(Sex::female, 25, 20)), 0);  // the regression's muscles have it
}

TEST(Fit, TheFatLayerHoldsTheBodysFat) {
  NEED_PACKAGES();
  for (const BodySpec& spec : {BodySpec{.sex = Sex::male, .age = 30, .height = 1.95, .mass = 105},
                               BodySpec{.sex = Sex::male, .age = 70, .height = 1.70, .mass = 95}}) {
    const Body body = make_body(package, spec);
    const Fit fit = fit_anatomy(own, body);
    const TriMesh skin = capped_skin(package, body.skin.V);
    const SkinRays rays(skin);
    Anatomy no_bones = fit.anatomy;  // no ribs nor shins that change the layer
    no_bones.bones.clear();
    const FatLayer layer = make_fat_layer(own.tables.fat, rays, no_bones, body);
    const Points normals = vertex_normals(skin);
    const auto below = [&](const std::vector<float>& depths) {
      TriMesh inner = skin;
      for (Eigen::Index i = 0; i < inner.V.rows(); ++i)
        inner.V.row(i) -= double(depths[std::size_t(i)]) * normals.row(i);
      return mesh_volume(inner);
    };
    const double fat = below(layer.skin) - below(layer.thickness);
    EXPECT_NEAR(fat / subcutaneous_fat(body), 1, 0.02) << int(spec.sex);
  }
}

// Of a heavy person the table's layer reaches down to the blades; muscle lies over them.
TEST(Fit, TheFatLayerLeavesRoomOverTheBlades) {
  NEED_PACKAGES();
  const Body body =
      make_body(package, {.sex = Sex::female, .age = 57, .height = 1.58, .mass = 102});
  const Fit fit = fit_anatomy(own, body);
  const SkinRays rays(capped_skin(package, body.skin.V));
  Anatomy bladeless = fit.anatomy;
  std::erase_if(bladeless.bones, [](const Bone& bone) { return bone.name.starts_with("scapula"); });
  const FatLayer table = make_fat_layer(own.tables.fat, rays, bladeless, body),
                 layer = make_fat_layer(own.tables.fat, rays, fit.anatomy, body);
  const SkinRays blade(fit.anatomy.bones[std::size_t(find_bone(fit.anatomy, "scapula_l"))].mesh);
  const Points normals = vertex_normals(rays.mesh());
  int over = 0, thinner = 0;
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const RayHit hit = blade.first_hit(rays.mesh().V.row(i), -normals.row(i), 0.06);
    if (hit.triangle < 0) continue;
    const std::size_t v = std::size_t(i);
    ++over;
    thinner += layer.thickness[v] < table.thickness[v];
    EXPECT_GE(layer.thickness[v], 0.499f * table.thickness[v]);
    EXPECT_LE(layer.thickness[v],
              std::max(0.501 * double(table.thickness[v]), double(hit.distance) - 0.014));
  }
  EXPECT_GT(over, 20);
  EXPECT_GT(thinner, 10);
}

TEST(Fit, FatSitesFaceAsTheirNamesSay) {
  NEED_PACKAGES();
  const Vec3 left = Vec3::UnitX(), up = Vec3::UnitY(), front = Vec3::UnitZ();
  const std::vector<std::pair<Vec3, std::vector<std::string>>> faces{
      {front,
       {"chest_l", "breast_l", "sternum", "abdominal_l", "hypogastric_l", "suprapubic", "groin_l",
        "front_thigh_l", "knee_patella_l", "biceps_l"}},
      {-front,
       {"subscapular_l", "upper_back_t7_l", "lumbar_l3_l", "buttock_l", "posterior_thigh_l",
        "popliteal_l", "posterior_calf_l", "distal_calf_l", "achilles_l", "triceps_l",
        "elbow_olecranon_l", "scalp_back", "neck_back"}},
      {left,
       {"midaxillary_l", "flank_l", "suprailiac_jp_l", "greater_trochanter_l", "lateral_thigh_l",
        "lateral_knee_l", "lateral_leg_l", "lateral_ankle_l", "neck_side_l"}},
      {-left, {"medial_thigh_l", "medial_knee_l", "medial_calf_l", "medial_ankle_l"}},
      {up, {"scalp", "forehead", "foot_dorsum_l"}},
      {-up, {"heel_pad_l", "arch_l", "sole_ball_l"}}};
  const SkinRays rays(capped_skin(package, own.body.skin.V));
  const FatLayer layer = make_fat_layer(own.tables.fat, rays, own.anatomy, own.body);
  for (const auto& [direction, names] : faces)
    for (const std::string& name : names) {
      const auto site = std::find_if(layer.sites.begin(), layer.sites.end(),
                                     [&](const FatSite& s) { return s.name == name; });
      ASSERT_NE(site, layer.sites.end()) << name;
      EXPECT_GT(site->normal.dot(direction), 0.5) << name;
    }
}

// Where a line from `from` first meets the mesh: every triangle tried, by Cramer's rule.
double depth_by_hand(const TriMesh& mesh, const Vec3& from, const Vec3& direction) {
  double least = 1;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2)), out = from - a;
    const Vec3 across = direction.cross(c - a), other = out.cross(b - a);
    const double size = (b - a).dot(across);
    if (std::abs(size) < 1e-14) continue;
    const double u = out.dot(across) / size, v = direction.dot(other) / size,
                 t = (c - a).dot(other) / size;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) least = std::min(least, t);
  }
  return least;
}

TEST(Fit, TheFatLayerReachesBareBoneAndNothingElse) {
  NEED_PACKAGES();
  const std::vector<std::string> bare{"tibia",   "fibula", "femur", "patella",
                                      "humerus", "ulna",   "radius"};
  const auto is_bare = [&](const std::string& name) {
    return std::any_of(bare.begin(), bare.end(),
                       [&](const std::string& b) { return name == b + "_l" || name == b + "_r"; });
  };
  Anatomy without = own.anatomy;
  std::erase_if(without.bones, [&](const Bone& bone) { return is_bare(bone.name); });
  const TriMesh skin = capped_skin(package, own.body.skin.V);
  const SkinRays rays(skin);
  const FatLayer plain = make_fat_layer(own.tables.fat, rays, without, own.body),
                 layer = make_fat_layer(own.tables.fat, rays, own.anatomy, own.body);
  const auto parts = vertex_parts(package);
  const Points normals = vertex_normals(skin);
  const auto deeper = [&](size_t i) { return double(layer.thickness[i] - plain.thickness[i]); };
  int left = 0, right = 0, shins = 0;
  for (size_t i = 0; i < layer.thickness.size(); ++i) {
    EXPECT_GE(deeper(i), 0);
    if (deeper(i) < 1e-3) continue;
    const Vec3 at = skin.V.row(i);
    // a bone straight below, no farther off than the table says, and no nearer than the layer
    // reaches
    bool covered = false;
    for (const Bone& bone : own.anatomy.bones) {
      const double depth = is_bare(bone.name) ? depth_by_hand(bone.mesh, at, -normals.row(i)) : 1;
      covered = covered || (depth < 0.035 && double(layer.thickness[i]) < depth + 1e-5);
    }
    EXPECT_TRUE(covered) << i;
    EXPECT_LT(double(layer.thickness[i]), 0.035);
    ASSERT_LT(i, parts.size());
    EXPECT_NE(parts[i].part, BodyPart::trunk);
    EXPECT_NE(parts[i].part, BodyPart::head);
    ++(at.x() > 0 ? left : right);
    shins += parts[i].part == BodyPart::shank;
  }
  EXPECT_GT(shins, 60);
  EXPECT_NEAR(left, right, 4);
}

TEST(Fit, EveryJointRestsInsideItsLimitsInAnatomicalAxes) {
  NEED_PACKAGES();
  for (const char* name : {"default_female", "heavy_male", "tall_male"}) {
    for (const BodySpec& spec : standard_bodies()) {
      if (spec.name != name) continue;
      const Skeleton skeleton = fit_anatomy(own, make_body(package, spec)).anatomy.skeleton;
      const auto angles = [&](const char* joint) {
        return Vec3(joint_angles(skeleton.joints[find_joint(skeleton, joint)], Quat::Identity()) *
                    (180 / 3.14159265358979));
      };
      for (const Joint& joint : skeleton.joints) {
        EXPECT_TRUE(joint.axes.isUnitary(1e-9) && joint.axes.determinant() > 0) << joint.name;
        EXPECT_LT(limit_excess(joint, Quat::Identity()), 1e-9) << name << ' ' << joint.name;
        if (!joint.name.ends_with("_l")) continue;
        const Vec3 other =
            skeleton.joints[find_joint(skeleton, joint.name.substr(0, joint.name.size() - 1) + "r")]
                .zero;
        EXPECT_LT((joint.zero - other).norm(), 1e-6) << joint.name;
      }
      // The base mesh stands with its arms held out and its elbows bent forwards.
      EXPECT_GT(angles("shoulder_l")[1], 20) << name;
      EXPECT_LT(angles("shoulder_l")[1], 65) << name;
      EXPECT_GT(angles("elbow_l")[0], 25) << name;
      EXPECT_LT(angles("elbow_l")[0], 60) << name;
      EXPECT_GT(angles("hip_l")[1], 0) << name;
    }
  }
}

TEST(Fit, AMovedBodyGetsAMovedSkeleton) {
  NEED_PACKAGES();
  const Vec3 shift(0.3, 0.1, -0.2);
  Body body = own.body;
  body.skin.V.rowwise() += shift.transpose();
  EXPECT_LT(largest_move(own.anatomy, fit_anatomy(own, body).anatomy, shift), 1e-6);
}

TEST(Fit, BonesStayInsideEveryStandardBody) {
  NEED_PACKAGES();
  for (const BodySpec& spec : some_of(standard_bodies())) {
    const Body body = make_body(package, spec);
    const Fit fit = fit_anatomy(own, body);
    EXPECT_EQ(fit.report.bones_outside, 0) << spec.name;
    EXPECT_EQ(outside(fit.anatomy, SkinField(capped_skin(package, body.skin.V))), 0) << spec.name;
    EXPECT_LT(nearest_vertices(fit.anatomy, "femur_l", "hip_bone_l"), 6e-3) << spec.name;
    EXPECT_LT(nearest_vertices(fit.anatomy, "humerus_l", "scapula_l"), 8e-3) << spec.name;
    for (const Bone& bone : fit.anatomy.bones)
      EXPECT_TRUE(bone.mesh.V.allFinite()) << spec.name << ' ' << bone.name;
    EXPECT_NO_THROW(validate(fit.anatomy)) << spec.name;
  }
}

TEST(Fit, PalpablePointsAreAsDeepAsTheyShouldBe) {
  NEED_PACKAGES();
  const std::vector<const char*> names{"default_male", "default_female", "short_male",
                                       "tall_male",    "young_male",     "young_female"};
  for (const char* name : some_of(names, 1, 2)) {
    for (const BodySpec& spec : standard_bodies()) {
      if (spec.name != name) continue;
      int missed = 0;
      const Fit fit = fit_anatomy(own, make_body(package, spec));
      for (const LandmarkDepth& at : fit.report.landmarks)
        missed += at.depth < at.low - 4e-3 || at.depth > at.high + 4e-3;
      EXPECT_GE(fit.report.landmarks.size(), 40u);
      EXPECT_LE(missed, 2) << name;
    }
  }
}

// The lower teeth close behind the upper ones where the lips meet, and the chin is as far under its
// skin, seen from the front, as in people: 8 to 14 mm.
TEST(Fit, TheJawClosesBehindTheLipsOfEveryStandardBody) {
  NEED_PACKAGES();
  const auto foremost = [](const Points& V, double from, double to) {
    double out = -1;
    const double low = V.col(1).minCoeff(), size = V.col(1).maxCoeff() - low;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      if (V(i, 1) >= low + from * size && V(i, 1) <= low + to * size) out = std::max(out, V(i, 2));
    return out;
  };
  for (const BodySpec& spec : some_of(standard_bodies(), 2)) {
    const Body body = make_body(package, spec);
    const Fit fit = fit_anatomy(own, body);
    const Points& jaw = fit.anatomy.bones[std::size_t(find_bone(fit.anatomy, "mandible"))].mesh.V;
    const Points& skull = fit.anatomy.bones[std::size_t(find_bone(fit.anatomy, "skull"))].mesh.V;
    constexpr int kChin = 5162, kLips = 474;  // vertices of the base mesh
    const double tissue = body.skin.V(kChin, 2) - foremost(jaw, 0, 1.0 / 3);
    EXPECT_GT(tissue, 0.006) << spec.name;
    EXPECT_LT(tissue, 0.017) << spec.name;
    const double overbite = foremost(skull, 0, 0.2) - foremost(jaw, 0.4, 1);
    EXPECT_GT(overbite, 0) << spec.name;
    EXPECT_LT(overbite, 0.010) << spec.name;
    const auto line = find_mouth(fit.anatomy, body.skin);
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->over(body.skin.V.row(kLips)), 0, 1.5e-3) << spec.name;
  }
}

// Lips of such bodies may cross, and heavy men's chins fold: what is near there is neither outside
// nor to be crushed.
TEST(Fit, PeopleDrawnFromTheShapeSpaceKeepTheirBones) {
  NEED_PACKAGES();
  const TapeMeasure tape(package, read_measure_table(package, test_assets().tables / "body"));
  const ShapeSpace space = read_shape_space(package, tape, Sex::male);
  const auto extent = [](const Points& V) {
    return Vec3((V.colwise().maxCoeff() - V.colwise().minCoeff()).transpose());
  };
  const std::size_t skull = find_bone(own.anatomy, "skull");
  for (const std::uint64_t seed : some_of<std::uint64_t>({100, 101, 105})) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Eigen::VectorXd z(space.basis.cols());
    for (double& x : z) x = normal(random);
    Body body;
    body.skin = skin_mesh(package, space_points(space, z));
    body.skin.V.col(1).array() -= body.skin.V.col(1).minCoeff();
    const Fit fit = fit_anatomy(own, body);
    EXPECT_EQ(fit.report.bones_outside, 0) << seed;
    for (const LandmarkDepth& l : fit.report.landmarks)
      EXPECT_LT(std::max(l.low - l.depth, l.depth - l.high), 0.006) << seed << " " << l.name;
    const Vec3 ratio = extent(fit.anatomy.bones[skull].mesh.V)
                           .cwiseQuotient(extent(own.anatomy.bones[skull].mesh.V));
    EXPECT_GT(ratio.minCoeff(), 0.85) << seed;
    EXPECT_LT(ratio.maxCoeff(), 1.2) << seed;
  }
}

TEST(Fit, UnevenBodiesAreFittedOnBothSides) {
  NEED_PACKAGES();
  Body body = own.body;
  const Vec3 hip = rest_positions(own.anatomy.skeleton)[find_joint(own.anatomy.skeleton, "knee_r")];
  for (Eigen::Index i = 0; i < body.skin.V.rows(); ++i) {  // a right leg 3 % longer below the knee
    Vec3 p = body.skin.V.row(i);
    if (p.x() < 0 && p.y() < hip.y() && p.y() < 0.9) p.y() = hip.y() + 1.03 * (p.y() - hip.y());
    body.skin.V.row(i) = p;
  }
  const Fit fit = fit_anatomy(own, body);
  EXPECT_GT(fit.report.asymmetry, 5e-3);
  EXPECT_EQ(outside(fit.anatomy, SkinField(capped_skin(package, body.skin.V))), 0);
  const auto at = [&](const char* joint) {
    return rest_positions(fit.anatomy.skeleton)[find_joint(fit.anatomy.skeleton, joint)];
  };
  const double left = (at("knee_l") - at("ankle_l")).norm(),
               right = (at("knee_r") - at("ankle_r")).norm();
  EXPECT_NEAR(right / left, 1.03, 0.015);
}

TEST(Fit, RefusesWhatIsNoBody) {
  NEED_PACKAGES();
  Body body = own.body;
  body.skin.V.conservativeResize(100, 3);
  EXPECT_THROW(fit_anatomy(own, body), UnfitError);
  body = own.body;
  body.skin.V(5, 1) = std::nan("");
  EXPECT_THROW(fit_anatomy(own, body), UnfitError);
  body = own.body;
  body.skin.V *= 100;
  EXPECT_THROW(fit_anatomy(own, body), UnfitError);
}

}  // namespace
}  // namespace ecorche
