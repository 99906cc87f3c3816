#include "skinning/files/character_read.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "skinning/files/character_check.h"
#include "skinning/files/character_format.h"
#include "skinning/files/extras_read.h"
#include "skinning/files/own_skin_file.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// What ecorche has written down in a .glb about a body or character.
class Reader {
 public:
  explicit Reader(const fs::path& file)
      : name_(printable(file.string())), bytes_(read_input_file(file)) {
    open();
  }
  Reader(std::string bytes, const std::string& name) : name_(name), bytes_(std::move(bytes)) {
    open();
  }

  Body read_body() {
    const Json& notes = scene_notes();
    const int schema = extras::read_schema(notes, name_);
    if (schema > kOwnSkinSchema)
      throw UnfitError(fmt::format(
          "{}: written by a newer version (schema {}, this program reads up to {}); update ecorche",
          name_, schema, kOwnSkinSchema));
    if (schema < 1) fail(fmt::format("schema {}; expected 1 to {}", schema, kOwnSkinSchema));
    Body body;
    if (!notes.contains("body")) fail("'body' is missing");
    extras::read_body(notes.at("body"), name_ + ": body", body);
    if (own()) {  // a body is the base mesh, which measures are tied to
      body.skin = gltf::read_own_base(*file_, *own());
      check_body(body, name_);
      return body;
    }
    for (std::size_t n = 0; n < names_.size(); ++n)
      if (names_[n] == "skin") body.skin = read_skin(n);
    if (body.skin.V.rows() == 0) fail("mesh node 'skin' is missing");
    check_body(body, name_);
    return body;
  }

