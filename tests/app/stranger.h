// A stranger's character made of the body package: posed by one of its rigs, in other units and
// axes, of several pieces; and the registration that finds it.
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/mesh_files/glb_bytes.h"
#include "morph/registration/registration.h"

namespace ecorche::test {

inline constexpr double kUnit = 0.02;  // m in one of the stranger's

// Upright along the file's z, facing -y.
inline Mat3 stranger_axes() {
  Mat3 out;
  out << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return out;
}

inline Points on_floor(const BodyPackage& package) {
  Points out = package.points;
  out.col(1).array() -= out.topRows(package.skin_size).col(1).minCoeff();
  return out;
}

// Of the package's undeformed body, its Mixamo bones turned: `turn` of a bone's name.
template <class Turn>
Registration turned_package(const BodyPackage& package, const Turn& turn) {
  const Points points = on_floor(package);
  const Rig rig = read_rig(package, "mixamo", points);
  std::vector<Transform> X;
  for (std::size_t b = 0; b < rig.names.size(); ++b) {
    Transform local = Transform::Identity();
    local.translate(rig.heads[b]).rotate(turn(rig.names[b])).translate(-rig.heads[b]);
    X.push_back(rig.parents[b] < 0 ? local : X[std::size_t(rig.parents[b])] * local);
  }
  Registration out;
  out.body.skin = skin_mesh(package, points);
  out.body.name = "stranger";
  out.posed.resize(package.skin_size, 3);
  for (int i = 0; i < package.skin_size; ++i) {
    Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();
    for (int k = rig.weights.start[i]; k < rig.weights.start[i + 1]; ++k)
      blend += rig.weights.weight[k] * X[std::size_t(rig.weights.bone[k])].matrix();
    out.turn.push_back(blend.topLeftCorner<3, 3>());
    out.posed.row(i) =
        out.turn.back() * out.body.skin.V.row(i).transpose() + Vec3(blend.topRightCorner<3, 1>());
  }
  const double floor = out.posed.col(1).minCoeff();
  out.posed.col(1).array() -= floor;
  out.seen.assign(std::size_t(package.skin_size), 1);
  out.scale = kUnit;
  out.axes = stranger_axes();
  out.shift = Vec3(0.1, 0, -0.2);
  return out;
}

inline Quat turn_about(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * kDegree, axis));
}

// Arms lowered and bent, a step forward.
inline Registration posed_package(const BodyPackage& package) {
  return turned_package(package, [](const std::string& name) -> Quat {
    if (name.ends_with("LeftArm"))
      return turn_about(-30, Vec3::UnitZ()) * turn_about(-15, Vec3::UnitX());
    if (name.ends_with("RightArm")) return turn_about(25, Vec3::UnitZ());
    if (name.ends_with("RightForeArm")) return turn_about(-60, Vec3::UnitX());
    if (name.ends_with("LeftUpLeg")) return turn_about(-20, Vec3::UnitX());
    if (name.ends_with("LeftLeg")) return turn_about(25, Vec3::UnitX());
    if (name.ends_with("Head")) return turn_about(15, Vec3::UnitY());
    return Quat::Identity();
  });
}

// A .glb being written.
class GlbFile {
 public:
  nlohmann::ordered_json root{{"asset", {{"version", "2.0"}}}, {"scene", 0}};

  template <class T>
  int add(const std::vector<T>& values, int component, const char* type, int columns) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    const std::size_t begin = binary_.size();
    binary_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", values.size() * sizeof(T)}});
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", values.size() / std::size_t(columns)},
                                 {"type", type}});
    return int(root["accessors"].size()) - 1;
  }

  int add_points(const Points& points, bool bounds) {
    std::vector<float> values;
    for (Eigen::Index k = 0; k < points.size(); ++k) values.push_back(float(points.data()[k]));
    const int out = add(values, 5126, "VEC3", 3);
    if (!bounds) return out;
    auto& accessor = root["accessors"].back();
    for (int k = 0; k < 3; ++k) {
      accessor["min"].push_back(float(points.col(k).minCoeff()));
      accessor["max"].push_back(float(points.col(k).maxCoeff()));
    }
    return out;
  }

  std::string bytes() {
    root["buffers"] = {{{"byteLength", (binary_.size() + 3) / 4 * 4}}};
    return glb_bytes(root.dump(), binary_);
  }

  // A bufferView of plain bytes.
  int add_bytes(const std::string& bytes) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}});
    binary_ += bytes;
    return int(root["bufferViews"].size()) - 1;
  }

 private:
  std::string binary_;
};

