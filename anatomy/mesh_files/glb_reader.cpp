#include "anatomy/mesh_files/glb_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/mesh_files/polygons.h"
#include "anatomy/mesh_files/vertex_values.h"

namespace ecorche::inline v1 {
namespace {

using Json = GltfFile::Json;

constexpr int kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6;  // glTF's modes that are read

// The vertices and faces of a part while its primitives are read.
struct GltfPart {
  Polygons polygons;
  std::vector<double> normals;  // of all vertices, or fewer
  std::vector<float> colours, uv;
  std::vector<std::string> materials;
  std::map<std::size_t, int> material_places;  // by the file's numbers
  std::vector<int> face_materials;             // of each polygon
};

// How a mesh is placed: by its node, or by joints.
struct Placement {
  Affine X_WN = Affine::Identity();
  std::vector<Affine> joints;         // X_W<joint> times the inverse bind matrix; empty: no skin
  std::vector<double> morph_weights;  // empty: the mesh's own
};

// What a file says about its meshes. Images and animations are never looked at.
class GltfMeshes {
 public:
  GltfMeshes(const GltfFile& file, const MeshReadOptions& options)
      : file_(file), options_(options) {}

  void read(MeshFile& out);

 private:
  [[noreturn]] void fail(const std::string& message) const { file_.fail(message); }
  std::vector<double> numbers(const Json& node, const char* key,
                              std::vector<double> otherwise) const;
  std::vector<double> number_list(const Json& object, const char* key) const;
  Affine node_transform(const Json& node) const;
  void place_nodes(const std::vector<int>& parents);
  std::vector<Affine> joint_transforms(std::size_t skin);
  void place_by_joints(const Json& node, Placement& placement, MeshFile& out);
  Points morphed(const Json& primitive, const char* attribute,
                 const std::vector<double>& weights) const;
  std::vector<Affine> vertex_transforms(const Json& attributes, std::size_t vertices,
                                        const Placement& placement, const std::string& where) const;
  void append_vertices(const Json& primitive, const std::vector<double>& weights,
                       const Placement& placement, const std::string& where, GltfPart& out) const;
  void append_extras(const Json& attributes, std::size_t before, std::size_t after,
                     GltfPart& out) const;
  void append_faces(const Json& primitive, int mode, std::size_t vertices, int base,
                    const std::string& where, GltfPart& out) const;
  int material_of(const Json& primitive, GltfPart& out) const;
  MeshPart mesh(std::size_t index, const Placement& placement, MeshFile& out) const;
  MeshPart finished(GltfPart& part, const std::string& where, bool mirrored, MeshFile& out) const;

