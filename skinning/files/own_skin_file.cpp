#include "skinning/files/own_skin_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/glb_bytes.h"
#include "skinning/rigs/source_rig.h"

namespace ecorche::inline v1::gltf {
namespace {

using Json = nlohmann::ordered_json;
using tinygltf::Value;

constexpr double kFarthest = 10;  // m from the origin

Value numbers(const double* values, std::size_t count) {
  Array out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(number(values[k]));
  return Value(std::move(out));
}

// Inverse bind matrices for a piece that stands by `place`.
int add_binds(GlbBuilder& glb, const std::vector<Transform>& X_WJ, const Affine& place) {
  std::vector<float> values;
  for (const Transform& X : X_WJ) {
    Eigen::Matrix4d bind = Eigen::Matrix4d::Identity();
    bind.topRows<3>() = (Affine(X.inverse()) * place).matrix().topRows<3>();
    for (int k = 0; k < 16; ++k) values.push_back(float(bind.data()[k]));
  }
  return glb.add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, 16, 0);
}

// Rows of the map, one after another: how many entries each has, base vertices, weights.
void add_rows(GlbBuilder& glb, const OwnSkin& own, Object& out) {
  std::vector<std::uint8_t> counts;
  std::vector<std::uint32_t> vertices;
  std::vector<float> weights;
  for (Eigen::Index i = 0; i < own.map.rows(); ++i) {
    int count = 0;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(own.map, i); it; ++it) {
      vertices.push_back(std::uint32_t(it.col()));
      weights.push_back(float(it.value()));
      ++count;
    }
    if (count == 0 || count > 255)
      throw std::invalid_argument(fmt::format("own skin: row {} has {} entries", i, count));
    counts.push_back(std::uint8_t(count));
  }
  out["counts"] = Value(
      glb.add_accessor(counts, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_SCALAR, 1, 0));
  out["vertices"] = Value(
      glb.add_accessor(vertices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1, 0));
  out["weights"] = Value(glb.add_scalars(weights, false, 0));
}

// Views of data that no mesh shows have no target.
int add_plain_vectors(GlbBuilder& glb, const Points& points) {
  const int accessor = glb.add_vectors(points, false);
  glb.model().bufferViews.back().target = 0;
  return accessor;
}

// Positions and normals of a piece that its own joints bend as it stands.
void add_bent(GlbBuilder& glb, const Points& V, const Triangles& F, Object& out) {
  out["position"] = Value(glb.add_vectors(V, true));
  out["normal"] = Value(glb.add_vectors(GlbBuilder::unit_normals({V, F}), false));
}

void shift(Json& object, const char* key, std::size_t by) {
  if (object.contains(key)) object[key] = object[key].get<std::size_t>() + by;
}

void shift_all(Json& object, const char* key, std::size_t by) {
  if (object.contains(key))
    for (Json& each : object[key]) each = each.get<std::size_t>() + by;
}

std::size_t size_of(const Json& root, const char* list) {
  return root.contains(list) && root.at(list).is_array() ? root.at(list).size() : 0;
}

void append(Json& root, const char* list, Json items) {
  if (items.empty()) return;
  if (!root.contains(list)) root[list] = Json::array();
  for (Json& item : items) root[list].push_back(std::move(item));
}

struct Offsets {
  std::size_t views, accessors, materials, meshes, nodes, skins, bytes;
};

