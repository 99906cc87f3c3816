#include "morph/tissue/tissue_mesh.h"

#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/byte_stream.h"
#include "anatomy/files/child_processes.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/memory_file.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/placement/half_skeleton.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

constexpr double kFromSkin = 3e-3;  // m: bone nodes keep this away from the skin
constexpr double kApart = 4e-3;     // m: and this from each other

double volume_of(const Points& V, const Eigen::RowVector4i& t) {
  const Vec3 a = V.row(t[0]), b = V.row(t[1]), c = V.row(t[2]), d = V.row(t[3]);
  return (b - a).cross(c - a).dot(d - a) / 6;
}

// Points of the bones' surfaces, about `spacing` apart, clear of the skin and of each other.
struct BoneNodes {
  std::vector<Vec3> at;
  std::vector<TissueAnchor> anchors;
};
BoneNodes bone_nodes(const SkinField& skin, const std::vector<Bone>& bones, double spacing) {
  BoneNodes out;
  std::map<std::array<int, 3>, std::vector<std::size_t>> cells;
  const auto cell = [](const Vec3& p) {
    const Eigen::Array3i c = (p / kApart).array().floor().cast<int>();
    return std::array<int, 3>{c[0], c[1], c[2]};
  };
  const auto crowded = [&](const Vec3& p) {
    const auto [x, y, z] = cell(p);
    for (int i = x - 1; i <= x + 1; ++i)
      for (int j = y - 1; j <= y + 1; ++j)
        for (int k = z - 1; k <= z + 1; ++k)
          if (const auto found = cells.find({i, j, k}); found != cells.end())
            for (const std::size_t n : found->second)
              if ((out.at[n] - p).norm() < kApart) return true;
    return false;
  };
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const TriMesh& mesh = bones[b].mesh;
    double area = 0;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      const Vec3 p = mesh.V.row(mesh.F(f, 0)), q = mesh.V.row(mesh.F(f, 1)),
                 r = mesh.V.row(mesh.F(f, 2));
      area += (q - p).cross(r - p).norm() / 2;
    }
    const int count = std::clamp(int(area / (spacing * spacing)), 4, 400);
    for (const int i : surface_samples(mesh, count)) {
      const Vec3 p = mesh.V.row(i);
      if (crowded(p) || skin.distance(p) > -kFromSkin) continue;
      cells[cell(p)].push_back(out.at.size());
      out.at.push_back(p);
      out.anchors.push_back({TissueAnchor::Kind::bone, int(b), {i, i, i}, Vec3::UnitX()});
    }
  }
  return out;
}

void mark_bones(const std::vector<Bone>& bones, TissueMesh& mesh) {
  Points middles(mesh.T.rows(), 3);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    middles.row(t) = (mesh.V.row(mesh.T(t, 0)) + mesh.V.row(mesh.T(t, 1)) +
                      mesh.V.row(mesh.T(t, 2)) + mesh.V.row(mesh.T(t, 3))) /
                     4;
  mesh.in_bone.assign(std::size_t(mesh.T.rows()), 0);
  for (const Bone& bone : bones) {
    const Eigen::RowVector3d low = bone.mesh.V.colwise().minCoeff(),
                             high = bone.mesh.V.colwise().maxCoeff();
    std::vector<Eigen::Index> near;
    for (Eigen::Index t = 0; t < middles.rows(); ++t)
      if ((middles.row(t).array() >= low.array()).all() &&
          (middles.row(t).array() <= high.array()).all())
        near.push_back(t);
    Points asked(near.size(), 3);
    for (std::size_t k = 0; k < near.size(); ++k) asked.row(k) = middles.row(near[k]);
    const std::vector<int> winding = winding_numbers(bone.mesh, asked);
    for (std::size_t k = 0; k < near.size(); ++k) mesh.in_bone[near[k]] |= winding[k] != 0;
  }
}

// --- TetGen, in its own program --------------------------------------------------------

// Returns the program's exit status; 128 + signal when it was ended by one.
int run_between(const fs::path& program, const std::string& argument, const MemoryFile& input,
                const MemoryFile& output) {
  try {
    ChildProcess child =
        start_program({program.string(), argument}, input.descriptor(), output.descriptor(), -1);
    int status = 0;
    while (waitpid(child.pid(), &status, 0) < 0 && errno == EINTR) continue;
    child.ended();
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  } catch (const std::system_error& e) {
    throw UnfitError(fmt::format("TetGen: {} cannot be started ({}); take --interior lattice",
                                 program.string(), e.code().message()));
  }
}

}  // namespace

