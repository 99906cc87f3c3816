#include "skinning/morphs/join_shapes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "skinning/morphs/turned_curves.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;

MatrixXf rows_of(const MatrixXf& columns, std::span<const int> vertices) {
  if (columns.cols() == 0) return MatrixXf(3 * Index(vertices.size()), 0);
  MatrixXf out(3 * Index(vertices.size()), columns.cols());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    out.middleRows(3 * Index(i), 3) = columns.middleRows(3 * Index(vertices[i]), 3);
  return out;
}

}  // namespace

MeshShapes shape_rows(const MeshShapes& shapes, std::span<const int> vertices) {
  MeshShapes out = shapes;
  out.shapes = rows_of(shapes.shapes, vertices);
  if (shapes.normals.size() > 0) out.normals = rows_of(shapes.normals, vertices);
  return out;
}

MeshShapes join_shapes(std::span<const MeshShapes> meshes, const ShapeOptions& options) {
  MeshShapes out;
  if (meshes.empty()) return out;
  Index rows = 0, count = 0;
  bool has_normals = true;
  for (const MeshShapes& mesh : meshes) {
    if (mesh.curves.rows() != meshes[0].curves.rows())
      throw std::invalid_argument("join_shapes: meshes of different motions");
    rows += mesh.shapes.rows();
    count += mesh.shapes.cols();
    has_normals &= mesh.normals.cols() == mesh.shapes.cols();
  }
  // Curves of shapes of unit length, so that they count by what they move.
  Eigen::VectorXf lengths(count);
  Eigen::MatrixXd curves(meshes[0].curves.rows(), count);
  Index column = 0;
  for (const MeshShapes& mesh : meshes)
    for (Index m = 0; m < mesh.shapes.cols(); ++m, ++column) {
      lengths[column] = std::max(1e-12f, mesh.shapes.col(m).norm());
      curves.col(column) = (lengths[column] * mesh.curves.col(m)).cast<double>();
    }
  const Eigen::MatrixXd turn = falling_axes(curves);
  const MatrixXf weights = lengths.cwiseInverse().asDiagonal() * turn.cast<float>();
  const auto gather = [&](auto&& part) {
    MatrixXf all(rows, count);
    Index row = 0, first = 0;
    for (const MeshShapes& mesh : meshes) {
      const MatrixXf& own = part(mesh);
      all.middleRows(row, mesh.shapes.rows()).noalias() =
          own * weights.middleRows(first, own.cols());
      row += mesh.shapes.rows();
      first += own.cols();
    }
    return all;
  };
  out.shapes = gather([](const MeshShapes& mesh) -> const MatrixXf& { return mesh.shapes; });
  out.curves = (curves * turn).cast<float>();
  const DroppedShapes dropped = drop_shapes(out, options);
  if (has_normals) {
    out.normals = gather([](const MeshShapes& mesh) -> const MatrixXf& { return mesh.normals; });
    out.normals.conservativeResize(Eigen::NoChange, dropped.kept);
  }
  scale_curves(out);
  double square = dropped.square_error;
  for (const MeshShapes& mesh : meshes) {
    const double places = double(mesh.shapes.rows() / 3 * mesh.curves.rows());
    out.max_error = std::max(out.max_error, mesh.max_error);
    square += mesh.rms_error * mesh.rms_error * places;
  }
  out.max_error += dropped.max_error;
  out.rms_error = std::sqrt(square / std::max(1.0, double(rows / 3 * out.curves.rows())));
  return out;
}

}  // namespace ecorche::inline v1
