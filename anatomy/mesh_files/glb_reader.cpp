#include "anatomy/mesh_files/glb_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/mesh_files/polygons.h"

namespace ecorche::inline v1 {
namespace {

using Json = GltfFile::Json;

// What a glTF file says about its meshes. Everything else in it (images, materials, animations) is
// never looked at.
class GltfMeshes {
 public:
  explicit GltfMeshes(const GltfFile& file) : file_(file) {}

  void read(MeshFile& out) const;

 private:
  [[noreturn]] void fail(const std::string& message) const { file_.fail(message); }
  std::vector<double> numbers(const Json& node, const char* key,
                              std::vector<double> otherwise) const;
  Affine node_transform(const Json& node) const;
  void append_corners(const Json& primitive, std::size_t vertices, int base,
                      const std::string& where, Polygons& out) const;
  TriMesh mesh(std::size_t index, const Affine& X_WN, MeshFile& out) const;

  const GltfFile& file_;
};

std::string name_of(const Json& element) {
  const auto found = element.find("name");
  return found != element.end() && found->is_string()
             ? printable(found->get<std::string>().substr(0, limits::kNameBytes))
             : "";
}

void GltfMeshes::append_corners(const Json& primitive, std::size_t vertices, int base,
                                const std::string& where, Polygons& out) const {
  std::vector<int> order;
  if (primitive.contains("indices")) {
    order = file_.corners(file_.whole(primitive, "indices"), vertices);
  } else {
    order.resize(vertices);
    for (std::size_t k = 0; k < vertices; ++k) order[k] = int(k);
  }
  if (order.size() % 3 != 0)
    fail(fmt::format("{}: {} corners are no whole number of triangles", where, order.size()));
  for (const int corner : order) out.corners.push_back(base + corner);
  out.sizes.insert(out.sizes.end(), order.size() / 3, 3);
}

// Primitives that share their positions (one mesh in several materials) stay one set of vertices.
TriMesh GltfMeshes::mesh(std::size_t index, const Affine& X_WN, MeshFile& out) const {
  const Json& element = file_.item("meshes", index);
  const auto primitives = element.find("primitives");
  if (primitives == element.end() || !primitives->is_array())
    fail(fmt::format("meshes[{}]: no primitives", index));
  Polygons polygons;
  std::optional<std::size_t> shared;
  std::size_t shared_vertices = 0;
  for (std::size_t p = 0; p < primitives->size(); ++p) {
    const Json& primitive = (*primitives)[p];
    const std::string where = fmt::format("meshes[{}].primitives[{}]", index, p);
    if (!primitive.is_object() || !primitive.contains("attributes"))
      fail(where + ": no attributes");
    if (primitive.contains("extensions"))
      fail(where + " is compressed; export without mesh compression");
    if (file_.whole(primitive, "mode", 4) != 4)
      continue;  // points, lines, strips: not surfaces of a body
    const std::size_t positions = file_.whole(primitive.at("attributes"), "POSITION");
    if (shared == positions) {
      append_corners(primitive, shared_vertices, 0, where, polygons);
      continue;
    }
    const Points places = file_.points(positions);
    const int base = polygons.coordinates.size() / 3;
    polygons.coordinates.insert(polygons.coordinates.end(), places.data(),
                                places.data() + places.size());
    append_corners(primitive, std::size_t(places.rows()), base, where, polygons);
    if (base == 0 && !shared) shared = positions, shared_vertices = places.rows();
  }
  TriMesh mesh =
      triangulate(polygons, fmt::format("{}: meshes[{}]", file_.name(), index), out.notes);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    mesh.V.row(i) = (X_WN * Vec3(mesh.V.row(i))).transpose();
  if (X_WN.linear().determinant() < 0) mesh.F.col(1).swap(mesh.F.col(2));
  if (!mesh.V.allFinite())
    fail(fmt::format("meshes[{}]: vertices are not finite once placed by their nodes", index));
  return mesh;
}

std::vector<double> GltfMeshes::numbers(const Json& node, const char* key,
                                        std::vector<double> otherwise) const {
  const auto found = node.find(key);
  if (found == node.end()) return otherwise;
  const bool right =
      found->is_array() && found->size() == otherwise.size() &&
      std::all_of(found->begin(), found->end(), [](const Json& v) { return v.is_number(); });
  if (!right)
    fail(fmt::format("node '{}': '{}' must hold {} numbers", name_of(node), key, otherwise.size()));
  return found->get<std::vector<double>>();
}

Affine GltfMeshes::node_transform(const Json& node) const {
  Affine out = Affine::Identity();
  if (node.contains("matrix")) {
    const auto m = numbers(node, "matrix", std::vector<double>(16));
    out.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
    out.makeAffine();
    return out;
  }
  const auto t = numbers(node, "translation", {0, 0, 0}),
             r = numbers(node, "rotation", {0, 0, 0, 1}), s = numbers(node, "scale", {1, 1, 1});
  const Quat q(r[3], r[0], r[1], r[2]);
  if (!(q.norm() > 1e-9))
    fail(fmt::format("node '{}': its rotation is the zero quaternion", name_of(node)));
  out.translate(Vec3(t[0], t[1], t[2])).rotate(q.normalized()).scale(Vec3(s[0], s[1], s[2]));
  return out;
}

// Walks the nodes from those that are nobody's child, without recursion.
void GltfMeshes::read(MeshFile& out) const {
  const std::vector<int> parents = file_.parents();
  std::vector<std::pair<std::size_t, Affine>> open;
  for (std::size_t n = parents.size(); n-- > 0;)
    if (parents[n] < 0) open.emplace_back(n, Affine::Identity());
  while (!open.empty()) {
    const auto [n, X_WP] = open.back();
    open.pop_back();
    const Json& node = file_.item("nodes", n);
    const Affine X_WN = X_WP * node_transform(node);
    // A skinned mesh is placed by its joints, not by its node.
    if (node.contains("mesh"))
      out.parts.push_back(
          {name_of(node), mesh(file_.whole(node, "mesh"),
                               node.contains("skin") ? Affine::Identity() : X_WN, out)});
    const auto children = node.find("children");
    if (children == node.end()) continue;
    for (auto child = children->rbegin(); child != children->rend(); ++child)
      open.emplace_back(child->get<std::size_t>(), X_WN);
  }
  if (parents.empty())
    for (std::size_t m = 0; m < file_.count("meshes"); ++m)
      out.parts.push_back({name_of(file_.item("meshes", m)), mesh(m, Affine::Identity(), out)});
  if (out.parts.empty()) throw UnfitError(file_.name() + ": the file holds no mesh");
}

}  // namespace

void parse_glb(std::string_view bytes, const std::string& name, MeshFile& out) {
  GltfMeshes(GltfFile(bytes, name)).read(out);
}

}  // namespace ecorche::inline v1
