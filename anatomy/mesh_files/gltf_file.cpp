#include "anatomy/mesh_files/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

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

std::size_t columns_of(const std::string& shape) {
  static const std::map<std::string, std::size_t> kColumns{
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  const auto found = kColumns.find(shape);
  return found == kColumns.end() ? 0 : found->second;
}

const char* vector_shape(std::size_t columns) {
  constexpr const char* kShapes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kShapes[columns - 1];
}

constexpr std::array<signed char, 256> kBase64 = [] {
  std::array<signed char, 256> out{};
  for (signed char& value : out) value = -1;
  const std::string_view letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t k = 0; k < letters.size(); ++k)
    out[static_cast<unsigned char>(letters[k])] = static_cast<signed char>(k);
  return out;
}();

// Nothing for what is not base64.
std::optional<std::string> base64_bytes(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char letter : text) {
    const int value = kBase64[static_cast<unsigned char>(letter)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | std::uint32_t(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += char(bits >> held & 0xFF);
  }
  return out;
}

// "my%20mesh.bin" -> "my mesh.bin"
std::string percent_decoded(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool coded =
        text[k] == '%' && k + 2 < text.size() && digit(text[k + 1]) >= 0 && digit(text[k + 2]) >= 0;
    out += coded ? char(digit(text[k + 1]) * 16 + digit(text[k + 2])) : text[k];
    if (coded) k += 2;
  }
  return out;
}

bool is_glb(std::string_view bytes) { return bytes.starts_with("glTF"); }

}  // namespace

void gltf_detail::refuse(const std::string& name, const std::string& message) {
  throw InputError(fmt::format("{}: {}", name, printable(message)));
}

