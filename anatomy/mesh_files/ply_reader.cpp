#include "anatomy/mesh_files/ply_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/polygons.h"
#include "anatomy/mesh_files/vertex_values.h"

namespace ecorche::inline v1 {
namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Scalar> scalar_of(std::string_view word) {
  if (word == "char" || word == "int8") return Scalar::int8;
  if (word == "uchar" || word == "uint8") return Scalar::uint8;
  if (word == "short" || word == "int16") return Scalar::int16;
  if (word == "ushort" || word == "uint16") return Scalar::uint16;
  if (word == "int" || word == "int32") return Scalar::int32;
  if (word == "uint" || word == "uint32") return Scalar::uint32;
  if (word == "float" || word == "float32") return Scalar::float32;
  if (word == "double" || word == "float64") return Scalar::float64;
  return std::nullopt;
}

std::size_t bytes_of(Scalar type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[std::size_t(type)];
}

// What a vertex's property is read as.
enum class Role { none, x, y, z, nx, ny, nz, red, green, blue, u, v, confidence };
constexpr std::size_t kRoles = 13;

Role role_of(std::string_view name) {
  constexpr std::pair<std::string_view, Role> kNames[] = {{"x", Role::x},
                                                          {"y", Role::y},
                                                          {"z", Role::z},
                                                          {"nx", Role::nx},
                                                          {"ny", Role::ny},
                                                          {"nz", Role::nz},
                                                          {"red", Role::red},
                                                          {"green", Role::green},
                                                          {"blue", Role::blue},
                                                          {"r", Role::red},
                                                          {"g", Role::green},
                                                          {"b", Role::blue},
                                                          {"diffuse_red", Role::red},
                                                          {"diffuse_green", Role::green},
                                                          {"diffuse_blue", Role::blue},
                                                          {"u", Role::u},
                                                          {"v", Role::v},
                                                          {"s", Role::u},
                                                          {"t", Role::v},
                                                          {"texture_u", Role::u},
                                                          {"texture_v", Role::v},
                                                          {"confidence", Role::confidence}};
  for (const auto& [known, role] : kNames)
    if (name == known) return role;
  return Role::none;
}

struct Property {
  std::string name;
  Scalar type = Scalar::float32;
  Role role = Role::none;
  bool is_list = false;
  Scalar count_type = Scalar::uint8;
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

enum class Coding { ascii, little, big };

struct Header {
  Coding coding = Coding::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes up to and with the line end_header
};

Property parse_property(TextScan& scan) {
  Property property;
  auto type = scan.word();
  property.is_list = type == "list";
  if (property.is_list) {
    const auto count_type = scalar_of(scan.word());
    if (!count_type || *count_type >= Scalar::float32)
      scan.fail("the count of a list must be of a whole type");
    property.count_type = *count_type;
    type = scan.word();
  }
  const auto known = scalar_of(type);
  if (!known) scan.fail("unknown property type; expected char .. double");
  property.type = *known;
  property.name = scan.word();
  property.role = role_of(property.name);
  return property;
}

Header parse_header(std::string_view bytes, const std::string& name) {
  Header header;
  const char end = bytes.starts_with("ply\r") && !bytes.starts_with("ply\r\n") ? '\r' : '\n';
  TextScan scan(bytes.substr(0, std::size_t{1} << 20), name, end);
  bool formatted = false;
  while (scan.next_line()) {
    const auto key = scan.word();
    if (key == "format") {
      const auto coding = scan.word();
      formatted = true;
      if (coding == "ascii")
        header.coding = Coding::ascii;
      else if (coding == "binary_little_endian")
        header.coding = Coding::little;
      else if (coding == "binary_big_endian")
        header.coding = Coding::big;
      else
        scan.fail("unknown format; expected ascii, binary_little_endian or binary_big_endian");
    } else if (key == "element") {
      Element element;
      element.name = printable(scan.word());
      element.count = scan.whole("element count", 0, INT64_MAX);
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) scan.fail("a property before any element");
      header.elements.back().properties.push_back(parse_property(scan));
    } else if (key == "end_header") {
      if (!formatted) scan.fail("the header has no format");
      header.size = scan.line().data() + scan.line().size() - bytes.data();
      while (header.size < bytes.size() && bytes[header.size] != end) ++header.size;
      header.size = std::min(header.size + 1, bytes.size());
      return header;
    } else if (key != "ply" && key != "comment" && key != "obj_info" && !key.empty()) {
      scan.fail("unknown statement in the header");
    }
  }
  throw InputError(fmt::format("{}: the header does not end", name));
}

// Values one after the other, from words or from bytes.
class Values {
 public:
  Values(std::string_view bytes, const Header& header, const std::string& name)
      : rest_(bytes.substr(header.size)),
        coding_(header.coding),
        scan_(coding_ == Coding::ascii ? rest_ : std::string_view(), name),
        name_(name) {}