// Our indices behind the source's.
void shift_ours(Json& ours, const Offsets& by) {
  const auto each = [&](const char* list, const auto& act) {
    if (ours.contains(list))
      for (Json& item : ours[list]) act(item);
  };
  each("bufferViews", [&](Json& view) {
    view["byteOffset"] = view.value("byteOffset", std::size_t{0}) + by.bytes;
  });
  each("accessors", [&](Json& accessor) { shift(accessor, "bufferView", by.views); });
  each("meshes", [&](Json& mesh) {
    for (Json& primitive : mesh["primitives"]) {
      const auto shift_each = [&](Json& attributes) {
        for (auto& [name, accessor] : attributes.items())
          accessor = accessor.template get<std::size_t>() + by.accessors;
      };
      shift_each(primitive["attributes"]);
      if (primitive.contains("targets"))
        for (Json& target : primitive["targets"]) shift_each(target);
      shift(primitive, "indices", by.accessors);
      shift(primitive, "material", by.materials);
    }
  });
  each("nodes", [&](Json& node) {
    shift_all(node, "children", by.nodes);
    shift(node, "mesh", by.meshes);
    shift(node, "skin", by.skins);
  });
  each("skins", [&](Json& skin) {
    shift_all(skin, "joints", by.nodes);
    shift(skin, "skeleton", by.nodes);
    shift(skin, "inverseBindMatrices", by.accessors);
  });
  each("animations", [&](Json& animation) {
    for (Json& sampler : animation["samplers"]) {
      shift(sampler, "input", by.accessors);
      shift(sampler, "output", by.accessors);
    }
    for (Json& channel : animation["channels"]) shift(channel["target"], "node", by.nodes);
  });
}

// Indices within the object `own`.
void shift_own(Json& own, const Offsets& by) {
  for (const char* key : {"counts", "vertices", "weights", "rest", "base", "base_triangles"})
    shift(own, key, by.accessors);
  shift(own, "source", by.views);
  shift(own, "skin", by.skins);
  for (Json& piece : own["pieces"]) {
    for (const char* key : {"joints", "weights", "position", "normal"})
      shift(piece, key, by.accessors);
    shift(piece, "skin", by.skins);
  }
}

// The source's pieces by our joints.
void hang_pieces(Json& root, const Json& own) {
  const Json meshes = root.at("meshes");
  std::map<std::size_t, std::size_t> user;  // mesh -> node whose it has become
  for (const Json& piece : own.at("pieces")) {
    Json& node = root["nodes"][piece.at("node").get<std::size_t>()];
    const std::size_t number = piece.at("node").get<std::size_t>();
    std::size_t mesh = node.at("mesh").get<std::size_t>();
    const auto [first, is_new] = user.emplace(mesh, number);
    if (!is_new && first->second != number) {
      // Another node's already: a copy, whose weights are this one's.
      root["meshes"].push_back(meshes[mesh]);
      mesh = root["meshes"].size() - 1;
      node["mesh"] = mesh;
      user.emplace(mesh, number);
    }
    node["skin"] = piece.at("skin");
    Json& attributes =
        root["meshes"][mesh]["primitives"][piece.at("primitive").get<std::size_t>()]["attributes"];
    for (int set = 0; set < 8; ++set)
      for (const char* name : {"JOINTS_{}", "WEIGHTS_{}"})
        attributes.erase(fmt::format(fmt::runtime(name), set));
    attributes["JOINTS_0"] = piece.at("joints");
    attributes["WEIGHTS_0"] = piece.at("weights");
    if (piece.contains("position")) {
      attributes["POSITION"] = piece.at("position");
      attributes["NORMAL"] = piece.at("normal");
      attributes.erase("TANGENT");
      root["meshes"][mesh]["primitives"][piece.at("primitive").get<std::size_t>()].erase("targets");
    }
  }
}

template <class Rows>
void require_finite(const GltfFile& file, const Rows& rows, const char* what) {
  if (!rows.allFinite() || (rows.size() > 0 && rows.cwiseAbs().maxCoeff() > kFarthest))
    file.fail(fmt::format("own skin: {} further than {} m from the origin", what, kFarthest));
}

