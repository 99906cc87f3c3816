#include "anatomy/mesh_files/scene_glb.h"

#include <assimp/scene.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

using Json = nlohmann::json;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr int kFloat = 5126, kWord = 5125, kShort = 5123;

Matrix4d matrix_of(const aiMatrix4x4& m) {
  Matrix4d out;
  for (unsigned r = 0; r < 4; ++r)
    for (unsigned c = 0; c < 4; ++c) out(int(r), int(c)) = double(m[r][c]);
  return out;
}

std::string text_of(const aiString& text) {
  return std::string(text.data, std::min<std::size_t>(text.length, limits::kNameBytes));
}

void require_finite(bool finite, const char* what) {
  if (!finite) throw std::runtime_error(std::string("malformed: ") + what + " is not finite");
}

// The document and its one buffer, as they grow.
class GlbBuilder {
 public:
  Json root = {{"asset", {{"version", "2.0"}, {"generator", "ecorche-import"}}}};

  std::size_t add(const char* list, Json item) {
    Json& all = root[list];
    all.push_back(std::move(item));
    return all.size() - 1;
  }

  std::size_t add_view(const void* bytes, std::size_t size) {
    binary_.append(-binary_.size() % 4, '\0');
    if (binary_.size() + size > limits::kImportBytes)
      throw std::runtime_error("the scene is larger than what is read");
    const std::size_t begin = binary_.size();
    binary_.append(static_cast<const char*>(bytes), size);
    return add("bufferViews", {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", size}});
  }

  template <class T>
  std::size_t add_values(const std::vector<T>& values, std::size_t columns, const char* shape,
                         int type, bool bounds = false) {
    Json accessor = {{"bufferView", add_view(values.data(), values.size() * sizeof(T))},
                     {"componentType", type},
                     {"count", values.size() / columns},
                     {"type", shape}};
    if (bounds && !values.empty()) {
      std::vector<T> low(values.begin(), values.begin() + std::ptrdiff_t(columns)), high = low;
      for (std::size_t k = 0; k < values.size(); ++k) {
        low[k % columns] = std::min(low[k % columns], values[k]);
        high[k % columns] = std::max(high[k % columns], values[k]);
      }
      accessor["min"] = low;
      accessor["max"] = high;
    }
    return add("accessors", std::move(accessor));
  }

  std::string bytes() {
    binary_.append(-binary_.size() % 4, '\0');
    if (!binary_.empty()) root["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    // What is not UTF-8 in names is replaced.
    std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.append(-text.size() % 4, ' ');
    std::string out = "glTF";
    const auto put = [&](std::size_t value) {
      const auto word = std::uint32_t(value);
      out.append(reinterpret_cast<const char*>(&word), 4);
    };
    put(2);
    put(20 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size()));
    put(text.size());
    out += "JSON" + text;
    if (binary_.empty()) return out;
    put(binary_.size());
    out.append("BIN\0", 4);
    return out + binary_;
  }

 private:
  std::string binary_;
};

struct Weighted {
  unsigned joint;
  double weight;
};

class SceneWriter {
 public:
  SceneWriter(const aiScene& scene, const SceneFrame& frame) : scene_(scene), frame_(frame) {}

  std::string write() {
    place_root();
    list_nodes();
    write_materials();
    for (std::size_t n = 0; n < nodes_.size(); ++n) write_node(n);
    for (unsigned a = 0; a < scene_.mNumAnimations; ++a) write_animation(*scene_.mAnimations[a]);
    glb_.root["scene"] = 0;
    glb_.root["scenes"] = Json::array({{{"nodes", {0}}}});
    glb_.root["asset"]["extras"] = {{"ecorche_source_format", frame_.format},
                                    {"ecorche_source_unit", frame_.source_unit * dae_unit_},
                                    {"ecorche_source_up", frame_.up}};
    return glb_.bytes();
  }

 private:
  void place_root();
  void list_nodes();
  void write_materials();
  void add_texture(const aiMaterial& material, Json& out);
  void write_node(std::size_t n);
  Json primitive_of(const aiMesh& mesh, bool skinned, const std::map<std::string, unsigned>& joints,
                    unsigned own_joint);
  void add_weights(const aiMesh& mesh, const std::map<std::string, unsigned>& joints,
                   unsigned own_joint, Json& attributes);
  std::map<std::string, unsigned> write_skin(const aiNode& node, std::size_t n, Json& out);
  void write_animation(const aiAnimation& animation);
  Json transform_of(const Matrix4d& local, bool animated) const;
  Matrix4d scaled(Matrix4d m) const {  // lengths in metres
    m.topRightCorner<3, 1>() *= unit_;
    return m;
  }
  std::vector<float> vectors(const aiVector3D* values, std::size_t count, double scale) const;

  const aiScene& scene_;
  const SceneFrame& frame_;
  GlbBuilder glb_;
  double unit_ = 1, dae_unit_ = 1;
  Matrix4d root_ = Matrix4d::Identity();
  std::vector<const aiNode*> nodes_;  // parents first
  std::map<const aiNode*, std::size_t> places_;
  std::map<std::string, std::size_t> named_;
  std::map<std::string, bool> animated_;
};

// The scale of the root, in which COLLADA's unit comes, goes into all lengths below it.
void SceneWriter::place_root() {
  root_ = matrix_of(scene_.mRootNode->mTransformation);
  unit_ = frame_.unit;
  require_finite(root_.allFinite(), "the root");
  const double scale = std::cbrt(std::abs(root_.topLeftCorner<3, 3>().determinant()));
  if (frame_.format == "dae") {
    if (!(scale > 1e-9 && scale < 1e9)) throw std::runtime_error("malformed: the root is singular");
    root_.topLeftCorner<3, 3>() /= scale;
    unit_ = scale;
    dae_unit_ = scale;
    return;
  }
  Matrix4d turn = Matrix4d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) turn(r, c) = frame_.turn[r][c];
  root_ = turn;
}

void SceneWriter::list_nodes() {
  std::vector<const aiNode*> open{scene_.mRootNode};
  while (!open.empty()) {
    const aiNode* const node = open.back();
    open.pop_back();
    places_[node] = nodes_.size();
    named_.try_emplace(text_of(node->mName), nodes_.size());
    nodes_.push_back(node);
    if (nodes_.size() > limits::kNodes) throw std::runtime_error("too many nodes");
    for (unsigned k = node->mNumChildren; k-- > 0;) open.push_back(node->mChildren[k]);
  }
  for (unsigned a = 0; a < scene_.mNumAnimations; ++a)
    for (unsigned c = 0; c < scene_.mAnimations[a]->mNumChannels; ++c)
      animated_[text_of(scene_.mAnimations[a]->mChannels[c]->mNodeName)] = true;
}

// A texture that lies in the file, where it is PNG or JPEG.
void SceneWriter::add_texture(const aiMaterial& material, Json& out) {
  aiString path;
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE})
    if (path.length == 0 && material.GetTexture(type, 0, &path) != aiReturn_SUCCESS) path.Clear();
  if (path.length == 0) return;
  const aiTexture* const texture = scene_.GetEmbeddedTexture(path.C_Str());
  if (!texture || texture->mHeight != 0 || texture->mWidth < 8) return;
  const auto* const bytes = reinterpret_cast<const char*>(texture->pcData);
  const bool png = std::memcmp(bytes, "\x89PNG", 4) == 0,
             jpeg = std::memcmp(bytes, "\xFF\xD8\xFF", 3) == 0;
  if (!png && !jpeg) return;
  const std::size_t image =
      glb_.add("images", {{"bufferView", glb_.add_view(bytes, texture->mWidth)},
                          {"mimeType", png ? "image/png" : "image/jpeg"}});
  const std::size_t index = glb_.add("textures", {{"source", image}});
  out["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", index}};
}