  double next(Scalar type, const char* what) {
    return coding_ == Coding::ascii ? next_word(what) : next_binary(type, what);
  }

  // Whether `count` items of at least so many values and bytes can still be there.
  bool can_hold(long long count, std::size_t values, std::size_t bytes) const {
    const std::size_t least =
        std::max<std::size_t>(coding_ == Coding::ascii ? 2 * values : bytes, 1);
    return static_cast<unsigned long long>(count) <= (rest_.size() + 1) / least;
  }

 private:
  double next_word(const char* what) {
    while (scan_.at_line_end()) {
      if (!scan_.next_line())
        throw InputError(fmt::format("{}: ends before the last {}", name_, what));
    }
    return scan_.number(what);
  }

  double next_binary(Scalar type, const char* what) {
    const std::size_t size = bytes_of(type);
    if (rest_.size() - at_ < size)
      throw InputError(fmt::format("{}: ends before the last {}", name_, what));
    const char* from = rest_.data() + at_;
    at_ += size;
    char turned[8];
    if ((coding_ == Coding::big) == (std::endian::native == std::endian::little)) {
      std::reverse_copy(from, from + size, turned);
      from = turned;
    }
    const auto as = [&](auto value) {
      std::memcpy(&value, from, sizeof value);
      return double(value);
    };
    switch (type) {
      case Scalar::int8:
        return as(std::int8_t{});
      case Scalar::uint8:
        return as(std::uint8_t{});
      case Scalar::int16:
        return as(std::int16_t{});
      case Scalar::uint16:
        return as(std::uint16_t{});
      case Scalar::int32:
        return as(std::int32_t{});
      case Scalar::uint32:
        return as(std::uint32_t{});
      case Scalar::float32:
        return as(float{});
      case Scalar::float64:
        return as(double{});
    }
    return 0;
  }

