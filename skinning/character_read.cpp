// Reading. Nothing outside the file itself is ever opened.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "anatomy/errors.h"
#include "skinning/character_io.h"
#include "skinning/crowd_read.h"
#include "skinning/gltf_values.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;
using tinygltf::Value;

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 31;

std::vector<unsigned char> read_bytes(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw InputError(fmt::format("{}: not a file that can be read", file.string()));
  const auto size = fs::file_size(file, error);
  if (error) throw InputError(fmt::format("{}: {}", file.string(), error.message()));
  if (size == 0) throw InputError(fmt::format("{}: empty file", file.string()));
  if (size > kLargestFile) throw LimitError(fmt::format("{}: {} bytes; at most {} are read", file.string(), size, kLargestFile));
  std::vector<unsigned char> bytes(size);
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    throw InputError(fmt::format("{}: could not be read to its end", file.string()));
  return bytes;
}

class Reader {
 public:
  explicit Reader(const fs::path& file) : name_(file.string()) {
    const auto bytes = read_bytes(file);
    if (bytes.size() < 20 || std::memcmp(bytes.data(), "glTF", 4) != 0)
      fail("not a binary glTF file; `ecorche fit BODY -o CHARACTER.glb` writes one");
    tinygltf::TinyGLTF loader;
    tinygltf::FsCallbacks closed{[](const std::string&, void*) { return false; },
                                 [](const std::string& path, void*) { return path; },
                                 [](std::vector<unsigned char>*, std::string* error, const std::string& path, void*) {
                                   *error = "refers to another file: " + path;
                                   return false;
                                 },
                                 [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; },
                                 nullptr};
    loader.SetFsCallbacks(closed);
    std::string error, warning;
    if (!loader.LoadBinaryFromMemory(&model_, &error, &warning, bytes.data(), static_cast<unsigned>(bytes.size()))) fail("malformed glTF: " + error);
    if (model_.scenes.empty() || !model_.scenes[0].extras.Has("ecorche"))
      fail("a glTF file, but not one that ecorche wrote; `ecorche fit` makes a character from a body");
    std::set<std::string> names;
    for (const tinygltf::Node& node : model_.nodes)
      if (!names.insert(node.name).second) fail(fmt::format("two nodes are named '{}'", node.name));
  }

  Body read_body() {
    const Value& ecorche = model_.scenes[0].extras.Get("ecorche");
    const int schema = gltf::read_schema(ecorche, name_);
    if (schema > kCharacterSchema)
      fail(fmt::format("written by a newer version (schema {}, this program reads up to {}); update ecorche", schema, kCharacterSchema));
    Body body;
    if (!ecorche.Has("body")) fail("'body' is missing");
    gltf::read_body_extras(ecorche.Get("body"), name_ + ": body", body);
    for (const tinygltf::Node& node : model_.nodes)
      if (node.name == "skin") body.skin = read_mesh(node);
    if (body.skin.V.rows() == 0) fail("mesh node 'skin' is missing");
    return body;
  }

