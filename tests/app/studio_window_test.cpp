// What the studio's window stands on, without a display: muscles that go along at once, names that
// are found, drags that become actions, sessions that are played.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "anatomy/muscles/action_line.h"
#include "app/edit/refit.h"
#include "app/studio/design/muscle_list.h"
#include "app/studio/design/script_panel.h"
#include "app/studio/design/shape_handles.h"
#include "app/studio/handles/bone_clicks.h"
#include "app/studio/handles/give_way.h"
#include "app/studio/handles/handles.h"
#include "app/studio/handles/limit_arcs.h"
#include "app/studio/handles/live_muscles.h"
#include "tests/test_assets.h"
#include "viewer/organ_rooms.h"
#include "viewer/scene.h"
#include "viewer/window/recorded_input.h"
#include "viewer/window/window_tool.h"

namespace ecorche {
namespace {

Strip straight(double length, double radius) {
  std::vector<PathPoint> path(3);
  for (int i = 0; i < 3; ++i) path[std::size_t(i)].rest = Vec3(0, 0.5 * length * i, 0);
  std::vector<Station> stations;
  for (int k = 0; k < 9; ++k)
    stations.push_back({k / 8.0, Vec3::Zero(), Vec3::UnitX(), Vec2(radius, 0.7 * radius)});
  return make_strip(path, stations);
}

Muscle spindle(double length, double radius) {
  Muscle muscle;
  muscle.name = "spindle_l";
  muscle.side = Side::left;
  muscle.volume = 1e-4;
  muscle.strips = {straight(length, radius)};
  return muscle;
}

Muscle grown(Muscle muscle) {
  Strip& strip = muscle.strips.front();
  for (PathPoint& point : strip.path) point.rest += Vec3(0.002, 0.001, -0.003);
  for (Slice& slice : strip.slices) {
    slice.radii *= 1.4;
    slice.roll += 0.2;
    slice.offset += Vec2(0.001, 0.002);
    slice.outline[3] = 1.2f;
  }
  muscle.volume *= 1.9;
  return muscle;
}

// A straight muscle along y, and what it is after a change.
std::vector<MovedSection> moved_by(const Vec3& step, double wider) {
  std::vector<MovedSection> out;
  for (const Ellipse& section : rest_slices(straight(0.3, 0.02))) {
    Ellipse now = section;
    now.center += step;
    now.radii.array() += wider;
    out.push_back({section, now});
  }
  return out;
}

TEST(GivingWay, WhatTouchesAMuscleGoesWithItsSurface) {
  for (const Vec3f& side : {Vec3f(1, 0, 0), Vec3f(-1, 0, 0)}) {
    const Vec3f place = Vec3f(0, 0.15f, 0) + 0.021f * side;
    const Vec3f wider = given_way(moved_by(Vec3::Zero(), 0.005), place);
    EXPECT_LT((wider - 0.005f * side).norm(), 0.4e-3f) << wider.transpose();
    const Vec3f moved = given_way(moved_by(Vec3(0.006, 0, 0), 0), place);
    EXPECT_LT((moved - Vec3f(0.006f, 0, 0)).norm(), 0.4e-3f) << moved.transpose();
  }
  EXPECT_EQ(given_way(moved_by(Vec3::Zero(), 0), Vec3f(0.02f, 0.15f, 0)), Vec3f::Zero());
  EXPECT_EQ(given_way(moved_by(Vec3::Zero(), 0.005), Vec3f(0.4f, 0.15f, 0)), Vec3f::Zero());
}

TEST(GivingWay, EndsWhereItBegan) {
  DrawMesh mesh;
  for (int k = 0; k < 50; ++k) mesh.positions.emplace_back(0.003f * float(k), 0.1f, 0.01f);
  const std::vector<Vec3f> before = mesh.positions;
  mesh.revision = 7;
  GivingWay way;
  for (const double wider : {0.002, 0.009, -0.003}) {
    way.move(moved_by(Vec3::Zero(), wider), mesh);
    EXPECT_NE(mesh.positions, before);
    EXPECT_NE(mesh.revision, 7u) << "it is uploaded again";
  }
  way.move({}, mesh);
  EXPECT_EQ(mesh.positions, before);
  // A mesh that was written anew is not put back to what was there before.
  way.move(moved_by(Vec3::Zero(), 0.004), mesh);
  mesh.positions.assign(50, Vec3f(9, 9, 9));
  mesh.revision = 8;
  way.move({}, mesh);
  EXPECT_EQ(mesh.positions, std::vector<Vec3f>(50, Vec3f(9, 9, 9)));
}

TEST(LiveMuscles, AMuscleThatIsAsBeforeIsTheFittedOne) {
  const Muscle before = spindle(0.3, 0.02), fitted = grown(before);
  const Muscle live = grown_like(before, before, fitted);
  const std::vector<Ellipse> a = rest_slices(live.strips[0]), b = rest_slices(fitted.strips[0]);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_LT((a[k].center - b[k].center).norm(), 1e-9);
    EXPECT_LT((a[k].radii - b[k].radii).norm(), 1e-9);
    EXPECT_EQ(a[k].outline, b[k].outline);
  }
  EXPECT_NEAR(live.volume, fitted.volume, 1e-12);
}

TEST(LiveMuscles, AMovedEndMovesAndTheGrowthStays) {
  const Muscle before = spindle(0.3, 0.02), fitted = grown(before);
  Muscle moved = before;
  moved.strips[0].path[2].rest += Vec3(0.01, 0, 0);
  const Muscle live = grown_like(moved, before, fitted);
  const Vec3 by = live.strips[0].path[2].rest - fitted.strips[0].path[2].rest;
  EXPECT_LT((by - Vec3(0.01, 0, 0)).norm(), 1e-12);
  for (std::size_t k = 0; k < live.strips[0].slices.size(); ++k)
    EXPECT_LT((live.strips[0].slices[k].radii - fitted.strips[0].slices[k].radii).norm(), 1e-9);
  // Other slices than before: the growth of what lies there.
  Muscle finer = before;
  finer.strips[0].slices.erase(finer.strips[0].slices.begin() + 1);
  for (const Slice& slice : grown_like(finer, before, fitted).strips[0].slices)
    EXPECT_NEAR(slice.radii.x(), 1.4 * 0.02, 1e-9);
}

TEST(LiveMuscles, PointsGoWhereTheBonesGo) {
  Anatomy from;
  from.skeleton.joints.resize(2);
  from.skeleton.joints[1].parent = 0;
  Bone bone{"femur_l", Side::left, 0, {}};
  bone.mesh.V.resize(64, 3);
  for (int k = 0; k < 64; ++k) bone.mesh.V.row(k) << k % 4, (k / 4) % 4, 3 * (k / 16);
  bone.mesh.V *= 0.01;
  from.bones.push_back(bone);
  Anatomy to = from;
  Mat3 stretch;
  stretch << 1.1, 0.05, 0, 0, 0.9, 0, 0.02, 0, 1.2;
  to.bones[0].mesh.V =
      (bone.mesh.V * stretch.transpose()).rowwise() + Eigen::RowVector3d(0.1, 0.2, -0.3);
  const BoneCarrier carrier(from, to);
  const Vec3 place(0.02, 0.05, 0.01), wanted = stretch * place + Vec3(0.1, 0.2, -0.3);
  EXPECT_LT((carrier.carry(place, 0) - wanted).norm(), 1e-4);
  EXPECT_LT((carrier.carry(place, 1) - carrier.carry(place, 0)).norm(), 1e-12)
      << "a joint without bones goes with its parent";
}

// In the template's own body, where nothing else has moved.
TEST(Handles, APointGoesWhereTheHandGoes) {
  if (!std::filesystem::exists(test_assets().packages.folder))
    GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them";
  Workshop workshop(test_assets());
  Document document = workshop.built_in();
  const Anatomy& shown = workshop.base().anatomy;
  LiveMuscleMaker maker(workshop, workshop.built_in(), shown);
  EXPECT_TRUE(maker.make(document).muscles.empty()) << "what is as built is not made anew";
  PosedAnatomy posed;
  forward_kinematics(shown.skeleton, rest_pose(shown.skeleton), posed.X_WJ);
  const std::vector<Vec3> rest = rest_positions(shown.skeleton);
  const Vec3 moved(0.008, 0.006, -0.01);
  for (const char* name : {"soleus", "biceps_brachii_long", "rectus_abdominis"}) {
    document.picked = name;
    for (const char* side : {"_l", "_r"}) {
      const int own = find_muscle(shown, std::string(name) + side);
      ASSERT_GE(own, 0);
      std::vector<Handle> handles;
      add_points(shown.muscles[std::size_t(own)], rest, posed, handles);
      const Handle& last = handles.back();
      const auto action = action_of_drag(
          {document, workshop, maker.carrier(), posed, shown.skeleton}, last, moved, false);
      ASSERT_TRUE(action) << name;
      const LiveMuscles live = maker.make(*applied(workshop, document, *action));
      ASSERT_EQ(live.muscles.size(), 2u);
      const Muscle& now = live.muscles[side == std::string("_l") ? 0 : 1];
      const Vec3 by =
          now.strips[std::size_t(last.strip)].path[std::size_t(last.point)].rest - last.at.rest;
      EXPECT_LT((by - moved).norm(), 0.5e-3) << name << side << ": " << by.transpose();
      EXPECT_EQ(live.replaced.size(), 2u);
    }
  }
}

// A muscle that is drawn by clicks begins and ends, placed anew, where the bones were clicked.
TEST(BoneClicks, AMuscleBeginsAndEndsWhereTheBonesAreClicked) {
  if (!std::filesystem::exists(test_assets().packages.folder))
    GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them";
  Workshop workshop(test_assets());
  const Anatomy& shown = workshop.base().anatomy;
  const std::vector<Vec3> rest = rest_positions(shown.skeleton);
  Pose pose = rest_pose(shown.skeleton);
  pose.rotations[std::size_t(find_joint(shown.skeleton, "elbow_l"))] =
      Quat(Eigen::AngleAxisd(0.7, Vec3::UnitX()));
  PosedAnatomy posed;
  forward_kinematics(shown.skeleton, pose, posed.X_WJ);
  Camera camera;
  camera.eye = Vec3f(0.6f, 1.2f, 3);
  camera.target = Vec3f(0, 1, 0);
  const ViewProjection view(camera, 1200, 900);
  for (const std::string side : {"_l", "_r"}) {
    std::vector<BonePlace> places;
    for (const std::string name : {"humerus", "radius"}) {
      const auto bone = std::ranges::find(shown.bones, name + side, &Bone::name);
      ASSERT_NE(bone, shown.bones.end());
      const auto seen_at = [&](const Vec3& at) {
        return posed_place({at, {bone->joint, -1}, 1}, rest, posed).cast<float>().eval();
      };
      // the middle of the triangle that is nearest to the eye
      Vec3 nearest = bone->mesh.V.row(0).transpose();
      for (Eigen::Index f = 0; f < bone->mesh.F.rows(); ++f) {
        Vec3 middle = Vec3::Zero();
        for (int k = 0; k < 3; ++k) middle += bone->mesh.V.row(bone->mesh.F(f, k)).transpose() / 3;
        if (view.depth(seen_at(middle)) < view.depth(seen_at(nearest))) nearest = middle;
      }
      const auto pixel = view.pixel(seen_at(nearest));
      ASSERT_TRUE(pixel);
      const auto place = bone_under(shown, rest, posed, view, *pixel, workshop);
      ASSERT_TRUE(place) << name << side;
      EXPECT_TRUE(place->text.starts_with(name + "@")) << place->text;
      EXPECT_LT((place->rest - nearest).norm(), 1e-3) << "another place of the bone";
      places.push_back(*place);
    }
    const BoneClick click{.what = BoneClick::For::insertion, .origin = places[0]};
    const std::string line = line_of_click(click, places[1], workshop.built_in());
    const auto document = applied(workshop, workshop.built_in(), *read_action(line));
    ASSERT_TRUE(document) << line;
    const std::vector<Muscle> made =
        placed_entry(workshop, *document, find_entry(*document, "own_muscle_1"));
    const std::vector<PathPoint>& path = made[side == "_l" ? 0 : 1].strips[0].path;
    EXPECT_LT((path.front().rest - places[0].rest).norm(), 2e-3) << side << " " << line;
    EXPECT_LT((path.back().rest - places[1].rest).norm(), 2e-3) << side << " " << line;
  }
  EXPECT_FALSE(bone_under(shown, rest, posed, view, Vec2f(3, 3), workshop)) << "no bone there";
}

double winding(const OrganRoom& room, const Vec3& p) {
  double sum = 0;
  for (const Triangle32& t : room.triangles) {
    const Vec3 a = room.rest[t[0]].cast<double>() - p, b = room.rest[t[1]].cast<double>() - p,
               c = room.rest[t[2]].cast<double>() - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum +=
        2 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return sum / (4 * std::numbers::pi);
}

// Cranial capacity of adults is 1.1 to 1.7 l; lungs that have breathed out, heart and vessels take
// some 3 to 6 l.
TEST(OrganRooms, AreAsLargeAsTheOrgansThatAreNotThereAndLeaveTheBonesOut) {
  if (!std::filesystem::exists(test_assets().packages.folder))
    GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them";
  Workshop workshop(test_assets());
  const Anatomy& shown = workshop.base().anatomy;
  const std::vector<OrganRoom> rooms = find_organ_rooms(shown, make_muscle_surface(shown));
  ASSERT_EQ(rooms.size(), 3u);
  const double brain = 1e3 * volume_of(rooms[0]), chest = 1e3 * volume_of(rooms[1]),
               belly = 1e3 * volume_of(rooms[2]);
  EXPECT_TRUE(brain > 1.1 && brain < 1.7) << brain;
  EXPECT_TRUE(chest > 3 && chest < 8) << chest;
  EXPECT_TRUE(belly > 3 && belly < 12) << belly;
  int inside = 0, all = 0;
  for (const Bone& bone : shown.bones) {
    if (!bone.name.starts_with("rib") && bone.name != "sternum" && bone.name != "l3") continue;
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); v += 7, ++all)
      for (const int k : {1, 2})
        inside += winding(rooms[std::size_t(k)], bone.mesh.V.row(v).transpose()) > 0.5;
  }
  EXPECT_LT(inside, 0.02 * all) << inside << " of " << all;
  for (const OrganRoom& room : rooms) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3f& p : room.rest) middle += p.cast<double>() / double(room.rest.size());
    EXPECT_NEAR(winding(room, middle), 1, 1e-6) << "closed, outwards";
    EXPECT_NEAR(winding(room, middle + Vec3(0, 1, 0)), 0, 1e-6);
  }
}

