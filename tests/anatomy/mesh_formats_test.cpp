#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/mesh_files/pcd_reader.h"
#include "anatomy/mesh_files/scene_import.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

// A tetrahedron: the same in every format.
constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
constexpr int kPlaces[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};

std::string lines(const auto& rows, const char* before, int more, const char* after = "") {
  std::string out;
  for (const auto& row : rows)
    out +=
        fmt::format("{}{} {} {}{}\n", before, row[0] + more, row[1] + more, row[2] + more, after);
  return out;
}

std::string stl_text() {
  std::string out = "solid t\n";
  for (const auto& face : kFaces) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int v : face)
      out += fmt::format("vertex {} {} {}\n", kPlaces[v][0], kPlaces[v][1], kPlaces[v][2]);
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid t\n";
}

std::string collada() {
  std::string corners;
  for (const auto& face : kFaces) corners += fmt::format("{} {} {} ", face[0], face[1], face[2]);
  std::string places;
  for (const auto& p : kPlaces) places += fmt::format("{} {} {} ", p[0], p[1], p[2]);
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
      "version=\"1.4.1\"><asset><unit meter=\"0.5\"/><up_axis>Y_UP</up_axis></asset>"
      "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" "
      "count=\"12\">{}</float_array><technique_common><accessor source=\"#a\" count=\"4\" "
      "stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param "
      "name=\"Z\" type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input "
      "semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"4\"><input "
      "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles></mesh></geometry>"
      "</library_geometries><library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">"
      "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene>"
      "<instance_visual_scene url=\"#s\"/></scene></COLLADA>\n",
      places, corners);
}

// The triangles by their places, so that the order of vertices does not matter.
std::vector<Vec3> corner_places(const TriMesh& mesh, double scale = 1) {
  std::vector<Vec3> out;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) out.push_back(scale * Vec3(mesh.V.row(mesh.F(f, k))));
  return out;
}

std::vector<Vec3> expected_places() {
  std::vector<Vec3> out;
  for (const auto& face : kFaces)
    for (const int v : face) out.emplace_back(kPlaces[v][0], kPlaces[v][1], kPlaces[v][2]);
  return out;
}

void expect_tetrahedron(const MeshFile& file, double scale = 1) {
  ASSERT_EQ(file.parts.size(), 1u);
  const std::vector<Vec3> found = corner_places(file.parts[0].mesh, scale),
                          expected = expected_places();
  ASSERT_EQ(found.size(), expected.size()) << file.format;
  for (std::size_t c = 0; c < found.size(); ++c)
    EXPECT_LT((found[c] - expected[c]).norm(), 1e-6) << file.format << " corner " << c;
}

TEST(MeshFormats, GiveTheSameTriangles) {
  expect_tetrahedron(parse_mesh(lines(kPlaces, "v ", 0) + lines(kFaces, "f ", 1), "t.obj"));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
  expect_tetrahedron(parse_mesh(ply + lines(kPlaces, "", 0) + lines(kFaces, "3 ", 0), "t.ply"));
  expect_tetrahedron(parse_mesh(
      "OFF # a comment\n4 4 6\n" + lines(kPlaces, "", 0) + lines(kFaces, "3 ", 0), "t.off"));
  expect_tetrahedron(parse_mesh(
      "COFF 4 4\n" + lines(kPlaces, "", 0, " 255 0 0 255") + lines(kFaces, "3 ", 0, " 1 0 0"),
      "t.off"));
  const MeshFile stl = parse_mesh(stl_text(), "t.stl");
  expect_tetrahedron(stl);
  EXPECT_EQ(stl.parts[0].mesh.V.rows(), 4) << "corners are welded";
  EXPECT_FALSE(stl.unit);
}

TEST(MeshFormats, CollladaComesInMetresFromAChildWithoutRights) {
  try {
    const MeshFile file = parse_mesh(collada(), "t.dae");
    expect_tetrahedron(file, 2);
    EXPECT_EQ(file.unit, 1);
    EXPECT_EQ(file.format, "dae");
  } catch (const UnfitError& e) {
    if (std::string(e.what()).find("cannot be started") == std::string::npos) throw;
    GTEST_SKIP() << e.what();
  }
}

TEST(MeshFormats, ColoursNormalsAndTextureAreKept) {
  const MeshFile obj = parse_mesh(
      "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0.5\nvt 0 0\nvt 1 0\nvt 0 0.25\nvn 0 0 2\nusemtl "
      "skin\nf 1/1/1 2/2/1 3/3/1\n",
      "t.obj");
  const MeshPart& part = obj.parts[0];
  ASSERT_EQ(part.colours.rows(), 3);
  EXPECT_EQ(part.colours(2, 2), 0.5F);
  ASSERT_EQ(part.normals.rows(), 3);
  EXPECT_EQ(part.normals(1, 2), 1);
  ASSERT_EQ(part.texture.rows(), 3);
  EXPECT_EQ(part.texture(2, 1), 0.25F);
  EXPECT_EQ(part.materials, std::vector<std::string>{"skin"});
  EXPECT_EQ(part.face_materials, std::vector<int>{0});
  const MeshFile off = parse_mesh(
      "CNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 255 0\n0 1 0 0 0 1 "
      "0 0 51\n3 0 1 2\n",
      "t.off");
  EXPECT_NEAR(off.parts[0].colours(2, 2), 0.2, 1e-6);
  EXPECT_EQ(off.parts[0].normals(0, 2), 1);
}