// Refuses what nests deeper than any glTF does before a parser builds it: what walks a tree
// afterwards may recurse.
void gltf_detail::check_text(std::string_view text, const std::string& name, std::size_t limit,
                             std::size_t most_values) {
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
  if (values > most_values)
    throw LimitError(
        fmt::format("{}: JSON of {} values; the limit is {}", name, values, most_values));
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

GltfFile::GltfFile(std::string_view bytes, std::string name,
                   std::optional<std::filesystem::path> folder)
    : name_(std::move(name)),
      folder_(std::move(folder)),
      parts_(is_glb(bytes) ? split_glb(bytes, name_) : GlbParts{bytes, {}}),
      root_(parse_gltf_json<Json>(parts_.json, name_,
                                  is_glb(bytes) ? limits::kJsonBytes : limits::kGltfTextBytes,
                                  limits::kJsonBytes / 4)),
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

std::string_view GltfFile::buffer_bytes(std::size_t buffer) const {
  const Json& b = item("buffers", buffer);
  const std::size_t stated = whole(b, "byteLength");
  const auto uri = b.find("uri");
  if (uri == b.end()) {
    if (buffer != 0) fail(fmt::format("buffer {} is neither in the file nor named", buffer));
    return parts_.binary.substr(0, stated);
  }
  if (!uri->is_string()) fail(fmt::format("buffer {}: 'uri' is no text", buffer));
  const std::string& text = uri->get_ref<const std::string&>();
  auto held = buffers_.find(buffer);
  if (held == buffers_.end() && text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    const bool base64 = comma != std::string::npos && comma >= 7 &&
                        std::string_view(text).substr(comma - 7, 7) == ";base64";
    std::optional<std::string> bytes;
    if (base64) bytes = base64_bytes(std::string_view(text).substr(comma + 1));
    if (!bytes) fail(fmt::format("buffer {}: its data: URI is not base64", buffer));
    held = buffers_.emplace(buffer, std::move(*bytes)).first;
  } else if (held == buffers_.end()) {
    if (!folder_)
      fail(
          fmt::format("buffer {} lies outside the file; only data inside it is read; save it as "
                      ".glb, which holds all",
                      buffer));
    const auto file =
        file_beside(*folder_, percent_decoded(text), fmt::format("{}: buffer {}", name_, buffer));
    held = buffers_.emplace(buffer, read_input_file(file)).first;
    allowed_ += held->second.size();
  }
  return std::string_view(held->second).substr(0, stated);
}

std::string_view GltfFile::view_bytes(std::size_t view) const {
  const Json& v = item("bufferViews", view);
  if (const auto extensions = v.find("extensions");
      extensions != v.end() && extensions->contains("EXT_meshopt_compression"))
    fail(
        fmt::format("bufferView {} is compressed (EXT_meshopt_compression); save the file without "
                    "compression: gltfpack without -c, Blender without Compress",
                    view));
  const std::string_view bytes = buffer_bytes(whole(v, "buffer"));
  const std::size_t begin = whole(v, "byteOffset", 0), length = whole(v, "byteLength");
  if (begin > bytes.size() || length > bytes.size() - begin)
    fail(fmt::format("bufferView {} reaches beyond the binary chunk of {} bytes", view,
                     bytes.size()));
  return bytes.substr(begin, length);
}

std::string GltfFile::shape_of(std::size_t accessor) const {
  const Json& a = item("accessors", accessor);
  const auto type = a.find("type");
  const std::string shape = type != a.end() && type->is_string() ? type->get<std::string>() : "";
  if (columns_of(shape) == 0)
    fail(fmt::format("accessor {}: unknown type '{}'", accessor, printable(shape)));
  return shape;
}

// Where `count` items of some columns lie in a bufferView; checks that all are there.
GltfFile::Values GltfFile::items(std::size_t view, std::size_t offset, std::size_t type,
                                 std::size_t count, std::size_t columns,
                                 std::size_t accessor) const {
  Values out;
  out.type = type;
  out.count = count;
  out.columns = columns;
  out.component = component_bytes(type);
  if (out.component == 0)
    fail(fmt::format("accessor {}: unknown componentType {}", accessor, type));
  const std::size_t size = out.component * columns;
  out.stride = whole(item("bufferViews", view), "byteStride", size);
  if (out.stride < size || out.stride > 252)
    fail(fmt::format("accessor {}: stride {} of items of {} bytes", accessor, out.stride, size));
  const std::string_view bytes = view_bytes(view);
  const std::size_t room = offset <= bytes.size() ? bytes.size() - offset : 0;
  if (count > 0 && (room < size || (count - 1) > (room - size) / out.stride))
    fail(fmt::format("bufferView {} is too short for {} items", view, count));
  out.bytes = bytes.substr(std::min(offset, bytes.size()));
  return out;
}

GltfFile::Values GltfFile::values(std::size_t accessor, const std::string& shape) const {
  const Json& a = item("accessors", accessor);
  const std::size_t type = whole(a, "componentType"), count = whole(a, "count"),
                    columns = columns_of(shape);
  if (component_bytes(type) == 0)
    fail(fmt::format("accessor {}: unknown componentType {}", accessor, type));
  if (!a.contains("type") || a.at("type") != shape)
    fail(fmt::format("accessor {}: it is not of type {}", accessor, shape));
  if (count > std::size_t(limits::kMeshElements) * 6)
    throw LimitError(fmt::format("{}: accessor {} of {} items; the limit is {}", name_, accessor,
                                 count, limits::kMeshElements));
  Values out;
  if (a.contains("bufferView")) {
    out = items(whole(a, "bufferView"), whole(a, "byteOffset", 0), type, count, columns, accessor);
  } else {
    out.type = type;
    out.count = count;
    out.columns = columns;
    out.component = component_bytes(type);
    out.is_zero = true;
  }
  const auto normalized = a.find("normalized");
  if (normalized != a.end() && *normalized == true) out.scale = normalized_scale(out.type);
  return out;
}

// The rows that a sparse accessor replaces: increasing, each below the accessor's count.
std::vector<std::size_t> GltfFile::sparse_rows(std::size_t accessor, const Values& all) const {
  const Json& sparse = item("accessors", accessor).at("sparse");
  const std::size_t count = whole(sparse, "count");
  if (count > all.count || !sparse.contains("indices") || !sparse.contains("values"))
    fail(fmt::format("accessor {}: sparse with {} of {} items, or without indices and values",
                     accessor, count, all.count));
  const Json& at = sparse.at("indices");
  const std::size_t type = whole(at, "componentType");
  if (type == 5126) fail(fmt::format("accessor {}: sparse indices in floating point", accessor));
  const Values rows =
      items(whole(at, "bufferView"), whole(at, "byteOffset", 0), type, count, 1, accessor);
  std::vector<std::size_t> out(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double row = component(rows.bytes.data() + k * rows.stride, type);
    if (!(row >= 0 && row < double(all.count)))
      fail(fmt::format("accessor {}: sparse item {} of {}", accessor, row, all.count));
    out[k] = std::size_t(row);
  }
  return out;
}

// All items into `out`, row by row; sparse ones over the others.
template <class T>
void GltfFile::copy(std::size_t accessor, const Values& all, T* out) const {
  const auto put = [&](const Values& from, std::size_t row, std::size_t to) {
    for (std::size_t k = 0; k < all.columns; ++k)
      out[to * all.columns + k] = T(number(from, accessor, row, k));
  };
  if (all.is_zero)
    std::fill_n(out, all.count * all.columns, T(0));
  else
    for (std::size_t row = 0; row < all.count; ++row) put(all, row, row);
  const Json& a = item("accessors", accessor);
  if (!a.contains("sparse")) return;
  const std::vector<std::size_t> rows = sparse_rows(accessor, all);
  const Json& at = a.at("sparse").at("values");
  Values some = items(whole(at, "bufferView"), whole(at, "byteOffset", 0), all.type, rows.size(),
                      all.columns, accessor);
  some.scale = all.scale;
  for (std::size_t k = 0; k < rows.size(); ++k) put(some, k, rows[k]);
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

GltfFile::Rows GltfFile::rows(std::size_t accessor, std::size_t columns) const {
  const Values all = values(accessor, vector_shape(columns));
  count_elements(all.count);
  Rows out(all.count, columns);
  copy(accessor, all, out.data());
  return out;
}

GltfFile::WholeRows GltfFile::whole_rows(std::size_t accessor, std::size_t columns) const {
  Values all = values(accessor, vector_shape(columns));
  if (all.type == 5126 || all.type == 5125)
    fail(fmt::format("accessor {}: joints of componentType {}; expected bytes or shorts", accessor,
                     all.type));
  all.scale = 1;
  count_elements(all.count);
  WholeRows out(all.count, columns);
  copy(accessor, all, out.data());
  return out;
}

Points GltfFile::points(std::size_t accessor) const {
  const Values all = values(accessor, "VEC3");
  count_elements(all.count);
  Points out(all.count, 3);
  copy(accessor, all, out.data());
  return out;
}

std::vector<double> GltfFile::scalars(std::size_t accessor) const {
  const Values all = values(accessor, "SCALAR");
  count_elements(all.count);
  std::vector<double> out(all.count);
  copy(accessor, all, out.data());
  return out;
}

std::vector<int> GltfFile::corners(std::size_t accessor, std::size_t vertices) const {
  Values all = values(accessor, "SCALAR");
  if (all.type == 5126)
    fail(fmt::format("accessor {}: corners of triangles in floating point", accessor));
  all.scale = 1;
  count_elements(all.count);
  std::vector<int> out(all.count);
  const auto put = [&](std::size_t row, double corner) {
    if (!(corner >= 0 && corner < double(vertices)))
      fail(fmt::format("accessor {}: corner {} names vertex {} of {}", accessor, row, corner,
                       vertices));
    out[row] = int(corner);
  };
  if (all.is_zero || item("accessors", accessor).contains("sparse")) {
    std::vector<double> numbers(all.count);
    copy(accessor, all, numbers.data());
    for (std::size_t row = 0; row < all.count; ++row) put(row, numbers[row]);
  } else {
    for (std::size_t row = 0; row < all.count; ++row)
      put(row, component(all.bytes.data() + row * all.stride, all.type));
  }
  return out;
}

std::vector<Eigen::Matrix4d> GltfFile::matrices(std::size_t accessor) const {
  const Values all = values(accessor, "MAT4");
  if (all.type != 5126)
    fail(fmt::format("accessor {}: matrices that are not in floating point", accessor));
  count_elements(16 * all.count);
  std::vector<Eigen::Matrix4d> out(all.count);
  if (all.count > 0) copy(accessor, all, out[0].data());
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
    values(i, shape_of(i));
  }
}

}  // namespace ecorche::inline v1