std::vector<double> list(const GltfFile& file, const GltfFile::Json& own, const char* key,
                         std::size_t count) {
  const auto found = own.find(key);
  if (found == own.end() || !found->is_array() || found->size() != count)
    file.fail(fmt::format("own skin: '{}' is not a list of {} numbers", key, count));
  std::vector<double> out;
  for (const auto& value : *found) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      file.fail(fmt::format("own skin: '{}' has what is no number", key));
    out.push_back(value.get<double>());
  }
  return out;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> read_rows(const GltfFile& file,
                                                       const GltfFile::Json& own,
                                                       Eigen::Index vertices, Eigen::Index base) {
  const std::vector<double> counts = file.scalars(file.whole(own, "counts")),
                            weights = file.scalars(file.whole(own, "weights"));
  const std::vector<int> columns = file.corners(file.whole(own, "vertices"), std::size_t(base));
  if (counts.size() != std::size_t(vertices) || weights.size() != columns.size())
    file.fail(fmt::format("own skin: attachment of {} vertices for {}", counts.size(), vertices));
  std::vector<Eigen::Triplet<double>> entries;
  std::size_t at = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto end = at + std::size_t(std::max(0.0, counts[i]));
    double sum = 0;
    for (std::size_t k = at; k < end && k < weights.size(); ++k) sum += weights[k];
    if (end > weights.size() || !(std::abs(sum - 1) < 1e-3))
      file.fail(fmt::format("own skin: weights of vertex {} do not sum to 1", i));
    for (; at < end; ++at) entries.emplace_back(int(i), columns[at], weights[at] / sum);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> out(vertices, base);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// The source as it came in: its JSON is kept as text, its binary chunk begins ours.
std::string read_source(const GltfFile& file, std::string_view bytes, const GltfFile::Json& own) {
  const GlbParts parts = split_glb(bytes, file.name());
  const std::size_t binary = file.whole(own, "source_bytes");
  if (binary > parts.binary.size())
    file.fail("own skin: its source reaches beyond the binary chunk");
  return glb_bytes(file.view_bytes(file.whole(own, "source")), parts.binary.substr(0, binary));
}

}  // namespace

Value add_own_skin(GlbBuilder& glb, const Character& character, const Binding& binding) {
  const OwnSkin& own = *character.own;
  const Skeleton& skeleton = character.anatomy.skeleton;
  const SourceRig rig = read_source_rig(*own.source, "the character's own skin");
  if (rig.mesh.V.rows() != character.body.skin.V.rows() || own.map.rows() != rig.mesh.V.rows() ||
      own.pose.rotations.size() != skeleton.joints.size())
    throw std::invalid_argument("the own skin belongs to another source or skeleton");
  std::vector<Transform> X_WJ;
  forward_kinematics(skeleton, own.pose, X_WJ);
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    tinygltf::Node& node = glb.model().nodes[j];
    const Quat& q = own.pose.rotations[j];
    node.rotation = {q.x(), q.y(), q.z(), q.w()};
    if (skeleton.joints[j].parent < 0)
      node.translation = {own.pose.root.x(), own.pose.root.y(), own.pose.root.z()};
  }
  Affine to_world = Affine::Identity();
  to_world.linear() = own.scale * own.axes;
  to_world.translation() = own.shift;

  Object out;
  std::vector<std::pair<Affine, int>> skins;  // by the place of their pieces
  const auto skin_of = [&](const Affine& place) {
    for (const auto& [known, skin] : skins)
      if ((known.linear() - place.linear()).cwiseAbs().maxCoeff() < 1e-7 * own.scale &&
          (known.translation() - place.translation()).cwiseAbs().maxCoeff() < 1e-7)
        return skin;
    tinygltf::Skin skin = glb.model().skins[0];
    skin.name = fmt::format("own skin {}", skins.size() + 1);
    skin.inverseBindMatrices = add_binds(glb, X_WJ, place);
    glb.model().skins.push_back(std::move(skin));
    skins.push_back({place, int(glb.model().skins.size()) - 1});
    return skins.back().second;
  };
  Array pieces;
  for (const SourcePiece& piece : rig.pieces) {
    Object each;
    each["node"] = Value(int(piece.node));
    each["primitive"] = Value(int(piece.primitive));
    tinygltf::Primitive primitive;
    glb.add_influences(
        primitive, std::span(binding.joint_weights)
                       .subspan(std::size_t(piece.first_vertex), std::size_t(piece.vertex_count)));
    each["joints"] = Value(primitive.attributes["JOINTS_0"]);
    each["weights"] = Value(primitive.attributes["WEIGHTS_0"]);
    if (piece.is_straight) {
      each["skin"] = Value(skin_of(to_world * piece.place));
    } else {
      Points V = rig.mesh.V.middleRows(piece.first_vertex, piece.vertex_count);
      for (Eigen::Index i = 0; i < V.rows(); ++i) V.row(i) = to_world * Vec3(V.row(i));
      Triangles F = rig.mesh.F.middleRows(piece.first_triangle, piece.triangle_count);
      F.array() -= piece.first_vertex;
      add_bent(glb, V, F, each);
      each["skin"] = Value(skin_of(Affine::Identity()));
    }
    pieces.push_back(Value(std::move(each)));
  }
  out["pieces"] = Value(std::move(pieces));
  out["skin"] = Value(0);
  out["nodes"] = Value(int(rig.node_count));
  add_rows(glb, own, out);
  out["rest"] = Value(add_plain_vectors(glb, character.body.skin.V));
  out["base"] = Value(add_plain_vectors(glb, own.base.V));
  const std::vector<std::uint32_t> corners(own.base.F.data(),
                                           own.base.F.data() + own.base.F.size());
  out["base_triangles"] = Value(
      glb.add_accessor(corners, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1, 0));
  const GlbParts source = split_glb(*own.source, "the character's own skin");
  const std::vector<std::uint8_t> json(source.json.begin(), source.json.end());
  glb.add_accessor(json, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_SCALAR, 1, 0);
  glb.model().accessors.pop_back();  // a bare view
  out["source"] = Value(int(glb.model().bufferViews.size()) - 1);
  out["source_bytes"] = Value(int(source.binary.size()));
  out["scale"] = number(own.scale);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> axes = own.axes;
  out["axes"] = numbers(axes.data(), 9);
  out["shift"] = vector3(own.shift);
  out["root"] = vector3(own.pose.root);
  std::vector<double> turns;
  for (const Quat& q : own.pose.rotations)
    turns.insert(turns.end(), q.coeffs().data(), q.coeffs().data() + 4);
  out["turns"] = numbers(turns.data(), turns.size());
  return Value(std::move(out));
}

