#include "skinning/rigs/source_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/geometry/mesh_islands.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/mesh_files/gltf_nodes.h"
#include "anatomy/mesh_files/head_islands.h"
#include "anatomy/mesh_files/part_kind.h"
#include "skinning/motion_files/gltf_motion.h"
#include "skinning/retarget/joint_names.h"

namespace ecorche::inline v1 {
namespace {

using Json = nlohmann::json;

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : file_(bytes, name), tree_(file_) {}

  SourceRig read() {
    out_.node_count = file_.count("nodes");
    read_joints();
    for (const std::size_t node : tree_.in_scene())
      if (file_.item("nodes", node).contains("mesh")) read_mesh(node);
    if (out_.mesh.V.rows() == 0)
      throw UnfitError(file_.name() +
                       ": its scene has no mesh; export the character's mesh with it");
    for (std::size_t k = 0; k < file_.count("animations"); ++k)
      out_.takes.push_back(
          file_.item("animations", k).value("name", fmt::format("take {}", k + 1)));
    tell_kinds();
    return std::move(out_);
  }

 private:
  void read_joints() {
    std::map<std::size_t, Affine> binds;
    for (std::size_t s = 0; s < file_.count("skins"); ++s) {
      const Json& skin = file_.item("skins", s);
      if (!skin.contains("joints") || !skin.at("joints").is_array())
        file_.fail(fmt::format("skin {} names no joints", s));
      std::vector<Eigen::Matrix4d> inverses;
      if (skin.contains("inverseBindMatrices"))
        inverses = file_.matrices(file_.whole(skin, "inverseBindMatrices"));
      skins_.emplace_back();
      for (const Json& joint : skin.at("joints")) {
        const std::size_t node = joint.is_number_unsigned() ? joint.get<std::size_t>() : SIZE_MAX;
        if (node >= out_.node_count) file_.fail(fmt::format("skin {}: joint {}", s, joint.dump()));
        const std::size_t k = skins_.back().nodes.size();
        Affine inverse = Affine::Identity();
        if (k < inverses.size()) inverse.matrix().topRows<3>() = inverses[k].topRows<3>();
        skins_.back().nodes.push_back(node);
        skins_.back().inverses.push_back(inverse);
        binds.emplace(node, inverse);
      }
    }
    std::map<std::size_t, int> number;
    for (const std::size_t node : tree_.order()) {
      const auto bind = binds.find(node);
      if (bind == binds.end()) continue;
      SourceJoint joint;
      joint.name = file_.item("nodes", node).value("name", fmt::format("joint {}", node));
      joint.node = node;
      for (int up = tree_.parents()[node]; up >= 0 && joint.parent < 0; up = tree_.parents()[up])
        if (const auto above = number.find(std::size_t(up)); above != number.end())
          joint.parent = above->second;
      joint.X_W = tree_.world()[node];
      if (std::abs(bind->second.linear().determinant()) > 1e-30)
        joint.bind = bind->second.inverse();
      number[node] = int(out_.joints.size());
      out_.joints.push_back(std::move(joint));
    }
    for (Skin& skin : skins_)
      for (const std::size_t node : skin.nodes) skin.joints.push_back(number.at(node));
  }

  void read_mesh(std::size_t node) {
    const Json& item = file_.item("nodes", node);
    const std::size_t mesh = file_.whole(item, "mesh");
    const Json& primitives = file_.item("meshes", mesh).at("primitives");
    if (!primitives.is_array()) file_.fail(fmt::format("mesh {} has no primitives", mesh));
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      SourcePiece piece;
      piece.name = item.value("name", file_.item("meshes", mesh).value("name", std::string()));
      piece.node = node;
      piece.mesh = mesh;
      piece.primitive = p;
      if (item.contains("skin")) piece.skin = int(file_.whole(item, "skin"));
      if (piece.skin >= int(skins_.size()))
        file_.fail(fmt::format("skin {} is not there", piece.skin));
      read_primitive(primitives[p], std::move(piece));
    }
  }

