// Laws of cuts: the faces of what a plane cuts lie in it, under their part's number, as large as
// the solid is there; what lies before it is gone.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "anatomy/errors.h"
#include "tests/viewer/balls.h"
#include "viewer/camera.h"
#include "viewer/cut_faces.h"
#include "viewer/gl/renderer.h"
#include "viewer/scene.h"
#include "viewer/section_plane.h"

namespace ecorche {
namespace {

const Vec3f kMiddle(0.2f, 1, -0.1f);

// A limb: skin around a muscle around a bone.
DrawList limb() {
  DrawList list;
  list.meshes.push_back(sphere(40));
  list.items.push_back(ball({0.8f, 0.6f, 0.5f}, kSkinPart, kMiddle, 0.10f));
  list.items.push_back(ball({0.6f, 0.2f, 0.2f}, kFirstMusclePart + 3, kMiddle, 0.08f));
  list.items.push_back(ball({0.9f, 0.9f, 0.8f}, kFirstBonePart + 5, kMiddle, 0.03f));
  list.camera = orbit_camera({0.2f, 1, -0.1f}, 0.12f, 0.4f, 0.7f);
  return list;
}

double area_of(const DrawMesh& faces, std::uint32_t part) {
  double area = 0;
  for (const Triangle32& t : faces.triangles) {
    if (faces.parts[t[0]] != part) continue;
    const Vec3f a = faces.positions[t[0]], b = faces.positions[t[1]], c = faces.positions[t[2]];
    area += 0.5 * double((b - a).cross(c - a).norm());
  }
  return area;
}

double disc_of(double radius) { return std::numbers::pi * radius * radius; }

// A tube along y with round ends, as a long bone.
DrawMesh tube(float radius, float length) {
  constexpr int around = 48, rows = 60;
  DrawMesh out;
  for (int r = 0; r <= rows; ++r)
    for (int k = 0; k < around; ++k) {
      const float a = 2 * std::numbers::pi_v<float> * float(k) / around, u = float(r) / rows;
      const float wide = radius * std::sqrt(std::min(1.0f, 40 * u * (1 - u) + 1e-3f));
      out.positions.emplace_back(wide * std::sin(a), length * u, wide * std::cos(a));
    }
  out.normals.assign(out.positions.size(), Vec3f::UnitY());
  const auto at = [](int r, int k) { return std::uint32_t(r * around + k % around); };
  for (int r = 0; r < rows; ++r)
    for (int k = 0; k < around; ++k) {
      out.triangles.emplace_back(at(r, k), at(r, k + 1), at(r + 1, k + 1));
      out.triangles.emplace_back(at(r, k), at(r + 1, k + 1), at(r + 1, k));
    }
  return out;
}

Vec4f plane_through(const Vec3f& normal, const Vec3f& at) {
  Vec4f out;
  out << normal.normalized(), normal.normalized().dot(at);
  return out;
}

TEST(CutFaces, AreAsLargeAsTheSolidsAreThereHoweverThePlaneIsTilted) {
  const DrawList list = limb();
  for (const Vec3f& normal : {Vec3f(0, 1, 0), Vec3f(0.3f, -0.9f, 0.4f), Vec3f(-1, 0.2f, 0)}) {
    const Vec4f plane = plane_through(normal, Vec3f(0.2f, 1, -0.1f) + 0.012f * normal.normalized());
    const DrawMesh faces = cut_faces(plane, list);
    const auto disc = [](double radius) {
      return std::numbers::pi * (radius * radius - 0.012 * 0.012);
    };
    EXPECT_NEAR(area_of(faces, kFirstMusclePart + 3) / disc(0.08), 1, 0.01);
    // marrow in all of it, and 1 mm of compact bone over its rim
    const double radius = std::sqrt(disc(0.03) / std::numbers::pi);
    EXPECT_NEAR(area_of(faces, kFirstBonePart + 5) /
                    (disc(0.03) + disc_of(radius) - disc_of(radius - 0.001)),
                1, 0.02);
    // fat over all of it, and the rim of the skin over that
    EXPECT_NEAR(area_of(faces, kSkinPart) / (disc(0.10) + 2 * std::numbers::pi * 0.098 * 0.002), 1,
                0.02);
    for (const Vec3f& p : faces.positions)
      EXPECT_LT(std::abs(plane.head<3>().dot(p) - plane.w()), 1e-5f);
  }
  EXPECT_TRUE(cut_faces(plane_through(Vec3f::UnitY(), {0, 3, 0}), list).triangles.empty());
}

// By how much the areas of a part's faces exceed a disc: the ring of compact bone.
TEST(CutFaces, ALongBonesShaftIsThickerThanItsEndsAndAPlateIsNotPierced) {
  DrawList list;
  list.meshes.push_back(tube(0.012f, 0.4f));
  DrawItem item;
  item.part = kFirstBonePart;
  list.items.push_back(item);
  const auto ring = [&](const Vec4f& plane, double radius) {
    return area_of(cut_faces(plane, list), kFirstBonePart) - disc_of(radius);
  };
  const Vec4f middle = plane_through(Vec3f::UnitY(), {0, 0.2031f, 0}),
              end = plane_through(Vec3f::UnitY(), {0, 0.021f, 0});
  EXPECT_NEAR(ring(middle, 0.012) / (disc_of(0.012) - disc_of(0.55 * 0.012)), 1, 0.03);
  EXPECT_NEAR(ring(end, 0.012) / (disc_of(0.012) - disc_of(0.011)), 1, 0.15);
  // As thin as its shell would be thick: the shell fills it and no more.
  for (Vec3f& p : list.meshes[0].positions) p.z() *= 0.05f;
  const DrawMesh flat = cut_faces(middle, list);
  for (const Vec3f& p : flat.positions) EXPECT_LT(std::abs(p.z()), 0.0006f + 1e-5f);
}

TEST(CutFaces, RoomsOfOrgansLieOverFatAndUnderMusclesAndAreNamed) {
  DrawList list = limb();
  DrawMesh room = sphere(40);
  for (Vec3f& p : room.positions) p = 0.09f * p + kMiddle;
  room.parts.assign(room.positions.size(), kFirstRoomPart + 1);
  const std::vector<DrawMesh> rooms{room};
  const Vec4f plane = plane_through(Vec3f::UnitY(), kMiddle + Vec3f(0, 0.001f, 0));
  const DrawMesh faces = cut_faces(plane, list, rooms);
  EXPECT_NEAR(area_of(faces, kFirstRoomPart + 1) / disc_of(0.09), 1, 0.01);
  const std::vector<FacePlace> places = room_places(faces);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].part, kFirstRoomPart + 1);
  EXPECT_LT((places[0].middle - kMiddle).norm(), 2e-3f);
  std::size_t fat = 0, organ = 0, muscle = 0;  // the last triangle of each
  for (std::size_t t = 0; t < faces.triangles.size(); ++t) {
    const std::uint32_t part = faces.parts[faces.triangles[t][0]];
    if (part == kFirstRoomPart + 1) organ = t;
    if (part == kFirstMusclePart + 3) muscle = t;
    if (part == kSkinPart && organ == 0) fat = t;
  }
  EXPECT_LT(fat, organ);
  EXPECT_LT(organ, muscle);
  list.items.erase(list.items.begin());
  EXPECT_TRUE(room_places(cut_faces(plane, list, rooms)).empty()) << "no skin, no rooms";
}