std::string join_own_skin(const std::string& ours_bytes, const OwnSkin& own) {
  const GlbParts ours_parts = split_glb(ours_bytes, "the character"),
                 source_parts = split_glb(*own.source, "the character's own skin");
  Json ours = parse_gltf_json<Json>(ours_parts.json, "the character", limits::kJsonBytes);
  Json root =
      parse_gltf_json<Json>(source_parts.json, "the character's own skin", limits::kJsonBytes);
  if (size_of(root, "buffers") > 1 ||
      (size_of(root, "buffers") == 1 && root["buffers"][0].contains("uri")))
    throw UnfitError(
        "the character's own skin: its data lies outside the .glb; save it as one file");
  std::string binary(source_parts.binary);
  binary.resize((binary.size() + 3) / 4 * 4);
  const Offsets by{size_of(root, "bufferViews"),
                   size_of(root, "accessors"),
                   size_of(root, "materials"),
                   size_of(root, "meshes"),
                   size_of(root, "nodes"),
                   size_of(root, "skins"),
                   binary.size()};
  shift_ours(ours, by);
  Json scene = std::move(ours["scenes"][0]);
  shift_all(scene, "nodes", by.nodes);
  Json& notes = scene["extras"]["ecorche"]["own"];
  shift_own(notes, by);
  binary += ours_parts.binary;

  Json roots = Json::array();
  const std::size_t shown = root.value("scene", std::size_t{0});
  if (size_of(root, "scenes") > shown && root["scenes"][shown].contains("nodes"))
    roots = root["scenes"][shown]["nodes"];
  if (size_of(root, "scenes") == 0) {  // then all nodes without a parent are shown
    std::set<std::size_t> below;
    for (std::size_t n = 0; n < by.nodes; ++n)
      if (root["nodes"][n].contains("children"))
        for (const Json& child : root["nodes"][n]["children"])
          below.insert(child.get<std::size_t>());
    for (std::size_t n = 0; n < by.nodes; ++n)
      if (!below.contains(n)) roots.push_back(n);
  }
  for (Json& node : scene["nodes"]) roots.push_back(std::move(node));
  scene["nodes"] = std::move(roots);
  for (const char* list : {"bufferViews", "accessors", "materials", "meshes", "nodes", "skins"})
    if (ours.contains(list)) append(root, list, std::move(ours[list]));
  hang_pieces(root, notes);
  // Our motion first: viewers play the first one.
  Json animations = ours.contains("animations") ? std::move(ours["animations"]) : Json::array();
  if (root.contains("animations"))
    for (Json& each : root["animations"]) animations.push_back(std::move(each));
  if (!animations.empty()) root["animations"] = std::move(animations);
  Json scenes = Json::array({std::move(scene)});
  for (std::size_t s = 0; s < size_of(root, "scenes"); ++s)
    if (s != shown) scenes.push_back(std::move(root["scenes"][s]));
  root["scenes"] = std::move(scenes);
  root["scene"] = 0;
  root["asset"]["generator"] = ours["asset"]["generator"];
  root["asset"]["version"] = "2.0";
  root["buffers"] = Json::array({Json{{"byteLength", binary.size()}}});
  return glb_bytes(root.dump(-1, ' ', false, Json::error_handler_t::replace), binary);
}

