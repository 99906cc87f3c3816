// Laws of fascia: the table has two sides, mirrored, and bad lines get exact errors; a sheet lies
// where it was laid at rest, goes with what carries it, and is raised out of a section that swells.
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "anatomy/authoring/fascia_table.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/fascia_again.h"
#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/muscles/thinned_fascia.h"
#include "tests/anatomy/source_skeleton.h"
#include "tests/anatomy/strips.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

MuscleTable one_landmark() {
  MuscleTable table;
  read_landmark_text("id,bone,left_mm,up_mm,front_mm,rule\nhere,femur,80,500,-100,x\n", "l.csv",
                     table);
  return table;
}

const char* kGood =
    "fascia band\n"
    "  label a band\n"
    "  group thigh\n"
    "  thickness 2\n"
    "  row\n"
    "    point here\n"
    "    point here 10 0 0\n"
    "  row\n"
    "    point here 0 -20 0\n"
    "    point here 10 -20 0\n";

std::string changed(const std::string& from, const std::string& to) {
  std::string text = kGood;
  text.replace(text.find(from), from.size(), to);
  return text;
}

std::string error_of(const std::string& text) {
  try {
    read_fascia_text(text, "f.txt", one_landmark());
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(FasciaTable, ReadsWhatItsPageSays) {
  const auto sheets = read_fascia_text(kGood, "f.txt", one_landmark());
  ASSERT_EQ(sheets.size(), 1u);
  EXPECT_EQ(sheets[0].label, "a band");
  EXPECT_DOUBLE_EQ(sheets[0].thickness, 2e-3);
  EXPECT_EQ(sheets[0].rows, 2);
  EXPECT_EQ(sheets[0].columns, 2);
  EXPECT_NEAR(sheets[0].points[3].offset.y(), -0.02, 1e-12);
}

TEST(FasciaTable, BadLinesAreNamed) {
  EXPECT_EQ(error_of(changed("point here\n", "point there\n")),
            "f.txt:6: band: unknown landmark 'there'; data/landmarks lists them");
  EXPECT_EQ(error_of(changed("thickness 2", "thickness 200")),
            "f.txt:4: band: thickness in mm: 200 is not within 0.1 .. 20");
  EXPECT_EQ(
      error_of(changed("    point here 10 -20 0\n", "")),
      "f.txt:9: band: row 2 has 1 points, the first 2; rows have the same number, two or more");
  EXPECT_EQ(error_of(changed("  label a band\n", "")), "f.txt:9: band: no 'label'");
  EXPECT_EQ(error_of(changed("group thigh", "colour red")),
            "f.txt:3: band: unknown keyword 'colour'");
  EXPECT_EQ(error_of("row\n"), "f.txt:1: 'row' outside a sheet; expected fascia");
  EXPECT_EQ(error_of(std::string(kGood) + kGood), "f.txt:11: band: the sheet is given twice");
}

TEST(FasciaTable, RightIsTheMirrorImageOfLeft) {
  NEED_SOURCE_SKELETON(source);
  const MuscleTable landmarks = read_muscle_table(test_assets().tables);
  const auto plans =
      place_fascia(read_fascia_table(test_assets().tables, landmarks), landmarks, source);
  EXPECT_GE(plans.size(), 20u);
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const FasciaPlan& plan = plans[i];
    ASSERT_EQ(plan.points.size(), std::size_t(plan.rows * plan.columns)) << plan.name;
    if (plan.side == Side::left) {
      for (std::size_t k = 0; k < plan.points.size(); ++k)
        EXPECT_LT((plans[i + 1].points[k].rest - mirror_point(plan.points[k].rest)).norm(), 1e-9)
            << plan.name;
    } else if (plan.side == Side::middle) {
      for (const std::string& bone : plan.bones) EXPECT_FALSE(bone.ends_with("_l")) << plan.name;
      for (int r = 0; r < plan.rows; ++r)
        for (int c = 0; c < plan.columns; ++c) {
          const auto at = [&](int column) {
            return plan.points[std::size_t(r * plan.columns + column)].rest;
          };
          EXPECT_LT((at(c) - mirror_point(at(plan.columns - 1 - c))).norm(), 1e-9) << plan.name;
        }
    }
  }
}

// A sheet of both sides that one side's bone carries would follow that side alone.
TEST(FasciaTable, BonesOfOneSideCarryNoSheetOfBoth) {
  NEED_SOURCE_SKELETON(source);
  const auto place = [&](const std::string& bone) {
    const std::string on = "  middle\n  on " + bone + "\n  row\n";
    place_fascia(read_fascia_text(changed("  row\n", on), "f.txt", one_landmark()), one_landmark(),
                 source);
  };
  EXPECT_THROW(place("femur"), InputError);
  EXPECT_NO_THROW(place("t7"));
}

// Two joints 0.4 m apart, a bone on each, a round muscle of 20 mm between them along y, and a sheet
// on its front.
Anatomy figure(bool on_bones) {
  Anatomy anatomy;
  for (const double height : {1.0, 0.6}) {
    Joint joint;
    joint.name = height > 0.8 ? "upper" : "lower";
    joint.parent = height > 0.8 ? -1 : 0;
    joint.X_PJ.translation() = height > 0.8 ? Vec3(0, 1, 0) : Vec3(0, -0.4, 0);
    anatomy.skeleton.joints.push_back(joint);
    Bone bone;
    bone.name = joint.name;
    bone.joint = int(anatomy.skeleton.joints.size()) - 1;
    bone.mesh.V.resize(3, 3);
    bone.mesh.V << -0.01, height, 0, 0.01, height, 0, 0, height, 0.01;
    bone.mesh.F.resize(1, 3);
    bone.mesh.F << 0, 1, 2;
    anatomy.bones.push_back(bone);
  }
  Muscle muscle;
  muscle.name = "round";
  std::vector<PathPoint> path{{Vec3(0, 1, 0), {0, -1}, 1}, {Vec3(0, 0.6, 0), {1, -1}, 1}};
  std::vector<Station> stations;
  for (int k = 0; k <= 20; ++k) {
    Station station;
    station.s = k / 20.0;
    station.width = Vec3::UnitX();
    station.radii = Vec2::Constant(0.02);
    stations.push_back(station);
  }
  muscle.strips.push_back(make_strip(path, stations));
  anatomy.muscles.push_back(muscle);
  FasciaSheet sheet;
  sheet.name = "sheet";
  sheet.rows = 9;
  sheet.columns = 5;
  sheet.V.resize(45, 3);
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 5; ++c) {
      const double angle = (c - 2) * 0.2;
      sheet.V.row(5 * r + c) << -0.021 * std::sin(angle), 0.9 - 0.025 * r, 0.021 * std::cos(angle);
    }
  sheet.belly.assign(45, 0);
  if (on_bones) sheet.bones = {"upper", "lower"};
  anatomy.fascia.push_back(sheet);
  return anatomy;
}

