// Laws of what the skin does by itself: it evens out, keeps volumes, and parts where it meets.
#include <gtest/gtest.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "anatomy/geometry/self_intersections.h"
#include "anatomy/geometry/vertex_normals.h"
#include "skinning/settle/elastic_skin.h"
#include "skinning/settle/fold_planes.h"
#include "skinning/settle/membrane.h"
#include "skinning/settle/self_contact.h"
#include "skinning/settle/skin_looseness.h"
#include "skinning/settle/volume_preservation.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

TriMesh fine_tube(int rings = 40, int sides = 24) {
  constexpr double kRadius = 0.1;
  constexpr int kCap = 6;
  std::vector<Vec2> profile;
  for (int k = 1; k <= kCap; ++k) {
    const double angle = std::numbers::pi / 2 * (1 - double(k) / kCap);
    profile.emplace_back(-kRadius * std::sin(angle), kRadius * std::cos(angle));
  }
  for (int k = 1; k < rings; ++k) profile.emplace_back(double(k) / rings, kRadius);
  for (int k = 0; k < kCap; ++k) {
    const double angle = std::numbers::pi / 2 * k / kCap;
    profile.emplace_back(1 + kRadius * std::sin(angle), kRadius * std::cos(angle));
  }
  return test::lathe(Vec3::Zero(), Vec3::UnitY(), profile, sides);
}

struct Tube {
  TriMesh mesh = fine_tube();
  std::vector<double> tissue = std::vector<double>(mesh.V.rows(), 0.04);
  std::span<const int> triangles() const { return {mesh.F.data(), std::size_t(mesh.F.size())}; }
};

std::vector<float> floats(const Points& V) {
  std::vector<float> out;
  for (Eigen::Index i = 0; i < V.rows(); ++i)
    for (int k = 0; k < 4; ++k) out.push_back(k < 3 ? float(V(i, k)) : 1);
  return out;
}

Points points(std::span<const float> positions) {
  Points out(positions.size() / 4, 3);
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index k = 0; k < 3; ++k) out(i, k) = positions[4 * i + k];
  return out;
}

double worst_edge(const TriMesh& rest, const Points& V) {
  double worst = 0;
  for (Eigen::Index f = 0; f < rest.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = rest.F(f, k), b = rest.F(f, (k + 1) % 3);
      worst = std::max(
          worst,
          std::abs((V.row(a) - V.row(b)).norm() / (rest.V.row(a) - rest.V.row(b)).norm() - 1));
    }
  return worst;
}

double volume(const TriMesh& mesh, const Points& V) {
  double six = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    six +=
        Vec3(V.row(mesh.F(f, 0))).dot(Vec3(V.row(mesh.F(f, 1))).cross(Vec3(V.row(mesh.F(f, 2)))));
  return six / 6;
}

// About y = 0.5 the tube is bent, within `length`.
Points bent(const Points& V, double angle, double length) {
  Points out = V;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    // The centre line is an arc of a circle about the x axis, straight before and after.
    const double radius = length / angle, along = V(i, 1) - (0.5 - length / 2),
                 t = std::clamp(along / length, 0.0, 1.0) * angle;
    const Quat turn(Eigen::AngleAxisd(t, Vec3::UnitX()));
    const Vec3 line(0, 0.5 - length / 2 + radius * std::sin(t), radius * (1 - std::cos(t)));
    const double rest = along - std::clamp(along, 0.0, length);
    out.row(i) = (line + turn * Vec3(V(i, 0), rest, V(i, 2))).transpose();
  }
  return out;
}

RelaxedSkin relaxed_skin(const Points& V, std::span<const int> triangles) {
  RelaxedSkin out;
  out.positions = floats(V);
  out.normals.resize(out.positions.size());
  vertex_normals(out.positions, triangles, out.normals);
  return out;
}

std::vector<float> relaxed(const Tube& tube, const Points& anchors) {
  std::vector<float> out = floats(anchors);
  MembraneWorkspace workspace;
  relax_membrane(make_membrane(tube.mesh, tube.tissue), tube.triangles(), out, workspace);
  return out;
}

