#include "anatomy/model_files/model_text.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/mesh_files/mesh_io.h"

namespace ecorche::inline v1 {

namespace fs = std::filesystem;

std::string text(double v) { return fmt::format("{}", v); }
std::string text(const Vec3& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }

std::string escaped(const std::string& raw) {
  std::string out;
  for (const char c : raw) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string write_model_meshes(const fs::path& file, const ExportModel& model, const Mat3& axes) {
  const std::string folder = file.stem().string() + "_meshes";
  if (model.meshes.empty()) return folder;
  make_output_folder(file.parent_path() / folder);
  for (const ExportMesh& mesh : model.meshes) {
    TriMesh turned = mesh.mesh;
    turned.V = mesh.mesh.V * axes.transpose();
    write_obj(file.parent_path() / folder / mesh.file, turned);
  }
  return folder;
}

}  // namespace ecorche::inline v1
