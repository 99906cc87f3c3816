#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "anatomy/errors.h"
#include "anatomy/input_file.h"
#include "anatomy/mesh_formats.h"

namespace ecorche {
namespace {

using nlohmann::json;

// What a glTF file says about its meshes. Everything else in it (images, materials, animations) is never looked at.
class GltfMeshes {
 public:
  GltfMeshes(const json& root, std::string_view binary, const std::string& name) : root_(root), binary_(binary), name_(name) {}

  void read(MeshFile& out);

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(fmt::format("{}: {}", name_, message)); }

  // The element of a top-level array, with its bounds checked.
  const json& item(const char* array, std::size_t index) const {
    const auto found = root_.find(array);
    if (found == root_.end() || !found->is_array() || index >= found->size() || !(*found)[index].is_object()) {
      fail(fmt::format("{}[{}] is named but not there", array, index));
    }
    return (*found)[index];
  }
  std::size_t array_size(const char* array) const {
    const auto found = root_.find(array);
    return found == root_.end() || !found->is_array() ? 0 : found->size();
  }

  static std::size_t whole(const json& object, const char* key, std::optional<std::size_t> otherwise = std::nullopt);
  std::string_view view_bytes(std::size_t view, std::size_t offset, std::size_t stride, std::size_t count, std::size_t size) const;
  Eigen::MatrixXd accessor(std::size_t index, int columns, bool indices) const;
  Affine node_transform(const json& node) const;
  void append_primitive(const json& primitive, const std::string& where, Polygons& out) const;
  TriMesh mesh(std::size_t index, const Affine& X_WN, MeshFile& out) const;

