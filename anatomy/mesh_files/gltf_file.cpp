#include "anatomy/mesh_files/gltf_file.h"

#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::size_t component_bytes(std::size_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

double component(const char* bytes, std::size_t type) {
  const auto as = [&](auto value) {
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
  };
  switch (type) {
    case 5120:
      return as(std::int8_t{});
    case 5121:
      return as(std::uint8_t{});
    case 5122:
      return as(std::int16_t{});
    case 5123:
      return as(std::uint16_t{});
    case 5125:
      return as(std::uint32_t{});
    default:
      return as(float{});
  }
}

double normalized_scale(std::size_t type) {
  switch (type) {
    case 5120:
      return 1.0 / 127;
    case 5121:
      return 1.0 / 255;
    case 5122:
      return 1.0 / 32767;
    case 5123:
      return 1.0 / 65535;
    default:
      return 1;
  }
}

}  // namespace

void gltf_detail::refuse(const std::string& name, const std::string& message) {
  throw InputError(fmt::format("{}: {}", name, printable(message)));
}

// Refuses what nests deeper than any glTF does before a parser builds it: what walks a tree
// afterwards may recurse.
void gltf_detail::check_text(std::string_view text, const std::string& name, std::size_t limit) {
  if (text.size() > limit)
    throw LimitError(
        fmt::format("{}: JSON of {} bytes; the limit is {}", name, text.size(), limit));
  int depth = 0;
  std::size_t values = 1;
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    values += !quoted && (c == ',' || c == '{' || c == '[');
    if (quoted && c == '\\')
      ++k;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '{' || c == '[') && ++depth > limits::kJsonDepth)
      throw LimitError(fmt::format("{}: JSON nested deeper than {}", name, limits::kJsonDepth));
    else if (!quoted && (c == '}' || c == ']'))
      --depth;
  }
  if (values > limit / 4)
    throw LimitError(
        fmt::format("{}: JSON of {} values; the limit is {}", name, values, limit / 4));
}

GlbParts split_glb(std::string_view bytes, const std::string& name) {
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (bytes.size() < 20 || !bytes.starts_with("glTF"))
    throw InputError(fmt::format("{}: the GLB header is truncated", name));
  if (word_at(bytes, 4) != 2)
    throw InputError(fmt::format("{}: GLB version {}; expected 2", name, word_at(bytes, 4)));
  if (word_at(bytes, 8) != bytes.size())
    throw InputError(fmt::format("{}: the header promises {} bytes, the file has {}", name,
                                 word_at(bytes, 8), bytes.size()));
  const std::size_t json_size = word_at(bytes, 12);
  if (word_at(bytes, 16) != kJson)
    throw InputError(fmt::format("{}: the first chunk is not JSON", name));
  if (json_size > bytes.size() - 20)
    throw InputError(
        fmt::format("{}: the JSON chunk of {} bytes reaches beyond the file", name, json_size));
  GlbParts out{bytes.substr(20, json_size), {}};
  const std::string_view rest = bytes.substr(20 + json_size);
  if (rest.empty()) return out;
  if (rest.size() < 8 || word_at(rest, 0) > rest.size() - 8)
    throw InputError(fmt::format("{}: the second chunk reaches beyond the file", name));
  if (word_at(rest, 4) == kBinary) out.binary = rest.substr(8, word_at(rest, 0));
  return out;
}

GltfFile::GltfFile(std::string_view bytes, std::string name)
    : name_(std::move(name)),
      parts_(split_glb(bytes, name_)),
      root_(parse_gltf_json<Json>(parts_.json, name_, limits::kJsonBytes)),
      allowed_(bytes.size() + limits::kRepeatedElements) {}

void GltfFile::fail(const std::string& message) const { gltf_detail::refuse(name_, message); }

std::size_t GltfFile::count(const char* list) const {
  const auto found = root_.find(list);
  return found == root_.end() || !found->is_array() ? 0 : found->size();
}