TEST(CutFaces, ThePictureShowsTheInnermostTissueAndNothingBeforeThePlane) {
  std::optional<Renderer> renderer;
  try {
    renderer.emplace(RenderOptions{.supersample = 1});
  } catch (const OutputError& error) {
    GTEST_SKIP() << error.what();
  }
  DrawList list = limb();
  for (const Vec3f& normal : {Vec3f(0, 1, 0), Vec3f(0.1f, -0.95f, 0.2f)}) {
    const Vec4f plane = plane_through(normal, {0.2f, 1, -0.1f});
    add_cut(plane, cut_faces(plane, list), list);
    renderer->render(list, 200, 200);
    EXPECT_EQ(renderer->part_at(100, 100), kFirstBonePart + 5);
    int muscle = 0, skin = 0, bone = 0;
    for (const std::uint32_t part : renderer->parts()) {
      muscle += part == kFirstMusclePart + 3;
      bone += part == kFirstBonePart + 5;
      skin += part == kSkinPart;
    }
    EXPECT_NEAR(double(muscle + bone) / bone, 64.0 / 9, 0.5) << "whole discs";
    EXPECT_GT(skin, muscle / 3);
    list.meshes.pop_back();
    list.items.pop_back();
    list.cut.reset();
    renderer->render(list, 200, 200);
    EXPECT_EQ(renderer->part_at(100, 100), kSkinPart) << "nothing of the cut stays";
  }
}

Skeleton leg() {
  Skeleton out;
  for (const auto& [name, parent, y] :
       {std::tuple{"pelvis", -1, 1.0}, {"hip_l", 0, -0.1}, {"knee_l", 1, -0.4}}) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.X_PJ.translation() = Vec3(0, y, 0);
    out.joints.push_back(joint);
  }
  return out;
}

TEST(SectionPlane, IsReadAsPeopleWriteItAndLiesWhereItSays) {
  const Skeleton skeleton = leg();
  PosedAnatomy posed;
  forward_kinematics(skeleton, rest_pose(skeleton), posed.X_WJ);
  const auto plane = [&](const char* text) {
    return plane_of(read_section_plane(text, skeleton, "--section"), skeleton, posed);
  };
  EXPECT_LT((plane("transverse:95cm") - Vec4f(0, 1, 0, 0.95f)).norm(), 1e-6f);
  EXPECT_LT((plane("transverse:0.95") - Vec4f(0, 1, 0, 0.95f)).norm(), 1e-6f);
  EXPECT_LT((plane("frontal:-2cm") - Vec4f(0, 0, 1, -0.02f)).norm(), 1e-6f);
  EXPECT_LT((plane("sagittal:0") - Vec4f(1, 0, 0, 0)).norm(), 1e-6f);
  EXPECT_LT((plane("hip_l-knee_l:25%") - Vec4f(0, -1, 0, -0.8f)).norm(), 1e-6f);
  for (const char* bad : {"", "transverse", "transverse:", "transverse:far", "hip_l:50%",
                          "hip_l-kne_l:50%", "hip_l-hip_l:50%", "hip_l-knee_l:150%", "frontal:99m"})
    EXPECT_THROW(read_section_plane(bad, skeleton, "--section"), UsageError) << bad;
}

}  // namespace
}  // namespace ecorche