TriMesh read_own_base(const GltfFile& file, const GltfFile::Json& own) {
  TriMesh out;
  out.V = file.points(file.whole(own, "base"));
  require_finite(file, out.V, "a base vertex lies");
  const std::vector<int> corners =
      file.corners(file.whole(own, "base_triangles"), std::size_t(out.V.rows()));
  if (corners.empty() || corners.size() % 3 != 0) file.fail("own skin: its base has no triangles");
  out.F = Eigen::Map<const Triangles>(corners.data(), Eigen::Index(corners.size() / 3), 3);
  return out;
}

OwnSkin read_own_skin(const GltfFile& file, std::string_view bytes, const GltfFile::Json& own,
                      std::size_t joints, Body& body) {
  OwnSkin out;
  out.source = std::make_shared<const std::string>(read_source(file, bytes, own));
  SourceRig rig = read_source_rig(*out.source, file.name() + ": own skin");
  body.skin.V = file.points(file.whole(own, "rest"));
  body.skin.F = std::move(rig.mesh.F);
  if (body.skin.V.rows() != rig.mesh.V.rows())
    file.fail(fmt::format("own skin: {} rest positions for {} vertices", body.skin.V.rows(),
                          rig.mesh.V.rows()));
  require_finite(file, body.skin.V, "a vertex lies");
  out.base = read_own_base(file, own);
  out.map = read_rows(file, own, body.skin.V.rows(), out.base.V.rows());
  out.scale = list(file, GltfFile::Json{{"scale", {own.value("scale", 0.0)}}}, "scale", 1)[0];
  if (!(out.scale > 0)) file.fail("own skin: 'scale' is not positive");
  const std::vector<double> axes = list(file, own, "axes", 9), shift = list(file, own, "shift", 3),
                            root = list(file, own, "root", 3),
                            turns = list(file, own, "turns", 4 * joints);
  out.axes = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(axes.data());
  out.shift = Vec3(shift[0], shift[1], shift[2]);
  out.pose.root = Vec3(root[0], root[1], root[2]);
  for (std::size_t j = 0; j < joints; ++j) {
    const Quat q(turns[4 * j + 3], turns[4 * j], turns[4 * j + 1], turns[4 * j + 2]);
    if (!(q.norm() > 1e-6)) file.fail(fmt::format("own skin: turn {} has no length", j));
    out.pose.rotations.push_back(q.normalized());
  }
  return out;
}

}  // namespace ecorche::inline v1::gltf
