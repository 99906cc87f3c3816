#include "skinning/evaluation/skin_quality.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "skinning/bind/blend_frames.h"

namespace ecorche::inline v1 {
namespace {

Vec3 area_vector(const Points& V, const Triangles& F, Eigen::Index f) {
  const Vec3 a = V.row(F(f, 0)), b = V.row(F(f, 1)), c = V.row(F(f, 2));
  return (b - a).cross(c - a);
}

// Rotation of the skin at each vertex: the mean of its blend frames' rotations by its weights.
std::vector<Eigen::Vector4d> vertex_rotations(const BlendTables& tables,
                                              std::span<const Transform> X_WJ) {
  std::vector<Quat> rotations;
  chain_rotations(tables.frames, X_WJ, rotations);
  const BlendMesh& mesh = tables.mesh;
  std::vector<Eigen::Vector4d> out(mesh.vertex_count, Eigen::Vector4d::Zero());
  for (const VertexRun& run : mesh.runs)
    for (int e = run.begin; e < run.end; ++e) {
      const std::size_t sorted = mesh.sorted_index[e];
      Eigen::Vector4d& sum = out[mesh.order.empty() ? sorted : std::size_t(mesh.order[sorted])];
      for (int k = 0; k < run.frames; ++k) {
        const std::size_t entry = run.frame_entry + std::size_t((e - run.begin) * run.frames + k);
        if (mesh.frame[entry] < rotations.size())
          sum += mesh.frame_weight[entry] * rotations[mesh.frame[entry]].coeffs();
      }
    }
  return out;
}

void measure_edges(const TriMesh& rest, const Points& V, SkinQuality& out) {
  std::vector<double> stretch;
  stretch.reserve(3 * rest.F.rows());
  for (Eigen::Index f = 0; f < rest.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = rest.F(f, k), b = rest.F(f, (k + 1) % 3);
      const double length = (rest.V.row(a) - rest.V.row(b)).norm();
      if (a < b && length > 0) stretch.push_back((V.row(a) - V.row(b)).norm() / length);
    }
  if (stretch.empty()) return;
  const auto [low, high] = std::minmax_element(stretch.begin(), stretch.end());
  out.stretch_min = *low;
  out.stretch_max = *high;
  const auto p99 = stretch.begin() + std::ptrdiff_t(0.99 * double(stretch.size() - 1));
  std::nth_element(stretch.begin(), p99, stretch.end());
  out.stretch_p99 = *p99;
}

}  // namespace

std::vector<int> flipped_triangles(const TriMesh& rest, const BlendTables& tables,
                                   std::span<const Transform> X_WJ, const Points& V) {
  if (V.rows() != rest.V.rows() || tables.mesh.vertex_count != rest.V.rows())
    throw std::invalid_argument(
        "flipped_triangles: the shape, the rest skin and the binding differ in their number of "
        "vertices");
  std::vector<int> out;
  const std::vector<Eigen::Vector4d> rotations = vertex_rotations(tables, X_WJ);
  for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int k = 0; k < 3; ++k) sum += rotations[rest.F(f, k)];
    if (area_vector(V, rest.F, f).dot(Quat(sum).normalized() * area_vector(rest.V, rest.F, f)) < 0)
      out.push_back(int(f));
  }
  return out;
}

SkinQuality measure_skin(const TriMesh& rest, const BlendTables& tables,
                         std::span<const LimbSection> sections, std::span<const Transform> X_WJ,
                         const SkinFrame& frame) {
  if (frame.positions.size() != 4 * std::size_t(rest.V.rows()) ||
      tables.mesh.vertex_count != rest.V.rows())
    throw std::invalid_argument(
        "measure_skin: the frame, the rest skin and the binding differ in their number of "
        "vertices");
  SkinQuality out;
  Points V;
  to_points(frame, V);
  out.triangles = rest.F.rows();
  for (Eigen::Index i = 0; i < V.rows(); ++i) out.not_finite += !V.row(i).allFinite();
  out.flipped = flipped_triangles(rest, tables, X_WJ, V).size();
  out.flipped_share = out.triangles > 0 ? double(out.flipped) / out.triangles : 0;
  measure_edges(rest, V, out);
  for (const LimbSection& section : sections) {
    const double before = section_volume(section, rest.F, rest.V);
    out.limb_volume_change.push_back((section_volume(section, rest.F, V) - before) / before);
  }
  return out;
}

}  // namespace ecorche::inline v1