  void read_primitive(const Json& primitive, SourcePiece piece) {
    if (primitive.contains("extensions") &&
        primitive.at("extensions").contains("KHR_draco_mesh_compression"))
      throw UnfitError(file_.name() +
                       ": its meshes are compressed (KHR_draco_mesh_compression); "
                       "export without compression");
    const Json& attributes = primitive.at("attributes");
    if (primitive.contains("material"))
      piece.material =
          file_.item("materials", file_.whole(primitive, "material")).value("name", std::string());
    const Points V = file_.points(file_.whole(attributes, "POSITION"));
    piece.first_vertex = int(out_.mesh.V.rows());
    piece.vertex_count = int(V.rows());
    piece.first_triangle = int(out_.mesh.F.rows());
    add_triangles(primitive, piece);
    std::vector<std::vector<Influence>> weights(V.rows());
    if (piece.skin >= 0) weights = influences(attributes, piece);
    place(V, weights, piece);
    for (std::vector<Influence>& row : weights) {
      for (Influence& w : row) w.joint = skins_[piece.skin].joints[w.joint];
      out_.weights.push_back(std::move(row));
    }
    out_.piece_of.insert(out_.piece_of.end(), V.rows(), int(out_.pieces.size()));
    out_.pieces.push_back(std::move(piece));
  }

  void add_triangles(const Json& primitive, SourcePiece& piece) {
    constexpr std::size_t kTriangles = 4, kStrip = 5, kFan = 6;
    const std::size_t mode = file_.whole(primitive, "mode", kTriangles);
    if (mode < kTriangles) return;
    std::vector<int> corners;
    if (primitive.contains("indices")) {
      corners = file_.corners(file_.whole(primitive, "indices"), std::size_t(piece.vertex_count));
    } else {
      for (int i = 0; i < piece.vertex_count; ++i) corners.push_back(i);
    }
    std::vector<int> triangles;
    if (mode == kTriangles) {
      triangles = std::move(corners);
      triangles.resize(triangles.size() / 3 * 3);
    } else {
      for (std::size_t k = 2; k < corners.size(); ++k) {
        const bool odd = mode == kStrip && k % 2 == 1;
        const int a = mode == kFan ? corners[0] : corners[k - 2], b = corners[k - 1],
                  c = corners[k];
        triangles.insert(triangles.end(), {odd ? b : a, odd ? a : b, c});
      }
    }
    piece.triangle_count = int(triangles.size() / 3);
    out_.mesh.F.conservativeResize(piece.first_triangle + piece.triangle_count, 3);
    for (int f = 0; f < piece.triangle_count; ++f)
      for (int k = 0; k < 3; ++k)
        out_.mesh.F(piece.first_triangle + f, k) =
            piece.first_vertex + triangles[3 * std::size_t(f) + std::size_t(k)];
  }

  std::vector<std::vector<Influence>> influences(const Json& attributes, const SourcePiece& piece) {
    std::vector<std::vector<Influence>> out(piece.vertex_count);
    for (int set = 0; attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
      const auto joints =
          file_.whole_rows(file_.whole(attributes, fmt::format("JOINTS_{}", set).c_str()), 4);
      const auto weights =
          file_.rows(file_.whole(attributes, fmt::format("WEIGHTS_{}", set).c_str()), 4);
      if (joints.rows() != piece.vertex_count || weights.rows() != piece.vertex_count)
        file_.fail(printable(piece.name) + ": joints and weights are not of all its vertices");
      for (int i = 0; i < piece.vertex_count; ++i)
        for (int k = 0; k < 4; ++k) {
          if (!(weights(i, k) > 0)) continue;
          if (joints(i, k) < 0 || joints(i, k) >= int(skins_[piece.skin].nodes.size()))
            file_.fail(fmt::format("{}: vertex {} names joint {} of {}", printable(piece.name), i,
                                   joints(i, k), skins_[piece.skin].nodes.size()));
          out[i].push_back({joints(i, k), weights(i, k)});
        }
    }
    for (std::vector<Influence>& row : out) {
      double sum = 0;
      for (const Influence& w : row) sum += w.weight;
      for (Influence& w : row) w.weight /= sum;
    }
    return out;
  }

