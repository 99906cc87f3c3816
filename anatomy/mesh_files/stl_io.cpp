#include "anatomy/mesh_files/stl_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {

namespace {

using Corner = std::array<float, 3>;

// Vertices in order of appearance, found again by their coordinates: a table of places, open at
// the next free one.
class VertexTable {
 public:
  explicit VertexTable(std::size_t corners) {
    std::size_t size = 1024;
    while (size < corners) size *= 2;  // a closed mesh has a sixth as many vertices
    places_.assign(size / 2, -1);
  }

  int find_or_add(Corner p) {
    for (float& x : p) x += 0.0F;  // -0 is 0
    if (2 * vertices_.size() >= places_.size()) grow();
    for (std::size_t at = hash(p);; ++at) {
      int& place = places_[at & (places_.size() - 1)];
      if (place >= 0 && vertices_[place] != p) continue;
      if (place < 0) {
        place = int(vertices_.size());
        vertices_.push_back(p);
      }
      return place;
    }
  }
  const std::vector<Corner>& vertices() const { return vertices_; }

 private:
  static std::size_t hash(const Corner& p) {
    std::array<std::uint32_t, 3> bits{};
    std::memcpy(bits.data(), p.data(), sizeof p);
    std::uint64_t mixed = 0;
    for (const std::uint32_t word : bits) {
      mixed = (mixed ^ word) * 0x9E3779B97F4A7C15ULL;
      mixed ^= mixed >> 29;
    }
    return std::size_t(mixed);
  }
  void grow() {
    places_.assign(2 * places_.size(), -1);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      std::size_t at = hash(vertices_[i]);
      while (places_[at & (places_.size() - 1)] >= 0) ++at;
      places_[at & (places_.size() - 1)] = int(i);
    }
  }

  std::vector<int> places_;
  std::vector<Corner> vertices_;
};

// Corners of a triangle soup become an indexed mesh; `corner(c)` gives each.
template <class CornerOf>
TriMesh weld(std::size_t corners, CornerOf corner, const std::string& name) {
  if (corners / 3 > std::size_t(limits::kMeshElements))
    throw LimitError(
        fmt::format("{}: {} triangles; the limit is {}", name, corners / 3, limits::kMeshElements));
  VertexTable table(corners);
  std::vector<int> faces;
  faces.reserve(corners);
  for (std::size_t c = 0; c + 2 < corners; c += 3) {
    std::array<int, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner p = corner(c + k);
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
        throw InputError(fmt::format("{}: triangle {}: a coordinate is not finite", name, c / 3));
      }
      face[k] = table.find_or_add(p);
    }
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0])
      faces.insert(faces.end(), face.begin(), face.end());
  }
  TriMesh mesh;
  mesh.V.resize(Eigen::Index(table.vertices().size()), 3);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    for (int k = 0; k < 3; ++k) mesh.V(i, k) = table.vertices()[i][k];
  }
  mesh.F = Eigen::Map<const Triangles>(faces.data(), Eigen::Index(faces.size() / 3), 3);
  return mesh;
}

std::vector<Corner> ascii_corners(std::string_view bytes, const std::string& name) {
  TextScan scan(bytes, name);
  std::vector<Corner> corners;
  while (scan.next_line()) {
    for (std::string_view word = scan.word(); !word.empty(); word = scan.word()) {
      if (word != "vertex") continue;
      Corner p{};
      for (float& x : p) {
        double value = 0;
        const std::string_view number = scan.word();
        if (!parse_number(number, value))
          throw InputError(
              fmt::format("{}: vertex {}: three numbers expected", name, corners.size()));
        x = float(value);
      }
      corners.push_back(p);
    }
  }
  if (corners.empty() || corners.size() % 3 != 0) {
    throw InputError(fmt::format("{}: {} corners in an ASCII STL file; three a triangle expected",
                                 name, corners.size()));
  }
  return corners;
}

// The triangles of a binary file; nothing where it is none. Some begin with "solid", so the size
// decides; division keeps a forged count from overflowing.
constexpr std::size_t kHeader = 84, kRecord = 50;
std::optional<std::size_t> binary_triangles(std::string_view bytes) {
  if (bytes.size() < kHeader) return std::nullopt;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  if (count == 0 || (bytes.size() - kHeader) / kRecord < count) return std::nullopt;
  return count;
}

}  // namespace

bool is_stl(std::string_view bytes) {
  const auto count = binary_triangles(bytes);
  if (count && bytes.size() == kHeader + kRecord * *count) return true;
  const std::string_view head = bytes.substr(0, 4096);
  return head.starts_with("solid") && head.find("facet") != std::string_view::npos;
}

TriMesh parse_stl(std::string_view bytes, const std::string& name) {
  const auto count = binary_triangles(bytes);
  if (!count || (bytes.size() != kHeader + kRecord * *count && bytes.starts_with("solid"))) {
    if (!bytes.starts_with("solid")) {
      std::uint32_t stated = 0;
      if (bytes.size() >= kHeader) std::memcpy(&stated, bytes.data() + 80, sizeof stated);
      throw InputError(fmt::format("{}: not an STL file: {} bytes, {} triangles stated", name,
                                   bytes.size(), stated));
    }
    const std::vector<Corner> corners = ascii_corners(bytes, name);
    return weld(
        corners.size(), [&](std::size_t c) { return corners[c]; }, name);
  }
  const auto corner = [&](std::size_t c) {
    Corner p;
    std::memcpy(&p, bytes.data() + kHeader + kRecord * (c / 3) + sizeof(Corner) * (1 + c % 3),
                sizeof p);
    return p;
  };
  return weld(3 * *count, corner, name);
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