const GltfFile::Json& GltfFile::item(const char* list, std::size_t index) const {
  const auto found = root_.find(list);
  if (found == root_.end() || !found->is_array() || index >= found->size() ||
      !(*found)[index].is_object())
    fail(fmt::format("{}[{}] is named but not there", list, index));
  return (*found)[index];
}

std::size_t GltfFile::whole(const Json& object, const char* key,
                            std::optional<std::size_t> otherwise) const {
  if (!object.is_object()) fail(fmt::format("an object with '{}' expected", key));
  const auto found = object.find(key);
  if (found == object.end() && otherwise) return *otherwise;
  if (found == object.end()) fail(fmt::format("'{}' is missing", key));
  if (!found->is_number_unsigned()) fail(fmt::format("'{}' must be a whole number >= 0", key));
  return found->get<std::size_t>();
}

std::string_view GltfFile::view_bytes(std::size_t view) const {
  const Json& v = item("bufferViews", view);
  const std::size_t buffer = whole(v, "buffer");
  const Json& b = item("buffers", buffer);
  if (buffer != 0 || b.contains("uri"))
    fail(fmt::format("buffer {} lies outside the file; only data inside a GLB is read", buffer));
  const std::size_t begin = whole(v, "byteOffset", 0), length = whole(v, "byteLength"),
                    stated = whole(b, "byteLength");
  const std::size_t there = std::min(parts_.binary.size(), stated);
  if (begin > there || length > there - begin)
    fail(fmt::format("bufferView {} reaches beyond the binary chunk of {} bytes", view, there));
  return parts_.binary.substr(begin, length);
}

GltfFile::Values GltfFile::values(std::size_t accessor, const char* shape,
                                  std::size_t columns) const {
  const Json& a = item("accessors", accessor);
  Values out;
  out.type = whole(a, "componentType");
  out.count = whole(a, "count");
  out.component = component_bytes(out.type);
  if (out.component == 0)
    fail(fmt::format("accessor {}: unknown componentType {}", accessor, out.type));
  if (!a.contains("type") || a.at("type") != shape)
    fail(fmt::format("accessor {}: it is not of type {}", accessor, shape));
  if (a.contains("sparse"))
    fail(fmt::format("accessor {}: sparse accessors are not read; export without them", accessor));
  if (out.count > std::size_t(limits::kMeshElements) * 6)
    throw LimitError(fmt::format("{}: accessor {} of {} items; the limit is {}", name_, accessor,
                                 out.count, limits::kMeshElements));
  const std::size_t view = whole(a, "bufferView"), size = out.component * columns,
                    offset = whole(a, "byteOffset", 0);
  out.stride = whole(item("bufferViews", view), "byteStride", size);
  if (out.stride < size || out.stride > 252)
    fail(fmt::format("accessor {}: stride {} of items of {} bytes", accessor, out.stride, size));
  const std::string_view bytes = view_bytes(view);
  const std::size_t room = offset <= bytes.size() ? bytes.size() - offset : 0;
  if (out.count > 0 && (room < size || (out.count - 1) > (room - size) / out.stride))
    fail(fmt::format("bufferView {} is too short for {} items", view, out.count));
  out.bytes = bytes.substr(std::min(offset, bytes.size()));
  const auto normalized = a.find("normalized");
  if (normalized != a.end() && *normalized == true) out.scale = normalized_scale(out.type);
  return out;
}

double GltfFile::number(const Values& values, std::size_t accessor, std::size_t row,
                        std::size_t column) const {
  const double value =
      values.scale *
      component(values.bytes.data() + row * values.stride + column * values.component, values.type);
  if (!std::isfinite(value)) fail(fmt::format("accessor {}: item {} is not finite", accessor, row));
  return value;
}

void GltfFile::count_elements(std::size_t more) const {
  handed_out_ += more;
  if (handed_out_ > allowed_)
    throw LimitError(
        fmt::format("{}: its meshes name the same vertices and corners again and again, {} beyond "
                    "what the file holds; save each mesh once",
                    name_, limits::kRepeatedElements));
}