// A muscle of the template's own body at rest, with its handles of shape.
struct ShapeBench {
  Workshop workshop{test_assets()};
  Document document = workshop.built_in();
  const Anatomy& shown = workshop.base().anatomy;
  LiveMuscleMaker maker{workshop, workshop.built_in(), shown};
  PosedAnatomy posed;
  std::vector<Vec3> rest = rest_positions(shown.skeleton);

  ShapeBench() { forward_kinematics(shown.skeleton, rest_pose(shown.skeleton), posed.X_WJ); }
  DragInput input() { return {document, workshop, maker.carrier(), posed, shown.skeleton}; }
  std::vector<Handle> handles(const Muscle& muscle) {
    DesignSession::SeenMuscle seen{&muscle, {}};
    for (const Strip& strip : muscle.strips)
      for (const Ellipse& each : rest_slices(strip)) seen.slices.push_back(each);
    std::vector<Handle> out;
    const int entry = find_entry(document, document.picked);
    add_section_handles(document.muscles[std::size_t(entry)]->left, seen, out);
    add_wrap_handles(muscle, rest, posed, out);
    return out;
  }
  const Muscle& muscle(const std::string& side) {
    return shown.muscles[std::size_t(find_muscle(shown, document.picked + side))];
  }
  // After the drag of a handle.
  Muscle after(const Action& action, const std::string& side) {
    LiveMuscles live = maker.make(*applied(workshop, document, action));
    for (Muscle& each : live.muscles)
      if (each.name == document.picked + side) return std::move(each);
    throw std::runtime_error("nothing has changed");
  }
};

