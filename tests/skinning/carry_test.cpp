// A person, or a ball, on a mattress and in a sheet: weight, energy, closed solutions.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "skinning/lift/carry.h"
#include "skinning/lift/pressure_map.h"
#include "tests/skinning/plain_skeleton.h"

namespace ecorche {
namespace {

constexpr double kBallRadius = 0.15, kBallMass = 20, kGravity = 9.81;

// A cube of n x n squares a side, drawn onto the ball.
TriMesh ball(double radius, int n) {
  std::vector<Vec3> V;
  std::vector<Eigen::RowVector3i> F;
  std::map<std::array<int, 3>, int> known;
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [it, fresh] = known.try_emplace(at, int(V.size()));
    if (fresh) {
      Vec3 p;
      for (int k = 0; k < 3; ++k)
        p[k] = std::tan((2.0 * at[std::size_t(k)] / n - 1) * std::numbers::pi / 4);
      V.push_back(radius * p.normalized());
    }
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int end : {0, 1})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> at{};
            at[axis] = end * n;
            at[(axis + 1) % 3] = i + u;
            at[(axis + 2) % 3] = j + v;
            return vertex(at);
          };
          const int a = corner(0, 0), c = corner(1, 1), b = corner(end, 1 - end),
                    d = corner(1 - end, end);
          F.emplace_back(a, b, c);
          F.emplace_back(a, c, d);
        }
  TriMesh out;
  out.V.resize(Eigen::Index(V.size()), 3);
  for (std::size_t i = 0; i < V.size(); ++i) out.V.row(Eigen::Index(i)) = V[i].transpose();
  out.F.resize(Eigen::Index(F.size()), 3);
  for (std::size_t f = 0; f < F.size(); ++f) out.F.row(Eigen::Index(f)) = F[f];
  return out;
}

Patient ball_patient(int n = 30) {
  const double inertia = 0.4 * kBallMass * kBallRadius * kBallRadius;
  return make_rigid_patient(ball(kBallRadius, n), kBallMass, Vec3::Constant(inertia), 0.03);
}

double mass_of(const Sheet& sheet) {
  return std::accumulate(sheet.mass.begin(), sheet.mass.end(), 0.0);
}

// A ball in a square sheet on four straps, no mattress.
CarryModel ball_in_sheet(double spacing, double step) {
  Sheet sheet = make_sheet(rectangle(0.8, 0.8, 0, spacing));
  for (const int x : {-1, 1})
    for (const int z : {-1, 1})
      add_strap(sheet, "corner", Vec3(0.4 * x, 0, 0.4 * z), Vec3(0.35 * x, 0.4, 0.35 * z), 0.4,
                0.16);
  CarryModel model{ball_patient(), std::make_shared<Sheet>(sheet), {}, {}, {}};
  model.mattress.present = false;
  model.options.step = step;
  return model;
}

// A ball in a sheet that hangs by two whole edges.
CarryModel ball_in_hammock(double spacing) {
  Sheet sheet = make_sheet(rectangle(0.8, 0.6, 0, spacing));
  for (const int x : {-1, 1})
    for (const double z : {-0.24, -0.12, 0.0, 0.12, 0.24})
      add_strap(sheet, "edge", Vec3(0.4 * x, 0, z), Vec3(0.3 * x, 0.4, z), 0.4, 0.085);
  CarryModel model{ball_patient(40), std::make_shared<Sheet>(sheet), {}, {}, {}};
  model.mattress.present = false;
  return model;
}

CarryState settled(const CarryModel& model, double height, double seconds) {
  Pose pose = rest_pose(model.patient.skeleton);
  pose.root = Vec3(0, height, 0);
  CarryState state = start_carrying(model, pose, Vec3::Zero(), Vec3::Zero());
  while (state.time < seconds) carry(model, Vec3::Zero(), state);
  return state;
}

double peak_of(const CarryModel& model, const CarryState& state) {
  return measure_pressure(model.patient, state.forces.pressure, state.forces.contact_area)
      .whole.peak;
}