TEST(Membrane, StaysWhereNothingStretchesIt) {
  const Tube tube;
  EXPECT_LT((points(relaxed(tube, tube.mesh.V)) - tube.mesh.V).cwiseAbs().maxCoeff(), 1e-6);
  const Quat turn(Eigen::AngleAxisd(2.1, Vec3(1, 2, -1).normalized()));
  Points turned = tube.mesh.V;
  for (Eigen::Index i = 0; i < turned.rows(); ++i)
    turned.row(i) = (turn * Vec3(turned.row(i))).transpose() + Eigen::RowVector3d(0.3, 1, -2);
  EXPECT_LT((points(relaxed(tube, turned)) - turned).cwiseAbs().maxCoeff(), 2e-6);
}

TEST(Membrane, EvensOutStretchAndStaysNearItsAnchors) {
  const Tube tube;
  const Points anchors = bent(tube.mesh.V, 1.2, 0.1), V = points(relaxed(tube, anchors));
  EXPECT_LT(worst_edge(tube.mesh, V), 0.7 * worst_edge(tube.mesh, anchors));
  EXPECT_LT((V - anchors).rowwise().norm().maxCoeff(), 0.05);
  for (Eigen::Index i = 0; i < V.rows(); ++i)
    if (std::abs(tube.mesh.V(i, 1) - 0.5) > 0.4) {
      EXPECT_LT((V.row(i) - anchors.row(i)).norm(), 2e-3) << i;
    }
}

// Skin over deep flesh gives way to a bend, but not far from it: what it may slide it may crumple.
TEST(Membrane, DeepSkinFollowsItsAnchorsAtADistanceFromABend) {
  Tube tube;
  tube.tissue.assign(tube.tissue.size(), 0.08);
  const Points anchors = bent(tube.mesh.V, 1.2, 0.1), V = points(relaxed(tube, anchors));
  double away = 0;
  for (Eigen::Index i = 0; i < V.rows(); ++i)
    if (std::abs(tube.mesh.V(i, 1) - 0.5) > 0.25)
      away = std::max(away, (V.row(i) - anchors.row(i)).norm());
  EXPECT_LT(away, 4.5e-3);
}

TEST(Membrane, SameBytesAtOneAndTwoThreads) {
  const Tube tube;
  const Points anchors = bent(tube.mesh.V, 1.2, 0.1);
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  const std::vector<float> first = relaxed(tube, anchors);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(first, relaxed(tube, anchors));
}

TEST(LimbVolumes, ComeBackWhenTheSkinWasPressedIn) {
  const Tube tube;
  const test::Arm arm = test::make_arm();
  const std::vector<float> rest = floats(tube.mesh.V);
  const std::vector<std::array<Influence, 4>> weights(tube.tissue.size(),
                                                      {Influence{0, 1}, {}, {}, {}});
  const VolumeRegions volumes =
      make_volume_regions(arm.anatomy.skeleton, rest, tube.triangles(), weights, tube.tissue);
  std::vector<Transform> X_WJ;
  forward_kinematics(arm.anatomy.skeleton, rest_pose(arm.anatomy.skeleton), X_WJ);
  const auto kept = [&](const Points& V) {
    RelaxedSkin skin = relaxed_skin(V, tube.triangles());
    skin.openness.assign(V.rows(), 1.0f);
    restore_volumes(volumes, X_WJ, skin);
    return points(skin.positions);
  };
  EXPECT_LT((kept(tube.mesh.V) - tube.mesh.V).cwiseAbs().maxCoeff(), 1e-6);
  Points pressed = tube.mesh.V;
  pressed.col(0) *= 0.96;
  const double before = volume(tube.mesh, tube.mesh.V);
  EXPECT_NEAR(volume(tube.mesh, pressed) / before, 0.96, 1e-6);
  EXPECT_NEAR(volume(tube.mesh, kept(pressed)) / before, 1, 2e-3);
}

