#include "viewer/cut_faces.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
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
const Vec3f kMarrowColor(0.82f, 0.54f, 0.40f);
constexpr float kShell = 0.001f, kShaftShare = 0.45f;  // m, compact bone; of a shaft's radius
constexpr double kWidest = 0.03;                       // m, half of the widest shaft
constexpr float kSlender = 6;                          // of a shaft's radius, lengths of long bones
constexpr float kSkinRim = 0.002f, kSheet = 0.0012f;   // m

// In which order tissues lie over each other.
enum Rank { fat, room, muscle, sheet, bone, shell, skull_room, rim };

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

// Where along a bone its shaft is: 1 there, 0 at the ends and in bones without one.
class BoneShaft {
 public:
  explicit BoneShaft(const std::vector<Vec3f>& positions) {
    for (const Vec3f& p : positions) middle_ += p / float(positions.size());
    Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
    for (const Vec3f& p : positions) spread += (p - middle_) * (p - middle_).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(spread);
    axis_ = solver.eigenvectors().col(2);
    float low = 0, high = 0;
    for (const Vec3f& p : positions) {
      low = std::min(low, axis_.dot(p - middle_));
      high = std::max(high, axis_.dot(p - middle_));
    }
    middle_ += 0.5f * (low + high) * axis_;
    half_ = std::max(0.5f * (high - low), 1e-4f);
    slender_ = 2 * half_ > kSlender * width_of(positions);
  }
  float at(const Vec3f& place) const {  // of the mesh
    if (!slender_) return 0;
    const float away = std::abs(axis_.dot(place - middle_)) / half_;
    const float t = std::clamp((0.85f - away) / 0.3f, 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  }

 private:
  // The mean distance from its own middle line, which may be bowed, over the half about the middle.
  float width_of(const std::vector<Vec3f>& positions) const {
    constexpr int pieces = 6;
    std::array<Vec3f, pieces> middles;
    std::array<int, pieces> counts{};
    middles.fill(Vec3f::Zero());
    const auto piece_of = [&](const Vec3f& p) {
      return int(std::floor(float(pieces) * (axis_.dot(p - middle_) / half_ + 0.5f)));
    };
    const auto across = [&](const Vec3f& p) { return Vec3f(p - axis_.dot(p) * axis_); };
    for (const Vec3f& p : positions)
      if (const int k = piece_of(p); k >= 0 && k < pieces)
        middles[std::size_t(k)] += across(p), ++counts[std::size_t(k)];
    float sum = 0;
    int count = 0;
    for (const Vec3f& p : positions)
      if (const int k = piece_of(p); k >= 0 && k < pieces) {
        sum += (across(p) - middles[std::size_t(k)] / float(counts[std::size_t(k)])).norm();
        ++count;
      }
    return count > 0 ? sum / float(count) : half_;
  }

  Vec3f middle_ = Vec3f::Zero(), axis_ = Vec3f::UnitY();
  float half_ = 1;
  bool slender_ = false;
};

// How far a point can go inwards until it is half way to another side of the outline.
double half_way(const Outline& outline, const Vec2& from, const Vec2& inwards, double most) {
  double out = most;
  for (const auto& [i, j] : outline.segments) {
    const Vec2 &a = outline.points[std::size_t(i)], &b = outline.points[std::size_t(j)];
    const Vec2 along = b - a, to = a - from;
    if (to.norm() > 2 * most + along.norm()) continue;
    const double across = inwards.x() * along.y() - inwards.y() * along.x();
    if (std::abs(across) < 1e-12) continue;
    const double distance = (to.x() * along.y() - to.y() * along.x()) / across,
                 share = (to.x() * inwards.y() - to.y() * inwards.x()) / across;
    if (share >= 0 && share <= 1 && distance > 1e-5) out = std::min(out, 0.5 * distance);
  }
  return out;
}

// A band within the outline, of a thickness by place, that goes round its corners whole.
void add_shell(const Outline& outline, const BoneShaft& shaft, const DrawItem& item,
               std::uint32_t part, Faces& faces) {
  std::vector<Vec2> inwards(outline.points.size(), Vec2::Zero());
  for (const auto& [from, to] : outline.segments) {
    const Vec2 along = outline.points[std::size_t(to)] - outline.points[std::size_t(from)];
    const Vec2 left(-along.y(), along.x());
    if (left.norm() < 1e-9) continue;
    inwards[std::size_t(from)] += left.normalized();
    inwards[std::size_t(to)] += left.normalized();
  }
  const Mat4f X_MW = item.X_WM.inverse();
  const auto first = std::uint32_t(faces.mesh.positions.size());
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const Vec2& at = outline.points[i];
    const Vec3f place = (X_MW * faces.frame.place(at).homogeneous()).head<3>();
    Vec2 inner = at;
    if (inwards[i].norm() > 1e-6) {
      const Vec2 way = inwards[i].normalized();
      const double half = half_way(outline, at, way, kWidest);
      const double thick = std::max(double(kShell), kShaftShare * half * double(shaft.at(place)));
      inner += std::min(thick, half) * way;
    }
    faces.add_vertex(at, outline.colors[i], part);
    faces.add_vertex(inner, outline.colors[i], part);
  }
  for (const auto& [from, to] : outline.segments) {
    const std::uint32_t a = first + 2 * std::uint32_t(from), b = first + 2 * std::uint32_t(to);
    faces.mesh.triangles.emplace_back(a, b, b + 1);
    faces.mesh.triangles.emplace_back(a, b + 1, a + 1);
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
    case Part::Kind::room:
      return part == kFirstRoomPart ? skull_room : room;
    default:
      return bone;
  }
}

}  // namespace