TEST(Carry, MattressCarriesTheWeight) {
  const CarryModel model{ball_patient(), nullptr, {}, {}, {}};
  const CarryState state = settled(model, kBallRadius, 2);
  EXPECT_NEAR(state.forces.mattress.y(), kBallMass * kGravity, 1e-3 * kBallMass * kGravity);
  EXPECT_NEAR(state.forces.mattress.x(), 0, 0.1);
  const PressureMap map =
      measure_pressure(model.patient, state.forces.pressure, state.forces.contact_area);
  EXPECT_NEAR(map.whole.force, kBallMass * kGravity, 0.01 * kBallMass * kGravity);
}

// A level cushion as large as the ball is nothing but a mattress.
Pad level_pad() {
  Pad pad;
  pad.half_width = pad.half_length = 1;
  pad.stiffness = Mattress{}.stiffness;
  pad.bottom = Mattress{}.bottom;
  return pad;
}

CarryModel ball_on_pads(std::vector<Pad> pads, int n = 30) {
  CarryModel model{ball_patient(n), nullptr, {}, {}, {}, std::move(pads)};
  model.mattress.present = false;
  return model;
}

TEST(Carry, LevelPadIsAMattress) {
  const CarryModel bed{ball_patient(), nullptr, {}, {}, {}}, chair = ball_on_pads({level_pad()});
  const CarryState lies = settled(bed, kBallRadius, 2), sits = settled(chair, kBallRadius, 2);
  EXPECT_NEAR(sits.forces.pads[0].y(), kBallMass * kGravity, 1e-3 * kBallMass * kGravity);
  EXPECT_NEAR(peak_of(chair, sits), peak_of(bed, lies), 1e-6 * peak_of(bed, lies));
}

// Two cushions at 45 degrees: each gives half of the weight, and sideways what the other takes.
TEST(Carry, PadsOfAValleyShareTheWeight) {
  std::vector<Pad> pads;
  for (const double side : {1.0, -1.0}) {
    Pad pad = level_pad();
    pad.X_WP.linear() = Eigen::AngleAxisd(-side * std::numbers::pi / 4, Vec3::UnitZ()).matrix();
    pad.X_WP.translation() = -side * pad.X_WP.linear().col(0);
    pads.push_back(pad);
  }
  const CarryModel model = ball_on_pads(pads);
  const CarryState state = settled(model, kBallRadius * std::numbers::sqrt2, 4);
  const double weight = kBallMass * kGravity;
  EXPECT_NEAR(state.forces.region[0].y(), weight, 1e-3 * weight);
  EXPECT_NEAR(state.forces.pads[0].y(), weight / 2, 0.01 * weight);
  EXPECT_NEAR(state.forces.pads[0].x(), -state.forces.pads[1].x(), 0.01 * weight);
  EXPECT_GT(std::abs(state.forces.pads[0].x()), 0.3 * weight);
}

TEST(Carry, PeakOnAPadHoldsAtTwiceTheNodesAndHalfTheStep) {
  const CarryModel model = ball_on_pads({level_pad()}), fine = ball_on_pads({level_pad()}, 42);
  CarryModel half = model;
  half.options.step /= 2;
  const double peak = peak_of(model, settled(model, kBallRadius, 2));
  EXPECT_NEAR(peak_of(fine, settled(fine, kBallRadius, 2)), peak, 0.1 * peak);
  EXPECT_NEAR(peak_of(half, settled(half, kBallRadius, 2)), peak, 0.01 * peak);
}

// A ball of radius R that sinks by d into springs of k a unit area: force = k pi d^2 (R - d / 3),
// peak = k d.
TEST(Carry, BallSinksAsElasticFoundationSays) {
  CarryModel model{ball_patient(60), nullptr, {}, {}, {}};
  model.mattress.stiffness = 2e6;
  model.mattress.bottom = 10;  // straight springs
  const double tissue = model.patient.tissue.modulus / model.patient.thickness[0];
  const double k = tissue * model.mattress.stiffness / (tissue + model.mattress.stiffness);
  const CarryState state = settled(model, kBallRadius, 2);
  const double depth = kBallRadius - state.body.pose.root.y();
  EXPECT_NEAR(k * std::numbers::pi * depth * depth * (kBallRadius - depth / 3),
              kBallMass * kGravity, 0.02 * kBallMass * kGravity);
  EXPECT_NEAR(peak_of(model, state), k * depth, 0.04 * k * depth);
}

