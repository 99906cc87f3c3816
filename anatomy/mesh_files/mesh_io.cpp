#include "anatomy/mesh_files/mesh_io.h"

#include <algorithm>
#include <bit>
#include <cctype>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/mesh_files/glb_reader.h"
#include "anatomy/mesh_files/obj_reader.h"
#include "anatomy/mesh_files/ply_reader.h"

namespace ecorche::inline v1 {
namespace {

enum class Format { obj, ply, glb };

Format format_of(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("glTF")) return Format::glb;
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return Format::ply;
  unmarked_text(bytes, name);  // refuses UTF-16 by its name
  const auto head = bytes.substr(0, 4096);
  if (head.find('\0') != std::string_view::npos)
    throw InputError(
        fmt::format("{}: neither OBJ, PLY nor GLB; give a mesh in one of these", name));
  return Format::obj;
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

MeshFile parse_mesh(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw InputError(name + ": empty file");
  MeshFile out;
  const Format format = format_of(bytes, name);
  std::string ending = std::filesystem::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const char* const expected = format == Format::glb   ? ".glb"
                               : format == Format::ply ? ".ply"
                                                       : ".obj";
  if (format == Format::glb) parse_glb(bytes, name, out);
  if (format == Format::ply) parse_ply(bytes, name, out);
  if (format == Format::obj) parse_obj(bytes, name, out);
  if (ending != expected)
    out.notes.push_back(fmt::format("{}: read as {} whatever its ending says", name, expected + 1));
  return out;
}

MeshFile read_mesh_file(const std::filesystem::path& file) {
  return parse_mesh(read_input_file(file), printable(file.string()));
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