void SceneWriter::write_materials() {
  for (unsigned m = 0; m < scene_.mNumMaterials; ++m) {
    const aiMaterial& material = *scene_.mMaterials[m];
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    aiColor4D colour(1, 1, 1, 1);
    material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    const auto part = [](float x) { return std::isfinite(x) ? std::clamp(x, 0.0F, 1.0F) : 1.0F; };
    Json out = {{"name", text_of(name)},
                {"pbrMetallicRoughness",
                 {{"baseColorFactor", {part(colour.r), part(colour.g), part(colour.b), 1}},
                  {"metallicFactor", 0}}}};
    add_texture(material, out);
    glb_.add("materials", std::move(out));
  }
}

// Translation, rotation and scale where they say all, as they must for what moves; else a matrix.
Json SceneWriter::transform_of(const Matrix4d& local, bool animated) const {
  require_finite(local.allFinite(), "a node");
  const Eigen::Matrix3d linear = local.topLeftCorner<3, 3>();
  Vector3d scale = linear.colwise().norm();
  if (linear.determinant() < 0) scale.x() = -scale.x();
  Json out = Json::object();
  const bool singular = !(scale.cwiseAbs().minCoeff() > 1e-12);
  const Eigen::Matrix3d turn = singular ? Eigen::Matrix3d::Identity().eval()
                                        : (linear * scale.cwiseInverse().asDiagonal()).eval();
  const bool rigid = !singular && (turn.transpose() * turn).isIdentity(1e-4);
  if (!rigid && !animated) {
    Matrix4d m = local;
    m.row(3) << 0, 0, 0, 1;
    out["matrix"] = std::vector<double>(m.data(), m.data() + 16);
    return out;
  }
  const Eigen::Quaterniond q = Eigen::Quaterniond(turn).normalized();
  out["translation"] = {local(0, 3), local(1, 3), local(2, 3)};
  out["rotation"] = {q.x(), q.y(), q.z(), q.w()};
  out["scale"] = {scale.x(), scale.y(), scale.z()};
  return out;
}

