#include "anatomy/model_files/model_reader.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/mesh_files/stl_io.h"
#include "anatomy/model_files/mjcf_reader.h"
#include "anatomy/model_files/model_xml.h"
#include "anatomy/model_files/osim_reader.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

// Where a relative path leads; symbolic links must not lead out of the folder either.
fs::path resolved(const fs::path& folder, const std::string& path) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error),
                 file = fs::weakly_canonical(root / path, error);
  const auto [end, rest] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
  if (error || end != root.end())
    throw InputError(fmt::format("{}: leads out of the model's folder {}", printable(path),
                                 printable(root.string())));
  return file;
}

// Polygons of an ASCII VTK poly data file, as OpenSim keeps its bones in.
TriMesh parse_vtp(const std::string& text, const std::string& name) {
  pugi::xml_document document;
  model_xml::load(document, text, name);
  const pugi::xml_node piece = document.child("VTKFile").child("PolyData").child("Piece");
  const auto array = [&](const char* part, std::string_view wanted) {
    for (pugi::xml_node node : piece.child(part).children("DataArray")) {
      if (!wanted.empty() && wanted != node.attribute("Name").value()) continue;
      if (std::string_view(node.attribute("format").value()) != "ascii")
        throw UnfitError(
            fmt::format("{}: data that are not ASCII; save it as ASCII VTP, OBJ or STL", name));
      return model_xml::numbers(node.child_value(), fmt::format("{}: {}", name, part),
                                std::size_t{1} << 24);
    }
    throw InputError(fmt::format("{}: no {} in its first piece", name, part));
  };
  const auto xyz = array("Points", ""), corners = array("Polys", "connectivity"),
             ends = array("Polys", "offsets");
  TriMesh mesh;
  if (xyz.size() % 3 != 0)
    throw InputError(fmt::format("{}: {} coordinates, no multiple of three", name, xyz.size()));
  mesh.V = Eigen::Map<const Points>(xyz.data(), Eigen::Index(xyz.size() / 3), 3);
  std::vector<int> triangles;
  double begin = 0;
  for (double end : ends) {
    if (end < begin || end > double(corners.size()))
      throw InputError(fmt::format("{}: offset {} of {} corners", name, end, corners.size()));
    for (size_t k = std::size_t(begin) + 2; k < std::size_t(end); ++k)
      for (size_t i : {std::size_t(begin), k - 1, k}) {
        if (corners[i] < 0 || corners[i] >= double(mesh.V.rows()))
          throw InputError(
              fmt::format("{}: corner {} of {} points", name, corners[i], mesh.V.rows()));
        triangles.push_back(int(corners[i]));
      }
    begin = end;
  }
  mesh.F = Eigen::Map<const Triangles>(triangles.data(), Eigen::Index(triangles.size() / 3), 3);
  return mesh;
}

}  // namespace

MusculoskeletalModel read_muscle_model(const fs::path& file, const fs::path& folder) {
  const std::string text = read_input_file(file, limits::kModelBytes);
  const fs::path root = folder.empty() ? fs::absolute(file).parent_path() : folder;
  const std::string head = text.substr(0, 4096);
  if (head.find("<OpenSimDocument") != std::string::npos)
    return parse_osim(text, file.filename().string());
  if (text.find("<mujoco") == std::string::npos)
    throw InputError(fmt::format(
        "{}: neither an OpenSim model (<OpenSimDocument>) nor a MuJoCo model (<mujoco>)",
        printable(file.string())));
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(file, error),
                 home = error ? fs::path() : fs::weakly_canonical(root, error);
  const std::string path = error ? "" : fs::proximate(whole, home, error).generic_string();
  if (error || path.starts_with(".."))
    throw InputError(
        fmt::format("{}: does not lie in {}", printable(file.string()), printable(root.string())));
  return parse_mjcf_model({[&](const std::string& inner) {
                            return read_input_file(resolved(root, inner), limits::kModelBytes);
                          }},
                          path);
}

TriMesh read_model_mesh(const fs::path& folder, const ModelMesh& part) {
  fs::path file = resolved(folder, part.file);
  std::error_code error;
  // OpenSim keeps meshes in a folder of this name beside the model.
  if (!fs::exists(file, error)) file = resolved(folder, "Geometry/" + part.file);
  if (!fs::exists(file, error)) return {};
  const std::string bytes = read_input_file(file, limits::kModelBytes), name = printable(part.file),
                    kind = file.extension().string();
  TriMesh mesh;
  if (kind == ".stl" || kind == ".STL")
    mesh = parse_stl(bytes, name);
  else if (kind == ".vtp")
    mesh = parse_vtp(bytes, name);
  else
    mesh = all_parts(parse_mesh(bytes, name));
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    mesh.V.row(i) = part.X_BG * mesh.V.row(i).transpose().cwiseProduct(part.scale);
  if (part.scale.prod() < 0 && mesh.F.rows() > 0) mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

}  // namespace ecorche::inline v1