  // Vertices as they stand.
  void place(const Points& V, const std::vector<std::vector<Influence>>& weights,
             SourcePiece& piece) {
    const Eigen::Index first = piece.first_vertex;
    out_.mesh.V.conservativeResize(first + V.rows(), 3);
    const Affine& X = tree_.world()[piece.node];
    std::vector<Affine> moves;
    if (piece.skin >= 0)
      for (std::size_t k = 0; k < skins_[piece.skin].nodes.size(); ++k)
        moves.push_back(tree_.world()[skins_[piece.skin].nodes[k]] *
                        skins_[piece.skin].inverses[k]);
    piece.place = X;
    bool any = false;
    const double size = V.rows() > 0 ? V.cwiseAbs().maxCoeff() + 1e-30 : 1;
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      Affine map = X;
      if (!weights[i].empty()) {
        map.matrix().setZero();
        for (const Influence& w : weights[i]) map.matrix() += w.weight * moves[w.joint].matrix();
      }
      if (!any) piece.place = map;
      any = true;
      const double scale = piece.place.linear().cwiseAbs().maxCoeff() + 1e-30;
      piece.is_straight &=
          (map.linear() - piece.place.linear()).cwiseAbs().maxCoeff() < 1e-6 * scale &&
          (map.translation() - piece.place.translation()).cwiseAbs().maxCoeff() <
              1e-6 * scale * size;
      out_.mesh.V.row(first + i) = map * Vec3(V.row(i));
    }
  }

  // A piece without weights under a joint of the rig is held.
  void tell_kinds() {
    std::map<std::size_t, int> joint_at;  // of nodes
    for (std::size_t j = 0; j < out_.joints.size(); ++j) joint_at[out_.joints[j].node] = int(j);
    for (SourcePiece& piece : out_.pieces) {
      piece.kind = kind_of_part(piece.name, std::span(&piece.material, 1));
      if (piece.skin >= 0) continue;
      for (int up = tree_.parents()[piece.node]; up >= 0 && piece.joint < 0;
           up = tree_.parents()[up])
        if (const auto at = joint_at.find(std::size_t(up)); at != joint_at.end())
          piece.joint = at->second;
      if (piece.kind == PartKind::body && piece.joint >= 0) piece.kind = PartKind::prop;
    }
    const bool has_body = std::any_of(
        out_.pieces.begin(), out_.pieces.end(),
        [](const auto& piece) { return piece.kind == PartKind::body && piece.triangle_count > 0; });
    if (has_body) return;
    // Clothes all over: what is seen is what there is.
    SourcePiece* largest = &out_.pieces[0];
    for (SourcePiece& piece : out_.pieces)
      if (piece.triangle_count > largest->triangle_count) largest = &piece;
    if (largest->kind != PartKind::clothes) largest->kind = PartKind::body;
  }

  struct Skin {
    std::vector<std::size_t> nodes;
    std::vector<Affine> inverses;
    std::vector<int> joints;  // of the rig
  };

  GltfFile file_;
  GltfTree tree_;
  std::vector<Skin> skins_;
  SourceRig out_;
};

// The mesh of one piece: two eyes in one are two islands.
TriMesh piece_mesh(const SourceRig& rig, const SourcePiece& piece) {
  TriMesh out;
  out.V = rig.mesh.V.middleRows(piece.first_vertex, piece.vertex_count);
  out.F = rig.mesh.F.middleRows(piece.first_triangle, piece.triangle_count).array() -
          piece.first_vertex;
  return out;
}