// The forearm's share of an arm's skin passes from 0 to 1 within `length` about the elbow.
std::vector<std::array<Influence, 4>> arm_weights(const test::Arm& arm, double length) {
  const double elbow = rest_positions(arm.anatomy.skeleton)[3].y();
  std::vector<std::array<Influence, 4>> out;
  for (Eigen::Index i = 0; i < arm.skin.V.rows(); ++i) {
    const double share = std::clamp(0.5 + (elbow - arm.skin.V(i, 1)) / length, 0.0, 1.0);
    out.push_back({Influence{2, 1 - share}, {3, share}, {}, {}});
  }
  return out;
}

TEST(JointStrain, GrowsWithLeverAndSteepnessAndEndsWithThePassage) {
  const test::Arm arm = test::make_arm();
  const double elbow = rest_positions(arm.anatomy.skeleton)[3].y(), length = 0.08;
  const std::vector<double> wide = find_joint_strain(arm.anatomy.skeleton, arm.skin,
                                                     arm_weights(arm, length)),
                            narrow = find_joint_strain(arm.anatomy.skeleton, arm.skin,
                                                       arm_weights(arm, length / 2));
  int about = 0, away = 0;
  for (Eigen::Index i = 0; i < arm.skin.V.rows(); ++i) {
    const std::size_t v = i;
    const double along = std::abs(arm.skin.V(i, 1) - elbow);
    if (along < 0.005) {
      ++about;
      EXPECT_NEAR(wide[v], 1.3 * 0.045 / length, 0.05);  // rad, m, m
      EXPECT_NEAR(narrow[v], 2 * wide[v], 0.1);
    } else if (along > length / 2 + 0.011) {
      ++away;
      EXPECT_EQ(wide[v], 0);
    }
  }
  EXPECT_GT(about, 20);
  EXPECT_GT(away, 1000);
}

TEST(JointStrain, ThinSkinOverAJointIsHeldLess) {
  const test::Arm arm = test::make_arm();
  const double elbow = rest_positions(arm.anatomy.skeleton)[3].y();
  const std::size_t n = arm.skin.V.rows();
  const std::vector<double> depth(n, 0.004), radius(n, 0.045);
  const std::vector<std::array<Influence, 4>> weights = arm_weights(arm, 0.08);
  const ElasticSkin skin =
      make_elastic_skin(arm.anatomy.skeleton, arm.skin, {depth, radius, weights}, {},
                        {arm.skin.F.data(), std::size_t(arm.skin.F.size())});
  for (std::size_t i = 0; i < n; ++i) {
    const double along = std::abs(arm.skin.V(i, 1) - elbow);
    if (along < 0.02) {
      EXPECT_LT(skin.membrane.stiffness[i], 0.15f);
    } else if (along > 0.12) {
      EXPECT_GT(skin.membrane.stiffness[i], 0.6f);
    }
  }
}

// A nub of 4 mm on the tube's end, which has all of its flesh beneath it.
TEST(LimbVolumes, SmallThingsOnDeepFleshKeepTheirShape) {
  constexpr double kRadius = 0.1, kNub = 0.004;
  std::vector<Vec2> profile;
  for (int k = 1; k <= 24; ++k) profile.emplace_back(0, kRadius * k / 24);
  for (int k = 1; k < 40; ++k) profile.emplace_back(k / 40.0, kRadius);
  for (int k = 0; k < 24; ++k) profile.emplace_back(1, kRadius + (kNub - kRadius) * k / 24);
  for (int k = 0; k < 4; ++k) {
    const double angle = std::numbers::pi / 2 * k / 4;
    profile.emplace_back(1 + kNub * std::sin(angle), kNub * std::cos(angle));
  }
  const TriMesh mesh = test::lathe(Vec3::Zero(), Vec3::UnitY(), profile, 24);
  const std::span<const int> triangles(mesh.F.data(), std::size_t(mesh.F.size()));
  const std::vector<double> tissue(mesh.V.rows(), 0.04);
  const std::vector<std::array<Influence, 4>> weights(tissue.size(), {Influence{0, 1}, {}, {}, {}});
  const test::Arm arm = test::make_arm();
  const VolumeRegions volumes =
      make_volume_regions(arm.anatomy.skeleton, floats(mesh.V), triangles, weights, tissue);
  std::vector<Transform> X_WJ;
  forward_kinematics(arm.anatomy.skeleton, rest_pose(arm.anatomy.skeleton), X_WJ);
  Points shorter = mesh.V;
  for (Eigen::Index i = 0; i < shorter.rows(); ++i)
    shorter(i, 1) -= 0.04 * std::clamp(shorter(i, 1), 0.0, 1.0);
  RelaxedSkin skin = relaxed_skin(shorter, triangles);
  skin.openness.assign(tissue.size(), 1.0f);
  restore_volumes(volumes, X_WJ, skin);
  const Points V = points(skin.positions);
  EXPECT_NEAR(volume(mesh, V) / volume(mesh, mesh.V), 1, 3e-3);
  int edges = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.F(f, k), b = mesh.F(f, (k + 1) % 3);
      if (std::min(mesh.V(a, 1), mesh.V(b, 1)) < 1 + 1e-4) continue;
      ++edges;
      EXPECT_NEAR((V.row(a) - V.row(b)).norm() / (mesh.V.row(a) - mesh.V.row(b)).norm(), 1, 0.06);
    }
  EXPECT_GT(edges, 100);
}