  const json& root_;
  std::string_view binary_;
  std::string name_;
};

// A non-negative whole number of an object; throws json::exception where it is anything else.
std::size_t GltfMeshes::whole(const json& object, const char* key, std::optional<std::size_t> otherwise) {
  const auto found = object.find(key);
  if (found == object.end() && otherwise) return *otherwise;
  const json& value = object.at(key);
  if (!value.is_number_unsigned()) throw json::other_error::create(501, fmt::format("'{}' must be a whole number >= 0", key), &object);
  return value.get<std::size_t>();
}

// The bytes from the first to the last of `count` items, checked against the buffer.
std::string_view GltfMeshes::view_bytes(std::size_t view, std::size_t offset, std::size_t stride, std::size_t count, std::size_t size) const {
  const json& v = item("bufferViews", view);
  const std::size_t buffer = whole(v, "buffer");
  const json& b = item("buffers", buffer);
  if (buffer != 0 || b.contains("uri")) fail(fmt::format("buffer {} lies outside the file; only data inside a GLB is read", buffer));
  const std::size_t begin = whole(v, "byteOffset", 0), length = whole(v, "byteLength");
  const bool view_fits = begin <= binary_.size() && length <= binary_.size() - begin && length <= whole(b, "byteLength");
  if (!view_fits) fail(fmt::format("bufferView {} reaches beyond the binary chunk of {} bytes", view, binary_.size()));
  const std::size_t room = offset <= length ? length - offset : 0;
  if (count == 0) return {};
  if (room < size || (count - 1) > (room - size) / stride) fail(fmt::format("bufferView {} is too short for {} items", view, count));
  return binary_.substr(begin + offset, (count - 1) * stride + size);
}

std::size_t component_bytes(std::size_t type) {
  switch (type) {
    case 5120: case 5121: return 1;
    case 5122: case 5123: return 2;
    case 5125: case 5126: return 4;
    default: return 0;
  }
}

double component(const char* bytes, std::size_t type) {
  const auto as = [&](auto value) {
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case 5120: return as(std::int8_t{});
    case 5121: return as(std::uint8_t{});
    case 5122: return as(std::int16_t{});
    case 5123: return as(std::uint16_t{});
    case 5125: return as(std::uint32_t{});
    default: return as(float{});
  }
}

Eigen::MatrixXd GltfMeshes::accessor(std::size_t index, int columns, bool indices) const {
  const json& a = item("accessors", index);
  const std::size_t type = whole(a, "componentType"), count = whole(a, "count"), bytes = component_bytes(type);
  const std::string shape = a.at("type");
  if (bytes == 0) fail(fmt::format("accessor {}: unknown componentType {}", index, type));
  if (shape != (columns == 3 ? "VEC3" : "SCALAR") || (indices && type == 5126)) fail(fmt::format("accessor {}: '{}' of type {} is not what its use needs", index, printable(shape), type));
  if (a.contains("sparse")) fail(fmt::format("accessor {}: sparse accessors are not read; export without them", index));
  if (count > static_cast<std::size_t>(kMeshLimit) * 6) throw LimitError(fmt::format("{}: accessor {} of {} items; the limit is {}", name_, index, count, kMeshLimit));
  const std::size_t size = bytes * static_cast<std::size_t>(columns);
  const json& view = item("bufferViews", whole(a, "bufferView"));
  const std::size_t stride = whole(view, "byteStride", size);
  if (stride < size || stride > 252) fail(fmt::format("accessor {}: stride {} of items of {} bytes", index, stride, size));
  const auto data = view_bytes(whole(a, "bufferView"), whole(a, "byteOffset", 0), stride, count, size);
  const bool normalized = a.value("normalized", false);
  const double scale = !normalized ? 1 : type == 5120 ? 1.0 / 127 : type == 5121 ? 1.0 / 255 : type == 5122 ? 1.0 / 32767 : 1.0 / 65535;
  Eigen::MatrixXd out(static_cast<Eigen::Index>(count), columns);
  for (std::size_t row = 0; row < count; ++row) {
    for (int k = 0; k < columns; ++k) {
      const double value = scale * component(data.data() + row * stride + bytes * static_cast<std::size_t>(k), type);
      if (!std::isfinite(value)) fail(fmt::format("accessor {}: item {} is not finite", index, row));
      out(static_cast<Eigen::Index>(row), k) = value;
    }
  }
  return out;
}

void GltfMeshes::append_primitive(const json& primitive, const std::string& where, Polygons& out) const {
  if (primitive.contains("extensions")) fail(where + " is compressed; export without mesh compression");
  const std::size_t mode = whole(primitive, "mode", 4);
  if (mode != 4) return;  // points, lines, strips: not surfaces of a body
  const Eigen::MatrixXd positions = accessor(whole(primitive.at("attributes"), "POSITION"), 3, false);
  const int base = static_cast<int>(out.coordinates.size() / 3);
  for (Eigen::Index i = 0; i < positions.rows(); ++i) out.coordinates.insert(out.coordinates.end(), {positions(i, 0), positions(i, 1), positions(i, 2)});
  Eigen::MatrixXd order = Eigen::VectorXd::LinSpaced(positions.rows(), 0, static_cast<double>(positions.rows()) - 1);
  if (primitive.contains("indices")) order = accessor(whole(primitive, "indices"), 1, true);
  if (order.rows() % 3 != 0) fail(fmt::format("{}: {} corners are no whole number of triangles", where, order.rows()));
  for (Eigen::Index k = 0; k < order.rows(); ++k) {
    if (order(k, 0) >= static_cast<double>(positions.rows())) fail(fmt::format("{}: corner {} names vertex {} of {}", where, k, order(k, 0), positions.rows()));
    out.corners.push_back(base + static_cast<int>(order(k, 0)));
  }
  out.sizes.insert(out.sizes.end(), static_cast<std::size_t>(order.rows() / 3), 3);
}

// Primitives that share their positions (one mesh in several materials) stay one set of vertices.
TriMesh GltfMeshes::mesh(std::size_t index, const Affine& X_WN, MeshFile& out) const {
  const json& primitives = item("meshes", index).at("primitives");
  Polygons polygons;
  std::optional<std::size_t> shared;
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    const std::string where = fmt::format("meshes[{}].primitives[{}]", index, p);
    const std::size_t positions = whole(primitives[p].at("attributes"), "POSITION");
    if (shared == positions) {
      Polygons more;
      append_primitive(primitives[p], where, more);
      polygons.corners.insert(polygons.corners.end(), more.corners.begin(), more.corners.end());
      polygons.sizes.insert(polygons.sizes.end(), more.sizes.begin(), more.sizes.end());
    } else {
      append_primitive(primitives[p], where, polygons);
      if (p == 0) shared = positions;
    }
  }
  TriMesh mesh = triangulate(polygons, fmt::format("{}: meshes[{}]", name_, index), out.notes);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) mesh.V.row(i) = (X_WN * Vec3(mesh.V.row(i))).transpose();
  if (X_WN.linear().determinant() < 0) mesh.F.col(1).swap(mesh.F.col(2));
  if (!mesh.V.allFinite()) fail(fmt::format("meshes[{}]: vertices are not finite once placed by their nodes", index));
  return mesh;
}

std::vector<double> numbers(const json& node, const char* key, std::vector<double> otherwise) {
  const auto found = node.find(key);
  if (found == node.end()) return otherwise;
  const auto values = found->get<std::vector<double>>();
  if (values.size() != otherwise.size()) throw json::other_error::create(502, fmt::format("'{}' must hold {} numbers", key, otherwise.size()), &node);
  return values;
}

