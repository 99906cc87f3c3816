#include "anatomy/mesh_files/stl_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <sstream>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

namespace {

using Corner = std::array<float, 3>;

// Corners of a triangle soup become an indexed mesh; vertices are numbered in order of appearance.
TriMesh weld(const std::vector<Corner>& corners, const std::string& name) {
  std::map<Corner, int> known;
  std::vector<Corner> vertices;
  std::vector<std::array<int, 3>> faces;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
    std::array<int, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner& p = corners[c + k];
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
        throw InputError(fmt::format("{}: triangle {}: a coordinate is not finite", name, c / 3));
      }
      const auto [entry, fresh] = known.try_emplace(p, int(vertices.size()));
      if (fresh) vertices.push_back(p);
      face[k] = entry->second;
    }
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) faces.push_back(face);
  }
  TriMesh mesh;
  mesh.V.resize(vertices.size(), 3);
  mesh.F.resize(faces.size(), 3);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    for (int k = 0; k < 3; ++k) mesh.V(i, k) = vertices[i][k];
  }
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) mesh.F(f, k) = faces[f][k];
  }
  return mesh;
}

std::vector<Corner> ascii_corners(std::string_view bytes, const std::string& name) {
  std::istringstream in{std::string(bytes)};
  in.imbue(std::locale::classic());
  std::vector<Corner> corners;
  std::string word;
  while (in >> word) {
    if (word != "vertex") continue;
    Corner p{};
    if (!(in >> p[0] >> p[1] >> p[2])) {
      throw InputError(fmt::format("{}: vertex {}: three numbers expected", name, corners.size()));
    }
    corners.push_back(p);
  }
  if (corners.empty() || corners.size() % 3 != 0) {
    throw InputError(fmt::format("{}: {} corners in an ASCII STL file; three a triangle expected",
                                 name, corners.size()));
  }
  return corners;
}

}  // namespace

TriMesh parse_stl(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kHeader = 84, kRecord = 50;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + 80, sizeof count);
  // Some binary files begin with "solid", so the size decides; division keeps a forged count from
  // overflowing.
  const bool binary = bytes.size() >= kHeader && (bytes.size() - kHeader) / kRecord >= count &&
                      count > 0 &&
                      (bytes.size() == kHeader + kRecord * count || !bytes.starts_with("solid"));
  if (!binary) {
    if (bytes.starts_with("solid")) return weld(ascii_corners(bytes, name), name);
    throw InputError(fmt::format("{}: not an STL file: {} bytes, {} triangles stated", name,
                                 bytes.size(), count));
  }
  std::vector<Corner> corners(std::size_t{3} * count);
  for (std::size_t f = 0; f < count; ++f) {
    std::memcpy(&corners[3 * f], bytes.data() + kHeader + kRecord * f + sizeof(Corner),
                3 * sizeof(Corner));
  }
  return weld(corners, name);
}

namespace {

struct HalfEdge {
  int from, to, face;
  bool operator<(const HalfEdge& o) const {
    const auto key = [](const HalfEdge& e) {
      return std::array{std::min(e.from, e.to), std::max(e.from, e.to), e.face};
    };
    return key(*this) < key(o);
  }
  bool same_edge(const HalfEdge& o) const {
    return (from == o.from && to == o.to) || (from == o.to && to == o.from);
  }
};

std::vector<HalfEdge> sorted_half_edges(const TriMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.F.rows());
  for (int f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) edges.push_back({mesh.F(f, k), mesh.F(f, (k + 1) % 3), f});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

TriMesh extract(const TriMesh& mesh, const std::vector<int>& faces) {
  std::vector<int> new_index(mesh.V.rows(), -1);
  std::vector<int> kept;
  TriMesh part;
  part.F.resize(faces.size(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      int& index = new_index[mesh.F(faces[f], k)];
      if (index < 0) {
        index = kept.size();
        kept.push_back(mesh.F(faces[f], k));
      }
      part.F(f, k) = index;
    }
  }
  part.V.resize(kept.size(), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) part.V.row(i) = mesh.V.row(kept[i]);
  return part;
}

}  // namespace

std::vector<TriMesh> connected_components(const TriMesh& mesh) {
  std::vector<int> root(mesh.F.rows());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int f) {
    while (root[f] != f) {
      f = root[f] = root[root[f]];
    }
    return f;
  };
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
  for (std::size_t e = 0, next = 0; e < edges.size(); e = next) {
    for (next = e + 1; next < edges.size() && edges[next].same_edge(edges[e]);) ++next;
    if (next - e != 2) continue;
    const int a = find(edges[e].face), b = find(edges[e + 1].face);
    root[std::max(a, b)] = std::min(a, b);
  }
  std::map<int, std::vector<int>> parts;  // by their first triangle
  for (int f = 0; f < mesh.F.rows(); ++f) parts[find(f)].push_back(f);
  std::vector<std::vector<int>> faces;
  for (auto& [first, part] : parts) faces.push_back(std::move(part));
  std::stable_sort(faces.begin(), faces.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<TriMesh> components;
  for (const auto& part : faces) components.push_back(extract(mesh, part));
  return components;
}

bool is_closed(const TriMesh& mesh) {
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
  for (std::size_t e = 0; e < edges.size(); e += 2) {
    if (e + 1 >= edges.size() || edges[e].from != edges[e + 1].to ||
        edges[e].to != edges[e + 1].from)
      return false;
    if (e + 2 < edges.size() && edges[e + 2].same_edge(edges[e])) return false;
  }
  return true;
}

namespace {

// Twice the area of a triangle.
double doubled_area(const TriMesh& mesh, Eigen::Index f) {
  const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
             c = mesh.V.row(mesh.F(f, 2));
  return (b - a).cross(c - a).norm();
}

}  // namespace

double surface_area(const TriMesh& mesh) {
  double doubled = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) doubled += doubled_area(mesh, f);
  return doubled / 2;
}

Vec3 surface_centroid(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const double w = doubled_area(mesh, f);
    sum += w / 3 *
           (mesh.V.row(mesh.F(f, 0)) + mesh.V.row(mesh.F(f, 1)) + mesh.V.row(mesh.F(f, 2)))
               .transpose();
    weight += w;
  }
  return weight > 0 ? Vec3(sum / weight) : Vec3(mesh.V.colwise().mean());
}

}  // namespace ecorche::inline v1