TEST(LimbVolumes, FoldsDoNotSwell) {
  const Tube tube;
  const Membrane rings = make_membrane(tube.mesh, tube.tissue);
  const auto openness = [&](const Points& V) {
    RelaxedSkin skin = relaxed_skin(V, tube.triangles());
    std::vector<float> working;
    find_openness(rings, skin, working);
    return skin.openness;
  };
  for (const float open : openness(tube.mesh.V)) EXPECT_EQ(open, 1);
  const std::vector<float> folded = openness(bent(tube.mesh.V, 1.2, 0.15));
  EXPECT_LT(*std::min_element(folded.begin(), folded.end()), 0.9f);
  EXPECT_EQ(folded.front(), 1);
}

// Two tubes side by side as one mesh, `apart` between their axes.
struct Pair {
  Tube one{fine_tube(100, 64), {}};
  TriMesh mesh{Points(2 * one.mesh.V.rows(), 3), Triangles(2 * one.mesh.F.rows(), 3)};
  std::vector<double> tissue = std::vector<double>(mesh.V.rows(), 0.04);
  Pair() {
    mesh.F << one.mesh.F, (one.mesh.F.array() + int(one.mesh.V.rows())).matrix();
    mesh.V = at(0.3);
  }
  Points at(double apart) const {
    Points V(mesh.V.rows(), 3);
    V << one.mesh.V, (one.mesh.V.rowwise() + Eigen::RowVector3d(apart, 0.013, 0.007)).matrix();
    return V;
  }
  std::span<const int> triangles() const { return {mesh.F.data(), std::size_t(mesh.F.size())}; }
  Points parted(const Points& V, std::vector<float>* its_normals = nullptr) const {
    const Membrane rings = make_membrane(mesh, tissue);
    const SelfContact contact = make_self_contact(rings, floats(mesh.V), triangles(), tissue);
    RelaxedSkin skin;
    skin.positions = floats(V);
    SelfContactWorkspace workspace;
    separate_skin(rings, contact, triangles(), skin, workspace);
    if (its_normals) *its_normals = skin.normals;
    return points(skin.positions);
  }
};

struct BentLeg {
  Skeleton skeleton;
  Tube tube;  // from the ankle, y = 0, to the hip, y = 1; the knee is in the middle
  std::vector<Vec3> rest;
  std::vector<JointWeights> weights;
  std::vector<HingeFold> folds;

  BentLeg() {
    const auto add = [&](const char* name, int parent, double y) {
      Joint joint;
      joint.name = name;
      joint.parent = parent;
      joint.X_PJ.translation() = Vec3(0, y, 0);
      joint.axes.col(0) = Vec3::UnitX();
      joint.axes.col(1) = Vec3::UnitY();
      joint.axes.col(2) = Vec3::UnitZ();
      joint.max.x() = 2.6;
      skeleton.joints.push_back(joint);
    };
    add("pelvis", -1, 1.2);
    add("hip_l", 0, -0.2);
    add("knee_l", 1, -0.5);
    add("ankle_l", 2, -0.5);
    for (Eigen::Index i = 0; i < tube.mesh.V.rows(); ++i) {
      rest.push_back(tube.mesh.V.row(i));
      weights.push_back({{{rest.back().y() > 0.5 ? 1 : 2, 1.0}}});
    }
    folds = make_fold_planes(skeleton, rest, weights, std::vector<double>(rest.size(), 0.12));
  }

