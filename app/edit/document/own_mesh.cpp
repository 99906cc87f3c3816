#include "app/edit/document/own_mesh.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/mesh_files/mesh_io.h"

namespace ecorche {
namespace {

constexpr Eigen::Index kMostTriangles = 100000;
constexpr double kSmallest = 1e-3, kLargest = 2;  // m, of a bone
const std::vector<std::pair<const char*, double>> kUnits{
    {"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", 0.0254}};

double unit_of(const std::string& name) {
  for (const auto& [unit, metres] : kUnits)
    if (name == unit) return metres;
  return 1;
}

}  // namespace

TriMesh read_own_mesh(const std::string& name, const std::string& unit_name,
                      const std::string& up) {
  const MeshFile file = read_mesh_file(name);
  TriMesh mesh = all_parts(file);
  const double unit = unit_name.empty() ? file.unit.value_or(1) : unit_of(unit_name);
  const bool z_up = up.empty() ? file.up && file.up->z() > 0.5 : up == "z";
  if (mesh.F.rows() > kMostTriangles)
    throw InputError(
        fmt::format("argument 'file': '{}': {} triangles; at most {} are taken: make "
                    "it coarser first",
                    name, mesh.F.rows(), kMostTriangles));
  mesh.V *= unit;
  for (Eigen::Index i = 0; z_up && i < mesh.V.rows(); ++i)
    mesh.V.row(i) = Vec3(mesh.V(i, 0), mesh.V(i, 2), -mesh.V(i, 1)).transpose();
  const double size = (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).maxCoeff();
  if (size < kSmallest || size > kLargest)
    throw InputError(
        fmt::format("argument 'file': '{}': it is {:.3g} m large; expected {:g} m to "
                    "{:g} m: say unit=mm, cm, m or in",
                    name, size, kSmallest, kLargest));
  if (mesh_volume(mesh) < 0) mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

void unit_and_up(Arguments& a, std::string& unit, std::string& up) {
  a.choice("unit", unit, {"m", "cm", "mm", "in"}, Need::optional,
           "of the file; left out: as it says, or m");
  a.choice("up", up, {"y", "z"}, Need::optional, "of the file; left out: as it says, or y");
}

}  // namespace ecorche
