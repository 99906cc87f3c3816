#include "anatomy/mesh_files/obj_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/polygons.h"
#include "anatomy/mesh_files/vertex_values.h"

namespace ecorche::inline v1 {
namespace {

class ObjFile {
 public:
  ObjFile(std::string_view text, const std::string& name) : scan_(text, name), name_(name) {}

  void read(const MeshReadOptions& options, MeshFile& out);

 private:
  // Vertex, texture coordinate and normal of a corner: as they stand, 0 where there is none.
  using Corner = std::array<long long, 3>;

  std::size_t vertices() const { return polygons_.coordinates.size() / 3; }
  Corner corner(std::string_view word);
  int vertex(long long index);
  void read_vertex();
  void read_face();
  void read_numbers(std::vector<float>& out, std::size_t count);
  void use_material();
  void statement(std::string_view key, MeshFile& out);
  void add_normals(MeshPart& part) const;
  void add_texture(const TriangleSources& sources, MeshPart& part,
                   std::vector<std::string>& notes) const;
  void add_materials(const TriangleSources& sources, MeshPart& part) const;

  TextScan scan_;
  std::string name_;
  Polygons polygons_;
  std::vector<float> colours_, uv_, normals_;
  // Of each corner, -1: none; empty until a corner names one.
  std::vector<int> corner_uv_, corner_normals_;
  std::vector<std::string> materials_;
  std::map<std::string, int, std::less<>> material_places_;
  std::vector<int> face_materials_;  // empty until a material is named
  int material_ = -1;
  int forward_ = -1, forward_line_ = 0;  // the highest vertex named before it came
  long long unknown_ = 0, statements_ = 0;
};

// "7", "7/1", "7//3", "7/1/3" or counted from the end "-1".
ObjFile::Corner ObjFile::corner(std::string_view word) {
  Corner out{};
  for (std::size_t begin = 0, field = 0; begin <= word.size(); ++field) {
    const auto end = std::min(word.find('/', begin), word.size());
    const auto part = word.substr(begin, end - begin);
    long long value = 0;
    const bool number = parse_whole(part, value);
    if (field > 2 || (!number && (field == 0 || !part.empty())))
      scan_.fail("a face corner is not 'vertex/texture/normal'");
    out[field] = value;
    begin = end + 1;
  }
  return out;
}

// 0-based. Vertices may follow their faces, so an index above their count is only remembered.
int ObjFile::vertex(long long index) {
  const auto count = static_cast<long long>(vertices());
  if (index == 0) scan_.fail("a face corner is 0; OBJ counts vertices from 1");
  if (index < 0) index += count + 1;
  if (index < 1)
    scan_.fail(fmt::format("a face corner counts back beyond the first of {} vertices", count));
  if (index > limits::kMeshElements)
    scan_.fail(fmt::format("a face corner names vertex {}, beyond the limit", index));
  if (index > count && int(index - 1) > forward_) {
    forward_ = int(index - 1);
    forward_line_ = scan_.line_number();
  }
  return int(index - 1);
}

// "v x y z", with a weight, a colour or both behind.
void ObjFile::read_vertex() {
  for (const char* axis : {"x", "y", "z"}) polygons_.coordinates.push_back(scan_.number(axis));
  if (vertices() > std::size_t(limits::kMeshElements))
    throw LimitError(fmt::format("{}: more than {} vertices", name_, limits::kMeshElements));
  double more[4];
  std::size_t count = 0;
  for (auto word = scan_.word(); !word.empty() && count < 4; word = scan_.word())
    if (!parse_number(word, more[count++])) return;
  if (count >= 3 && colours_.size() == 3 * (vertices() - 1))
    for (std::size_t k = count - 3; k < count; ++k) colours_.push_back(float(more[k]));
}

void ObjFile::read_face() {
  const std::size_t before = polygons_.corners.size();
  const auto remember = [&](std::vector<int>& list, long long index, std::size_t count) {
    if (index == 0 && list.empty()) return;
    list.resize(polygons_.corners.size() - 1, -1);
    if (index < 0) index += static_cast<long long>(count) + 1;
    list.push_back(index < 1 || index > limits::kMeshElements ? -1 : int(index - 1));
  };
  for (auto word = scan_.word(); !word.empty(); word = scan_.word()) {
    const Corner named = corner(word);
    polygons_.corners.push_back(vertex(named[0]));
    remember(corner_uv_, named[1], uv_.size() / 2);
    remember(corner_normals_, named[2], normals_.size() / 3);
  }
  polygons_.sizes.push_back(int(polygons_.corners.size() - before));
  if (material_ >= 0 || !face_materials_.empty()) {
    face_materials_.resize(polygons_.sizes.size() - 1, -1);
    face_materials_.push_back(material_);
  }
  if (polygons_.corners.size() > limits::kMeshCorners)
    throw LimitError(fmt::format("{}: more than {} corners of faces", name_, limits::kMeshCorners));
}

// Numbers that are none count as zero: texture and normals are no reason to refuse a body.
void ObjFile::read_numbers(std::vector<float>& out, std::size_t count) {
  if (out.size() > count * std::size_t(limits::kMeshElements))
    throw LimitError(fmt::format("{}: more than {} texture coordinates or normals", name_,
                                 limits::kMeshElements));
  for (std::size_t k = 0; k < count; ++k) {
    double value = 0;
    parse_number(scan_.word(), value);
    out.push_back(std::abs(value) < 1e30 ? float(value) : 0);
  }
}

void ObjFile::use_material() {
  const std::string name = printable(scan_.word().substr(0, limits::kNameBytes));
  const auto [found, fresh] = material_places_.try_emplace(name, int(materials_.size()));
  if (fresh) materials_.push_back(name);
  material_ = found->second;
}

void ObjFile::statement(std::string_view key, MeshFile& out) {
  ++statements_;
  if (key == "v")
    read_vertex();
  else if (key == "f")
    read_face();
  else if (key == "vt")
    read_numbers(uv_, 2);
  else if (key == "vn")
    read_numbers(normals_, 3);
  else if (key == "usemtl")
    use_material();
  else if (key == "mtllib")
    out.notes.push_back(fmt::format("{}:{}: materials are not read", name_, scan_.line_number()));
  else if (key != "vp" && key != "g" && key != "o" && key != "s" && key != "l" && key != "p")
    ++unknown_;
}

// A vertex's normal: the mean of those that its corners name; a cloud's in the order of vertices.
void ObjFile::add_normals(MeshPart& part) const {
  std::vector<double> sums(3 * vertices(), 0);
  if (polygons_.sizes.empty() && normals_.size() == sums.size()) {
    std::copy(normals_.begin(), normals_.end(), sums.begin());
  } else if (!corner_normals_.empty()) {
    for (std::size_t c = 0; c < corner_normals_.size(); ++c) {
      const int n = corner_normals_[c];
      if (n < 0 || 3 * std::size_t(n) >= normals_.size()) continue;
      for (std::size_t k = 0; k < 3; ++k)
        sums[3 * std::size_t(polygons_.corners[c]) + k] += normals_[3 * std::size_t(n) + k];
    }
  } else {
    return;
  }
  part.normals = unit_normals(sums);
}

void ObjFile::add_texture(const TriangleSources& sources, MeshPart& part,
                          std::vector<std::string>& notes) const {
  if (corner_uv_.empty()) return;
  part.texture.setZero(Eigen::Index(sources.corners.size()), 2);
  std::size_t missing = 0;
  for (std::size_t c = 0; c < sources.corners.size(); ++c) {
    const std::size_t corner = std::size_t(sources.corners[c]);
    const int at = corner < corner_uv_.size() ? corner_uv_[corner] : -1;
    const bool there = at >= 0 && 2 * std::size_t(at) < uv_.size();
    missing += !there;
    if (there)
      part.texture.row(Eigen::Index(c)) << uv_[2 * std::size_t(at)], uv_[2 * std::size_t(at) + 1];
  }
  if (missing > 0)
    notes.push_back(fmt::format("{}: {} corners without texture coordinates", name_, missing));
}

void ObjFile::add_materials(const TriangleSources& sources, MeshPart& part) const {
  if (face_materials_.empty()) return;
  part.materials = materials_;
  for (const int face : sources.polygons)
    part.face_materials.push_back(std::size_t(face) < face_materials_.size() ? face_materials_[face]
                                                                             : -1);
}

void ObjFile::read(const MeshReadOptions& options, MeshFile& out) {
  while (scan_.next_line()) {
    const auto key = scan_.word();
    if (!key.empty() && key.front() != '#') statement(key, out);
  }
  if (polygons_.coordinates.empty())
    throw InputError(name_ +
                     ": neither OBJ, PLY, STL, OFF, PCD, glTF, FBX nor COLLADA; give a "
                     "mesh in one of these");
  if (unknown_ * 2 > statements_)
    throw InputError(
        fmt::format("{}: {} of {} lines are no OBJ statement", name_, unknown_, statements_));
  if (forward_ >= static_cast<long long>(vertices()))
    throw InputError(fmt::format("{}:{}: a face corner names vertex {} of {}", name_, forward_line_,
                                 forward_ + 1, vertices()));
  TriangleSources sources;
  const bool traced = !corner_uv_.empty() || !face_materials_.empty();
  MeshPart part;
  part.mesh = triangulate(polygons_, name_, out.notes, options.clouds, traced ? &sources : nullptr);
  if (colours_.size() == 3 * vertices()) part.colours = colours_in_range(colours_);
  add_normals(part);
  add_texture(sources, part, out.notes);
  add_materials(sources, part);
  out.parts.push_back(std::move(part));
}

}  // namespace

void parse_obj(std::string_view text, const std::string& name, const MeshReadOptions& options,
               MeshFile& out) {
  ObjFile(text, name).read(options, out);
}

}  // namespace ecorche::inline v1