  // The skin as it is blended with the knee bent by `angle`, and pressed off the fold's plane.
  std::pair<Points, Points> pose(double angle) const {
    Pose pose = rest_pose(skeleton);
    pose.rotations[2] = Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
    std::vector<Transform> X_WJ;
    forward_kinematics(skeleton, pose, X_WJ);
    Points blended = tube.mesh.V;
    for (Eigen::Index i = 0; i < blended.rows(); ++i) {
      const int j = weights[std::size_t(i)][0].joint;
      blended.row(i) =
          X_WJ[j] * Vec3(rest[std::size_t(i)] - rest_positions(skeleton)[std::size_t(j)]);
    }
    RelaxedSkin skin = relaxed_skin(blended, tube.triangles());
    std::vector<float> moved;
    press_folds(folds, X_WJ, skin, moved);
    return {blended, points(skin.positions)};
  }
};

TEST(FoldPlanes, FleshOfASharpBendMeetsInAPlane) {
  const BentLeg leg;
  const double angle = 2.6, half = (std::numbers::pi - angle) / 2;
  ASSERT_EQ(leg.folds.size(), 1u);
  EXPECT_NEAR(leg.folds[0].distal_share, 0.5, 1e-6);
  const auto [blended, pressed] = leg.pose(angle);
  // Both segments are alike, so the plane halves the wedge: from the knee up and backwards.
  const Vec3 along(0, std::cos(half), -std::sin(half)), across(0, -std::sin(half), -std::cos(half));
  double worst_before = 0, worst = 0;
  for (Eigen::Index i = 0; i < pressed.rows(); ++i) {
    const double side = leg.rest[std::size_t(i)].y() > 0.5 ? -1 : 1;
    const auto crossed = [&](const Points& V) {
      const Vec3 from = Vec3(V.row(i)) - Vec3(0, 0.5, 0);
      return along.dot(from) > 0.05 ? -side * across.dot(from) : 0.0;
    };
    worst_before = std::max(worst_before, crossed(blended));
    worst = std::max(worst, crossed(pressed));
  }
  EXPECT_GT(worst_before, 0.05);
  EXPECT_LT(worst, 0.001);
}