void SceneWriter::write_node(std::size_t n) {
  const aiNode& node = *nodes_[n];
  const std::string name = text_of(node.mName);
  const Matrix4d local = n == 0 ? root_ : scaled(matrix_of(node.mTransformation));
  Json out = transform_of(local, n > 0 && animated_.contains(name));
  out["name"] = name;
  for (unsigned k = 0; k < node.mNumChildren; ++k)
    out["children"].push_back(places_.at(node.mChildren[k]));
  if (node.mNumMeshes > 0) {
    const auto joints = write_skin(node, n, out);
    Json mesh = {{"name", name}, {"primitives", Json::array()}};
    std::vector<double> weights;
    std::vector<std::string> targets;
    for (unsigned k = 0; k < node.mNumMeshes; ++k) {
      const aiMesh& part = *scene_.mMeshes[node.mMeshes[k]];
      if (part.mNumFaces == 0 || part.mNumVertices == 0) continue;
      mesh["primitives"].push_back(
          primitive_of(part, !joints.empty(), joints, joints.empty() ? 0 : joints.at("")));
      for (unsigned t = std::uint32_t(targets.size()); t < part.mNumAnimMeshes; ++t) {
        targets.push_back(text_of(part.mAnimMeshes[t]->mName));
        const double weight = double(part.mAnimMeshes[t]->mWeight);
        weights.push_back(std::isfinite(weight) ? weight : 0);
      }
    }
    // glTF wants the same targets of all primitives of a mesh.
    bool same = !targets.empty();
    for (const Json& primitive : mesh["primitives"])
      same = same && primitive.contains("targets") && primitive["targets"].size() == targets.size();
    if (same) {
      mesh["weights"] = weights;
      mesh["extras"] = {{"targetNames", targets}};
    } else {
      for (Json& primitive : mesh["primitives"]) primitive.erase("targets");
    }
    if (!mesh["primitives"].empty()) out["mesh"] = glb_.add("meshes", std::move(mesh));
    if (!out.contains("mesh")) out.erase("skin");
  }
  glb_.add("nodes", std::move(out));
}

// The joints of all meshes of a node, by name; "" is the node itself, on which vertices hang that
// have no weight. Empty where none of its meshes has bones.
std::map<std::string, unsigned> SceneWriter::write_skin(const aiNode& node, std::size_t n,
                                                        Json& out) {
  std::map<std::string, unsigned> joints;
  std::vector<std::size_t> list;
  std::vector<float> binds;
  const auto add = [&](const std::string& name, std::size_t place, const Matrix4d& bind) {
    if (!joints.try_emplace(name, unsigned(list.size())).second) return;
    require_finite(bind.allFinite(), "a bind matrix");
    list.push_back(place);
    for (int k = 0; k < 16; ++k) binds.push_back(float(bind.data()[k]));
  };
  for (unsigned k = 0; k < node.mNumMeshes; ++k) {
    const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[k]];
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const std::string name = text_of(mesh.mBones[b]->mName);
      const auto place = named_.find(name);
      if (place == named_.end() || name.empty()) continue;
      Matrix4d bind = scaled(matrix_of(mesh.mBones[b]->mOffsetMatrix));
      bind.row(3) << 0, 0, 0, 1;
      add(name, place->second, bind);
    }
  }
  if (list.empty()) return {};
  if (list.size() > 60000) throw std::runtime_error("a mesh on more than 60000 joints");
  add("", n, Matrix4d::Identity());
  Json skin = {{"joints", list}};
  skin["inverseBindMatrices"] = glb_.add_values(binds, 16, "MAT4", kFloat);
  out["skin"] = glb_.add("skins", std::move(skin));
  return joints;
}