PosedAnatomy at_rest(const Anatomy& anatomy) {
  PosedAnatomy posed;
  for (const Vec3& joint : rest_positions(anatomy.skeleton)) {
    posed.X_WJ.push_back(Transform::Identity());
    posed.X_WJ.back().translation() = joint;
  }
  posed.slices = rest_slices(anatomy);
  return posed;
}

TEST(FasciaSurface, LiesWhereItWasLaidAtRest) {
  for (const bool on_bones : {false, true}) {
    const Anatomy anatomy = figure(on_bones);
    validate(anatomy);
    PointsF at, normals;
    update_fascia_surface(make_fascia_surface(anatomy), at_rest(anatomy), at, &normals);
    EXPECT_LT((at.cast<double>() - anatomy.fascia[0].V).rowwise().norm().maxCoeff(), 1e-6);
    EXPECT_GT(normals.col(2).minCoeff(), 0.5f);
  }
}

TEST(FasciaSurface, IsCarriedRigidlyByWhatMovesRigidly) {
  const Anatomy anatomy = figure(false);
  PosedAnatomy posed = at_rest(anatomy);
  Transform move = Transform::Identity();
  move.translate(Vec3(0.3, -0.2, 0.1)).rotate(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()));
  for (Transform& joint : posed.X_WJ) joint = move * joint;
  for (Ellipse& slice : posed.slices) {
    slice.center = move * slice.center;
    slice.axes = move.linear() * slice.axes;
  }
  PointsF at;
  update_fascia_surface(make_fascia_surface(anatomy), posed, at);
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    const Vec3 wanted = move * Vec3(anatomy.fascia[0].V.row(i));
    EXPECT_LT((at.row(i).transpose().cast<double>() - wanted).norm(), 1e-5);
  }
}