// Names of joints by what they move; where a name is in use for either of two neighbours, the other
// names tell: LeftHip above LeftKnee is the hip; LeftShoulder above LeftArm the collarbone.
std::vector<NamedPart> named_joints(const SourceRig& rig) {
  std::vector<std::string> names;
  for (const SourceJoint& joint : rig.joints) names.push_back(joint.name);
  drop_numbers(names);
  std::vector<NamedPart> parts = named_parts(names);
  std::set<std::pair<std::string, Side>> known;
  for (const NamedPart& one : parts) known.insert({one.part, one.side});
  for (auto& [part, side] : parts) {
    if (part == "hip?") part = known.contains({"hip", side}) ? "" : "hip";
    if (part.empty()) side = Side::middle;
    if (part == "foot?") part = known.contains({"ankle", side}) ? "toes" : "ankle";
    if (part == "shoulder?") part = known.contains({"shoulder", side}) ? "clavicle" : "shoulder";
  }
  return parts;
}

bool is_head(const NamedPart& part) { return part.part == "head" || part.part == "jaw"; }

// Whether most of the weight of these vertices is on joints of the head; nothing where it is not on
// joints of a limb either.
std::optional<bool> hangs_on_head(const SourceRig& rig, const SourcePiece& piece,
                                  const std::vector<NamedPart>& parts,
                                  std::span<const int> vertices) {
  double all = 0, head = 0, limbs = 0;
  const auto count = [&](int joint, double weight) {
    all += weight;
    if (is_head(parts[joint])) head += weight;
    if (parts[joint].side != Side::middle) limbs += weight;
  };
  for (const int v : vertices)
    for (const Influence& w : rig.weights[v]) count(w.joint, w.weight);
  if (piece.joint >= 0) count(piece.joint, 1);
  if (head > 0.5 * all) return true;
  if (limbs > 0.5 * all) return false;
  return std::nullopt;
}

// From the pelvis to the head, where names tell them; else as glTF has it.
Vec3 up_of(const SourceRig& rig, const std::vector<NamedPart>& parts) {
  const auto place = [&](const char* name) -> std::optional<Vec3> {
    for (std::size_t j = 0; j < parts.size(); ++j)
      if (parts[j].part == name) return rig.joints[j].X_W.translation();
    return std::nullopt;
  };
  const std::optional<Vec3> pelvis = place("pelvis"), head = place("head");
  if (!pelvis || !head || *pelvis == *head) return Vec3::UnitY();
  return (*head - *pelvis).normalized();
}

// Kinds of vertices: those of their pieces, but for islands that only share the eyes' material.
void tell_vertex_kinds(SourceRig& rig) {
  const std::vector<NamedPart> parts = joint_parts(rig);
  Eigen::AlignedBox3d figure;
  std::vector<HeadIsland> islands;
  std::vector<std::vector<int>> members;
  for (const SourcePiece& piece : rig.pieces) {
    rig.kinds.insert(rig.kinds.end(), piece.vertex_count, piece.kind);
    if (!shows_body(piece.kind) && !is_in_head(piece.kind)) continue;
    for (int i = 0; i < piece.vertex_count; ++i)
      figure.extend(Vec3(rig.mesh.V.row(piece.first_vertex + i)));
    if (!is_in_head(piece.kind)) continue;
    const std::vector<int> island_of = mesh_islands(piece_mesh(rig, piece));
    std::map<int, std::vector<int>> of_piece;
    for (int i = 0; i < piece.vertex_count; ++i)
      of_piece[island_of[i]].push_back(piece.first_vertex + i);
    for (auto& [lowest, vertices] : of_piece) {
      HeadIsland island{piece.kind, {}, hangs_on_head(rig, piece, parts, vertices)};
      for (const int v : vertices) island.box.extend(Vec3(rig.mesh.V.row(v)));
      islands.push_back(island);
      members.push_back(std::move(vertices));
    }
  }
  const std::vector<char> in_head = lies_in_head(islands, figure, up_of(rig, parts));
  for (std::size_t i = 0; i < islands.size(); ++i)
    for (const int v : members[i])
      if (!in_head[i]) rig.kinds[v] = PartKind::body;
}

}  // namespace