  const GltfFile& file_;
  const MeshReadOptions& options_;
  std::vector<Affine> worlds_;      // of all nodes
  std::vector<std::size_t> order_;  // parents before their children
  std::size_t joints_ = 0;          // of all skins of all nodes
};

std::string name_of(const Json& element) {
  const auto found = element.find("name");
  return found != element.end() && found->is_string()
             ? printable(found->get<std::string>().substr(0, limits::kNameBytes))
             : "";
}

// Whether ecorche-import wrote it.
bool is_imported(const GltfFile& file) {
  const auto asset = file.root().find("asset");
  return asset != file.root().end() && asset->is_object() && asset->contains("extras") &&
         asset->at("extras").contains("ecorche_source_format");
}

int GltfMeshes::material_of(const Json& primitive, GltfPart& out) const {
  if (!primitive.contains("material")) return -1;
  const std::size_t index = file_.whole(primitive, "material");
  const auto [place, fresh] = out.material_places.try_emplace(index, int(out.materials.size()));
  if (!fresh) return place->second;
  const std::string name = name_of(file_.item("materials", index));
  out.materials.push_back(name.empty() ? fmt::format("material {}", index) : name);
  return place->second;
}

void GltfMeshes::append_faces(const Json& primitive, int mode, std::size_t vertices, int base,
                              const std::string& where, GltfPart& out) const {
  if (mode == kPoints) return;
  std::vector<int> order;
  if (primitive.contains("indices")) {
    order = file_.corners(file_.whole(primitive, "indices"), vertices);
  } else {
    order.resize(vertices);
    for (std::size_t k = 0; k < vertices; ++k) order[k] = int(k);
  }
  if (mode == kTriangles && order.size() % 3 != 0)
    fail(fmt::format("{}: {} corners are no whole number of triangles", where, order.size()));
  std::vector<int>& corners = out.polygons.corners;
  const std::size_t before = corners.size();
  if (mode == kTriangles)
    for (const int corner : order) corners.push_back(base + corner);
  for (std::size_t k = 2; mode != kTriangles && k < order.size(); ++k) {
    const bool turn = mode == kStrip && k % 2 == 1;
    const int a = order[mode == kFan ? 0 : k - 2], b = order[k - 1];
    corners.insert(corners.end(), {base + (turn ? b : a), base + (turn ? a : b), base + order[k]});
  }
  const std::size_t faces = (corners.size() - before) / 3;
  out.polygons.sizes.insert(out.polygons.sizes.end(), faces, 3);
  out.face_materials.insert(out.face_materials.end(), faces, material_of(primitive, out));
}

// An attribute with the morph targets that stand in the mesh by their weights.
Points GltfMeshes::morphed(const Json& primitive, const char* attribute,
                           const std::vector<double>& weights) const {
  Points out = file_.points(file_.whole(primitive.at("attributes"), attribute));
  const auto targets = primitive.find("targets");
  if (targets == primitive.end() || !targets->is_array()) return out;
  for (std::size_t t = 0; t < std::min(weights.size(), targets->size()); ++t) {
    if (weights[t] == 0 || !(*targets)[t].contains(attribute)) continue;
    const Points offsets = file_.points(file_.whole((*targets)[t], attribute));
    if (offsets.rows() != out.rows())
      fail(fmt::format("morph target {} has {} of {} vertices", t, offsets.rows(), out.rows()));
    out += weights[t] * offsets;
  }
  return out;
}

// One transform for all vertices, or one for each where joints place them.
std::vector<Affine> GltfMeshes::vertex_transforms(const Json& attributes, std::size_t vertices,
                                                  const Placement& placement,
                                                  const std::string& where) const {
  if (placement.joints.empty()) return {placement.X_WN};
  if (!attributes.contains("JOINTS_0")) return {Affine::Identity()};
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(Eigen::Index(vertices));
  std::vector<Affine> out(vertices);
  for (Affine& X : out) X.matrix().setZero();
  for (int set = 0; set < 2; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set),
                      weights_name = fmt::format("WEIGHTS_{}", set);
    if (!attributes.contains(joints_name)) continue;
    const auto joints = file_.whole_rows(file_.whole(attributes, joints_name.c_str()), 4);
    const auto weights = file_.rows(file_.whole(attributes, weights_name.c_str()), 4);
    if (joints.rows() != Eigen::Index(vertices) || weights.rows() != Eigen::Index(vertices))
      fail(fmt::format("{}: {} positions, {} joints and {} weights", where, vertices, joints.rows(),
                       weights.rows()));
    for (Eigen::Index i = 0; i < joints.rows(); ++i)
      for (Eigen::Index k = 0; k < 4; ++k) {
        const double w = weights(i, k);
        if (!(w > 0)) continue;
        if (std::size_t(joints(i, k)) >= placement.joints.size())
          fail(fmt::format("{}: vertex {} hangs on joint {} of {}", where, i, joints(i, k),
                           placement.joints.size()));
        out[std::size_t(i)].matrix() += w * placement.joints[std::size_t(joints(i, k))].matrix();
        sums[i] += w;
      }
  }
  for (std::size_t i = 0; i < vertices; ++i) {
    if (sums[Eigen::Index(i)] > 0)
      out[i].matrix() /= sums[Eigen::Index(i)];
    else
      out[i] = placement.joints[0];
    out[i].makeAffine();
  }
  return out;
}

// What not all vertices of a part have is dropped at its end.
void GltfMeshes::append_extras(const Json& attributes, std::size_t before, std::size_t after,
                               GltfPart& out) const {
  const std::size_t count = after - before;
  if (attributes.contains("COLOR_0") && out.colours.size() == 3 * before) {
    const std::size_t accessor = file_.whole(attributes, "COLOR_0");
    const auto values = file_.rows(accessor, file_.shape_of(accessor) == "VEC4" ? 4 : 3);
    if (std::size_t(values.rows()) == count)
      for (Eigen::Index i = 0; i < values.rows(); ++i)
        for (Eigen::Index k = 0; k < 3; ++k) out.colours.push_back(float(values(i, k)));
  }
  if (attributes.contains("TEXCOORD_0") && out.uv.size() == 2 * before) {
    const auto values = file_.rows(file_.whole(attributes, "TEXCOORD_0"), 2);
    if (std::size_t(values.rows()) == count)
      for (Eigen::Index i = 0; i < values.rows(); ++i)
        out.uv.insert(out.uv.end(), {float(values(i, 0)), float(1 - values(i, 1))});
  }
}

void GltfMeshes::append_vertices(const Json& primitive, const std::vector<double>& weights,
                                 const Placement& placement, const std::string& where,
                                 GltfPart& out) const {
  const Json& attributes = primitive.at("attributes");
  const Points places = morphed(primitive, "POSITION", weights);
  const std::size_t count = std::size_t(places.rows()),
                    before = out.polygons.coordinates.size() / 3;
  const std::vector<Affine> transforms = vertex_transforms(attributes, count, placement, where);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = transforms[transforms.size() > 1 ? i : 0] * Vec3(places.row(Eigen::Index(i)));
    out.polygons.coordinates.insert(out.polygons.coordinates.end(), p.data(), p.data() + 3);
  }
  if (attributes.contains("NORMAL") && out.normals.size() == 3 * before) {
    const Points normals = morphed(primitive, "NORMAL", weights);
    const auto turned = [](const Affine& X) {
      const double det = X.linear().determinant();
      Mat3 turn = X.linear();
      if (std::abs(det) > 1e-30) turn = X.linear().inverse().transpose();
      return turn;
    };
    const Mat3 turn = turned(transforms.empty() ? Affine::Identity() : transforms[0]);
    for (std::size_t i = 0; i < count && std::size_t(normals.rows()) == count; ++i) {
      const Mat3 own = transforms.size() > 1 ? turned(transforms[i]) : turn;
      const Vec3 n = (own * Vec3(normals.row(Eigen::Index(i)))).stableNormalized();
      const Vec3 kept = n.allFinite() ? n : Vec3(Vec3::Zero());
      out.normals.insert(out.normals.end(), kept.data(), kept.data() + 3);
    }
  }
  append_extras(attributes, before, before + count, out);
}

