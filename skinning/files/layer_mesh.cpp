#include "skinning/files/layer_mesh.h"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>

#include "anatomy/bones/cartilage.h"
#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

void add_groups(LayerMesh& layer, const std::string& name, const Triangles& F,
                const std::vector<char>& second, const TissueLook& first_look,
                const TissueLook& second_look) {
  Triangles first = faces_with(F, second, 0), other = faces_with(F, second, 1);
  if (first.rows() > 0) layer.groups.push_back({name, first_look, std::move(first)});
  if (other.rows() > 0) layer.groups.push_back({name, second_look, std::move(other)});
}

}  // namespace

LayerMesh skin_layer(const TriMesh& skin, const SkinTexture& texture) {
  LayerMesh layer;
  layer.rest = skin.V.cast<float>();
  layer.texture = texture;
  layer.groups.push_back({"skin", kSkinLook, skin.F});
  return layer;
}

LayerMesh bone_layer(const Anatomy& anatomy, const std::vector<CartilageRule>& rules) {
  LayerMesh layer;
  layer.kind = LayerMesh::Kind::bones;
  layer.joint_rest = rest_positions(anatomy.skeleton);
  Eigen::Index vertices = 0;
  for (const Bone& bone : anatomy.bones) vertices += bone.mesh.V.rows();
  layer.rest.resize(vertices, 3);
  for (const Bone& bone : anatomy.bones) {
    const int begin = layer.joint.size();
    layer.rest.middleRows(begin, bone.mesh.V.rows()) = bone.mesh.V.cast<float>();
    layer.joint.resize(layer.joint.size() + std::size_t(bone.mesh.V.rows()), bone.joint);
    const Triangles F = bone.mesh.F.array() + begin;
    add_groups(layer, "bone/" + bone.name, F, cartilage_faces(rules, bone), kBoneLook,
               kCartilageLook);
  }
  return layer;
}

LayerMesh muscle_layer(const Anatomy& anatomy) {
  LayerMesh layer;
  layer.kind = LayerMesh::Kind::muscles;
  layer.surface = make_muscle_surface(anatomy, {.points_per_slice = kLoftPoints});
  Points rest;
  update_muscle_surface(layer.surface, rest_slices(anatomy), rest);
  layer.rest = rest.cast<float>();
  for (const MuscleSurface::Part& part : layer.surface.parts) {
    const Triangles F =
        layer.surface.F.middleRows(part.face_begin, part.face_end - part.face_begin);
    const std::string name = "muscle/" + anatomy.muscles[part.muscle].name;
    add_groups(layer, name, F, tendon_faces(layer.surface.belly, F), kMuscleLook, kTendonLook);
  }
  layer.fascia = make_fascia_surface(anatomy);
  const Eigen::Index muscles = layer.rest.rows();
  layer.rest.conservativeResize(muscles + layer.fascia.vertices(), 3);
  for (const FasciaSurface::Part& part : layer.fascia.parts) {
    const FasciaSheet& sheet = anatomy.fascia[part.sheet];
    layer.rest.middleRows(muscles + part.vertex_begin, sheet.V.rows()) = sheet.V.cast<float>();
    layer.groups.push_back(
        {"fascia/" + sheet.name, kTendonLook,
         layer.fascia.F.middleRows(part.face_begin, part.face_end - part.face_begin).array() +
             int(muscles)});
  }
  return layer;
}

void pose_layer(const LayerMesh& layer, const PosedAnatomy& posed, const SkinFrame& skin,
                PointsF& out) {
  if (layer.kind == LayerMesh::Kind::muscles) {
    PointsF muscles, fascia;
    update_muscle_surface(layer.surface, posed, muscles);
    update_fascia_surface(layer.fascia, posed, fascia);
    out.resize(layer.rest.rows(), 3);
    out.topRows(muscles.rows()) = muscles;
    out.bottomRows(fascia.rows()) = fascia;
    return;
  }
  out.resize(layer.rest.rows(), 3);
  if (layer.kind == LayerMesh::Kind::skin) {
    if (skin.positions.size() != 4 * std::size_t(out.rows()))
      throw std::invalid_argument("pose_layer: the frame is of another skin");
    for (Eigen::Index i = 0; i < out.rows(); ++i)
      for (int k = 0; k < 3; ++k) out(i, k) = skin.positions[4 * i + k];
    return;
  }
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const std::size_t j = layer.joint[i];
    out.row(i) =
        (posed.X_WJ[j] * (layer.rest.row(i).transpose().cast<double>() - layer.joint_rest[j]))
            .transpose()
            .cast<float>();
  }
}

std::string layer_materials(std::span<const LayerMesh> layers) {
  std::string out;
  for (const LayerMesh& layer : layers)
    for (const MeshGroup& group : layer.groups) {
      const std::string head = fmt::format("newmtl {}\n", group.look.name);
      if (out.find(head) != std::string::npos) continue;
      const Rgb light = linear_light(group.look.color);
      out += head + fmt::format("Kd {:.4f} {:.4f} {:.4f}\nKs 0.04 0.04 0.04\nd 1\nillum 2\n",
                                light.x(), light.y(), light.z());
    }
  return out;
}

std::string layer_faces(std::span<const LayerMesh> layers) {
  std::string out;
  const auto append = [&]<class... A>(fmt::format_string<A...> format, A&&... values) {
    fmt::format_to(std::back_inserter(out), format, std::forward<A>(values)...);
  };
  for (const LayerMesh& layer : layers)
    for (Eigen::Index i = 0; i < layer.texture.places.rows(); ++i)
      append("vt {} {}\n", layer.texture.places(i, 0), layer.texture.places(i, 1));
  Eigen::Index begin = 1, places = 1;
  for (const LayerMesh& layer : layers) {
    for (const MeshGroup& group : layer.groups) {
      append("g {}\nusemtl {}\n", group.name, group.look.name);
      for (Eigen::Index f = 0; f < group.F.rows(); ++f) {
        const Eigen::RowVector3i v = group.F.row(f).array() + int(begin);
        if (layer.texture.empty()) {
          append("f {} {} {}\n", v[0], v[1], v[2]);
        } else {
          const Eigen::RowVector3i t = layer.texture.F.row(f).array() + int(places);
          append("f {}/{} {}/{} {}/{}\n", v[0], t[0], v[1], t[1], v[2], t[2]);
        }
      }
    }
    begin += layer.rest.rows();
    places += layer.texture.places.rows();
  }
  return out;
}

void append_vertices(std::span<const float> positions, int stride, std::string& out) {
  for (std::size_t i = 0; i + 2 < positions.size(); i += std::size_t(stride))
    fmt::format_to(std::back_inserter(out), "v {} {} {}\n", positions[i], positions[i + 1],
                   positions[i + 2]);
}

}  // namespace ecorche::inline v1