TEST(FoldPlanes, LeaveALittleBentHingesAlone) {
  const BentLeg leg;
  const auto [blended, pressed] = leg.pose(1.0);
  EXPECT_LT((blended - pressed).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SkinContact, WhatIsApartStaysAndWhatMeetsIsPressedFlat) {
  const Pair pair;
  EXPECT_EQ(floats(pair.parted(pair.mesh.V)), floats(pair.mesh.V));
  const Points through = pair.at(0.18), V = pair.parted(through);
  const int before = count_self_intersections(pair.mesh.F, through);
  EXPECT_GT(before, 20);
  const int after = count_self_intersections(pair.mesh.F, V);
  EXPECT_LT(after, before / 4);
  double far = 0;  // both give way by about as much
  for (Eigen::Index i = 0; i < V.rows(); ++i)
    far = std::max(far, (V.row(i) - through.row(i)).norm());
  EXPECT_LT(far, 0.015);
  EXPECT_GT(far, 0.008);
}

TEST(SkinContact, NormalsAreThoseOfThePartedSkin) {
  const Pair pair;
  std::vector<float> normals, anew(4 * pair.tissue.size());
  vertex_normals(floats(pair.parted(pair.at(0.18), &normals)), pair.triangles(), anew);
  ASSERT_EQ(normals.size(), anew.size());
  for (std::size_t k = 0; k < anew.size(); ++k) ASSERT_NEAR(normals[k], anew[k], 1e-5) << k / 4;
}

TEST(SkinContact, WhatNearlyMeetsKeepsAGap) {
  const Pair pair;
  const auto between = [&](const Points& V) {
    const Eigen::Index half = V.rows() / 2;
    return V.col(0).tail(half).minCoeff() - V.col(0).head(half).maxCoeff();
  };
  const Points near = pair.at(0.2002), V = pair.parted(near);
  EXPECT_GT(between(V), between(near) + 1e-4);
  EXPECT_EQ(count_self_intersections(pair.mesh.F, V), 0);
  EXPECT_EQ(floats(pair.parted(pair.at(0.203))), floats(pair.at(0.203)));
}

TEST(SkinContact, GivesWayNoFurtherThanTheFleshIsThick) {
  const Pair pair;
  const Points deep = pair.at(0.08), V = pair.parted(deep);
  EXPECT_LT((V - deep).rowwise().norm().maxCoeff(), 0.0421);
}

TEST(SkinContact, LooksAtEveryVertexThatIsInsideAndAtFewOthers) {
  const Pair pair;
  const std::vector<float> rest = floats(pair.mesh.V), posed = floats(pair.at(0.17)),
                           give(pair.tissue.size(), 0.04f);
  std::vector<float> normals(rest.size());
  vertex_normals(rest, pair.triangles(), normals);
  const ContactPatches patches =
      cut_patches(make_membrane(pair.mesh, pair.tissue), rest, normals, give);
  vertex_normals(posed, pair.triangles(), normals);
  PatchWorkspace scratch;
  std::vector<char> wanted;
  ASSERT_TRUE(find_contact_vertices(patches, {give, 2e-3f, posed, normals}, scratch, wanted));
  const Points V = points(posed);
  const Eigen::Index half = V.rows() / 2;
  int inside = 0, looked_at = 0;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const bool second = i >= half;
    const Vec3 p = Vec3(V.row(i)) -
                   (second ? Vec3::Zero() : Vec3(0.17, 0.013, 0.007));  // to the other tube's axis
    const double along = std::clamp(p.y(), 0.0, 1.0),
                 depth = 0.1 - Vec3(p.x(), p.y() - along, p.z()).norm();
    looked_at += wanted[i];
    if (depth < 2e-4) continue;  // facets lie a little within the round
    ++inside;
    EXPECT_TRUE(wanted[i]) << i << " is " << depth << " m inside";
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(looked_at, 3 * inside);
}

// Over muscles the skin may rise as freely as it is open, but little where it has met another part.
TEST(SkinContact, WhatHasMetRisesLess) {
  const Pair pair;
  const test::Arm arm = test::make_arm();
  const std::vector<std::array<Influence, 4>> weights(pair.tissue.size(),
                                                      {Influence{0, 1}, {}, {}, {}});
  const auto skin = make_elastic_skin(arm.anatomy.skeleton, pair.mesh,
                                      {pair.tissue, pair.tissue, weights}, {}, pair.triangles());
  const auto rising = [&](const Points& V) {
    RelaxedSkin surface = relaxed_skin(V, pair.triangles());
    surface.openness.assign(V.rows(), 0.5f);
    SelfContactWorkspace workspace;
    find_liftable(skin.contact, surface, workspace);
    return surface.liftable;
  };
  for (const float free : rising(pair.mesh.V)) EXPECT_EQ(free, 0.5f);
  const Points through = pair.at(0.17);
  const std::vector<float> met = rising(through);
  int held = 0;
  for (Eigen::Index i = 0; i < through.rows() / 2; ++i) {
    const Vec3 p = Vec3(through.row(i)) - Vec3(0.17, 0.013, 0.007);
    const double depth = 0.1 - Vec3(p.x(), p.y() - std::clamp(p.y(), 0.0, 1.0), p.z()).norm();
    if (depth > 2e-4) {
      EXPECT_LT(met[i], 0.1f) << i;
      ++held;
    } else if (through(i, 0) < 0) {
      EXPECT_EQ(met[i], 0.5f) << i;
    }
  }
  EXPECT_GT(held, 20);
}

}  // namespace
}  // namespace ecorche