  Character read() {
    Character character;
    character.body = read_body();
    read_skeleton(character.anatomy.skeleton);
    const auto positions = rest_positions(character.anatomy.skeleton);
    for (const tinygltf::Node& node : model_.nodes) {
      if (node.name.starts_with("bone/")) character.anatomy.bones.push_back(read_bone(node, positions));
      if (node.name.starts_with("muscle/")) character.anatomy.muscles.push_back(read_muscle(node));
    }
    try {
      validate(character.anatomy);
    } catch (const std::invalid_argument& e) {
      fail(e.what());
    }
    return character;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": " + what); }

  void read_skeleton(Skeleton& skeleton) {
    if (model_.skins.size() != 1) fail(fmt::format("{} skins; a character has one", model_.skins.size()));
    std::map<int, int> joint_of_node;
    const auto& joints = model_.skins[0].joints;
    for (size_t j = 0; j < joints.size(); ++j) {
      if (joints[j] < 0 || joints[j] >= static_cast<int>(model_.nodes.size())) fail(fmt::format("skin names node {}", joints[j]));
      joint_of_node[joints[j]] = static_cast<int>(j);
    }
    skeleton.joints.resize(joints.size());
    for (const auto& [node, j] : joint_of_node) {
      Joint& joint = skeleton.joints[j];
      joint.name = model_.nodes[node].name;
      gltf::read_joint_extras(model_.nodes[node].extras, name_ + ": joint '" + joint.name + "'", joint);
      for (int child : model_.nodes[node].children) {
        const auto found = joint_of_node.find(child);
        if (found != joint_of_node.end()) skeleton.joints[found->second].parent = j;
      }
    }
  }

  Bone read_bone(const tinygltf::Node& node, const std::vector<Vec3>& positions) {
    Bone bone;
    bone.name = node.name.substr(5);
    gltf::read_bone_extras(node.extras, name_ + ": " + node.name, bone);
    if (bone.joint < 0 || bone.joint >= static_cast<int>(positions.size())) fail(fmt::format("{}: joint {} of {}", node.name, bone.joint, positions.size()));
    bone.mesh = read_mesh(node);
    bone.mesh.V.rowwise() += positions[bone.joint].transpose();
    return bone;
  }

  Muscle read_muscle(const tinygltf::Node& node) {
    Muscle muscle;
    muscle.name = node.name.substr(7);
    gltf::read_muscle_extras(node.extras, name_ + ": " + node.name, muscle);
    return muscle;
  }

  TriMesh read_mesh(const tinygltf::Node& node) {
    const std::string where = name_ + ": " + node.name;
    if (node.mesh < 0 || node.mesh >= static_cast<int>(model_.meshes.size()) || model_.meshes[node.mesh].primitives.size() != 1)
      throw InputError(where + ": needs one mesh with one primitive");
    const tinygltf::Primitive& primitive = model_.meshes[node.mesh].primitives[0];
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) throw InputError(where + ": has no POSITION");
    TriMesh mesh;
    const auto values = read_accessor<float>(position->second, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, where);
    mesh.V = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3)
                 .cast<double>();
    if (!mesh.V.allFinite()) throw InputError(where + ": a vertex is not finite");
    const auto indices =
        read_accessor<std::uint32_t>(primitive.indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1, where);
    if (indices.size() % 3 != 0) throw InputError(where + ": the number of indices is no multiple of three");
    mesh.F.resize(static_cast<Eigen::Index>(indices.size() / 3), 3);
    for (size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] >= static_cast<std::uint32_t>(mesh.V.rows()))
        throw InputError(fmt::format("{}: index {} of {} vertices", where, indices[i], mesh.V.rows()));
      mesh.F.data()[i] = static_cast<int>(indices[i]);
    }
    return mesh;
  }

  template <class T>
  std::vector<T> read_accessor(int index, int component_type, int type, size_t components, const std::string& where) {
    if (index < 0 || index >= static_cast<int>(model_.accessors.size())) throw InputError(where + ": an accessor is missing");
    const tinygltf::Accessor& accessor = model_.accessors[index];
    if (accessor.componentType != component_type || accessor.type != type || accessor.sparse.isSparse || accessor.bufferView < 0 ||
        accessor.bufferView >= static_cast<int>(model_.bufferViews.size()))
      throw InputError(where + ": an accessor is of a kind that ecorche does not write");
    const tinygltf::BufferView& view = model_.bufferViews[accessor.bufferView];
    if (view.buffer != 0 || model_.buffers.empty() || view.byteStride != 0) throw InputError(where + ": a buffer view is of a kind that ecorche does not write");
    const size_t available = model_.buffers[0].data.size();
    const size_t start = view.byteOffset + accessor.byteOffset, element = components * sizeof(T);
    if (view.byteOffset > available || accessor.byteOffset > available || start > available || accessor.count > (available - start) / element)
      throw InputError(fmt::format("{}: an accessor of {} elements reaches beyond the file", where, accessor.count));
    std::vector<T> out(accessor.count * components);
    if (!out.empty()) std::memcpy(out.data(), model_.buffers[0].data.data() + start, out.size() * sizeof(T));
    return out;
  }

  std::string name_;
  tinygltf::Model model_;
};

}  // namespace

Character read_character(const fs::path& file) {
  if (const std::optional<CrowdAddress> one = crowd_address(file))
    throw InputError(fmt::format("{}: a crowd has its people's muscles only as meshes; `ecorche fit '{}' -o {}.glb` makes a character of this one", file.string(),
                                 file.string(), one->person));
  return Reader(file).read();
}

Body read_body(const fs::path& file) {
  if (const std::optional<CrowdAddress> one = crowd_address(file)) return read_crowd_person(open_crowd(one->file), one->person).body;
  return Reader(file).read_body();
}

bool has_body_notes(const fs::path& file) {
  if (crowd_address(file)) return true;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  std::ifstream in(file, std::ios::binary);
  char header[20];
  if (!in.read(header, sizeof header) || std::memcmp(header, "glTF", 4) != 0) return false;
  std::uint32_t length = 0;
  std::memcpy(&length, header + 12, sizeof length);
  if (length > fs::file_size(file, error)) return false;
  std::string text(length, '\0');
  in.read(text.data(), length);
  return text.find("\"ecorche\"") != std::string::npos;
}

}  // namespace ecorche
