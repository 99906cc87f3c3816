#include "skinning/evaluation/delta_mush.h"

#include <cmath>
#include <stdexcept>

#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/geometry/vertex_rings.h"

namespace ecorche::inline v1 {
namespace {

using Vec3f = Eigen::Vector3f;
using Mat3f = Eigen::Matrix3f;

std::size_t vertices_of(const MushTables& tables) { return tables.start.size() - 1; }

Vec3f at(const std::vector<float>& p, std::size_t i) { return Eigen::Map<const Vec3f>(&p[4 * i]); }

void smooth(const MushTables& tables, MushWorkspace& workspace) {
  workspace.next.resize(workspace.smooth.size());
  for (int round = 0; round < tables.options.iterations; ++round) {
    for (std::size_t i = 0; i < vertices_of(tables); ++i) {
      const int begin = tables.start[i], end = tables.start[i + 1];
      Eigen::Array4f sum = Eigen::Array4f::Zero();
      for (int k = begin; k < end; ++k)
        sum += Eigen::Map<const Eigen::Array4f>(&workspace.smooth[4 * tables.neighbour[k]]);
      const Eigen::Map<const Eigen::Array4f> here(&workspace.smooth[4 * i]);
      Eigen::Map<Eigen::Array4f> next(&workspace.next[4 * i]);
      next = begin == end
                 ? Eigen::Array4f(here)
                 : Eigen::Array4f(here + tables.options.step * (sum / float(end - begin) - here));
    }
    workspace.smooth.swap(workspace.next);
  }
  workspace.normals.resize(workspace.smooth.size());
  vertex_normals(workspace.smooth, tables.triangles, workspace.normals);
}

// Tangent, bitangent, normal of the smoothed shape.
Mat3f frame_at(const MushTables& tables, const MushWorkspace& workspace, std::size_t i) {
  const Vec3f n = at(workspace.normals, i), here = at(workspace.smooth, i);
  Vec3f t = Vec3f::Zero();
  for (int k = tables.start[i]; k < tables.start[i + 1]; ++k)
    t += tables.tangent_weight[k] * (at(workspace.smooth, std::size_t(tables.neighbour[k])) - here);
  t -= n.dot(t) * n;
  const float length = t.norm();
  t = length > 1e-12f ? Vec3f(t / length) : n.unitOrthogonal();
  Mat3f frame;
  frame << t, n.cross(t), n;
  return frame;
}

}  // namespace

MushTables make_mush(const TriMesh& mesh, const std::vector<float>& rest,
                     const MushOptions& options) {
  if (rest.size() != 4 * std::size_t(mesh.V.rows()))
    throw std::invalid_argument("make_mush: four floats a vertex are needed");
  MushTables tables;
  tables.options = options;
  tables.triangles.assign(mesh.F.data(), mesh.F.data() + mesh.F.size());
  tables.start.push_back(0);
  for (const std::vector<int>& ring : vertex_neighbours(mesh)) {
    tables.neighbour.insert(tables.neighbour.end(), ring.begin(), ring.end());
    tables.start.push_back(int(tables.neighbour.size()));
  }
  MushWorkspace workspace;
  workspace.smooth = rest;
  smooth(tables, workspace);
  tables.tangent_weight.resize(tables.neighbour.size());
  tables.detail.resize(vertices_of(tables));
  for (std::size_t i = 0; i < vertices_of(tables); ++i) {
    const Vec3f here = at(workspace.smooth, i);
    Vec3f wanted = Vec3f::Zero();
    for (int k = tables.start[i]; k < tables.start[i + 1]; ++k) {
      const Vec3f edge = at(workspace.smooth, std::size_t(tables.neighbour[k])) - here;
      if (k == tables.start[i]) wanted = edge.normalized();
      // The mix of edges that best turns with the whole ring instead of with one edge.
      tables.tangent_weight[k] = edge.dot(wanted) / std::max(edge.squaredNorm(), 1e-12f);
    }
    const Vec3f detail = frame_at(tables, workspace, i).transpose() * (at(rest, i) - here);
    tables.detail[i] = {detail.x(), detail.y(), detail.z()};
  }
  return tables;
}

void deform_mush(const MushTables& tables, MushWorkspace& workspace, SkinFrame& skin) {
  if (skin.positions.size() != 4 * vertices_of(tables))
    throw std::invalid_argument("deform_mush: a frame of another skin");
  workspace.smooth.assign(skin.positions.begin(), skin.positions.end());
  smooth(tables, workspace);
  for (std::size_t i = 0; i < vertices_of(tables); ++i)
    Eigen::Map<Vec3f>(&skin.positions[4 * i]) =
        at(workspace.smooth, i) +
        frame_at(tables, workspace, i) * Eigen::Map<const Vec3f>(tables.detail[i].data());
  skin.normals.resize(skin.positions.size());
  vertex_normals(skin.positions, tables.triangles, skin.normals);
}

}  // namespace ecorche::inline v1
