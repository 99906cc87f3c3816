#include "viewer/cut_faces.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>
#include <utility>

#include "anatomy/base_mesh/tissue_look.h"
#include "anatomy/geometry/fill_outline.h"
#include "viewer/scene.h"

namespace ecorche {
namespace {

// Of fresh fat. Dermis is 1 to 4 mm thick, sheets of fascia about one (Laurent and others 2007,
// Stecco 2015).
const Vec3f kFatColor(0.93f, 0.80f, 0.50f);
constexpr float kSkinRim = 0.002f, kSheet = 0.0012f;  // m

// In which order tissues lie over each other.
enum Rank { fat, muscle, sheet, bone, rim };

// Where a plane meets a mesh: points with colours, and segments with the inside on their left.
struct Outline {
  std::vector<Vec2> points;
  std::vector<Vec3f> colors;
  std::vector<std::array<int, 2>> segments;
};

// Directions within the plane, a x b = n.
struct PlaneFrame {
  Vec3f origin, a, b, n;

  explicit PlaneFrame(const Vec4f& plane) {
    n = plane.head<3>();
    origin = plane.w() * n;
    a = n.unitOrthogonal();
    b = n.cross(a);
  }
  Vec2 flat(const Vec3f& p) const { return {double(a.dot(p - origin)), double(b.dot(p - origin))}; }
  Vec3f place(const Vec2& p) const { return origin + float(p.x()) * a + float(p.y()) * b; }
};

// Outlines of an item by part.
std::map<std::uint32_t, Outline> outlines_of(const PlaneFrame& frame, const DrawMesh& mesh,
                                             const DrawItem& item) {
  std::map<std::uint32_t, Outline> out;
  std::vector<Vec3f> places;
  std::vector<float> over;
  for (const Vec3f& p : mesh.positions) {
    places.push_back(item.X_WM.topLeftCorner<3, 3>() * p + item.X_WM.topRightCorner<3, 1>());
    over.push_back(frame.n.dot(places.back() - frame.origin));
  }
  std::unordered_map<std::uint64_t, int> known;  // by the edge; its part is that of its triangles
  const auto crossing = [&](std::uint32_t i, std::uint32_t j, Outline& outline) {
    if (i > j) std::swap(i, j);
    const auto [at, fresh] =
        known.try_emplace((std::uint64_t(i) << 32) | j, int(outline.points.size()));
    if (!fresh) return at->second;
    const float u = over[i] / (over[i] - over[j]);
    outline.points.push_back(frame.flat(places[i] + u * (places[j] - places[i])));
    outline.colors.push_back(mesh.colors.empty()
                                 ? item.surface.color
                                 : Vec3f(mesh.colors[i] + u * (mesh.colors[j] - mesh.colors[i])));
    return at->second;
  };
  for (const Triangle32& t : mesh.triangles) {
    const bool above[3] = {over[t[0]] >= 0, over[t[1]] >= 0, over[t[2]] >= 0};
    if (above[0] == above[1] && above[1] == above[2]) continue;
    Outline& outline = out[mesh.parts.empty() ? item.part : mesh.parts[t[0]]];
    std::array<int, 2> segment{};
    for (int k = 0; k < 3; ++k)  // from where the triangle goes down to where it comes up
      if (above[k] != above[(k + 1) % 3])
        segment[above[k] ? 0 : 1] = crossing(t[k], t[(k + 1) % 3], outline);
    outline.segments.push_back(segment);
  }
  return out;
}

struct Faces {
  PlaneFrame frame;
  DrawMesh mesh;

  void add_vertex(const Vec2& at, const Vec3f& color, std::uint32_t part) {
    mesh.positions.push_back(frame.place(at));
    mesh.normals.push_back(frame.n);
    mesh.colors.push_back(color);
    mesh.parts.push_back(part);
  }
};

void add_filled(const Outline& outline, const Vec3f* color, std::uint32_t part, Faces& faces) {
  const FilledOutline filled = fill_outline(outline.points, outline.segments);
  const auto first = std::uint32_t(faces.mesh.positions.size());
  for (std::size_t i = 0; i < filled.points.size(); ++i)
    faces.add_vertex(filled.points[i],
                     color ? *color : outline.colors[std::min(i, outline.colors.size() - 1)], part);
  for (const auto& t : filled.triangles)
    faces.mesh.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
}

// A band along the outline, on its inner side or on both.
void add_band(const Outline& outline, float inner, float outer, std::uint32_t part, Faces& faces) {
  for (const auto& [from, to] : outline.segments) {
    const Vec2 &a = outline.points[std::size_t(from)], &b = outline.points[std::size_t(to)];
    const Vec2 along = b - a;
    if (along.norm() < 1e-9) continue;
    const Vec2 left = Vec2(-along.y(), along.x()).normalized();
    const auto first = std::uint32_t(faces.mesh.positions.size());
    for (const Vec2& at : {a, b})
      for (const float side : {-outer, inner})
        faces.add_vertex(at + double(side) * left, outline.colors[std::size_t(at == a ? from : to)],
                         part);
    faces.mesh.triangles.emplace_back(first, first + 2, first + 3);
    faces.mesh.triangles.emplace_back(first, first + 3, first + 1);
  }
}

Rank rank_of(std::uint32_t part) {
  switch (part_of(part).kind) {
    case Part::Kind::skin:
      return fat;
    case Part::Kind::muscle:
      return muscle;
    case Part::Kind::fascia:
      return sheet;
    default:
      return bone;
  }
}

}  // namespace

DrawMesh cut_faces(const Vec4f& plane, const DrawList& list) {
  struct Piece {
    Rank rank;
    std::uint32_t part;
    Outline outline;
  };
  Faces faces{PlaneFrame(plane), {}};
  std::vector<Piece> pieces;
  for (const DrawItem& item : list.items) {
    if (item.cut_face) continue;
    const DrawMesh& mesh = list.meshes[std::size_t(item.mesh)];
    for (auto& [part, outline] : outlines_of(faces.frame, mesh, item)) {
      const Rank rank = rank_of(part);
      if (rank == fat) pieces.push_back({rim, part, outline});
      pieces.push_back({rank, part, std::move(outline)});
    }
  }
  std::ranges::stable_sort(pieces, {}, [](const Piece& p) { return std::pair(p.rank, p.part); });
  for (const Piece& piece : pieces) {
    if (piece.rank == rim)
      add_band(piece.outline, kSkinRim, 0, piece.part, faces);
    else if (piece.rank == sheet)
      add_band(piece.outline, kSheet / 2, kSheet / 2, piece.part, faces);
    else
      add_filled(piece.outline, piece.rank == fat ? &kFatColor : nullptr, piece.part, faces);
  }
  return std::move(faces.mesh);
}

void add_cut(const Vec4f& plane, DrawMesh faces, DrawList& list) {
  list.cut = plane;
  if (faces.triangles.empty()) return;
  DrawItem item;
  item.mesh = int(list.meshes.size());
  item.surface = {.roughness = 0.7f, .specular = 0.02f, .scatter = 0.2f};
  item.casts_shadow = false;
  item.cut_face = true;
  list.meshes.push_back(std::move(faces));
  list.items.push_back(item);
}

}  // namespace ecorche
