// Laws of contact in motion: muscles that a pose presses into one another part, keep their volumes,
// are at rest what they were, follow mirror and rigid motion, and do not jump.
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>

#include <cstring>

#include "anatomy/contact/muscle_model.h"
#include "anatomy/contact/press_outline.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/slice_outline.h"
#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {
// Two flexors of the elbow side by side, 1 mm apart at rest; `mirror` = -1 gives the right arm.
// `size`: of sections and what lies between them.
Anatomy flexors(double mirror = 1, int slices = 13, double size = 1) {
  Anatomy anatomy;
  anatomy.skeleton = arm_skeleton(mirror);
  Joint& elbow = anatomy.skeleton.joints[2];
  elbow.axes = Eigen::DiagonalMatrix<double, 3>(-1, 1, -1) * Mat3::Identity();
  elbow.min = Vec3(-0.01, -0.01, -0.01);
  elbow.max = Vec3(130 * kDegree, 0.01, 0.01);
  for (const double x : {0.16, 0.16 + 0.039 * size}) {
    const auto at = [&](double y, double z) { return Vec3(mirror * x, y, z); };
    Strip strip =
        make_strip({on(1, at(1.42, 0.03)), on(1, at(1.30, 0.035)), on(1, at(1.20, 0.035)),
                    on(2, at(1.10, 0.03)), on(2, at(1.06, 0.02))},
                   spindle(slices, 0.0194 * size, 0.004 * size, 0.1, 0.85, mirror * Vec3::UnitX()));
    strip.belly_begin = 0.1;
    strip.belly_end = 0.85;
    Muscle muscle;
    muscle.name = std::string(x == 0.16 ? "inner" : "outer") + (mirror > 0 ? "_l" : "_r");
    muscle.side = mirror > 0 ? Side::left : Side::right;
    muscle.strips.push_back(strip);
    anatomy.muscles.push_back(muscle);
  }
  return anatomy;
}

PosedAnatomy posed_posed_contact(const Anatomy& anatomy, const Pose& pose) {
  PosedAnatomy out;
  ContactWorkspace workspace;
  pose_muscles(make_muscle_model(anatomy), anatomy.skeleton, pose, out, workspace);
  return out;
}

PosedAnatomy posed_without_contact(const Anatomy& anatomy, const Pose& pose) {
  PosedAnatomy out;
  pose_anatomy(make_posing_table(anatomy), anatomy.skeleton, pose, out);
  return out;
}

Pose bent(const Anatomy& anatomy, double degrees) {
  return arm_pose(anatomy.skeleton, 0, 0, 0, degrees, 0);
}

// Of the drawn surfaces, by lines through them: knows nothing of sections.
double overlap(const Anatomy& anatomy, const PosedAnatomy& p) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, p, positions);
  std::vector<Solid> solids;
  for (const MuscleSurface::Part& part : surface.parts)
    solids.push_back({Solid::Kind::muscle, &positions, &surface.F, part.face_begin, part.face_end});
  return measure_solids(solids, 0.0007).muscle_overlap_share();
}

Vec3 outline_point(const Ellipse& e, int i) {
  const double angle = 2 * std::numbers::pi * i / kOutlinePoints, f = double(e.outline[i]);
  return e.center + f * (e.radii.x() * std::cos(angle) * e.axes.col(0) +
                         e.radii.y() * std::sin(angle) * e.axes.col(1));
}

double part_volumes(const Anatomy& anatomy, const PosedAnatomy& p, std::size_t muscle) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, p, positions);
  return part_volume(surface, surface.parts[muscle], positions);
}

}  // namespace

TEST(PosedContact, MusclesThatSwellIntoOneAnotherPart) {
  const Anatomy anatomy = flexors();
  const double before = overlap(anatomy, posed_without_contact(anatomy, bent(anatomy, 100)));
  const double after = overlap(anatomy, posed_posed_contact(anatomy, bent(anatomy, 100)));
  EXPECT_GT(before, 0.01);
  EXPECT_LT(after, 0.5 * before);
}

