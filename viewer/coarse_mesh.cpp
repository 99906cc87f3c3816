#include "viewer/coarse_mesh.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"

namespace ecorche {
namespace {

constexpr float kLeastTurn = 0.2f;  // cosine between the normals of a vertex and its stand-in
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Neighbours of all vertices over edges, one after the other.
struct Neighbours {
  std::vector<std::uint32_t> begin, of;

  Neighbours(std::size_t vertices, std::span<const Triangle32> triangles)
      : begin(vertices + 1, 0), of(6 * triangles.size()) {
    for (const Triangle32& t : triangles)
      for (int k = 0; k < 3; ++k) begin[t[k] + 1] += 2;
    for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const Triangle32& t : triangles)
      for (int k = 0; k < 3; ++k) {
        of[next[t[k]]++] = t[(k + 1) % 3];
        of[next[t[k]]++] = t[(k + 2) % 3];
      }
  }
};

std::vector<Vec3f> rows_of(const PointsF& points) {
  std::vector<Vec3f> out(std::size_t(points.rows()));
  for (Eigen::Index i = 0; i < points.rows(); ++i) out[std::size_t(i)] = points.row(i).transpose();
  return out;
}

// By part, so that parts can be left out; returns where each begins.
template <class Part>
std::vector<int> add_by_part(const std::vector<Part>& parts, const PointsF& positions,
                             const PointsF& normals, float reach, DrawMesh& mesh) {
  const std::vector<Vec3f> places = rows_of(positions), directions = rows_of(normals);
  const std::vector<std::uint32_t> standing =
      standing_for(places, directions, mesh.triangles, reach);
  std::vector<int> begin{0};
  for (const Part& part : parts) {
    const std::span<const Triangle32> own(mesh.triangles.begin() + part.face_begin,
                                          mesh.triangles.begin() + part.face_end);
    const std::vector<Triangle32> coarse = coarse_triangles(own, standing);
    mesh.coarse.insert(mesh.coarse.end(), coarse.begin(), coarse.end());
    begin.push_back(int(mesh.coarse.size()));
  }
  return begin;
}

void add_whole(float reach, DrawMesh& mesh) {
  mesh.coarse = coarse_triangles(
      mesh.triangles, standing_for(mesh.positions, mesh.normals, mesh.triangles, reach));
}

}  // namespace

std::vector<std::uint32_t> standing_for(std::span<const Vec3f> positions,
                                        std::span<const Vec3f> normals,
                                        std::span<const Triangle32> triangles, float reach) {
  const Neighbours near(positions.size(), triangles);
  std::vector<std::uint32_t> out(positions.size(), kNone), open;
  for (std::uint32_t v = 0; v < out.size(); ++v) {
    if (out[v] != kNone) continue;
    out[v] = v;
    open.assign(1, v);
    while (!open.empty()) {
      const std::uint32_t from = open.back();
      open.pop_back();
      for (std::uint32_t k = near.begin[from]; k < near.begin[from + 1]; ++k) {
        const std::uint32_t u = near.of[k];
        if (out[u] != kNone || (positions[u] - positions[v]).squaredNorm() > reach * reach ||
            normals[u].dot(normals[v]) < kLeastTurn)
          continue;
        out[u] = v;
        open.push_back(u);
      }
    }
  }
  return out;
}

std::vector<Triangle32> coarse_triangles(std::span<const Triangle32> triangles,
                                         std::span<const std::uint32_t> standing) {
  std::vector<Triangle32> out;
  for (const Triangle32& t : triangles) {
    const Triangle32 c(standing[t[0]], standing[t[1]], standing[t[2]]);
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) out.push_back(c);
  }
  return out;
}

void add_coarse(const Anatomy& anatomy, double reach, SceneModel& model) {
  const float r = float(reach);
  add_whole(r, model.skin);
  for (DrawMesh& bone : model.bones) add_whole(r, bone);
  for (DrawMesh& eye : model.eyes) add_whole(r, eye);
  PosedAnatomy rest;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), rest.X_WJ);
  rest.slices = rest_slices(anatomy);
  PointsF positions, normals;
  if (!anatomy.muscles.empty()) {
    update_muscle_surface(model.surface, rest, positions, &normals);
    model.muscle_coarse =
        add_by_part(model.surface.parts, positions, normals, r, model.muscles);
  }
  if (model.fascia_surface.vertices() > 0) {
    update_fascia_surface(model.fascia_surface, rest, positions, &normals);
    model.fascia_coarse =
        add_by_part(model.fascia_surface.parts, positions, normals, r, model.fascia);
  }
}

}  // namespace ecorche