TEST(FasciaSurface, StandsOutOfAMuscleThatSwells) {
  const Anatomy anatomy = figure(false);
  PosedAnatomy posed = at_rest(anatomy);
  for (Ellipse& slice : posed.slices) slice.radii *= 1.4;
  PointsF at;
  update_fascia_surface(make_fascia_surface(anatomy), posed, at);
  for (Eigen::Index i = 0; i < at.rows(); ++i)
    EXPECT_GT(std::hypot(at(i, 0), at(i, 2)), 0.028f - 2e-4f) << i;
}

TEST(FasciaLift, IsTheWayOutOfARoundStripAlongADirection) {
  const std::vector<Ellipse> sections = rest_slices(figure(true));  // a cylinder of 20 mm
  for (const double off : {0.0, 0.005, 0.015})
    for (const double deep : {0.001, 0.008, 0.015}) {
      const double edge = std::sqrt(0.02 * 0.02 - off * off);
      EXPECT_NEAR(height_over_strip(sections, Vec3(off, 0.8, edge - deep), Vec3::UnitZ()), deep,
                  4e-4)
          << off << " " << deep;  // outlines are polygons
    }
  EXPECT_EQ(height_over_strip(sections, Vec3(0, 0.8, 0.0205), Vec3::UnitZ()), 0);
  EXPECT_EQ(height_over_strip(sections, Vec3(0, 1.1, 0), Vec3::UnitZ()), 0) << "beyond its end";
  EXPECT_EQ(height_over_strip(sections, Vec3(0, 0.8, 0), Vec3::UnitY()), 0) << "along the strip";
  EXPECT_EQ(height_over_strip(sections, Vec3(0, 0.8, -0.019), Vec3::UnitZ()), kMostFasciaLift);
}

TEST(FasciaSurface, RisesOverAMuscleThatComesOutThroughIt) {
  const Anatomy anatomy = figure(true);  // bones carry the sheet
  const FasciaSurface surface = make_fascia_surface(anatomy);
  PosedAnatomy posed = at_rest(anatomy);
  for (Ellipse& slice : posed.slices)  // a bulge that ends above the sheet's last rows
    slice.center.z() += 0.008 * std::clamp((slice.center.y() - 0.72) / 0.04, 0.0, 1.0);
  PointsF at;
  update_fascia_surface(surface, posed, at);
  double highest = 0;
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    if (at(i, 1) > 0.77f) {
      EXPECT_GT(std::hypot(at(i, 0), at(i, 2) - 0.008f), 0.019f) << i;
    }
    highest = std::max(highest, double(at(i, 2)) - anatomy.fascia[0].V(i, 2));
  }
  EXPECT_LT(highest, 0.011);
}

TEST(FasciaSurface, BetweenTwoBonesIsDrawnStraight) {
  const Anatomy anatomy = figure(true);
  PosedAnatomy posed = at_rest(anatomy);
  posed.X_WJ[1].translation() += Vec3(0, 0, 0.2);  // the lower bone goes to the front
  PointsF at;
  update_fascia_surface(make_fascia_surface(anatomy), posed, at);
  float before = 0;
  for (int r = 0; r < 9; ++r) {
    const float forward = at(5 * r + 2, 2) - 0.021f, share = forward / 0.2f,
                along = (0.1f + 0.025f * float(r)) / 0.4f;
    EXPECT_NEAR(share, along, 0.03f) << r;
    EXPECT_GT(share, before);
    before = share;
  }
}