SourceRig read_source_rig(std::string_view glb, const std::string& name) {
  try {
    SourceRig rig = Reader(glb, name).read();
    tell_vertex_kinds(rig);
    return rig;
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format("{}: {}", name, printable(e.what())));
  }
}

std::vector<int> rigid_pieces(const SourceRig& rig) {
  std::vector<int> out(rig.mesh.V.rows(), -1);
  for (const SourcePiece& piece : rig.pieces) {
    if (!is_rigid(piece.kind)) continue;
    // What is held is one thing; eyes are two, teeth two rows.
    const bool whole = piece.kind == PartKind::prop || piece.kind == PartKind::headgear;
    const std::vector<int> island = mesh_islands(piece_mesh(rig, piece));
    for (int i = 0; i < piece.vertex_count; ++i)
      if (is_rigid(rig.kinds[piece.first_vertex + i]))
        out[piece.first_vertex + i] = piece.first_vertex + (whole ? 0 : island[i]);
  }
  return out;
}

TriMesh body_mesh(const SourceRig& rig) {
  const bool has_body = std::ranges::find(rig.kinds, PartKind::body) != rig.kinds.end();
  TriMesh out;
  std::vector<int> place(rig.mesh.V.rows(), -1);
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (Eigen::Index f = 0; f < rig.mesh.F.rows(); ++f) {
    const PartKind kind = rig.kinds[rig.mesh.F(f, 0)];
    if (has_body ? kind != PartKind::body : is_rigid(kind)) continue;
    std::array<int, 3> t;
    for (int k = 0; k < 3; ++k) {
      int& at = place[rig.mesh.F(f, k)];
      if (at < 0) {
        at = int(points.size());
        points.push_back(rig.mesh.V.row(rig.mesh.F(f, k)));
      }
      t[std::size_t(k)] = at;
    }
    triangles.push_back(t);
  }
  out.V.resize(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) out.V.row(i) = points[i];
  out.F.resize(triangles.size(), 3);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) out.F(f, Eigen::Index(k)) = triangles[f][k];
  return out;
}

std::vector<NamedPart> joint_parts(const SourceRig& rig) {
  std::vector<NamedPart> parts = named_joints(rig);
  std::vector<char> below_pelvis(parts.size(), 0);
  for (std::size_t j = 0; j < parts.size(); ++j) {
    const int up = rig.joints[j].parent;
    below_pelvis[j] = parts[j].part == "pelvis" || (up >= 0 && below_pelvis[up]) ? 1 : 0;
    if (up >= 0 && parts[j].part.empty() && (parts[up].side != Side::middle || is_head(parts[up])))
      parts[j] = parts[up];
  }
  for (std::size_t j = 0; j < parts.size(); ++j) {
    const std::string& part = parts[j].part;
    if (!below_pelvis[j] || (part != "head" && part != "clavicle" && part != "shoulder")) continue;
    for (int up = rig.joints[j].parent; up >= 0 && below_pelvis[up]; up = rig.joints[up].parent) {
      std::string name = rig.joints[up].name;
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
      if (parts[up].part.empty())
        parts[up].part = name.find("neck") == std::string::npos ? "trunk" : "neck";
    }
  }
  return parts;
}

std::vector<Landmark> joint_hints(const SourceRig& rig) {
  const std::vector<NamedPart> parts = named_joints(rig);
  std::vector<Landmark> out;
  std::set<std::string> taken;
  for (std::size_t j = 0; j < parts.size(); ++j) {
    auto [part, side] = parts[j];
    if (part == "toes") part = "mtp2";
    if (part.empty() || part == "fingers") continue;
    const std::string ours = part + side_suffix(side);
    // Of several bones of one name the first sits at the joint.
    if (taken.insert(ours).second) out.push_back({ours, rig.joints[j].X_W.translation()});
  }
  return out;
}

}  // namespace ecorche::inline v1