TEST(Carry, SheetAndStrapsCarryTheWeight) {
  const CarryModel model = ball_in_sheet(0.05, 1.0 / 60);
  const CarryState state = settled(model, 0.16, 4);
  const double weight = kBallMass * kGravity;
  EXPECT_NEAR(state.forces.region[0].y(), weight, 0.01 * weight);
  const double all = weight + mass_of(*model.sheet) * kGravity;
  EXPECT_NEAR(state.forces.strap_sum.y(), all, 0.01 * all);
  EXPECT_LT(state.forces.strap_sum.head<1>().norm(), 0.01 * all);
}

TEST(Carry, PeakHoldsAtHalfTheStep) {
  const CarryModel model = ball_in_sheet(0.05, 1.0 / 60), half = ball_in_sheet(0.05, 1.0 / 120);
  const double peak = peak_of(model, settled(model, 0.16, 4));
  EXPECT_NEAR(peak_of(half, settled(half, 0.16, 4)), peak, 0.1 * peak);
}

TEST(Carry, PeakHoldsAtTwiceTheNodes) {
  const CarryModel model = ball_in_hammock(0.05), fine = ball_in_hammock(0.05 / std::sqrt(2.0));
  const double peak = peak_of(model, settled(model, 0.16, 4));
  EXPECT_NEAR(peak_of(fine, settled(fine, 0.16, 4)), peak, 0.1 * peak);
}

// A strip that hangs by its ends is a catenary: length = 2 a sinh(span / 2a), sag = a (cosh(span /
// 2a) - 1).
TEST(Carry, StripHangsAsACatenary) {
  constexpr double kLength = 1.2, kSpan = 0.9, kWidth = 0.1;
  Sheet sheet = make_sheet(rectangle(kWidth, kLength, 0, 0.025));
  for (const int x : {-1, 1})
    for (const int z : {-1, 1})
      add_strap(sheet, "end", Vec3(0.5 * kWidth * x, 0, 0.5 * kLength * z),
                Vec3(0.5 * kWidth * x, 0, 0.5 * kSpan * z), 0, 0.001);
  CarryModel model{ball_patient(4), std::make_shared<Sheet>(sheet), {}, {}, {}};
  model.mattress.height = -5;
  model.options.drag = 3;
  Pose pose = rest_pose(model.patient.skeleton);
  pose.root = Vec3(3, -5 + kBallRadius, 0);
  CarryState state = start_carrying(model, pose, Vec3::Zero(), Vec3::Zero());
  while (state.time < 8) carry(model, Vec3::Zero(), state);
  double low = 0.05, high = 10;
  for (int i = 0; i < 80; ++i) {
    const double a = 0.5 * (low + high);
    (2 * a * std::sinh(0.5 * kSpan / a) > kLength ? low : high) = a;
  }
  const double sag = low * (std::cosh(0.5 * kSpan / low) - 1);
  EXPECT_NEAR(-state.nodes.col(1).minCoeff(), sag, 0.01 * sag);
  EXPECT_NEAR(state.forces.strap_sum.y(), mass_of(sheet) * kGravity,
              0.01 * mass_of(sheet) * kGravity);
}

TEST(Carry, SwingLosesEnergyOnly) {
  CarryModel model = ball_in_sheet(0.08, 1.0 / 120);
  model.options.drag = 0;
  CarryState state = settled(model, 0.16, 3);
  state.body.velocity[0] = 0.6;
  state.node_velocities.col(0).setConstant(0.6);
  const double start = carried_energy(model, state);
  double most_later = -1e9, last = start;
  for (int step = 0; step < 480; ++step) {
    carry(model, Vec3::Zero(), state);
    last = carried_energy(model, state);
    most_later = std::max(most_later, last);
  }
  EXPECT_LE(most_later, start + 0.02 * 0.5 * kBallMass * 0.36);
  EXPECT_LT(last, start);
}

// Our joint tree with a skin of a speck: dynamics alone.
Patient bare_patient() {
  Anatomy anatomy;
  anatomy.skeleton = plain_skeleton();
  anatomy.bones.push_back({"speck", Side::middle, 0, ball(0.01, 2)});
  const TriMesh skin = ball(0.02, 2);
  return make_patient(anatomy, skin,
                      std::vector<JointWeights>(std::size_t(skin.V.rows()), {Influence{0, 1.0}}),
                      70);
}

