#include "anatomy/base_mesh/skin_texture.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

const char* const kMeshPath = "mpfb2/3dobjs/base.obj";

using Place = Eigen::RowVector2f;
using Corners = std::vector<std::array<Place, 3>>;  // #F, of each triangle's corners

// The places at the corners of the skin's quads, in the file's order; #Q.
std::vector<std::array<Place, 4>> read_quad_corners(const BodyPackage& package) {
  const auto bytes = package.reader ? package.reader(kMeshPath) : std::nullopt;
  if (!bytes)
    throw InputError(fmt::format(
        "{}: missing from the body package; run `make setup` to fetch it again", kMeshPath));
  std::vector<Place> places;
  std::vector<std::array<Place, 4>> quads;
  bool skin = false;
  TextScan scan(*bytes, kMeshPath);
  while (scan.next_line()) {
    const auto key = scan.word();
    if (key == "vt") {
      const double right = scan.number("u"), up = scan.number("v");
      places.emplace_back(float(right), float(up));
    } else if (key == "g") {
      skin = scan.word() == "body";
    } else if (key == "f" && skin) {
      std::array<Place, 4>& quad = quads.emplace_back();
      for (Place& corner : quad) {
        const auto word = scan.word();
        const std::size_t slash = word.find('/');
        long long index = 0;
        if (slash == word.npos ||
            !parse_whole(word.substr(slash + 1, word.find('/', slash + 1) - slash - 1), index) ||
            index < 1 || index > static_cast<long long>(places.size()))
          scan.fail("a corner of the skin has no place on the texture");
        corner = places[index - 1];
      }
    }
  }
  if (Eigen::Index(quads.size()) != package.quads.rows())
    throw InputError(fmt::format("{}: places on the texture for {} quads of {}", kMeshPath,
                                 quads.size(), package.quads.rows()));
  return quads;
}

// A textured vertex for every place that a skin vertex has; the first place found is the vertex's
// own.
SkinTexture from_corners(const Triangles& F, int vertices, const Corners& corners) {
  SkinTexture out;
  out.F = F;
  for (int i = 0; i < vertices; ++i) out.vertex.push_back(i);
  std::vector<Place> places(vertices, Place::Zero());
  std::vector<bool> placed(vertices, false);
  std::vector<std::vector<int>> copies(vertices);
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = F(f, k);
      const Place& place = corners[f][k];
      const std::size_t at = v;
      if (!placed[at]) {
        placed[at] = true;
        places[at] = place;
      }
      if (places[at] == place) continue;
      const auto same = [&](int copy) { return places[copy] == place; };
      const auto found = std::find_if(copies[at].begin(), copies[at].end(), same);
      if (found == copies[at].end()) {
        copies[at].push_back(int(places.size()));
        places.push_back(place);
        out.vertex.push_back(v);
        out.F(f, k) = copies[at].back();
      } else {
        out.F(f, k) = *found;
      }
    }
  out.places.resize(places.size(), 2);
  for (std::size_t i = 0; i < places.size(); ++i) out.places.row(i) = places[i];
  return out;
}

// What a fine vertex is to the base triangles around it.
struct FineVertex {
  int base = -1;           // the base vertex that it comes from, or -1
  int parents[2]{-1, -1};  // base triangles that it lies in: two on an edge, one in the middle
  int near = -1;           // on an edge: the base vertex a third of the edge away
};

std::vector<FineVertex> fine_vertices(const Refinement& refinement) {
  std::vector<FineVertex> out(refinement.map.rows());
  for (std::size_t b = 0; b < refinement.base_rows.size(); ++b)
    out[refinement.base_rows[b]].base = int(b);
  for (Eigen::Index f = 0; f < refinement.F.rows(); ++f) {
    const int parent = refinement.parents[f];
    const Eigen::RowVector3i t = refinement.F.row(f);
    int corner = -1;
    for (const int v : t) corner = std::max(corner, out[v].base);
    for (const int v : t) {
      FineVertex& one = out[v];
      if (one.base >= 0) continue;
      if (corner >= 0)
        one.near = corner;  // only the triangles at a base vertex have one as a corner
      if (one.parents[0] < 0)
        one.parents[0] = parent;
      else if (one.parents[0] != parent)
        one.parents[1] = parent;
    }
  }
  return out;
}

// Where a fine vertex lies in a base triangle whose corners lie at `places`. `other`: the triangle
// across the edge that it lies on.
Place place_in(const FineVertex& one, const Eigen::RowVector3i& triangle,
               const Eigen::RowVector3i& other, const std::array<Place, 3>& places) {
  if (one.base >= 0)
    for (int k = 0; k < 3; ++k)
      if (triangle[k] == one.base) return places[k];
  if (one.parents[1] < 0) return (places[0] + places[1] + places[2]) / 3;
  Place near = Place::Zero(), far = Place::Zero();
  for (int k = 0; k < 3; ++k) {
    if (triangle[k] == one.near)
      near = places[k];
    else if ((other.array() == triangle[k]).any())
      far = places[k];
  }
  return (2 * near + far) / 3;
}

}  // namespace

SkinTexture skin_texture(const BodyPackage& package) {
  const auto quads = read_quad_corners(package);
  Corners corners(std::size_t(package.triangles.rows()));
  for (Eigen::Index f = 0; f < package.triangles.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 4; ++c)
        if (package.quads(f / 2, c) == package.triangles(f, k)) corners[f][k] = quads[f / 2][c];
  return from_corners(package.triangles, package.skin_size, corners);
}

SkinTexture skin_texture(const SkinTexture& base, const Refinement& refinement) {
  const std::vector<FineVertex> fine = fine_vertices(refinement);
  // The base triangle's corners as skin vertices, and where they lie.
  const auto corners_of = [&](int parent) {
    Eigen::RowVector3i triangle = base.F.row(parent);
    for (int& v : triangle) v = base.vertex[v];
    return triangle;
  };
  Corners corners(std::size_t(refinement.F.rows()));
  for (Eigen::Index f = 0; f < refinement.F.rows(); ++f) {
    const int parent = refinement.parents[f];
    std::array<Place, 3> places;
    for (int k = 0; k < 3; ++k) places[k] = base.places.row(base.F(parent, k));
    const Eigen::RowVector3i triangle = corners_of(parent);
    for (int k = 0; k < 3; ++k) {
      const FineVertex& one = fine[refinement.F(f, k)];
      const int across = one.parents[0] == parent ? one.parents[1] : one.parents[0];
      corners[f][k] = place_in(one, triangle, across < 0 ? triangle : corners_of(across), places);
    }
  }
  return from_corners(refinement.F, int(refinement.map.rows()), corners);
}

Points textured_rows(const SkinTexture& texture, const Points& skin) {
  Points out(texture.vertex.size(), 3);
  for (std::size_t i = 0; i < texture.vertex.size(); ++i) out.row(i) = skin.row(texture.vertex[i]);
  return out;
}

}  // namespace ecorche::inline v1