// Two bones with round ends, one over the other, and a sleeve about both.
Anatomy hinge() {
  Anatomy anatomy;
  for (const double height : {0.02, -0.02}) {
    Joint joint;
    joint.name = height > 0 ? "upper" : "lower";
    joint.parent = height > 0 ? -1 : 0;
    anatomy.skeleton.joints.push_back(joint);
    Bone bone;
    bone.name = joint.name;
    bone.joint = int(anatomy.skeleton.joints.size()) - 1;
    bone.mesh.V.resize(13 * 24, 3);
    for (int r = 0; r < 13; ++r)
      for (int c = 0; c < 24; ++c) {
        const double a = std::numbers::pi * r / 12, b = 2 * std::numbers::pi * c / 24;
        bone.mesh.V.row(24 * r + c) << 0.019 * std::sin(a) * std::cos(b),
            height + 0.019 * std::cos(a), 0.019 * std::sin(a) * std::sin(b);
      }
    bone.mesh.F = grid_triangles(13, 24);
    anatomy.bones.push_back(bone);
  }
  FasciaSheet sheet;
  sheet.name = "sleeve";
  sheet.bones = {"upper", "lower"};
  sheet.rows = 9;
  sheet.columns = 25;
  sheet.V.resize(9 * 25, 3);
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 25; ++c) {
      const double turn = 2 * std::numbers::pi * (c % 24) / 24;
      sheet.V.row(25 * r + c) << 0.02 * std::sin(turn), 0.02 - 0.005 * r, 0.02 * std::cos(turn);
    }
  sheet.belly.assign(9 * 25, 0);
  anatomy.fascia.push_back(sheet);
  return anatomy;
}

PosedAnatomy bent(const Anatomy& anatomy, double angle) {
  PosedAnatomy posed = at_rest(anatomy);
  posed.X_WJ[1].rotate(Eigen::AngleAxisd(angle, Vec3::UnitX()));
  return posed;
}

TEST(FasciaSurface, ASleeveIsOneWithoutASeam) {
  const Anatomy anatomy = hinge();
  EXPECT_TRUE(is_sleeve(anatomy.fascia[0]));
  EXPECT_FALSE(is_sleeve(figure(true).fascia[0]));
  EXPECT_EQ(cells_from_edge(9, 25, 25 * 4, true), 4);
  EXPECT_EQ(cells_from_edge(9, 25, 25 * 4, false), 0);
  PointsF at, normals;
  update_fascia_surface(make_fascia_surface(anatomy), bent(anatomy, 1), at, &normals);
  for (int r = 0; r < 9; ++r) {
    EXPECT_EQ(at.row(25 * r), at.row(25 * r + 24));
    EXPECT_EQ(normals.row(25 * r), normals.row(25 * r + 24));
    EXPECT_NEAR(normals.row(25 * r).norm(), 1, 1e-5);
  }
}

TEST(FasciaSurface, ASleeveEndsOnItsBonesAndLiesWhereItWasLaid) {
  const Anatomy anatomy = hinge();
  const FasciaSurface surface = make_fascia_surface(anatomy);
  const auto rest = anatomy.fascia[0].V.cast<float>();
  PointsF at;
  update_fascia_surface(surface, at_rest(anatomy), at);
  EXPECT_LT((at - rest).rowwise().norm().maxCoeff(), 1e-6f);
  const PosedAnatomy posed = bent(anatomy, 1.2);
  update_fascia_surface(surface, posed, at);
  for (int c = 0; c < 25; ++c) {
    EXPECT_LT((at.row(c) - rest.row(c)).norm(), 1e-6f);
    const Vec3 last = posed.X_WJ[1] * Vec3(anatomy.fascia[0].V.row(8 * 25 + c));
    EXPECT_LT((at.row(8 * 25 + c).transpose().cast<double>() - last).norm(), 1e-6);
  }
}