TEST(PosedContact, VolumesAreKept) {
  const Anatomy anatomy = flexors();
  const auto ranges = slice_ranges(anatomy);
  const PosedAnatomy rest = posed_posed_contact(anatomy, rest_pose(anatomy.skeleton));
  for (const double degrees : {20.0, 70.0, 125.0}) {
    const PosedAnatomy p = posed_posed_contact(anatomy, bent(anatomy, degrees));
    EXPECT_EQ(p.clamped, 0);
    for (std::size_t m = 0; m < 2; ++m) {
      EXPECT_NEAR(strip_volume(p, ranges[m]) / strip_volume(rest, ranges[m]), 1, 1e-9);
      EXPECT_NEAR(part_volumes(anatomy, p, m) / part_volumes(anatomy, rest, m), 1, 0.02)
          << "round caps are no part of a strip's volume";
    }
  }
}

// Lines close by the joint, and outlines that lean so far to the hollow side of its bend that no
// growth of the belly gives them their volume: they are rounded out when they are posed. The
// neighbour then presses only some of them.
TEST(PosedContact, VolumesAreKeptWhereOutlinesWereRoundedOut) {
  Anatomy anatomy = flexors();
  for (Muscle& muscle : anatomy.muscles) {
    Strip& strip = muscle.strips[0];
    const auto at = [&](double y, double z) { return Vec3(strip.path[0].rest.x(), y, z); };
    strip = make_strip({on(1, at(1.28, 0.03)), on(1, at(1.18, 0.005)), on(2, at(1.12, 0.005)),
                        on(2, at(1.06, 0.02))},
                       spindle(13, 0.0194, 0.004, 0.1, 0.85, Vec3::UnitX()));
    strip.belly_begin = 0.1;
    strip.belly_end = 0.85;
    for (Slice& slice : strip.slices)
      for (std::size_t i = 0; i < kOutlinePoints; ++i)
        slice.outline[i] = outline_directions()[i].y() > 0.5 ? 4.0f : 0.5f;
  }
  const auto ranges = slice_ranges(anatomy);
  const PosedAnatomy rest = posed_posed_contact(anatomy, rest_pose(anatomy.skeleton));
  for (const double degrees : {90.0, 128.0}) {
    const PosedAnatomy alone = posed_without_contact(anatomy, bent(anatomy, degrees)),
                       p = posed_posed_contact(anatomy, bent(anatomy, degrees));
    for (std::size_t m = 0; m < 2; ++m) {
      int pressed = 0, rounded = 0;
      for (int k = ranges[m].begin; k < ranges[m].end; ++k) {
        const std::size_t i = k;
        if (p.slices[i].outline != alone.slices[i].outline)
          ++pressed;
        else if (alone.slices[i].outline != rest.slices[i].outline)
          ++rounded;
      }
      EXPECT_GE(pressed, 1) << "not what this test is about";
      EXPECT_GE(rounded, 2) << "not what this test is about";
      EXPECT_NEAR(strip_volume(p, ranges[m]) / strip_volume(rest, ranges[m]), 1, 2e-6)
          << anatomy.muscles[m].name << " at " << degrees;
    }
  }
}

TEST(PosedContact, RestIsRest) {
  const Anatomy anatomy = flexors();
  const PosedAnatomy with = posed_posed_contact(anatomy, rest_pose(anatomy.skeleton)),
                     without = posed_without_contact(anatomy, rest_pose(anatomy.skeleton));
  for (std::size_t k = 0; k < with.slices.size(); ++k)
    EXPECT_EQ(std::memcmp(&with.slices[k], &without.slices[k], sizeof(Ellipse)), 0)
        << "slice " << k;
}

TEST(PosedContact, MirrorAndRigidMotion) {
  const Anatomy left = flexors(1), right = flexors(-1);
  Pose pose = bent(left, 110);
  const PosedAnatomy a = posed_posed_contact(left, pose),
                     b = posed_posed_contact(right, bent(right, 110));
  const Eigen::DiagonalMatrix<double, 3> flip(-1, 1, 1);
  pose.root = Vec3(2, -1, 0.5);
  pose.rotations[0] = Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()));
  const PosedAnatomy c = posed_posed_contact(left, pose);
  const Transform X = c.X_WJ[0] * a.X_WJ[0].inverse();
  int pressed = 0;
  for (std::size_t k = 0; k < a.slices.size(); ++k) {
    double nearest_sum = 0;
    for (int i = 0; i < kOutlinePoints; ++i) {
      double nearest = 1;
      for (int j = 0; j < kOutlinePoints; ++j)
        nearest = std::min(
            nearest, (flip * outline_point(a.slices[k], i) - outline_point(b.slices[k], j)).norm());
      nearest_sum += nearest;
      EXPECT_LT((X * outline_point(a.slices[k], i) - outline_point(c.slices[k], i)).norm(), 1e-6);
    }
    EXPECT_LT(nearest_sum, 1e-5) << "slice " << k;
    pressed += a.slices[k].outline != kEllipticOutline;
  }
  EXPECT_GE(pressed, 4);
}