  Character read() {
    if (scene_notes().contains("detail"))
      throw UnfitError(
          name_ +
          ": a light version, for looking at only; give the character that it was written from");
    Character character;
    character.body = read_body();
    read_skeleton(character.anatomy.skeleton);
    if (own())
      character.own = std::make_shared<const OwnSkin>(gltf::read_own_skin(
          *file_, bytes_, *own(), character.anatomy.skeleton.joints.size(), character.body));
    const auto positions = rest_positions(character.anatomy.skeleton);
    for (std::size_t n = first_node(); n < names_.size(); ++n) {
      if (names_[n].starts_with("bone/"))
        character.anatomy.bones.push_back(read_bone(n, positions));
      if (names_[n].starts_with("muscle/")) character.anatomy.muscles.push_back(read_muscle(n));
      if (names_[n].starts_with("fascia/")) character.anatomy.fascia.push_back(read_fascia(n));
    }
    check_character(character, name_);
    return character;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": " + what); }

  void open() {
    if (bytes_.size() < 20 || !bytes_.starts_with("glTF"))
      fail("not a binary glTF file; `ecorche fit BODY -o CHARACTER.glb` writes one");
    file_.emplace(bytes_, name_);
    scene_notes();
    const std::size_t nodes = file_->count("nodes");
    if (nodes > limits::kNodes)
      throw LimitError(fmt::format("{}: {} nodes; the limit is {}", name_, nodes, limits::kNodes));
    std::set<std::string> known;
    for (std::size_t n = 0; n < nodes; ++n) {
      const Json& node = file_->item("nodes", n);
      if (n < first_node()) {  // whatever it is called
        names_.emplace_back();
        continue;
      }
      const auto name = node.find("name");
      if (name == node.end() || !name->is_string()) fail(fmt::format("node {} has no name", n));
      names_.push_back(name->get<std::string>());
      if (names_.back().size() > limits::kNameBytes)
        throw LimitError(fmt::format("{}: node {}: a name of {} bytes; the limit is {}", name_, n,
                                     names_.back().size(), limits::kNameBytes));
      if (!known.insert(names_.back()).second)
        fail(fmt::format("two nodes are named '{}'", printable(names_.back())));
    }
    parents_ = file_->parents();
    file_->check_views();
  }

  // The file's own words about itself: extras of its first scene.
  const Json& scene_notes() const {
    if (file_->count("scenes") > 0) {
      const Json& scene = file_->item("scenes", 0);
      const auto extras = scene.find("extras");
      if (extras != scene.end() && extras->is_object() && extras->contains("ecorche"))
        return extras->at("ecorche");
    }
    fail(
        "a glTF file, but not one that ecorche wrote; `ecorche fit` makes a character from a body");
  }

  // What the file says of a skin of its own; null where it has none.
  const Json* own() const {
    const Json& notes = scene_notes();
    const auto found = notes.is_object() ? notes.find("own") : notes.end();
    return found == notes.end() ? nullptr : &*found;
  }
  // Those before are the own skin's.
  std::size_t first_node() const { return own() ? file_->whole(*own(), "nodes") : 0; }

  const Json& extras_of(std::size_t node) const {
    static const Json kNone;
    const Json& all = file_->item("nodes", node);
    const auto found = all.find("extras");
    return found == all.end() ? kNone : *found;
  }

  void read_skeleton(Skeleton& skeleton) {
    if (file_->count("skins") == 0)
      throw UnfitError(
          fmt::format("{}: a body without bones and muscles; `ecorche fit {} -o CHARACTER.glb` "
                      "puts them inside",
                      name_, name_));
    if (!own() && file_->count("skins") != 1)
      fail(fmt::format("{} skins; a character has one", file_->count("skins")));
    const Json& skin = file_->item("skins", own() ? file_->whole(*own(), "skin") : 0);
    const auto joints = skin.find("joints");
    if (joints == skin.end() || !joints->is_array() || joints->empty())
      fail("its skin names no joints");
    std::map<std::size_t, int> joint_of_node;
    for (const Json& joint : *joints) {
      const std::size_t node =
          joint.is_number_unsigned() ? joint.get<std::size_t>() : names_.size();
      if (node >= names_.size())
        fail(fmt::format("its skin names node {}, which is not there", joint.dump()));
      if (!joint_of_node.emplace(node, int(joint_of_node.size())).second)
        fail(fmt::format("joint '{}' is in its skin twice", printable(names_[node])));
    }
    check_binds(skin, joints->size());
    skeleton.joints.resize(joints->size());
    for (const auto& [node, j] : joint_of_node) {
      Joint& joint = skeleton.joints[j];
      joint.name = names_[node];
      extras::read_joint(extras_of(node),
                         fmt::format("{}: joint '{}'", name_, printable(joint.name)), joint);
      const auto parent = parents_[node] < 0 ? joint_of_node.end()
                                             : joint_of_node.find(std::size_t(parents_[node]));
      if (parent != joint_of_node.end()) joint.parent = parent->second;
    }
  }

  // We have no use for them, but other programs move the file's meshes by them.
  void check_binds(const Json& skin, std::size_t joints) const {
    if (!skin.contains("inverseBindMatrices")) return;
    const std::vector<Eigen::Matrix4d> binds =
        file_->matrices(file_->whole(skin, "inverseBindMatrices"));
    if (binds.size() < joints)
      fail(fmt::format("{} inverse bind matrices for {} joints", binds.size(), joints));
    for (std::size_t j = 0; j < joints; ++j)
      if (!(std::abs(binds[j].determinant()) > 1e-9))
        fail(fmt::format("inverse bind matrix {} is singular", j));
  }

  Bone read_bone(std::size_t node, const std::vector<Vec3>& positions) {
    Bone bone;
    bone.name = names_[node].substr(5);
    extras::read_bone(extras_of(node), fmt::format("{}: {}", name_, printable(names_[node])), bone);
    if (bone.joint < 0 || bone.joint >= int(positions.size()))
      fail(
          fmt::format("{}: joint {} of {}", printable(names_[node]), bone.joint, positions.size()));
    bone.mesh = read_mesh(node);
    bone.mesh.V.rowwise() += positions[bone.joint].transpose();
    return bone;
  }

  Muscle read_muscle(std::size_t node) {
    Muscle muscle;
    muscle.name = names_[node].substr(7);
    extras::read_muscle(extras_of(node), fmt::format("{}: {}", name_, printable(names_[node])),
                        muscle);
    return muscle;
  }

  FasciaSheet read_fascia(std::size_t node) {
    FasciaSheet sheet;
    sheet.name = names_[node].substr(7);
    extras::read_fascia(extras_of(node), fmt::format("{}: {}", name_, printable(names_[node])),
                        sheet);
    const Json& attributes = primitives_of(node)[0].at("attributes");
    sheet.V = file_->points(file_->whole(attributes, "POSITION"));
    for (const double share : file_->scalars(file_->whole(attributes, "_BELLY")))
      sheet.belly.push_back(float(share));
    return sheet;
  }

  const Json& primitives_of(std::size_t node) const {
    const Json& mesh = file_->item("meshes", file_->whole(file_->item("nodes", node), "mesh"));
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array() || primitives->empty())
      fail(printable(names_[node]) + ": its mesh has no primitive");
    for (const Json& each : *primitives)
      if (!each.is_object() || !each.contains("attributes") || !each.at("attributes").is_object())
        fail(printable(names_[node]) + ": has no POSITION");
    return *primitives;
  }

  // Of all its tissues, which share the vertices.
  TriMesh read_mesh(std::size_t node) const {
    const std::string where = printable(names_[node]);
    const Json& primitives = primitives_of(node);
    const std::size_t position = file_->whole(primitives[0].at("attributes"), "POSITION");
    TriMesh out;
    out.V = file_->points(position);
    std::vector<int> corners;
    for (const Json& primitive : primitives) {
      if (file_->whole(primitive.at("attributes"), "POSITION") != position)
        fail(where + ": its primitives do not share their vertices");
      const std::vector<int> more =
          file_->corners(file_->whole(primitive, "indices"), std::size_t(out.V.rows()));
      if (more.size() % 3 != 0) fail(where + ": the number of indices is no multiple of three");
      corners.insert(corners.end(), more.begin(), more.end());
    }
    out.F = Eigen::Map<const Triangles>(corners.data(), Eigen::Index(corners.size() / 3), 3);
    return out;
  }

  // Without the copies of its vertices that seams of the texture need.
  TriMesh read_skin(std::size_t node) const {
    TriMesh mesh = read_mesh(node);
    const Json& attributes = primitives_of(node)[0].at("attributes");
    if (!attributes.contains("_SKIN_VERTEX")) return mesh;
    const std::vector<double> own = file_->scalars(file_->whole(attributes, "_SKIN_VERTEX"));
    if (own.size() != std::size_t(mesh.V.rows()))
      fail("skin: _SKIN_VERTEX is not of all its vertices");
    std::size_t count = 0;
    while (count < own.size() && own[count] == double(count)) ++count;
    for (std::size_t i = count; i < own.size(); ++i)
      if (!(own[i] >= 0 && own[i] < double(count)) || own[i] != std::floor(own[i]))
        fail(fmt::format("skin: _SKIN_VERTEX of vertex {} is {}, with {} vertices of its own", i,
                         own[i], count));
    for (int* v = mesh.F.data(); v != mesh.F.data() + mesh.F.size(); ++v) *v = int(own[*v]);
    mesh.V.conservativeResize(count, 3);
    return mesh;
  }

  std::string name_, bytes_;
  std::optional<GltfFile> file_;
  std::vector<std::string> names_;  // #nodes
  std::vector<int> parents_;        // #nodes
};

}  // namespace

Character read_character(const fs::path& file) { return Reader(file).read(); }

Character parse_character(std::string bytes, const std::string& name) {
  return Reader(std::move(bytes), name).read();
}
Body parse_body(std::string bytes, const std::string& name) {
  return Reader(std::move(bytes), name).read_body();
}

Body read_body(const fs::path& file) { return Reader(file).read_body(); }

bool has_body_notes(const fs::path& file) {
  check_input_file(file);
  std::ifstream in(file, std::ios::binary);
  char header[20];
  if (!in.read(header, sizeof header) || std::memcmp(header, "glTF", 4) != 0) return false;
  std::uint32_t length = 0;
  std::memcpy(&length, header + 12, sizeof length);
  std::error_code error;
  if (length > limits::kJsonBytes || length > fs::file_size(file, error)) return false;
  std::string text(length, '\0');
  in.read(text.data(), length);
  return text.find("\"ecorche\"") != std::string::npos;
}

}  // namespace ecorche::inline v1