const std::string kCloud =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
    "z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty "
    "uchar "
    "green\nproperty uchar blue\nproperty float confidence\nend_header\n0 0 0 0 0 3 255 0 51 "
    "0.5\n1 "
    "2 3 0 1 0 0 0 0 1\n";

TEST(MeshFormats, CloudsAreGivenOnlyWhereAsked) {
  EXPECT_THROW(parse_mesh(kCloud, "t.ply"), UnfitError);
  const MeshPart part = parse_mesh(kCloud, "t.ply", {.clouds = true}).parts[0];
  EXPECT_EQ(part.mesh.V.rows(), 2);
  EXPECT_EQ(part.mesh.F.rows(), 0);
  EXPECT_EQ(part.normals(0, 2), 1);
  EXPECT_NEAR(part.colours(0, 2), 0.2, 1e-6);
  EXPECT_EQ(part.confidence[0], 0.5F);
}

std::string pcd(const std::string& data, const std::string& body) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 "
         "1\nWIDTH "
         "2\nHEIGHT 1\nPOINTS 2\nDATA " +
         data + "\n" + body;
}

TEST(MeshFormats, PcdIsTheSameInItsThreeCodings) {
  const float places[2][3] = {{1, 2, 3}, {NAN, 0, 0}};
  const std::uint32_t colours[2] = {0xFF336699, 0};
  std::string rows, columns;
  for (int i = 0; i < 2; ++i) {
    rows.append(reinterpret_cast<const char*>(places[i]), 12);
    rows.append(reinterpret_cast<const char*>(&colours[i]), 4);
  }
  for (int k = 0; k < 3; ++k)
    for (const auto& place : places) columns.append(reinterpret_cast<const char*>(&place[k]), 4);
  columns.append(reinterpret_cast<const char*>(colours), 8);
  const std::uint32_t sizes[2] = {33, 32};
  const std::string packed =
      std::string(reinterpret_cast<const char*>(sizes), 8) + char(31) + columns;
  for (const std::string& bytes : {pcd("ascii", "1 2 3 4281558681\nnan 0 0 0\n"),
                                   pcd("binary", rows), pcd("binary_compressed", packed)}) {
    const MeshFile file = parse_mesh(bytes, "t.pcd", {.clouds = true});
    const MeshPart& part = file.parts[0];
    ASSERT_EQ(part.mesh.V.rows(), 1);
    EXPECT_EQ(part.mesh.V(0, 2), 3);
    EXPECT_NEAR(part.colours(0, 0), 0.2, 1e-6);
    EXPECT_EQ(file.notes.size(), 1u) << "the point that is not finite is said";
    EXPECT_THROW(parse_mesh(bytes, "t.pcd"), UnfitError);
  }
}

TEST(MeshFormats, LzfUnpacksRunsThatOverlap) {
  EXPECT_EQ(lzf_unpacked(std::string("\x00"
                                     "a\xe0\x01\x00",
                                     5),
                         11, "t"),
            "aaaaaaaaaaa");
  EXPECT_THROW(lzf_unpacked(std::string("\x20\x05", 2), 3, "t"), InputError);
}

TEST(MeshFormats, BuffersBesideAGltfAreReadByPlainNamesOnly) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("ecorche_gltf_{}", ::getpid());
  fs::create_directories(folder / "inside");
  const float places[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string bytes(reinterpret_cast<const char*>(places), sizeof places);
  for (const fs::path& file : {folder / "my mesh.bin", folder / "inside" / "x.bin"})
    std::ofstream(file, std::ios::binary) << bytes;
  const auto write = [&](const std::string& uri) {
    std::ofstream(folder / "t.gltf")
        << R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[-1,1,1]}],)"
           R"("meshes":[{"primitives":[)"
           R"({"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,)"
           R"("count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{)"
        << fmt::format("\"byteLength\":36,\"uri\":\"{}\"}}]}}", uri);
    return folder / "t.gltf";
  };
  const MeshFile read = read_mesh_file(write("my%20mesh.bin"));
  EXPECT_EQ(read.unit, 1);
  EXPECT_EQ(read.parts[0].mesh.F.row(0), Eigen::RowVector3i(0, 2, 1))
      << "mirrored nodes turn faces";
  for (const char* uri : {"inside/x.bin", "../x.bin", "/etc/passwd", "gone.bin"})
    EXPECT_THROW(read_mesh_file(write(uri)), InputError) << uri;
  fs::remove_all(folder);
}

TEST(MeshFormats, StrangersCharactersStandAsTheyWereBound) {
  const fs::path rigs = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "rigs";
  const fs::path body = rigs / "sketchfab_basemeshes" / "free_rigged_male_basemesh.glb";
  if (!fs::exists(body)) GTEST_SKIP() << body << " is not there";
  const auto height = [](const MeshFile& file) {
    const TriMesh all = all_parts(file);
    return all.V.col(1).maxCoeff() - all.V.col(1).minCoeff();
  };
  EXPECT_NEAR(height(read_mesh_file(body)), 5.13, 0.02);
  EXPECT_GT(height(read_mesh_file(body, {.node_pose = true})), 400) << "as its nodes stand";
  try {
    EXPECT_NEAR(height(read_mesh_file(rigs / "ozz_arnaud" / "arnaud.fbx")), 1.832, 0.005);
    EXPECT_NEAR(height(read_mesh_file(rigs / "momentum_tests" / "simple_anim.fbx")), 1.742, 0.005);
  } catch (const UnfitError& e) {
    GTEST_SKIP() << e.what();
  }
}

}  // namespace
}  // namespace ecorche