  std::string_view rest_;
  Coding coding_;
  std::size_t at_ = 0;
  TextScan scan_;
  std::string name_;
};

struct PlyMesh {
  Polygons polygons;
  std::vector<double> normals;
  std::vector<float> colours, uv, confidence;
  std::vector<float> corner_uv;  // of all corners, in their order
};

// Which values an element has: a role that is given twice counts once.
struct Roles {
  explicit Roles(const Element& element) {
    for (const Property& property : element.properties)
      if (!property.is_list) has[std::size_t(property.role)] = true;
  }
  bool all(std::initializer_list<Role> roles) const {
    return std::ranges::all_of(roles, [&](Role role) { return has[std::size_t(role)]; });
  }
  bool has[kRoles] = {};
};

// What a whole type's largest value stands for is 1; numbers with a point are taken as they are.
float colour_scale(Scalar type) {
  return type == Scalar::uint8 ? 1.0F / 255 : type == Scalar::uint16 ? 1.0F / 65535 : 1.0F;
}

float small_or_zero(double value) { return std::abs(value) < 1e30 ? float(value) : 0; }

void read_vertices(const Element& element, Values& values, PlyMesh& out, const std::string& name) {
  const Roles roles(element);
  const bool normals = roles.all({Role::nx, Role::ny, Role::nz}),
             colours = roles.all({Role::red, Role::green, Role::blue}),
             texture = roles.all({Role::u, Role::v}), confidence = roles.all({Role::confidence});
  float scale = 1;
  for (const Property& property : element.properties)
    if (property.role == Role::red) scale = colour_scale(property.type);
  out.polygons.coordinates.reserve(3 * std::size_t(element.count));
  double all[kRoles] = {};
  const auto of = [&](Role role) { return all[std::size_t(role)]; };
  for (long long row = 0; row < element.count; ++row) {
    for (const Property& property : element.properties)
      all[std::size_t(property.role)] = values.next(property.type, "vertex");
    for (const Role axis : {Role::x, Role::y, Role::z}) {
      if (!std::isfinite(of(axis)))
        throw InputError(fmt::format("{}: vertex {} is not finite", name, row));
      out.polygons.coordinates.push_back(of(axis));
    }
    if (normals)
      for (const Role axis : {Role::nx, Role::ny, Role::nz})
        out.normals.push_back(small_or_zero(of(axis)));
    if (colours)
      for (const Role part : {Role::red, Role::green, Role::blue})
        out.colours.push_back(small_or_zero(of(part)) * scale);
    if (texture)
      for (const Role part : {Role::u, Role::v}) out.uv.push_back(small_or_zero(of(part)));
    if (confidence) out.confidence.push_back(small_or_zero(of(Role::confidence)));
  }
}

// One row of an element with lists: the list named vertex_indices is a face, texcoord its texture
// coordinates; other values are read over.
void read_row_with_lists(const Element& element, long long row, Values& values, PlyMesh* mesh,
                         const std::string& name) {
  for (const auto& property : element.properties) {
    if (!property.is_list) {
      values.next(property.type, element.name.c_str());
      continue;
    }
    const double count = values.next(property.count_type, "list length");
    if (!(count >= 0 && count == std::floor(count)) ||
        !values.can_hold(static_cast<long long>(count), 1, bytes_of(property.type))) {
      throw InputError(fmt::format("{}: {} {}: a list of {} does not fit into the file", name,
                                   element.name, row, count));
    }
    Polygons* const faces =
        mesh && (property.name == "vertex_indices" || property.name == "vertex_index")
            ? &mesh->polygons
            : nullptr;
    const bool is_texture = mesh && property.name == "texcoord";
    for (long long k = 0; k < static_cast<long long>(count); ++k) {
      const double value = values.next(property.type, "list entry");
      if (is_texture) mesh->corner_uv.push_back(small_or_zero(value));
      if (!faces) continue;
      if (!(value >= 0 && value < double(faces->coordinates.size() / 3) &&
            value == std::floor(value))) {
        throw InputError(fmt::format("{}: face {} names vertex {} of {}", name, row, value,
                                     faces->coordinates.size() / 3));
      }
      faces->corners.push_back(int(value));
    }
    if (faces && faces->corners.size() > limits::kMeshCorners)
      throw LimitError(
          fmt::format("{}: more than {} corners of faces", name, limits::kMeshCorners));
    if (faces) faces->sizes.push_back(int(count));
  }
}

void append_part(PlyMesh& mesh, const std::string& name, const MeshReadOptions& options,
                 MeshFile& out) {
  const std::size_t vertices = mesh.polygons.coordinates.size() / 3;
  const bool textured =
      !mesh.corner_uv.empty() && mesh.corner_uv.size() == 2 * mesh.polygons.corners.size();
  TriangleSources sources;
  MeshPart part;
  part.mesh =
      triangulate(mesh.polygons, name, out.notes, options.clouds, textured ? &sources : nullptr);
  if (!mesh.normals.empty()) part.normals = unit_normals(mesh.normals);
  if (!mesh.colours.empty()) part.colours = colours_in_range(mesh.colours);
  if (mesh.confidence.size() == vertices)
    part.confidence =
        Eigen::Map<const Eigen::VectorXf>(mesh.confidence.data(), Eigen::Index(vertices));
  if (textured) {
    part.texture.resize(Eigen::Index(sources.corners.size()), 2);
    for (std::size_t c = 0; c < sources.corners.size(); ++c)
      part.texture.row(Eigen::Index(c)) << mesh.corner_uv[2 * std::size_t(sources.corners[c])],
          mesh.corner_uv[2 * std::size_t(sources.corners[c]) + 1];
  } else if (!mesh.uv.empty()) {
    part.texture = corner_texture(mesh.uv, part.mesh.F);
  }
  out.parts.push_back(std::move(part));
}

}  // namespace

void parse_ply(std::string_view bytes, const std::string& name, const MeshReadOptions& options,
               MeshFile& out) {
  const Header header = parse_header(bytes, name);
  Values values(bytes, header, name);
  PlyMesh mesh;
  for (const auto& element : header.elements) {
    std::size_t least = 0;
    bool has_lists = false;
    int coordinates = 0;
    for (const auto& property : element.properties) {
      least += bytes_of(property.is_list ? property.count_type : property.type);
      has_lists = has_lists || property.is_list;
      coordinates += property.name == "x" || property.name == "y" || property.name == "z";
    }
    if (!values.can_hold(element.count, element.properties.size(), least)) {
      throw InputError(
          fmt::format("{}: the header promises {} of element '{}', more than the file can hold",
                      name, element.count, printable(element.name)));
    }
    if (element.count > limits::kMeshElements)
      throw LimitError(fmt::format("{}: {} of an element; the limit is {}", name, element.count,
                                   limits::kMeshElements));
    if (element.count > 0 && element.properties.empty())
      throw InputError(fmt::format("{}: an element without properties", name));
    const bool is_vertex = element.name == "vertex";
    if (is_vertex && (coordinates != 3 || has_lists || !mesh.polygons.coordinates.empty())) {
      throw InputError(
          fmt::format("{}: the vertex element must come once, with x, y, z and no lists", name));
    }
    if (is_vertex) {
      read_vertices(element, values, mesh, name);
      continue;
    }
    for (long long row = 0; row < element.count; ++row)
      read_row_with_lists(element, row, values, element.name == "face" ? &mesh : nullptr, name);
  }
  append_part(mesh, name, options, out);
}

}  // namespace ecorche::inline v1
