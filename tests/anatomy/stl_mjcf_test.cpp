#include <cstring>
#include <map>

#include <gtest/gtest.h>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/stl_io.h"
#include "anatomy/model_files/mjcf_meshes.h"

namespace ecorche {
namespace {

std::string binary_stl(const std::vector<std::array<float, 9>>& triangles, std::uint32_t stated) {
  std::string bytes(84, '\0');
  std::memcpy(bytes.data() + 80, &stated, 4);
  for (const auto& t : triangles) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(t.data()), 36);
    bytes.append(2, '\0');
  }
  return bytes;
}

// A tetrahedron with corners 0, x, y, z, shifted along x.
std::vector<std::array<float, 9>> tetrahedron(float shift) {
  const float s = shift;
  return {{s, 0, 0, s, 1, 0, s + 1, 0, 0},
          {s, 0, 0, s + 1, 0, 0, s, 0, 1},
          {s, 0, 0, s, 0, 1, s, 1, 0},
          {s + 1, 0, 0, s, 1, 0, s, 0, 1}};
}

TEST(Stl, WeldsCornersAndFindsComponents) {
  auto triangles = tetrahedron(0);
  for (const auto& t : tetrahedron(5)) triangles.push_back(t);
  triangles.push_back({9, 9, 9, 9, 9, 9, 9, 9, 8});  // collapsed
  triangles.push_back({20, 0, 0, 21, 0, 0, 20, 1, 0});
  const TriMesh mesh = parse_stl(binary_stl(triangles, 10), "two.stl");
  EXPECT_EQ(mesh.F.rows(), 9);
  const auto parts = connected_components(mesh);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_TRUE(is_closed(parts[0]) && is_closed(parts[1]));
  EXPECT_FALSE(is_closed(parts[2]));
  EXPECT_EQ(parts[0].V.rows(), 4);
  EXPECT_NEAR(surface_area(parts[2]), 0.5, 1e-12);
  EXPECT_LT((surface_centroid(parts[2]) - Vec3(20 + 1. / 3, 1. / 3, 0)).norm(), 1e-12);
}

TEST(Stl, ReadsTextFiles) {
  const TriMesh mesh = parse_stl(
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 "
      "0\nendloop\n"
      "endfacet\nendsolid",
      "a.stl");
  EXPECT_EQ(mesh.F.rows(), 1);
}

TEST(Stl, RefusesBadFiles) {
  const auto good = tetrahedron(0);
  EXPECT_THROW(parse_stl("", "x.stl"), InputError);
  EXPECT_THROW(parse_stl(binary_stl(good, 4000000000u), "x.stl"), InputError);
  EXPECT_THROW(parse_stl(binary_stl(good, 4).substr(0, 200), "x.stl"), InputError);
  EXPECT_THROW(parse_stl("solid a\nvertex 0 0\n", "x.stl"), InputError);
  EXPECT_THROW(parse_stl(binary_stl({{0, 0, 0, NAN, 0, 0, 1, 1, 1}}, 1), "x.stl"), InputError);
}

Mjcf model(const std::map<std::string, std::string>& files) {
  return read_mjcf(
      [&](const std::string& path) {
        const auto found = files.find(path);
        if (found == files.end()) throw InputError(path + ": missing");
        return found->second;
      },
      "body/main.xml");
}

TEST(MjcfReader, ComposesFramesAndFollowsCouplings) {
  const Mjcf m = model(
      {{"body/main.xml", R"(<mujoco><compiler angle="radian"/><include file="../part/assets.xml"/>
    <worldbody><body name="a" pos="1 0 0" euler="0 0 1.5707963267948966">
    <include file="../part/chain.xml"/></body></worldbody></mujoco>)"},
       {"part/assets.xml", R"(<x><asset><mesh name="m" file="m.stl" scale="1 1 -1"/></asset>
    <equality><joint joint1="slide" joint2="turn" polycoef="0.5 2 0 0 0"/></equality>
    <tendon><spatial name="t"><site site="s"/><geom geom="w"/><site site="s"/></spatial></tendon>
    </x>)"},
       {"part/chain.xml",
        R"(<x><joint name="turn" axis="0 0 2"/><body name="b" pos="1 0 0">
    <joint name="slide" type="slide" axis="1 0 0"/>
    <geom name="g" mesh="m" quat="0 0 0 1"/><site name="s" pos="0 1 0"/></body></x>)"}});
  // b lies at (1, 0, 0) + Rz(90 deg) (1 + 0.5, 0, 0)
  EXPECT_LT((m.bodies.at("b").translation() - Vec3(1, 1.5, 0)).norm(), 1e-12);
  EXPECT_LT((m.sites.at("s").position - Vec3(0, 1.5, 0)).norm(), 1e-12);
  EXPECT_LT((m.joints.at("slide").axis - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((m.geoms.at("g").X_WG * Vec3(1, 0, 0) - Vec3(1, 0.5, 0)).norm(), 1e-12);
  EXPECT_EQ(m.meshes.at("m").scale.z(), -1);
  EXPECT_EQ(m.tendons.at(0).sites.size(), 2u);
}

TEST(MjcfReader, NamesWhatIsWrong) {
  EXPECT_THROW(model({{"body/main.xml",
                       "<mujoco><worldbody><body name='a' pos='1 x 0'/></worldbody></mujoco>"}}),
               InputError);
  EXPECT_THROW(model({{"body/main.xml", "<mujoco><worldbody>"}}), InputError);
  EXPECT_THROW(model({{"body/main.xml", "<mujoco><compiler angle='degree'/></mujoco>"}}),
               InputError);
  EXPECT_THROW(model({{"body/main.xml", "<mujoco><include file='../../etc/passwd'/></mujoco>"}}),
               InputError);
  EXPECT_THROW(model({{"body/main.xml", "<mujoco><include file='main.xml'/></mujoco>"}}),
               LimitError);
  EXPECT_THROW(
      model({{"body/main.xml",
              "<mujoco><worldbody><body name='a'/><body name='a'/></worldbody></mujoco>"}}),
      InputError);
}

}  // namespace
}  // namespace ecorche