inline Points vertex_directions(const TriMesh& mesh) {
  Points out = Points::Zero(mesh.V.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    for (int k = 0; k < 3; ++k) out.row(mesh.F(f, k)) += (b - a).cross(c - a).transpose();
  }
  return out.rowwise().normalized();
}

// The posed skin 2 mm out, its quads cut the other way; a coat 4 cm off the trunk and the upper
// arms; two eyes, and in their mesh two toecaps no larger. With a rig of the stranger's own, and a
// texture that nobody must touch.
inline std::string stranger_glb(const BodyPackage& package, const Registration& registration) {
  const Mat3 back = registration.axes.inverse() / registration.scale;
  const auto to_file = [&](const Points& V) -> Points {
    return (V.rowwise() - registration.shift.transpose()) * back.transpose();
  };
  const TriMesh posed{registration.posed, package.triangles};
  const Points normals = vertex_directions(posed);
  Triangles other(2 * package.quads.rows(), 3);
  for (Eigen::Index q = 0; q < package.quads.rows(); ++q) {
    const auto& quad = package.quads.row(q);
    other.row(2 * q) << quad[0], quad[1], quad[3];
    other.row(2 * q + 1) << quad[1], quad[2], quad[3];
  }
  const std::vector<VertexPart> parts = vertex_parts(package);
  std::vector<int> coat_of(parts.size(), -1);
  std::vector<int> coat_vertices;
  std::vector<std::array<int, 3>> coat_faces;
  const auto worn = [&](int v) {
    return parts[std::size_t(v)].part == BodyPart::trunk ||
           parts[std::size_t(v)].part == BodyPart::upper_arm;
  };
  for (Eigen::Index f = 0; f < package.triangles.rows(); ++f) {
    const auto& t = package.triangles.row(f);
    if (!worn(t[0]) || !worn(t[1]) || !worn(t[2])) continue;
    std::array<int, 3> face;
    for (int k = 0; k < 3; ++k) {
      int& at = coat_of[std::size_t(t[k])];
      if (at < 0) at = int(coat_vertices.size()), coat_vertices.push_back(t[k]);
      face[std::size_t(k)] = at;
    }
    coat_faces.push_back(face);
  }
  TriMesh coat{Points(coat_vertices.size(), 3), Triangles(coat_faces.size(), 3)};
  for (std::size_t i = 0; i < coat_vertices.size(); ++i)
    coat.V.row(Eigen::Index(i)) =
        posed.V.row(coat_vertices[i]) + 0.04 * normals.row(coat_vertices[i]);
  for (std::size_t f = 0; f < coat_faces.size(); ++f)
    coat.F.row(Eigen::Index(f)) << coat_faces[f][0], coat_faces[f][1], coat_faces[f][2];
  // Octahedra before the highest points of the head, and as many on the floor under it.
  TriMesh eyes{Points(24, 3), Triangles(32, 3)};
  Eigen::Index crown = 0;
  posed.V.col(1).maxCoeff(&crown);
  const Vec3 head = posed.V.row(crown);
  for (int e = 0; e < 4; ++e) {
    const double down = e < 2 ? 0.11 : head.y() - 0.02;
    const Vec3 center = head + Vec3(e % 2 == 0 ? 0.03 : -0.03, -down, 0.07);
    for (int k = 0; k < 6; ++k)
      eyes.V.row(6 * e + k) = center + (k % 2 == 0 ? 0.012 : -0.012) * Vec3(Vec3::Unit(k / 2));
    for (int k = 0; k < 8; ++k) {
      const int x = k & 1, y = 2 + (k >> 1 & 1), z = 4 + (k >> 2 & 1);
      if ((x + y + z) % 2 == 0)
        eyes.F.row(8 * e + k) << 6 * e + x, 6 * e + y, 6 * e + z;
      else
        eyes.F.row(8 * e + k) << 6 * e + x, 6 * e + z, 6 * e + y;
    }
  }

  GlbFile glb;
  auto& root = glb.root;
  root["images"] = {{{"name", "no picture"},
                     {"mimeType", "image/png"},
                     {"bufferView", glb.add_bytes(std::string("\x89PNG\r\n\x1a\n", 8) + "any")}}};
  root["textures"] = {{{"source", 0}}};
  root["materials"] = {{{"name", "Skin"},
                        {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                        {"extras", {{"theirs", 7}}}},
                       {{"name", "Coat"}, {"doubleSided", true}}};

  // A rig: nodes of the package's bones under an armature that is turned.
  const Points points = on_floor(package);
  const Rig rig = read_rig(package, "mixamo", points);
  const int bones = int(rig.names.size());
  std::vector<std::vector<int>> children(rig.names.size());
  // Joints stand where the bones' heads have gone, found by the vertices about them.
  std::vector<Vec3> heads;
  for (int b = 0; b < bones; ++b) {
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (int i = 0; i < package.skin_size; ++i)
      for (int k = rig.weights.start[i]; k < rig.weights.start[i + 1]; ++k) {
        if (rig.weights.bone[k] != b) continue;
        const Vec3 rest = registration.body.skin.V.row(i), posed_at = registration.posed.row(i);
        sum += rig.weights.weight[k] * (posed_at + registration.turn[i] * (rig.heads[b] - rest));
        weight += rig.weights.weight[k];
      }
    heads.push_back(back * ((weight > 0 ? Vec3(sum / weight) : rig.heads[std::size_t(b)]) -
                            registration.shift));
    if (rig.parents[std::size_t(b)] >= 0)
      children[std::size_t(rig.parents[std::size_t(b)])].push_back(b);
  }
  std::vector<float> binds;
  std::vector<int> joints;
  for (int b = 0; b < bones; ++b) {
    const int parent = rig.parents[std::size_t(b)];
    const Vec3 offset =
        heads[std::size_t(b)] - (parent < 0 ? Vec3::Zero() : heads[std::size_t(parent)]);
    nlohmann::ordered_json node{{"name", rig.names[std::size_t(b)]},
                                {"translation", {offset.x(), offset.y(), offset.z()}}};
    if (!children[std::size_t(b)].empty()) node["children"] = children[std::size_t(b)];
    root["nodes"].push_back(node);
    joints.push_back(b);
    Eigen::Matrix4f bind = Eigen::Matrix4f::Identity();
    bind.topRightCorner<3, 1>() = -heads[std::size_t(b)].cast<float>();
    binds.insert(binds.end(), bind.data(), bind.data() + 16);
  }
  root["skins"] = {{{"joints", joints}, {"inverseBindMatrices", glb.add(binds, 5126, "MAT4", 16)}}};

  const auto weights_of = [&](const std::vector<int>& base, nlohmann::ordered_json& attributes) {
    std::vector<std::uint16_t> joint;
    std::vector<float> weight;
    for (const int v : base) {
      float sum = 0;
      std::array<float, 4> four{};
      for (int k = 0; k < 4; ++k) {
        const int at = rig.weights.start[v] + k;
        const bool there = at < rig.weights.start[v + 1];
        joint.push_back(there ? std::uint16_t(rig.weights.bone[at]) : 0);
        sum += four[std::size_t(k)] = there ? float(rig.weights.weight[at]) : 0;
      }
      for (const float w : four) weight.push_back(w / sum);
    }
    attributes["JOINTS_0"] = glb.add(joint, 5123, "VEC4", 4);
    attributes["WEIGHTS_0"] = glb.add(weight, 5126, "VEC4", 4);
  };
  const auto add_mesh = [&](const char* name, const TriMesh& mesh, int material,
                            const std::vector<int>& base) {
    nlohmann::ordered_json attributes{{"POSITION", glb.add_points(to_file(mesh.V), true)}};
    std::vector<float> uv;
    for (Eigen::Index i = 0; i < 2 * mesh.V.rows(); ++i) uv.push_back(float(i % 97) / 97);
    attributes["TEXCOORD_0"] = glb.add(uv, 5126, "VEC2", 2);
    if (!base.empty()) weights_of(base, attributes);
    const std::vector<std::uint32_t> corners(mesh.F.data(), mesh.F.data() + mesh.F.size());
    root["meshes"].push_back({{"name", name},
                              {"primitives",
                               {{{"attributes", attributes},
                                 {"indices", glb.add(corners, 5125, "SCALAR", 1)},
                                 {"material", material}}}}});
    nlohmann::ordered_json node{{"name", name}, {"mesh", root["meshes"].size() - 1}};
    if (!base.empty()) node["skin"] = 0;
    root["nodes"].push_back(node);
    return int(root["nodes"].size()) - 1;
  };
  std::vector<int> all(std::size_t(package.skin_size));
  for (int i = 0; i < package.skin_size; ++i) all[std::size_t(i)] = i;
  std::vector<int> top;
  for (int b = 0; b < bones; ++b)
    if (rig.parents[std::size_t(b)] < 0) top.push_back(b);
  top.push_back(add_mesh("Body", {posed.V + 0.002 * normals, other}, 0, all));
  top.push_back(add_mesh("Coat", coat, 1, coat_vertices));
  top.push_back(add_mesh("Eyes", eyes, 0, {}));
  root["scenes"] = {{{"nodes", top}}};
  return glb.bytes();
}

}  // namespace ecorche::test