TissueMesh tetgen_tissue(const TriMesh& closed_skin, const std::vector<Bone>& bones,
                         const TissueOptions& options) {
  const std::optional<fs::path> program = find_program("ECORCHE_TETGEN", "ecorche-tetgen");
  if (!program)
    throw UnfitError(
        "TetGen: the program ecorche-tetgen is not beside ecorche; build it (it needs "
        "libtet1.5-dev), name it in ECORCHE_TETGEN, or take --interior lattice");
  const BoneNodes on_bones = bone_nodes(SkinField(closed_skin), bones, options.bone_spacing);
  // The skin's vertices that have triangles come first, then the bones' nodes.
  std::vector<int> number(closed_skin.V.rows(), -1);
  std::vector<double> points;
  TissueMesh mesh;
  const auto add = [&](const Vec3& p, const TissueAnchor& anchor) {
    points.insert(points.end(), {p.x(), p.y(), p.z()});
    mesh.anchors.push_back(anchor);
  };
  Triangles F = closed_skin.F;
  for (int& v : F.reshaped()) {
    if (number[v] < 0) {
      number[v] = mesh.anchors.size();
      add(closed_skin.V.row(v), {TissueAnchor::Kind::skin, -1, {v, v, v}, Vec3::UnitX()});
    }
    v = number[v];
  }
  for (std::size_t k = 0; k < on_bones.at.size(); ++k) add(on_bones.at[k], on_bones.anchors[k]);
  MemoryFile input("TetGen"), output("TetGen");
  {
    std::string question;
    const std::int64_t counts[] = {std::int64_t(mesh.anchors.size()), F.rows()};
    put_bytes(question, counts, 2);
    put_bytes(question, points.data(), points.size());
    put_bytes(question, F.data(), std::size_t(F.size()));
    input.write_all(question);
  }
  const int status = run_between(*program, fmt::format("{}", options.quality), input, output);
  if (status != 0)
    throw UnfitError(
        fmt::format("TetGen gave up on this skin (status {}); take --interior lattice", status));
  const std::string answer = output.read_all();
  std::string_view in = answer;
  std::int64_t counts[2];
  if (in.size() < sizeof counts)
    throw UnfitError("TetGen: its answer ends too early; take --interior lattice");
  take_bytes(in, counts, 2);
  constexpr std::int64_t kMost = 1 << 26;
  if (counts[0] < std::int64_t(mesh.anchors.size()) || counts[0] > kMost || counts[1] < 1 ||
      counts[1] > kMost)
    throw UnfitError("TetGen: its answer does not hold this skin; take --interior lattice");
  if (in.size() != std::size_t(counts[0]) * 24 + std::size_t(counts[1]) * 16)
    throw UnfitError("TetGen: its answer has another length than it says");
  mesh.V.resize(counts[0], 3);
  mesh.T.resize(counts[1], 4);
  take_bytes(in, mesh.V.data(), std::size_t(mesh.V.size()));
  take_bytes(in, mesh.T.data(), std::size_t(mesh.T.size()));
  if (mesh.T.minCoeff() < 0 || mesh.T.maxCoeff() >= counts[0] || !mesh.V.allFinite())
    throw UnfitError("TetGen: its answer names points that are not there");
  mesh.anchors.resize(counts[0]);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    if (volume_of(mesh.V, mesh.T.row(t)) < 0) std::swap(mesh.T(t, 0), mesh.T(t, 1));
  mark_bones(bones, mesh);
  return mesh;
}