TEST(Carry, TumblingBodyKeepsMomentumAndEnergy) {
  Patient patient = bare_patient();
  for (PassiveJoint& group : patient.groups) group.stiffness = group.damping = 0;
  CarryModel model{patient, nullptr, {}, {}, {}};
  model.mattress.present = false;
  model.options.gravity = 0;
  model.options.drag = 0;
  model.options.step = 1e-3;
  CarryState state = start_carrying(model, rest_pose(patient.skeleton), Vec3::Zero(), Vec3::Zero());
  state.body.velocity.segment<3>(0) = Vec3(0.4, 0.1, -0.2);
  state.body.velocity.segment<3>(3) = Vec3(1.5, 0.5, 1.0);
  const auto momentum = [&] {
    BodyFrames frames;
    body_frames(patient, state.body.pose, frames);
    BodyForces forces;
    body_forces(patient, state.rest, state.body, frames, 0, forces);
    return Eigen::VectorXd(forces.inertia * state.body.velocity);
  };
  const double energy = carried_energy(model, state);
  const Vec3 before = momentum().head<3>();
  for (int step = 0; step < 400; ++step) carry(model, Vec3::Zero(), state);
  EXPECT_LT((momentum().head<3>() - before).norm(), 0.01 * before.norm());
  EXPECT_NEAR(carried_energy(model, state), energy, 0.03 * energy);
  EXPECT_LE(carried_energy(model, state), energy * 1.001);
}

TEST(Carry, JacobianIsTheVelocity) {
  const Patient patient = bare_patient();
  BodyState state{rest_pose(patient.skeleton), Eigen::VectorXd::Zero(patient.freedoms())};
  for (int i = 0; i < state.velocity.size(); ++i) state.velocity[i] = 0.3 * std::sin(1.0 + i);
  advance_body(patient, 1, state);
  BodyFrames before, after;
  body_frames(patient, state.pose, before);
  constexpr double kStep = 1e-6;
  BodyState moved = state;
  advance_body(patient, kStep, moved);
  body_frames(patient, moved.pose, after);
  for (const BodySegment& segment : patient.segments) {
    const std::size_t j = std::size_t(segment.joint);
    const Eigen::VectorXd v = before.jacobian[j] * state.velocity;
    const Vec3 seen = (after.X_WJ[j].translation() - before.X_WJ[j].translation()) / kStep;
    EXPECT_LT((Vec3(v.tail<3>()) - seen).norm(), 1e-4);
  }
}

TEST(Carry, SameInputSameBytes) {
  const CarryModel model = ball_in_sheet(0.08, 1.0 / 60);
  const CarryState a = settled(model, 0.16, 0.5), b = settled(model, 0.16, 0.5);
  EXPECT_TRUE(a.nodes == b.nodes);
  EXPECT_TRUE(a.body.velocity == b.body.velocity);
  EXPECT_EQ(a.forces.pressure, b.forces.pressure);
}

TEST(Carry, FinerSheetIsAsStiff) {
  const auto stiffness_along = [](double spacing) {
    // Energy of one per cent of stretch along x.
    const Sheet sheet = make_sheet(rectangle(1, 1, 0, spacing));
    double energy = 0;
    for (const SheetSpring& spring : sheet.springs) {
      const Vec3 way = (sheet.mesh.V.row(spring.a) - sheet.mesh.V.row(spring.b)).transpose();
      const double longer = (way + 0.01 * way.x() * Vec3::UnitX()).norm() - spring.rest;
      energy += 0.5 * spring.stiffness * longer * longer;
    }
    return energy;
  };
  EXPECT_NEAR(stiffness_along(0.05), stiffness_along(0.1), 0.02 * stiffness_along(0.1));
  EXPECT_NEAR(stiffness_along(0.1), 0.5 * SheetMaterial{}.stiffness * 1e-4,
              0.5 * 0.5 * SheetMaterial{}.stiffness * 1e-4);
}

}  // namespace
}  // namespace ecorche