TEST(FasciaSurface, ASleeveIsPushedOutOfBentBones) {
  const Anatomy anatomy = hinge();
  const FasciaSurface surface = make_fascia_surface(anatomy);
  PointsF at;
  for (const double angle : {-1.2, -0.7, 0.7, 1.2}) {
    update_fascia_surface(surface, bent(anatomy, angle), at);
    for (int i = 25; i < 8 * 25; ++i) {
      // what lay over a ball at rest does not sink into it; the balls are round, seen from between
      const Eigen::Vector3f p = at.row(i);
      const double upper = (p.cast<double>() - Vec3(0, 0.02, 0)).norm();
      EXPECT_GT(upper, 0.0165) << angle << ' ' << i;
    }
  }
}

// The point of `fine` that is nearest to each of `coarse`, and how far that is.
double farthest_from(const PointsF& coarse, const PointsF& fine) {
  double most = 0;
  for (Eigen::Index i = 0; i < coarse.rows(); ++i)
    most = std::max(most, double((fine.rowwise() - coarse.row(i)).rowwise().norm().minCoeff()));
  return most;
}

TEST(ThinnedFascia, IsPointsOfTheSameSheetsThatGoAsTheyDid) {
  for (const bool sleeve : {false, true}) {
    const Anatomy anatomy = sleeve ? hinge() : figure(true);
    const FasciaSurface fine = make_fascia_surface(anatomy),
                        coarse = thinned_fascia(fine, sleeve ? 0.02 : 0.06);
    ASSERT_EQ(coarse.parts.size(), fine.parts.size());
    EXPECT_LT(3 * coarse.vertices(), fine.vertices());
    EXPECT_LT(coarse.F.maxCoeff(), coarse.vertices());
    EXPECT_EQ(coarse.parts[0].face_end, coarse.F.rows());
    const PosedAnatomy posed = bent(anatomy, 0.7);
    PointsF at, all, normals;
    update_fascia_surface(fine, posed, all);
    update_fascia_surface(coarse, posed, at, &normals);
    EXPECT_LT(farthest_from(at, all), 1e-6);
    EXPECT_LT((at.row(0) - all.row(0)).norm(), 1e-6);  // its corners stay
    EXPECT_LT((at.bottomRows(1) - all.bottomRows(1)).norm(), 1e-6);
    EXPECT_NEAR(normals.rowwise().norm().minCoeff(), 1, 1e-5);
  }
}

TEST(ThinnedFascia, RisesOverAMuscleAsItDid) {
  const Anatomy anatomy = figure(true);
  const FasciaSurface fine = make_fascia_surface(anatomy);
  PosedAnatomy posed = at_rest(anatomy);
  for (Ellipse& slice : posed.slices) slice.center.z() += 0.008;
  PointsF at, all;
  update_fascia_surface(fine, posed, all);
  update_fascia_surface(thinned_fascia(fine, 0.01), posed, at);
  EXPECT_GT(at.col(2).maxCoeff(), 0.026f);
  EXPECT_LT(farthest_from(at, all), 1e-3);
}

// The figure, another of its kind far to the side, and a sleeve.
Anatomy two_figures() {
  Anatomy out = figure(false);
  Muscle far = out.muscles.front();
  far.name = "far";
  for (PathPoint& point : far.strips[0].path) point.rest.x() += 0.5;
  out.muscles.push_back(far);
  FasciaSheet sheet = out.fascia.front();
  sheet.name = "far sheet";
  sheet.V.col(0).array() += 0.5;
  out.fascia.push_back(sheet);
  FasciaSheet sleeve = hinge().fascia.front();
  sleeve.V.col(1).array() += 0.8;
  out.fascia.push_back(sleeve);
  sheet.name = "over both";
  sheet.bones = {"upper", "lower"};
  out.fascia.push_back(sheet);
  sheet.name = "band";  // the sleeve's bones push it
  sheet.bones = {"upper", "lower", "third"};
  out.bones.push_back(out.bones.back());
  out.bones.back().name = "third";
  out.bones.back().mesh.V.col(1).array() -= 0.1;
  out.fascia.push_back(sheet);
  return out;
}