TEST(PosedContact, NothingJumps) {
  const Anatomy anatomy = flexors();
  const MuscleModel model = make_muscle_model(anatomy);
  ContactWorkspace workspace;
  PosedAnatomy before, now;
  constexpr double step = 0.25;
  double most = 0;
  for (double degrees = 0; degrees <= 128; degrees += step) {
    pose_muscles(model, anatomy.skeleton, bent(anatomy, degrees), now, workspace);
    if (degrees > 0) {
      for (std::size_t k = 0; k < now.slices.size(); ++k)
        for (int i = 0; i < kOutlinePoints; ++i) {
          // In the section's own plane: what the joint moves is no jump.
          const auto local = [&](const PosedAnatomy& p) {
            return (outline_point(p.slices[k], i) - p.slices[k].center).norm();
          };
          most = std::max(most, std::abs(local(now) - local(before)) / step);
        }
    }
    std::swap(before, now);
  }
  EXPECT_LT(most, 1e-3) << "m a degree";
}

TEST(PosedContact, SameBytesAtAnyNumberOfThreadsAndAfterAnyHistory) {
  const Anatomy anatomy = flexors();
  const MuscleModel model = make_muscle_model(anatomy);
  PosedAnatomy fresh, used;
  ContactWorkspace workspace, own;
  pose_muscles(model, anatomy.skeleton, bent(anatomy, 15), used, workspace, 2);
  pose_muscles(model, anatomy.skeleton, bent(anatomy, 120), used, workspace, 2);
  pose_muscles(model, anatomy.skeleton, bent(anatomy, 120), fresh, own, 1);
  EXPECT_EQ(
      std::memcmp(fresh.slices.data(), used.slices.data(), fresh.slices.size() * sizeof(Ellipse)),
      0);
}

namespace {

bool same_slices(const PosedAnatomy& a, const PosedAnatomy& b) {
  return a.slices.size() == b.slices.size() &&
         std::memcmp(a.slices.data(), b.slices.data(), a.slices.size() * sizeof(Ellipse)) == 0;
}

// So many that threads share them, two by two, 0.1 m apart; the first `thin` pairs a fifth as
// thick.
Anatomy many_flexors(int thin = 0) {
  const Anatomy two = flexors(1, 60), thin_two = flexors(1, 60, 0.2);
  Anatomy all = two;
  all.muscles.clear();
  for (int i = 0; i < 12; ++i)
    for (Muscle muscle : (i < thin ? thin_two : two).muscles) {
      for (PathPoint& p : muscle.strips[0].path) p.rest.x() += 0.1 * i;  // along the hinge
      muscle.name = "pair_" + std::to_string(i) + "_" + muscle.name;
      all.muscles.push_back(muscle);
    }
  return all;
}

// The outer muscle moved towards the inner one, as the skin might move it.
PosedAnatomy moved(const Anatomy& anatomy, const MuscleModel& model, double degrees, double way) {
  PosedAnatomy out;
  ContactWorkspace workspace;
  pose_muscles(model, anatomy.skeleton, bent(anatomy, degrees), out, workspace);
  const SliceRange outer = slice_ranges(anatomy)[1];
  for (int k = outer.begin; k < outer.end; ++k) out.slices[k].center.x() -= way;
  return out;
}

}  // namespace

TEST(PosedContact, SameBytesOnAllCores) {
  const Anatomy anatomy = many_flexors();
  const MuscleModel model = make_muscle_model(anatomy);
  ASSERT_GE(model.contact.all.blocks.size(), 4u) << "too few for several threads";
  PosedAnatomy one, all;
  ContactWorkspace workspace[2];
  pose_muscles(model, anatomy.skeleton, bent(anatomy, 110), one, workspace[0], 1);
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  pose_muscles(model, anatomy.skeleton, bent(anatomy, 110), all, workspace[1], 4);
  EXPECT_TRUE(same_slices(one, all));
  ContactState state[2];
  for (PosedAnatomy* posed_posed_contact : {&one, &all})
    for (Ellipse& slice : posed_posed_contact->slices) slice.center.x() *= 0.97;
  resolve_muscle_contact(model.contact, model.posing, {}, one, state[0], workspace[0],
                         Threads::one);
  resolve_muscle_contact(model.contact, model.posing, {}, all, state[1], workspace[1],
                         Threads::all);
  EXPECT_TRUE(same_slices(one, all));
  EXPECT_EQ(state[0].depth, state[1].depth);
  resolve_deep_contact(model.contact, model.posing, {}, one, state[0], workspace[0], Threads::one);
  resolve_deep_contact(model.contact, model.posing, {}, all, state[1], workspace[1], Threads::all);
  EXPECT_TRUE(same_slices(one, all));
}