const Handle& handle_named(const std::vector<Handle>& handles, const std::string& name) {
  const auto found = std::ranges::find(handles, name, &Handle::name);
  if (found == handles.end()) throw std::runtime_error(name + " is not there");
  return *found;
}

TEST(Handles, SectionsWidenAndRollAsTheHandDoes) {
  if (!std::filesystem::exists(test_assets().packages.folder))
    GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them";
  ShapeBench bench;
  bench.document.picked = "soleus";
  for (const std::string side : {"_l", "_r"}) {
    const std::string suffix = side == "_l" ? "" : "_r";
    const std::vector<Handle> handles = bench.handles(bench.muscle(side));
    const Handle& thickness = handle_named(handles, "thickness" + suffix + ":1:0.38");
    const Vec3 arm = thickness.place - thickness.middle;
    const auto thicker = action_of_shape(bench.input(), thickness, 0.25 * arm, false);
    ASSERT_TRUE(thicker);
    EXPECT_NEAR(*std::get<SetSection>(*thicker).thickness, 1.25 * 34.3, 0.06);
    EXPECT_FALSE(std::get<SetSection>(*thicker).width);

    const Handle& width = handle_named(handles, "width" + suffix + ":1:0.38");
    const Vec3 from = width.place - width.middle;
    const Vec3 to = Eigen::AngleAxisd(20 * kDegree, width.along) * from;
    const auto rolled = action_of_shape(bench.input(), width, to - from, false);
    ASSERT_TRUE(rolled);
    EXPECT_NEAR(std::abs(*std::get<SetSection>(*rolled).roll), 20, 0.6);
    const Muscle now = bench.after(*rolled, side);
    const std::vector<Handle> moved = bench.handles(now);
    const Handle& is = handle_named(moved, width.name);
    const Vec3 turned = (is.place - is.middle).normalized();
    EXPECT_LT((turned - to.normalized()).norm(), (turned - from.normalized()).norm())
        << side << " rolls the way of the hand";
    EXPECT_FALSE(action_of_shape(bench.input(), width, Vec3::Zero(), false));
  }
  const std::vector<Handle> handles = bench.handles(bench.muscle("_l"));
  const Handle& end = handle_named(handles, "belly:1:end");
  const auto [share, place] = end.way[end.way.size() / 2];
  const auto shorter = action_of_shape(bench.input(), end, place - end.place, false);
  ASSERT_TRUE(shorter);
  EXPECT_NEAR(*std::get<SetBelly>(*shorter).end, share, 1e-3);
}