Points GltfFile::points(std::size_t accessor) const {
  const Values all = values(accessor, "VEC3", 3);
  count_elements(all.count);
  Points out(all.count, 3);
  for (std::size_t row = 0; row < all.count; ++row)
    for (std::size_t k = 0; k < 3; ++k) out(row, Eigen::Index(k)) = number(all, accessor, row, k);
  return out;
}

std::vector<double> GltfFile::scalars(std::size_t accessor) const {
  const Values all = values(accessor, "SCALAR", 1);
  count_elements(all.count);
  std::vector<double> out(all.count);
  for (std::size_t row = 0; row < all.count; ++row) out[row] = number(all, accessor, row, 0);
  return out;
}

std::vector<int> GltfFile::corners(std::size_t accessor, std::size_t vertices) const {
  const Values all = values(accessor, "SCALAR", 1);
  if (all.type == 5126)
    fail(fmt::format("accessor {}: corners of triangles in floating point", accessor));
  count_elements(all.count);
  std::vector<int> out(all.count);
  for (std::size_t row = 0; row < all.count; ++row) {
    const double corner = component(all.bytes.data() + row * all.stride, all.type);
    if (!(corner >= 0 && corner < double(vertices)))
      fail(fmt::format("accessor {}: corner {} names vertex {} of {}", accessor, row, corner,
                       vertices));
    out[row] = int(corner);
  }
  return out;
}

std::vector<Eigen::Matrix4d> GltfFile::matrices(std::size_t accessor) const {
  const Values all = values(accessor, "MAT4", 16);
  if (all.type != 5126)
    fail(fmt::format("accessor {}: matrices that are not in floating point", accessor));
  count_elements(16 * all.count);
  std::vector<Eigen::Matrix4d> out(all.count);
  for (std::size_t row = 0; row < all.count; ++row)
    for (std::size_t k = 0; k < 16; ++k)
      out[row](Eigen::Index(k % 4), Eigen::Index(k / 4)) = number(all, accessor, row, k);
  return out;
}

std::vector<int> GltfFile::parents() const {
  const std::size_t nodes = count("nodes");
  std::vector<int> out(nodes, -1);
  for (std::size_t n = 0; n < nodes; ++n) {
    const Json& node = item("nodes", n);
    const auto children = node.find("children");
    if (children == node.end()) continue;
    if (!children->is_array()) fail(fmt::format("node {}: 'children' is no list", n));
    for (const Json& child : *children) {
      const std::size_t c = child.is_number_unsigned() ? child.get<std::size_t>() : nodes;
      if (c >= nodes || out[c] >= 0)
        fail(fmt::format("node {} is a child of more than one node, or not there", child.dump()));
      out[c] = int(n);
    }
  }
  // Each node's way up ends: walked once, marked by the walk that found it.
  std::vector<std::size_t> walk(nodes, nodes);
  for (std::size_t n = 0; n < nodes; ++n) {
    std::size_t at = n;
    while (walk[at] == nodes && out[at] >= 0) {
      walk[at] = n;
      at = out[at];
    }
    if (walk[at] == n) fail("some nodes are their own ancestors");
    walk[at] = std::min(walk[at], n);
  }
  return out;
}

void GltfFile::check_views() const {
  const auto outside = [&](std::size_t view) {
    const std::size_t buffer = whole(item("bufferViews", view), "buffer");
    return item("buffers", buffer).contains("uri");
  };
  for (std::size_t v = 0; v < count("bufferViews"); ++v)
    if (!outside(v)) view_bytes(v);
  for (std::size_t i = 0; i < count("accessors"); ++i) {
    const Json& a = item("accessors", i);
    if (!a.contains("bufferView")) continue;
    const std::size_t view = whole(a, "bufferView");
    if (outside(view)) continue;
    const std::string shape =
        a.value("type", Json()).is_string() ? a.at("type").get<std::string>() : "";
    static const std::map<std::string, std::size_t> kColumns{
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
        {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    const auto columns = kColumns.find(shape);
    if (columns == kColumns.end()) fail(fmt::format("accessor {}: unknown type '{}'", i, shape));
    if (!a.contains("sparse")) values(i, shape.c_str(), columns->second);
  }
}

}  // namespace ecorche::inline v1