TEST(PosedContact, WhatIsMovedIntoAnotherPartsAgainAndKeepsItsVolume) {
  const Anatomy anatomy = flexors();
  const MuscleModel model = make_muscle_model(anatomy);
  const auto ranges = slice_ranges(anatomy);
  const PosedAnatomy rest = posed_posed_contact(anatomy, rest_pose(anatomy.skeleton));
  const PosedAnatomy still = moved(anatomy, model, 100, 0.008);
  PosedAnatomy p = still;
  const double before = overlap(anatomy, p);
  ContactState state;
  ContactWorkspace workspace;
  resolve_muscle_contact(model.contact, model.posing, {}, p, state, workspace, Threads::one);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(overlap(anatomy, p), 0.6 * before);
  for (const SliceRange& range : ranges)
    EXPECT_NEAR(strip_volume(p, range) / strip_volume(rest, range), 1, 1e-9);
  for (std::size_t k = 0; k < p.slices.size(); ++k)
    EXPECT_GT(piece_areas(p.slices[k].outline, p.slices[k].outline).own,
              0.59 * piece_areas(still.slices[k].outline, still.slices[k].outline).own);
}

// Pairs of flexors at rest, whose outer ones may be moved.
struct RestingFlexors {
  explicit RestingFlexors(int thin)
      : anatomy(many_flexors(thin)),
        model(make_muscle_model(anatomy)),
        ranges(slice_ranges(anatomy)) {
    ContactWorkspace workspace;
    pose_muscles(model, anatomy.skeleton, rest_pose(anatomy.skeleton), p, workspace);
  }

  void move_outer(std::size_t pair, double way) {
    for (int k = ranges[2 * pair + 1].begin; k < ranges[2 * pair + 1].end; ++k)
      p.slices[k].center.x() -= way;
  }

  Anatomy anatomy;
  MuscleModel model;
  std::vector<SliceRange> ranges;
  PosedAnatomy p;
};

TEST(PosedContact, WhatWasDeepPartsOnceMoreAndNothingElse) {
  RestingFlexors resting(0);
  auto& [anatomy, model, ranges, p] = resting;
  constexpr std::size_t kDeep = 3;  // pairs; the others lie as at rest
  for (std::size_t pair = 0; pair < kDeep; ++pair) resting.move_outer(pair, 0.006);
  ContactState state;
  ContactWorkspace workspace;
  resolve_muscle_contact(model.contact, model.posing, {}, p, state, workspace, Threads::one);
  for (std::size_t pair = 0; pair < kDeep; ++pair) resting.move_outer(pair, 0.012);
  resting.move_outer(kDeep, 0.004);
  const PosedAnatomy once = p;
  const double before = overlap(anatomy, p);
  std::vector<char> selected;
  select_deep_members(model.contact.all, state, selected);
  resolve_deep_contact(model.contact, model.posing, {}, p, state, workspace, Threads::one);
  EXPECT_LT(overlap(anatomy, p), 0.95 * before);
  for (std::size_t m = 0; m < ranges.size(); ++m) {
    int changed = 0;
    for (int k = ranges[m].begin; k < ranges[m].end; ++k) {
      const std::size_t i = k;
      changed += p.slices[i].outline != once.slices[i].outline;
    }
    EXPECT_EQ(changed > 0, m < 2 * kDeep) << "muscle " << m << ": only pairs that were deep before";
    EXPECT_NEAR(strip_volume(p, ranges[m]) / strip_volume(once, ranges[m]), 1, 1e-9);
  }
  const std::vector<ContactMember>& members = model.contact.all.members;
  int looked_at = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const bool moved = members[i].section < ranges[2 * kDeep].begin;
    looked_at += selected[i];
    EXPECT_FALSE(selected[i] && !moved)
        << "section " << members[i].section << ": only those and what they may meet are looked at";
  }
  EXPECT_GT(looked_at, 0);
}