TEST(Handles, AWrapGoesAndGrowsAsTheHandDoes) {
  if (!std::filesystem::exists(test_assets().packages.folder))
    GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them";
  ShapeBench bench;
  bench.document.picked = "biceps_brachii_long";
  for (const std::string side : {"_l", "_r"}) {
    const std::string suffix = side == "_l" ? "" : "_r";
    const Muscle& before = bench.muscle(side);
    const std::vector<Handle> handles = bench.handles(before);
    const Vec3 by(0.004, -0.003, 0.006);
    const auto moved =
        action_of_shape(bench.input(), handle_named(handles, "wrap" + suffix + ":1:2"), by, false);
    ASSERT_TRUE(moved);
    const Vec3 gone = bench.after(*moved, side).strips[0].wraps[1].X_WO.translation() -
                      before.strips[0].wraps[1].X_WO.translation();
    EXPECT_LT((gone - by).norm(), 0.5e-3) << side << gone.transpose();
    const Handle& size = handle_named(handles, "size" + suffix + ":1:1:x");
    const auto larger =
        action_of_shape(bench.input(), size, 0.3 * (size.place - size.middle), false);
    ASSERT_TRUE(larger);
    EXPECT_NEAR(bench.after(*larger, side).strips[0].wraps[0].radii.x() /
                    before.strips[0].wraps[0].radii.x(),
                1.3, 0.01);
  }
}