TissueMesh lattice_tissue(const TriMesh& closed_skin, const std::vector<Bone>& bones,
                          const TissueOptions& options) {
  const double cube = options.cube;
  const Vec3 low = closed_skin.V.colwise().minCoeff(), high = closed_skin.V.colwise().maxCoeff();
  const Eigen::Array3i size = ((high - low).array() / cube).ceil().cast<int>() +
                              3;  // nodes along each axis; one cube around the body
  if (!(cube > 0) || double(size[0]) * size[1] * size[2] > (1 << 24))
    throw LimitError(fmt::format("a lattice of {:g} mm has too many cubes", 1e3 * cube));
  const auto node = [&](int i, int j, int k) { return (i * size[1] + j) * size[2] + k; };
  const Eigen::Index nodes = size.prod();
  Points at(nodes, 3);
  for (int i = 0; i < size[0]; ++i)
    for (int j = 0; j < size[1]; ++j)
      for (int k = 0; k < size[2]; ++k)
        at.row(node(i, j, k)) = low + cube * Vec3(i - 1, j - 1, k - 1);
  const std::vector<int> inside = winding_numbers(closed_skin, at);
  // Cubes with any corner inside; six tetrahedra about the diagonal.
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
  TissueMesh mesh;
  std::vector<int> number(nodes, -1);
  std::vector<int> tetrahedra;
  for (int i = 0; i + 1 < size[0]; ++i)
    for (int j = 0; j + 1 < size[1]; ++j)
      for (int k = 0; k + 1 < size[2]; ++k) {
        bool any = false;
        for (int c = 0; c < 8; ++c)
          any = any || inside[node(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))] != 0;
        if (!any) continue;
        for (const auto& path : kPaths) {
          int corner[3] = {i, j, k};
          int t[4] = {node(i, j, k)};
          for (int step = 0; step < 3; ++step) {
            ++corner[path[step]];
            t[step + 1] = node(corner[0], corner[1], corner[2]);
          }
          const bool even = path[1] == (path[0] + 1) % 3;
          if (!even) std::swap(t[2], t[3]);
          tetrahedra.insert(tetrahedra.end(), t, t + 4);
        }
      }
  std::vector<Vec3> used;
  for (int& v : tetrahedra) {
    int& n = number[v];
    if (n < 0) {
      n = used.size();
      used.push_back(at.row(v));
      mesh.anchors.emplace_back();
      if (inside[v] == 0) mesh.anchors.back().kind = TissueAnchor::Kind::skin;
    }
    v = n;
  }
  mesh.V.resize(used.size(), 3);
  for (std::size_t n = 0; n < used.size(); ++n) mesh.V.row(n) = used[n];
  mesh.T = Eigen::Map<const Tetrahedra>(tetrahedra.data(), Eigen::Index(tetrahedra.size() / 4), 4);
  // Nodes outside go with the nearest point of the skin, nodes near a bone with its nearest vertex.
  const SkinField skin(closed_skin);
  for (std::size_t n = 0; n < used.size(); ++n) {
    TissueAnchor& anchor = mesh.anchors[n];
    if (anchor.kind != TissueAnchor::Kind::skin) continue;
    const SkinPoint nearest = skin.nearest(used[n]);
    const auto face = closed_skin.F.row(nearest.triangle);
    const Vec3 a = closed_skin.V.row(face[0]), b = closed_skin.V.row(face[1]),
               c = closed_skin.V.row(face[2]);
    const Vec3 normal = (b - a).cross(c - a);
    const double area = normal.squaredNorm();
    anchor.vertices = {face[0], face[1], face[2]};
    if (area > 0) {
      const double v = (c - b).cross(nearest.point - b).dot(normal) / area,
                   w = (a - c).cross(nearest.point - c).dot(normal) / area;
      anchor.weights = Vec3(v, w, 1 - v - w);
    }
  }
  const BoneNodes on_bones = bone_nodes(skin, bones, std::min(options.bone_spacing, cube));
  std::vector<double> nearest(used.size(), 0.75 * cube);
  for (std::size_t k = 0; k < on_bones.at.size(); ++k) {
    const Eigen::Array3i from = ((on_bones.at[k] - low) / cube).array().floor().cast<int>() + 1;
    for (int c = 0; c < 8; ++c) {
      const int n = number[node(from[0] + (c & 1), from[1] + (c >> 1 & 1), from[2] + (c >> 2))];
      if (n < 0 || mesh.anchors[n].kind == TissueAnchor::Kind::skin) continue;
      const double away = (used[n] - on_bones.at[k]).norm();
      if (away >= nearest[n]) continue;
      nearest[n] = away;
      mesh.anchors[n] = on_bones.anchors[k];
    }
  }
  mark_bones(bones, mesh);
  return mesh;
}

void write_tissue_vtk(const fs::path& file, const TissueMesh& mesh) {
  fmt::memory_buffer out;
  const auto add = [&]<class... Values>(fmt::format_string<Values...> text, Values&&... values) {
    fmt::format_to(std::back_inserter(out), text, std::forward<Values>(values)...);
  };
  add("# vtk DataFile Version 3.0\nsoft tissue in metres\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS "
      "{} double\n",
      mesh.V.rows());
  for (Eigen::Index n = 0; n < mesh.V.rows(); ++n)
    add("{:.9g} {:.9g} {:.9g}\n", mesh.V(n, 0), mesh.V(n, 1), mesh.V(n, 2));
  add("CELLS {} {}\n", mesh.T.rows(), 5 * mesh.T.rows());
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    add("4 {} {} {} {}\n", mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3));
  constexpr int kTetrahedron = 10;
  add("CELL_TYPES {}\n", mesh.T.rows());
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) add("{}\n", kTetrahedron);
  add("CELL_DATA {}\nSCALARS part int 1\nLOOKUP_TABLE default\n", mesh.T.rows());
  for (const char in_bone : mesh.in_bone) add("{}\n", in_bone ? 1 : 0);
  add("POINT_DATA {}\nSCALARS anchor int 1\nLOOKUP_TABLE default\n", mesh.V.rows());
  for (const TissueAnchor& anchor : mesh.anchors) add("{}\n", int(anchor.kind));
  write_file_atomically(file, {out.data(), out.size()});
}

std::vector<double> tissue_volumes(const TissueMesh& mesh, const Points& moved) {
  std::vector<double> out;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) out.push_back(volume_of(moved, mesh.T.row(t)));
  return out;
}

}  // namespace ecorche::inline v1