DrawMesh cut_faces(const Vec4f& plane, const DrawList& list, std::span<const DrawMesh> rooms) {
  struct Piece {
    Rank rank;
    std::uint32_t part;
    Outline outline;
    const DrawItem* item = nullptr;
  };
  Faces faces{PlaneFrame(plane), {}};
  std::vector<Piece> pieces;
  for (const DrawItem& item : list.items) {
    if (item.cut_face) continue;
    const DrawMesh& mesh = list.meshes[std::size_t(item.mesh)];
    for (auto& [part, outline] : outlines_of(faces.frame, mesh, item)) {
      const Rank rank = rank_of(part);
      if (rank == fat) pieces.push_back({rim, part, outline});
      if (rank == bone && part_of(part).kind == Part::Kind::bone)
        pieces.push_back({shell, part, outline, &item});
      pieces.push_back({rank, part, std::move(outline), &item});
    }
  }
  const bool skinned = std::ranges::any_of(pieces, [](const Piece& p) { return p.rank == fat; });
  for (const DrawMesh& room : rooms)
    for (auto& [part, outline] : outlines_of(faces.frame, room, {}))
      if (skinned) pieces.push_back({rank_of(part), part, std::move(outline)});
  std::ranges::stable_sort(pieces, {}, [](const Piece& p) { return std::pair(p.rank, p.part); });
  for (const Piece& piece : pieces) {
    if (piece.rank == rim)
      add_band(piece.outline, kSkinRim, 0, piece.part, faces);
    else if (piece.rank == shell)
      add_shell(piece.outline, BoneShaft(list.meshes[std::size_t(piece.item->mesh)].positions),
                *piece.item, piece.part, faces);
    else if (piece.rank == sheet)
      add_band(piece.outline, kSheet / 2, kSheet / 2, piece.part, faces);
    else
      add_filled(piece.outline,
                 piece.rank == fat ? &kFatColor
                 : piece.rank == bone && part_of(piece.part).kind == Part::Kind::bone
                     ? &kMarrowColor
                     : nullptr,
                 piece.part, faces);
  }
  return std::move(faces.mesh);
}

std::vector<FacePlace> room_places(const DrawMesh& faces) {
  std::map<std::uint32_t, FacePlace> places;
  for (const Triangle32& t : faces.triangles) {
    const std::uint32_t part = faces.parts[t[0]];
    if (part_of(part).kind != Part::Kind::room) continue;
    const Vec3f &a = faces.positions[t[0]], &b = faces.positions[t[1]], &c = faces.positions[t[2]];
    const float area = 0.5f * (b - a).cross(c - a).norm();
    FacePlace& place = places[part];
    place.part = part;
    place.middle += area * (a + b + c) / 3;
    place.area += area;
  }
  std::vector<FacePlace> out;
  for (auto& [part, place] : places) {
    if (place.area <= 0) continue;
    place.middle /= place.area;
    out.push_back(place);
  }
  return out;
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