std::vector<float> SceneWriter::vectors(const aiVector3D* values, std::size_t count,
                                        double scale) const {
  std::vector<float> out(3 * count);
  for (std::size_t i = 0; i < count; ++i)
    for (unsigned k = 0; k < 3; ++k) {
      const double x = double(values[i][k]) * scale;
      require_finite(std::isfinite(float(x)), "a vertex");
      out[3 * i + k] = float(x);
    }
  return out;
}

// The eight largest weights of each vertex, as two sets of four where one does not do.
void SceneWriter::add_weights(const aiMesh& mesh, const std::map<std::string, unsigned>& joints,
                              unsigned own_joint, Json& attributes) {
  std::vector<std::vector<Weighted>> all(mesh.mNumVertices);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const auto joint = joints.find(text_of(bone.mName));
    if (joint == joints.end()) continue;
    for (unsigned k = 0; k < bone.mNumWeights; ++k) {
      const aiVertexWeight& w = bone.mWeights[k];
      if (w.mVertexId < mesh.mNumVertices && std::isfinite(w.mWeight) && w.mWeight > 0)
        all[w.mVertexId].push_back({joint->second, double(w.mWeight)});
    }
  }
  std::size_t most = 1;
  for (auto& vertex : all) {
    std::stable_sort(vertex.begin(), vertex.end(),
                     [](const Weighted& a, const Weighted& b) { return a.weight > b.weight; });
    if (vertex.size() > 8) vertex.resize(8);
    if (vertex.empty()) vertex.push_back({own_joint, 1});
    most = std::max(most, vertex.size());
  }
  for (std::size_t set = 0; 4 * set < most; ++set) {
    std::vector<std::uint16_t> places(4 * all.size(), 0);
    std::vector<float> weights(4 * all.size(), 0);
    for (std::size_t i = 0; i < all.size(); ++i) {
      double sum = 0;
      for (const Weighted& w : all[i]) sum += w.weight;
      for (std::size_t k = 4 * set; k < std::min(4 * set + 4, all[i].size()); ++k) {
        places[4 * i + k % 4] = std::uint16_t(all[i][k].joint);
        weights[4 * i + k % 4] = float(all[i][k].weight / sum);
      }
    }
    attributes["JOINTS_" + std::to_string(set)] = glb_.add_values(places, 4, "VEC4", kShort);
    attributes["WEIGHTS_" + std::to_string(set)] = glb_.add_values(weights, 4, "VEC4", kFloat);
  }
}

Json SceneWriter::primitive_of(const aiMesh& mesh, bool skinned,
                               const std::map<std::string, unsigned>& joints, unsigned own_joint) {
  const std::size_t count = mesh.mNumVertices;
  Json attributes = {{"POSITION", glb_.add_values(vectors(mesh.mVertices, count, unit_), 3, "VEC3",
                                                  kFloat, true)}};
  if (mesh.mNormals) {
    std::vector<float> normals(3 * count);
    for (std::size_t i = 0; i < count; ++i)
      for (unsigned k = 0; k < 3; ++k)
        normals[3 * i + k] = std::isfinite(mesh.mNormals[i][k]) ? mesh.mNormals[i][k] : 0;
    attributes["NORMAL"] = glb_.add_values(normals, 3, "VEC3", kFloat);
  }
  if (mesh.mTextureCoords[0]) {
    std::vector<float> uv(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const aiVector3D& at = mesh.mTextureCoords[0][i];
      if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
      uv[2 * i] = at.x;
      uv[2 * i + 1] = 1 - at.y;
    }
    attributes["TEXCOORD_0"] = glb_.add_values(uv, 2, "VEC2", kFloat);
  }
  if (mesh.mColors[0]) {
    std::vector<float> colours(4 * count, 1);
    for (std::size_t i = 0; i < count; ++i)
      for (unsigned k = 0; k < 3; ++k) {
        const float value = mesh.mColors[0][i][k];
        colours[4 * i + k] = std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 1;
      }
    attributes["COLOR_0"] = glb_.add_values(colours, 4, "VEC4", kFloat);
  }
  if (skinned) add_weights(mesh, joints, own_joint, attributes);
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * std::size_t(mesh.mNumFaces));
  for (unsigned f = 0; f < mesh.mNumFaces; ++f)
    for (unsigned k = 0; mesh.mFaces[f].mNumIndices == 3 && k < 3; ++k)
      corners.push_back(mesh.mFaces[f].mIndices[k]);
  Json out = {{"attributes", std::move(attributes)},
              {"indices", glb_.add_values(corners, 1, "SCALAR", kWord)}};
  if (mesh.mMaterialIndex < scene_.mNumMaterials) out["material"] = mesh.mMaterialIndex;
  for (unsigned t = 0; t < mesh.mNumAnimMeshes; ++t) {
    const aiAnimMesh& target = *mesh.mAnimMeshes[t];
    if (!target.mVertices || target.mNumVertices != mesh.mNumVertices) return out;
    std::vector<float> moved = vectors(target.mVertices, count, unit_);
    const std::vector<float> rest = vectors(mesh.mVertices, count, unit_);
    for (std::size_t k = 0; k < moved.size(); ++k) moved[k] -= rest[k];
    out["targets"].push_back({{"POSITION", glb_.add_values(moved, 3, "VEC3", kFloat, true)}});
  }
  return out;
}