MeshPart GltfMeshes::finished(GltfPart& part, const std::string& where, bool mirrored,
                              MeshFile& out) const {
  const std::size_t vertices = part.polygons.coordinates.size() / 3;
  for (const double x : part.polygons.coordinates)
    if (!std::isfinite(x)) fail(where + ": vertices are not finite once placed by their nodes");
  const bool materials = !part.materials.empty();
  TriangleSources sources;
  MeshPart done;
  done.mesh = triangulate(part.polygons, fmt::format("{}: {}", file_.name(), where), out.notes,
                          options_.clouds, materials ? &sources : nullptr);
  if (vertices > 0 && part.normals.size() == 3 * vertices)
    done.normals = Eigen::Map<const Points>(part.normals.data(), Eigen::Index(vertices), 3);
  if (part.colours.size() == 3 * vertices) done.colours = colours_in_range(part.colours);
  if (mirrored) done.mesh.F.col(1).swap(done.mesh.F.col(2));
  if (part.uv.size() == 2 * vertices) done.texture = corner_texture(part.uv, done.mesh.F);
  done.materials = part.materials;
  for (const int face : sources.polygons) done.face_materials.push_back(part.face_materials[face]);
  return done;
}

// Primitives that share their positions (one mesh in several materials) stay one set of vertices.
MeshPart GltfMeshes::mesh(std::size_t index, const Placement& placement, MeshFile& out) const {
  const Json& element = file_.item("meshes", index);
  const auto primitives = element.find("primitives");
  if (primitives == element.end() || !primitives->is_array())
    fail(fmt::format("meshes[{}]: no primitives", index));
  const std::vector<double> weights =
      placement.morph_weights.empty() ? number_list(element, "weights") : placement.morph_weights;
  GltfPart part;
  std::map<std::size_t, std::size_t> bases;  // of positions that came before
  for (std::size_t p = 0; p < primitives->size(); ++p) {
    const Json& primitive = (*primitives)[p];
    const std::string where = fmt::format("meshes[{}].primitives[{}]", index, p);
    if (!primitive.is_object() || !primitive.contains("attributes"))
      fail(where + ": no attributes");
    if (const auto extensions = primitive.find("extensions");
        extensions != primitive.end() && extensions->contains("KHR_draco_mesh_compression"))
      fail(where +
           " is compressed (KHR_draco_mesh_compression); save it without mesh compression: in "
           "Blender's glTF export, without Compression");
    const std::size_t mode = file_.whole(primitive, "mode", kTriangles);
    if (mode != kTriangles && mode != kStrip && mode != kFan &&
        !(mode == kPoints && options_.clouds))
      continue;  // points and lines are no surfaces of a body
    const std::size_t positions = file_.whole(primitive.at("attributes"), "POSITION");
    const auto [base, fresh] = bases.try_emplace(positions, part.polygons.coordinates.size() / 3);
    if (fresh) append_vertices(primitive, weights, placement, where, part);
    append_faces(primitive, int(mode), file_.size_of(positions), int(base->second), where, part);
  }
  const Affine& X = placement.joints.empty() ? placement.X_WN : placement.joints[0];
  return finished(part, fmt::format("meshes[{}]", index), X.linear().determinant() < 0, out);
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

std::vector<double> GltfMeshes::number_list(const Json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end()) return {};
  return numbers(object, key, std::vector<double>(found->is_array() ? found->size() : 0));
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
void GltfMeshes::place_nodes(const std::vector<int>& parents) {
  worlds_.assign(parents.size(), Affine::Identity());
  std::vector<std::size_t> open;
  for (std::size_t n = parents.size(); n-- > 0;)
    if (parents[n] < 0) open.push_back(n);
  while (!open.empty()) {
    const std::size_t n = open.back();
    open.pop_back();
    order_.push_back(n);
    const Json& node = file_.item("nodes", n);
    const Affine X_WP = parents[n] < 0 ? Affine::Identity() : worlds_[std::size_t(parents[n])];
    worlds_[n] = X_WP * node_transform(node);
    const auto children = node.find("children");
    if (children == node.end()) continue;
    for (auto child = children->rbegin(); child != children->rend(); ++child)
      open.push_back(child->get<std::size_t>());
  }
}

std::vector<Affine> GltfMeshes::joint_transforms(std::size_t index) {
  const Json& skin = file_.item("skins", index);
  const auto joints = skin.find("joints");
  if (joints == skin.end() || !joints->is_array() || joints->empty())
    fail(fmt::format("skins[{}]: no joints", index));
  joints_ += joints->size();
  if (joints_ > limits::kRepeatedElements)
    throw LimitError(fmt::format("{}: its meshes hang on {} joints; the limit is {}", file_.name(),
                                 joints_, limits::kRepeatedElements));
  std::vector<Eigen::Matrix4d> binds;
  if (skin.contains("inverseBindMatrices"))
    binds = file_.matrices(file_.whole(skin, "inverseBindMatrices"));
  if (!binds.empty() && binds.size() < joints->size())
    fail(fmt::format("skins[{}]: {} inverse bind matrices for {} joints", index, binds.size(),
                     joints->size()));
  std::vector<Affine> out;
  for (std::size_t j = 0; j < joints->size(); ++j) {
    const Json& joint = (*joints)[j];
    const std::size_t node = joint.is_number_unsigned() ? joint.get<std::size_t>() : worlds_.size();
    if (node >= worlds_.size()) fail(fmt::format("skins[{}]: joint {} is no node", index, j));
    out.push_back(worlds_[node]);
    if (binds.empty()) continue;
    out.back().matrix() *= binds[j];
    out.back().makeAffine();
  }
  return out;
}

// What most joints do to a mesh that they bind; nothing where they stand in another pose.
std::optional<Affine> agreed_transform(const std::vector<Affine>& joints) {
  constexpr double kSame = 0.03;       // of the transform's size: some two degrees
  constexpr std::size_t kAsked = 256;  // joints; those behind are fingers and hair
  const std::size_t count = std::min(joints.size(), kAsked);
  for (std::size_t j = 0; j < count; ++j) {
    const Mat3 own = joints[j].linear();
    const auto agrees = [&](const Affine& other) {
      return (other.linear() - own).norm() <= kSame * own.norm();
    };
    const auto same = std::count_if(joints.begin(), joints.begin() + std::ptrdiff_t(count), agrees);
    if (2 * std::size_t(same) > count) return joints[j];
  }
  return std::nullopt;
}

// A skinned mesh is placed by its joints, not by its node; FBX and COLLADA bind in the node's
// frame.
void GltfMeshes::place_by_joints(const Json& node, Placement& placement, MeshFile& out) {
  std::vector<Affine> joints = joint_transforms(file_.whole(node, "skin"));
  if (options_.node_pose) {
    placement.joints = std::move(joints);
    return;
  }
  if (const std::optional<Affine> agreed = agreed_transform(joints)) {
    placement.X_WN = *agreed;
    return;
  }
  out.notes.push_back(
      fmt::format("{}: '{}': its joints stand in another pose than it was bound in; "
                  "taken as bound",
                  file_.name(), name_of(node)));
  if (!is_imported(file_)) placement.X_WN = Affine::Identity();
}

void GltfMeshes::read(MeshFile& out) {
  const std::vector<int> parents = file_.parents();
  place_nodes(parents);
  for (const std::size_t n : order_) {
    const Json& node = file_.item("nodes", n);
    if (!node.contains("mesh")) continue;
    Placement placement;
    placement.X_WN = worlds_[n];
    if (node.contains("skin")) place_by_joints(node, placement, out);
    placement.morph_weights = number_list(node, "weights");
    out.parts.push_back(mesh(file_.whole(node, "mesh"), placement, out));
    out.parts.back().name = name_of(node);
  }
  for (std::size_t m = 0; parents.empty() && m < file_.count("meshes"); ++m) {
    out.parts.push_back(mesh(m, {}, out));
    out.parts.back().name = name_of(file_.item("meshes", m));
  }
  if (out.parts.empty()) throw UnfitError(file_.name() + ": the file holds no mesh");
}

// Notes what ecorche-import says of the file that it read.
void note_source(const GltfFile& file, MeshFile& out) {
  if (!is_imported(file)) return;
  const Json& extras = file.root().at("asset").at("extras");
  const auto unit = extras.find("ecorche_source_unit"), up = extras.find("ecorche_source_up");
  if (unit == extras.end() || !unit->is_number() || up == extras.end() || !up->is_string()) return;
  out.notes.push_back(fmt::format("{}: the file says that its unit is {:.6g} m and its up axis {}",
                                  file.name(), unit->get<double>(),
                                  printable(up->get<std::string>().substr(0, 40))));
}

}  // namespace

void parse_glb(std::string_view bytes, const std::string& name,
               const std::optional<std::filesystem::path>& folder, const MeshReadOptions& options,
               MeshFile& out) {
  const GltfFile file(bytes, name, folder);
  GltfMeshes(file, options).read(out);
  note_source(file, out);
  out.unit = 1;
  out.up = Vec3::UnitY();
}

}  // namespace ecorche::inline v1