TEST(Handles, ALimitGoesToTheAngleThatTheHandShows) {
  if (!std::filesystem::exists(test_assets().packages.folder))
    GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them";
  ShapeBench bench;
  const Skeleton& skeleton = bench.shown.skeleton;
  const int elbow = find_joint(skeleton, "elbow_l");
  std::vector<Handle> handles;
  const std::vector<LimitArc> arcs =
      limit_arcs(skeleton, bench.document, elbow, bench.posed, handles);
  ASSERT_FALSE(arcs.empty());
  ASSERT_EQ(handles.size(), 2 * arcs.size());
  const Handle& most = handle_named(handles, "limit:flexion:max");
  const auto wanted = most.way[most.way.size() / 2 - 25];
  const auto action = action_of_limit(bench.input(), most, wanted.second - most.place, false);
  ASSERT_TRUE(action);
  const SetLimits& limits = std::get<SetLimits>(*action);
  EXPECT_EQ(limits.joint, "elbow");
  EXPECT_NEAR(limits.max, most.value - 25, 1);
  EXPECT_NEAR(limits.min, skeleton.joints[std::size_t(elbow)].min.x() / kDegree, 0.06);
  // The arc follows what was set.
  const Document after = *applied(bench.workshop, bench.document, *action);
  std::vector<Handle> again;
  limit_arcs(skeleton, after, elbow, bench.posed, again);
  EXPECT_LT((handle_named(again, most.name).place - wanted.second).norm(), 2e-3);
}