// Keys' times, each once and rising; what does not rise is left out.
template <class Key, class Take>
std::pair<std::vector<float>, std::vector<float>> keys_of(const Key* keys, unsigned count,
                                                          double rate, Take take) {
  std::pair<std::vector<float>, std::vector<float>> out;
  for (unsigned k = 0; k < count; ++k) {
    const auto time = float(keys[k].mTime / rate);
    if (!std::isfinite(time) || (!out.first.empty() && time <= out.first.back())) continue;
    if (!take(keys[k].mValue, out.second)) continue;
    out.first.push_back(time);
  }
  return out;
}

void SceneWriter::write_animation(const aiAnimation& animation) {
  const double rate = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 25;
  Json out = {
      {"name", text_of(animation.mName)}, {"channels", Json::array()}, {"samplers", Json::array()}};
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    const aiNodeAnim& channel = *animation.mChannels[c];
    const auto node = named_.find(text_of(channel.mNodeName));
    if (node == named_.end() || node->second == 0) continue;
    const auto add = [&](const char* path, const char* shape, std::size_t columns,
                         const auto& keys) {
      if (keys.first.empty()) return;
      const std::size_t input = glb_.add_values(keys.first, 1, "SCALAR", kFloat, true),
                        output = glb_.add_values(keys.second, columns, shape, kFloat);
      out["channels"].push_back({{"sampler", out["samplers"].size()},
                                 {"target", {{"node", node->second}, {"path", path}}}});
      out["samplers"].push_back({{"input", input}, {"output", output}});
    };
    const auto vector = [](double scale) {
      return [scale](const aiVector3D& v, std::vector<float>& values) {
        if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
        for (unsigned k = 0; k < 3; ++k) values.push_back(float(double(v[k]) * scale));
        return true;
      };
    };
    add("translation", "VEC3", 3,
        keys_of(channel.mPositionKeys, channel.mNumPositionKeys, rate, vector(unit_)));
    // Neighbours on the same half of the sphere, so that what lies between is the short way.
    const auto turn = [](const aiQuaternion& q, std::vector<float>& values) {
      Eigen::Vector4d next(double(q.x), double(q.y), double(q.z), double(q.w));
      if (!next.allFinite() || !(next.norm() > 1e-6)) return false;
      next.normalize();
      double along = 0;
      for (int k = 0; !values.empty() && k < 4; ++k)
        along += next[k] * double(values[values.size() - 4 + std::size_t(k)]);
      if (along < 0) next = -next;
      for (int k = 0; k < 4; ++k) values.push_back(float(next[k]));
      return true;
    };
    add("rotation", "VEC4", 4,
        keys_of(channel.mRotationKeys, channel.mNumRotationKeys, rate, turn));
    add("scale", "VEC3", 3,
        keys_of(channel.mScalingKeys, channel.mNumScalingKeys, rate, vector(1)));
  }
  if (!out["channels"].empty()) glb_.add("animations", std::move(out));
}

}  // namespace

std::string scene_glb(const aiScene& scene, const SceneFrame& frame) {
  return SceneWriter(scene, frame).write();
}

}  // namespace ecorche::inline v1
