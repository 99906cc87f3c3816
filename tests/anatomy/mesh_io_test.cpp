#include "anatomy/mesh_files/mesh_io.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

fs::path scratch(const std::string& name) {
  const auto folder = fs::temp_directory_path() / ("ecorche_mesh_io_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  return folder / name;
}

std::string outcome_of(const fs::path& file, std::string& words) {
  try {
    const MeshFile read = read_mesh_file(file);
    for (const auto& note : read.notes) words += note + "\n";
    EXPECT_EQ(read.parts.size(), 1u);
    EXPECT_EQ(read.parts[0].mesh.V.rows(), 4) << file;
    EXPECT_EQ(read.parts[0].mesh.F.rows(), 2) << file;
    return "ok";
  } catch (const InputError& e) {
    words = e.what();
    return "input";
  } catch (const UnfitError& e) {
    words = e.what();
    return "unfit";
  } catch (const LimitError& e) {
    words = e.what();
    return "limit";
  }
}

TEST(MeshCorpus, EveryFileHasItsOutcome) {
  const fs::path folder = fs::path(ECORCHE_TEST_DIR) / "corpus" / "mesh";
  std::ifstream table(folder / "expected.tsv");
  std::string line;
  int files = 0;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string name, outcome, needle, words;
    std::getline(row, name, '\t');
    std::getline(row, outcome, '\t');
    std::getline(row, needle, '\t');
    EXPECT_EQ(outcome_of(folder / name, words), outcome) << name << ": " << words;
    EXPECT_NE(words.find(needle), std::string::npos)
        << name << ": " << words << "\nlacks: " << needle;
    ++files;
  }
  EXPECT_GT(files, 80);
}

// Whatever a file's bytes are changed to, it is read or refused.
TEST(MeshCorpus, SurvivesEveryDamagedByteAndEveryTruncation) {
  const fs::path folder = fs::path(ECORCHE_TEST_DIR) / "corpus" / "mesh";
  for (const char* name :
       {"quad.obj", "quad.ply", "quad_little.ply", "quad_big.ply", "quad.glb", "quad_nodes.glb"}) {
    std::ifstream file(folder / name, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
    ASSERT_FALSE(bytes.empty());
    const auto attempt = [&](const std::string& changed) {
      try {
        parse_mesh(changed, name);
      } catch (const Error&) {
      }
    };
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      attempt(bytes.substr(0, k));
      for (const char c : {'\0', '\xff', '9', '-', char(bytes[k] ^ 0x10)}) {
        std::string changed = bytes;
        changed[k] = c;
        attempt(changed);
      }
    }
  }
}

TEST(MeshFiles, RefuseWhatIsNoRegularFile) {
  EXPECT_THROW(read_mesh("/no/such/file.obj"), InputError);
  EXPECT_THROW(read_mesh(fs::temp_directory_path()), InputError);
  const auto fifo = scratch("pipe.obj");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THROW(read_mesh(fifo), InputError);
  const auto loop = scratch("loop.obj");
  fs::create_symlink(loop, loop);
  EXPECT_THROW(read_mesh(loop), InputError);
  fs::remove_all(fifo.parent_path());
}

TriMesh bumpy() {
  TriMesh mesh;
  const int n = 12;
  mesh.V.resize(n * n, 3);
  mesh.F.resize(2 * (n - 1) * (n - 1), 3);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      mesh.V.row(i * n + j) << 0.1 * i / 3.0, std::sin(i * 1.7) / 7, 1e-9 * j + 1e5 / (1 + j);
  }
  Eigen::Index f = 0;
  for (int i = 0; i + 1 < n; ++i) {
    for (int j = 0; j + 1 < n; ++j) {
      mesh.F.row(f++) << i * n + j, i * n + j + 1, (i + 1) * n + j;
      mesh.F.row(f++) << i * n + j + 1, (i + 1) * n + j + 1, (i + 1) * n + j;
    }
  }
  return mesh;
}

TEST(MeshFiles, RoundTripExactlyUnderAnyName) {
  const TriMesh mesh = bumpy();
  for (const std::string name : {"a.obj", "with space 'quoted'.obj",
                                 "\xC3\xA9"
                                 "corch\xC3\xA9.ply",
                                 "-dash.ply"}) {
    const auto file = scratch(name);
    name.ends_with(".obj") ? write_obj(file, mesh) : write_ply(file, mesh);
    const TriMesh back = read_mesh(file);
    EXPECT_TRUE(back.V == mesh.V) << name;
    EXPECT_TRUE(back.F == mesh.F) << name;
  }
  fs::remove_all(scratch("x").parent_path());
}

TEST(MeshFiles, WriteNothingHalfway) {
  EXPECT_THROW(write_obj("/no/such/folder/a.obj", bumpy()), OutputError);
  EXPECT_THROW(write_ply(fs::temp_directory_path(), bumpy()), OutputError);
}

TEST(MeshFiles, PlacesNodesOfAGlb) {
  const auto read = read_mesh(fs::path(ECORCHE_TEST_DIR) / "corpus" / "mesh" / "quad_nodes.glb");
  EXPECT_LT((read.V.row(2) - Eigen::RowVector3d(4, 6, 6)).norm(),
            1e-12);  // 2 * ((1, 1, 0) + (1, 2, 3))
}

double area_of(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    EXPECT_GE((b - a).cross(c - a).z(), 0);
    sum += 0.5 * (b - a).cross(c - a);
  }
  return sum.z();
}

TEST(MeshFiles, ConcavePolygonsAreCutInside) {
  // A comb of 20 teeth: half of its box is empty.
  std::string text, face = "f";
  int corners = 0;
  const auto corner = [&](double x, double y) {
    text += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
    face += " " + std::to_string(++corners);
  };
  corner(0, -1);
  corner(40, -1);
  for (int tooth = 20; tooth-- > 0;) {
    corner(2 * tooth + 2, 0), corner(2 * tooth + 1, 0), corner(2 * tooth + 1, 5),
        corner(2 * tooth, 5);
  }
  const MeshFile read = parse_mesh(text + face + "\n", "comb.obj");
  EXPECT_EQ(read.parts[0].mesh.F.rows(), corners - 2);
  EXPECT_NEAR(area_of(read.parts[0].mesh), 40 + 20 * 5, 1e-9);
  // An arrow head: only one diagonal lies inside.
  const MeshFile arrow = parse_mesh("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n", "arrow.obj");
  EXPECT_NEAR(area_of(arrow.parts[0].mesh), 1, 1e-12);
}

}  // namespace
}  // namespace ecorche