void expect_same(const FasciaSurface& a, const FasciaSurface& b) {
  EXPECT_EQ(a.term_begin, b.term_begin);
  ASSERT_EQ(a.terms.size(), b.terms.size());
  for (std::size_t t = 0; t < a.terms.size(); ++t) {
    const FasciaSurface::Term &x = a.terms[t], &y = b.terms[t];
    EXPECT_EQ(x.carrier, y.carrier) << t;
    EXPECT_EQ(x.weight, y.weight) << t;
    EXPECT_EQ(x.at, y.at) << t;
    EXPECT_EQ(x.outline, y.outline) << t;
    EXPECT_EQ(x.out, y.out) << t;
  }
  EXPECT_EQ(a.F, b.F);
  EXPECT_EQ(a.along, b.along);
  EXPECT_EQ(a.across, b.across);
  EXPECT_EQ(a.clearances, b.clearances);
  EXPECT_EQ(a.reaches.size(), b.reaches.size());
  EXPECT_EQ(a.lift.begin, b.lift.begin);
  ASSERT_EQ(a.lift.covers.size(), b.lift.covers.size());
  for (std::size_t k = 0; k < a.lift.covers.size(); ++k) {
    EXPECT_EQ(a.lift.covers[k].begin, b.lift.covers[k].begin) << k;
    EXPECT_EQ(a.lift.covers[k].end, b.lift.covers[k].end) << k;
    EXPECT_EQ(a.lift.covers[k].rest, b.lift.covers[k].rest) << k;
  }
  for (std::size_t n = 0; n < a.parts.size(); ++n) {
    EXPECT_EQ(a.parts[n].sheet, b.parts[n].sheet) << n;
    EXPECT_EQ(a.parts[n].vertex_begin, b.parts[n].vertex_begin) << n;
    EXPECT_EQ(a.parts[n].reaches, b.parts[n].reaches) << n;
    EXPECT_EQ(a.parts[n].push_begin, b.parts[n].push_begin) << n;
  }
}

TEST(FasciaAgain, IsAsMadeAnewWhereMusclesOrSheetsHaveChanged) {
  const Anatomy before = two_figures();
  const FasciaSurface surface = make_fascia_surface(before);
  ASSERT_FALSE(surface.parts[2].reaches.empty());
  EXPECT_EQ(surface.parts.back().reaches, surface.parts[2].reaches);
  const auto expect_alike = [&](const Anatomy& now) {
    expect_same(make_fascia_again(now, {&before, &surface}), make_fascia_surface(now));
  };
  expect_alike(before);
  Anatomy now = before;
  for (Slice& slice : now.muscles.back().strips[0].slices) slice.radii *= 1.2;
  expect_alike(now);
  now.muscles.insert(now.muscles.begin(), now.muscles.back());  // others have other numbers
  now.muscles.front().name = "new";
  for (PathPoint& point : now.muscles.front().strips[0].path) point.rest.x() += 0.01;
  expect_alike(now);
  now = before;
  now.muscles.erase(now.muscles.begin());
  now.fascia.pop_back();
  expect_alike(now);
  now = before;
  now.fascia[2].V.col(2).array() += 1e-3;  // the sleeve
  expect_alike(now);
  now.fascia.erase(now.fascia.begin() + 2);
  expect_alike(now);
  now = before;
  now.bones[1].mesh.V.col(2).array() += 1e-3;
  expect_alike(now);
}

TEST(FasciaSurface, GridsThatAreNoneAreRefused) {
  Anatomy anatomy = figure(false);
  anatomy.fascia[0].rows = 8;
  EXPECT_THROW(validate(anatomy), std::invalid_argument);
  anatomy = figure(true);
  anatomy.fascia[0].bones = {"nobody"};
  EXPECT_THROW(validate(anatomy), std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
