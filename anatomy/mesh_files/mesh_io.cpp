#include "anatomy/mesh_files/mesh_io.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <optional>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/mesh_files/glb_reader.h"
#include "anatomy/mesh_files/obj_reader.h"
#include "anatomy/mesh_files/off_reader.h"
#include "anatomy/mesh_files/pcd_reader.h"
#include "anatomy/mesh_files/ply_reader.h"
#include "anatomy/mesh_files/scene_import.h"
#include "anatomy/mesh_files/stl_io.h"

namespace ecorche::inline v1 {
namespace {

bool is_json(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

// The ending that the bytes call for, without its point.
std::string format_of(std::string_view bytes, const std::string& name, const std::string& ending) {
  if (bytes.starts_with("glTF")) return "glb";
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return "ply";
  if (const std::optional<std::string> scene = scene_format(bytes)) return *scene;
  if (is_stl(bytes)) return "stl";
  if (is_pcd(bytes)) return "pcd";
  const std::string_view text = unmarked_text(bytes, name);  // refuses UTF-16 by its name
  if (is_json(text)) return "gltf";
  const auto head = text.substr(0, 4096);
  const std::size_t word_end = head.find_first_of(" \t\r\n#");
  if (is_off_keyword(head.substr(0, word_end))) return "off";
  if (ending == "stl") return "stl";  // whose reader says what is wrong with it
  if (head.starts_with("PK\3\4") || head.starts_with("\x1f\x8b"))
    throw InputError(name + ": an archive; unpack it and give the mesh inside");
  if (head.find('\0') != std::string_view::npos || head.starts_with("<"))
    throw InputError(name +
                     ": neither OBJ, PLY, STL, OFF, PCD, glTF, FBX nor COLLADA; give a mesh "
                     "in one of these");
  return "obj";
}

// A file's own ending in lower case; what OFF and glTF are also called.
std::string ending_of(const std::string& name) {
  std::string out = std::filesystem::path(name).extension().string();
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (!out.empty()) out.erase(0, 1);
  return out == "coff" || out == "noff" || out == "cnoff" ? "off" : out == "vrm" ? "glb" : out;
}

MeshPart stl_part(std::string_view bytes, const std::string& name) {
  MeshPart out;
  out.mesh = parse_stl(bytes, name);
  if (out.mesh.F.rows() == 0)
    throw UnfitError(
        fmt::format("{}: {} vertices but no faces; a surface is needed", name, out.mesh.V.rows()));
  return out;
}

MeshFile parse_by_format(std::string_view bytes, const std::string& name,
                         const std::optional<std::filesystem::path>& folder,
                         const MeshReadOptions& options) {
  if (bytes.empty()) throw InputError(name + ": empty file");
  const std::string ending = ending_of(name);
  MeshFile out;
  out.format = format_of(bytes, name, ending);
  if (out.format == "glb") parse_glb(bytes, name, std::nullopt, options, out);
  if (out.format == "gltf") parse_glb(unmarked_text(bytes, name), name, folder, options, out);
  if (out.format == "ply") parse_ply(bytes, name, options, out);
  if (out.format == "stl") out.parts.push_back(stl_part(bytes, name));
  if (out.format == "off") parse_off(bytes, name, options, out);
  if (out.format == "pcd") parse_pcd(bytes, name, options, out);
  if (out.format == "obj") parse_obj(bytes, name, options, out);
  if (out.format == "fbx" || out.format == "dae")
    parse_glb(import_scene(bytes, name), name, std::nullopt, options, out);
  if (ending != out.format)
    out.notes.push_back(fmt::format("{}: read as {} whatever its ending says", name, out.format));
  return out;
}

void append_line(std::string& text, const char* key, const auto& row) {
  fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", key, row[0], row[1], row[2]);
}

template <typename T>
void append_bytes(std::string& out, T value) {
  static_assert(std::endian::native == std::endian::little);
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

MeshFile parse_mesh(std::string_view bytes, const std::string& name,
                    const MeshReadOptions& options) {
  return parse_by_format(bytes, name, std::nullopt, options);
}

MeshFile read_mesh_file(const std::filesystem::path& file, const MeshReadOptions& options) {
  return parse_by_format(read_input_file(file), printable(file.string()), file.parent_path(),
                         options);
}

TriMesh all_parts(const MeshFile& file) {
  std::vector<const TriMesh*> parts;
  for (const MeshPart& part : file.parts) parts.push_back(&part.mesh);
  return join_meshes(parts);
}

TriMesh read_mesh(const std::filesystem::path& file) { return all_parts(read_mesh_file(file)); }

void write_obj(const std::filesystem::path& file, const TriMesh& mesh) {
  std::string text;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) append_line(text, "v", mesh.V.row(i));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    append_line(text, "f", (mesh.F.row(f).array() + 1).eval());
  write_file_atomically(file, text);
}

void write_ply(const std::filesystem::path& file, const TriMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double "
      "y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.V.rows(), mesh.F.rows());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    for (int k = 0; k < 3; ++k) append_bytes(bytes, mesh.V(i, k));
  }
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    append_bytes(bytes, static_cast<unsigned char>(3));
    for (int k = 0; k < 3; ++k) append_bytes(bytes, std::int32_t(mesh.F(f, k)));
  }
  write_file_atomically(file, bytes);
}

}  // namespace ecorche::inline v1