Affine GltfMeshes::node_transform(const json& node) const {
  Affine out = Affine::Identity();
  if (node.contains("matrix")) {
    const auto m = numbers(node, "matrix", std::vector<double>(16));
    out.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
    out.makeAffine();
    return out;
  }
  const auto t = numbers(node, "translation", {0, 0, 0}), r = numbers(node, "rotation", {0, 0, 0, 1}), s = numbers(node, "scale", {1, 1, 1});
  const Quat q(r[3], r[0], r[1], r[2]);
  if (!(q.norm() > 1e-9)) fail("a node's rotation is the zero quaternion");
  out.translate(Vec3(t[0], t[1], t[2])).rotate(q.normalized()).scale(Vec3(s[0], s[1], s[2]));
  return out;
}

// Walks the nodes from those that are nobody's child, without recursion; what is met twice is no tree.
void GltfMeshes::read(MeshFile& out) {
  const std::size_t count = array_size("nodes");
  std::vector<int> parents(count, 0);
  for (std::size_t n = 0; n < count; ++n) {
    for (const json& child : item("nodes", n).value("children", json::array())) {
      const auto c = child.get<std::size_t>();
      if (c >= count || ++parents[c] > 1) fail(fmt::format("node {} is a child of more than one node, or not there", c));
    }
  }
  std::vector<std::pair<std::size_t, Affine>> open;
  for (std::size_t n = count; n-- > 0;) {
    if (parents[n] == 0) open.emplace_back(n, Affine::Identity());
  }
  std::size_t seen = 0;
  while (!open.empty()) {
    const auto [n, X_WP] = open.back();
    open.pop_back();
    ++seen;
    const json& node = item("nodes", n);
    const Affine X_WN = X_WP * node_transform(node);
    // A skinned mesh is placed by its joints, not by its node.
    if (node.contains("mesh")) out.parts.push_back({node.value("name", std::string()), mesh(whole(node, "mesh"), node.contains("skin") ? Affine::Identity() : X_WN, out)});
    const auto children = node.value("children", std::vector<std::size_t>());
    for (auto child = children.rbegin(); child != children.rend(); ++child) open.emplace_back(*child, X_WN);
  }
  if (seen != count) fail("some nodes are their own ancestors");
  if (count == 0) {
    for (std::size_t m = 0; m < array_size("meshes"); ++m) out.parts.push_back({item("meshes", m).value("name", std::string()), mesh(m, Affine::Identity(), out)});
  }
  if (out.parts.empty()) throw UnfitError(name_ + ": the file holds no mesh");
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

// Refuses what nests deeper than any glTF does, before the parser builds it.
void check_depth(std::string_view text, const std::string& name) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted && c == '\\') ++k;
    else if (c == '"') quoted = !quoted;
    else if (!quoted && (c == '{' || c == '[') && ++depth > 64) throw LimitError(fmt::format("{}: JSON nested deeper than 64", name));
    else if (!quoted && (c == '}' || c == ']')) --depth;
  }
}

}  // namespace

void parse_glb(std::string_view bytes, const std::string& name, MeshFile& out) {
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (bytes.size() < 20) throw InputError(fmt::format("{}: the GLB header is truncated", name));
  if (word_at(bytes, 4) != 2) throw InputError(fmt::format("{}: GLB version {}; expected 2", name, word_at(bytes, 4)));
  if (word_at(bytes, 8) != bytes.size()) throw InputError(fmt::format("{}: the header promises {} bytes, the file has {}", name, word_at(bytes, 8), bytes.size()));
  const std::size_t json_size = word_at(bytes, 12);
  if (word_at(bytes, 16) != kJson) throw InputError(fmt::format("{}: the first chunk is not JSON", name));
  if (json_size > bytes.size() - 20) throw InputError(fmt::format("{}: the JSON chunk of {} bytes reaches beyond the file", name, json_size));
  const auto text = bytes.substr(20, json_size);
  std::string_view binary;
  const auto rest = bytes.substr(20 + json_size);
  if (!rest.empty()) {
    if (rest.size() < 8 || word_at(rest, 0) > rest.size() - 8) throw InputError(fmt::format("{}: the second chunk reaches beyond the file", name));
    if (word_at(rest, 4) == kBinary) binary = rest.substr(8, word_at(rest, 0));
  }
  check_depth(text, name);
  try {
    const json root = json::parse(text);
    if (!root.is_object()) throw InputError(fmt::format("{}: the JSON chunk is no object", name));
    GltfMeshes(root, binary, name).read(out);
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: {}", name, printable(e.what())));
  }
}

}  // namespace ecorche