TEST(MuscleList, WordsOfBothLanguagesAreFound) {
  TableMuscle muscle;
  muscle.name = "biceps_brachii_long";
  muscle.label = "Biceps of the arm, long head";
  muscle.insertion = "radial tuberosity";
  for (const char* words : {"brachii", "BICEPS long", "arm head", "radial", "", "biceps brachii"})
    EXPECT_TRUE(is_found(muscle, words)) << words;
  for (const char* words : {"femoris", "biceps femoris"}) EXPECT_FALSE(is_found(muscle, words));
}

TEST(ViewProjection, AMoveOfPixelsIsSeenAsSuch) {
  Camera camera;
  camera.eye = {1, 1.2f, 3};
  const ViewProjection view(camera, 1280, 720);
  const Vec3f place(0.1f, 1.1f, 0.2f);
  const auto before = view.pixel(place), after = view.pixel(place + view.moved(place, 40, -25));
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(after->x() - before->x(), 40, 0.3);
  EXPECT_NEAR(after->y() - before->y(), -25, 0.3);
  EXPECT_FALSE(view.pixel(Vec3f(1, 1.3f, 9))) << "behind the eye";
}

TEST(StudioScript, IsWhatHasBeenDoneAndNotTakenBack) {
  History history = begin_history({});
  for (const char* line : {"pick soleus", "move_point point=2 by=0,0,1", "pick plantaris"})
    add_step(history, {}, line);
  undo_steps(history, 1);
  EXPECT_EQ(script_of(history), "pick soleus\nmove_point point=2 by=0,0,1\n");
}

TEST(RecordedInput, MistakesNameFileAndLine) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("ecorche_input_{}.txt", ::getpid());
  for (const char* line : {"drag point", "klick find", "key Hyper", "frames 0", "picture x.jpg",
                           "drag find 3", "turn left", "drop", "close it"}) {
    std::ofstream(file) << "# a remark\nwait\n" << line << "\n";
    try {
      RecordedInput input(file);
      ADD_FAILURE() << line;
    } catch (const std::exception& error) {
      EXPECT_NE(std::string(error.what()).find(file.string() + ":3"), std::string::npos)
          << error.what();
    }
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace ecorche