TEST(PosedContact, DeepContactNeedsTheStateOfAPassBefore) {
  RestingFlexors resting(0);
  ContactState state;
  ContactWorkspace workspace;
  EXPECT_THROW(resolve_deep_contact(resting.model.contact, resting.model.posing, {}, resting.p,
                                    state, workspace, Threads::one),
               std::invalid_argument);
}

TEST(PosedContact, WhatHasLittleToGivePartsOnceAlone) {
  RestingFlexors resting(1);
  auto& [anatomy, model, ranges, p] = resting;
  ContactState state;
  ContactWorkspace workspace;
  // Sections of the thin pair and of the next one, which move by so much for their size.
  const auto changed = [&](const auto& resolve) {
    resting.move_outer(0, 0.0009);
    resting.move_outer(1, 0.0045);
    const PosedAnatomy before = p;
    resolve(model.contact, model.posing, std::span<const RadialSamples>(), p, state, workspace,
            Threads::one);
    std::array<int, 2> out{};
    for (std::size_t m = 0; m < 4; ++m)
      for (int k = ranges[m].begin; k < ranges[m].end; ++k)
        out[m / 2] += p.slices[k].outline != before.slices[k].outline;
    return out;
  };
  const auto [thin, thick] = changed(resolve_muscle_contact);
  EXPECT_GT(thin, 5);
  EXPECT_GT(thick, 5);
  const auto [thin_again, thick_again] = changed(resolve_deep_contact);
  EXPECT_EQ(thin_again, 0);
  EXPECT_GT(thick_again, 3);
}

TEST(PosedContact, ASideGrowsTheLessTheLongerItIs) {
  RadialSamples press{}, held{};
  press[2] = 0.5f;
  held[2] = 1;
  double before = 1;
  for (const float length : {1.2f, 1.5f, 1.8f, 4.0f}) {
    SliceOutline flat = kEllipticOutline;
    flat[0] = flat[8] = length;
    SliceOutline now = flat;
    press_outline(press, held, now);
    const double even = std::sqrt(piece_areas(flat, flat).own), share = now[12] / flat[12] - 1,
                 grown = (now[0] - flat[0]) / (even * share);
    ASSERT_GT(share, 0.01);
    EXPECT_LT(grown, before) << "an even outline's growth is 1, one in proportion would be "
                             << length;
    EXPECT_EQ(grown > 0, length < 2 * even);
    before = grown;
  }
}

TEST(PosedContact, WhatIsPressedAgainAndAgainDoesNotStickOut) {
  RadialSamples press{}, held{};
  press.fill(0.3f);
  held.fill(1);
  press[2] = held[2] = 0;
  SliceOutline now = kEllipticOutline;
  for (int turn = 0; turn < 8; ++turn) {
    press_outline(press, held, now, 0.6f);
    EXPECT_LT(now[4], 2.1f) << "turn " << turn;
  }
}

TEST(PosedContact, WhatHasNotBeenMovedAtRestStays) {
  const Anatomy anatomy = flexors();
  const MuscleModel model = make_muscle_model(anatomy);
  const PosedAnatomy rest = posed_posed_contact(anatomy, rest_pose(anatomy.skeleton));
  PosedAnatomy p = rest;
  ContactState state;
  ContactWorkspace workspace;
  resolve_muscle_contact(model.contact, model.posing, {}, p, state, workspace, Threads::one);
  EXPECT_TRUE(same_slices(p, rest));
}

TEST(PosedContact, SectionsThatAreHeldDoNotGrowThere) {
  const Anatomy anatomy = flexors();
  const MuscleModel model = make_muscle_model(anatomy);
  const SliceRange inner = slice_ranges(anatomy)[0];
  RadialSamples all_round;
  all_round.fill(1);
  const std::vector<RadialSamples> blocked(model.posing.slices(), all_round);
  const PosedAnatomy before = moved(anatomy, model, 100, 0.008);
  PosedAnatomy p = before;
  ContactState state;
  ContactWorkspace workspace;
  resolve_muscle_contact(model.contact, model.posing, blocked, p, state, workspace, Threads::one);
  int pressed = 0;
  for (int k = inner.begin; k < inner.end; ++k)
    for (std::size_t i = 0; i < kOutlinePoints; ++i) {
      const float now = p.slices[k].outline[i], then = before.slices[k].outline[i];
      EXPECT_LE(now, then + 1e-6f);
      pressed += now < then - 1e-3f;
    }
  EXPECT_GE(pressed, 4);
}
