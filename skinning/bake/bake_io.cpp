#include "skinning/bake/bake_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/files/glb_builder.h"
#include "skinning/files/gltf_values.h"
#include "skinning/files/quantized_rotations.h"

namespace ecorche::inline v1 {
namespace {

using gltf::Array;
using gltf::number;
using gltf::Object;
using tinygltf::Value;

// `Index`: type of the stored vertex indices.
template <class Index>
int add_sparse(gltf::GlbBuilder& glb, const Points& shape, int component) {
  std::vector<Index> places;
  std::vector<float> offsets;
  Eigen::Array3d low = Eigen::Array3d::Zero(),
                 high = Eigen::Array3d::Zero();  // what is not stored is zero
  for (Eigen::Index i = 0; i < shape.rows(); ++i) {
    if (shape.row(i).isZero(0)) continue;
    places.push_back(static_cast<Index>(i));
    for (int k = 0; k < 3; ++k) {
      offsets.push_back(float(shape(i, k)));
      low[k] = std::min(low[k], double(offsets.back()));
      high[k] = std::max(high[k], double(offsets.back()));
    }
  }
  if (places.empty()) {  // a sparse accessor must hold something
    places.push_back(0);
    offsets.assign(3, 0);
  }
  const int indices = glb.add_accessor(places, component, TINYGLTF_TYPE_SCALAR, 1, 0);
  const int values =
      glb.add_accessor(offsets, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, 0);
  std::vector<tinygltf::Accessor>& accessors = glb.model().accessors;
  tinygltf::Accessor accessor;
  accessor.bufferView = -1;
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = TINYGLTF_TYPE_VEC3;
  accessor.count = shape.rows();
  accessor.minValues = {low[0], low[1], low[2]};
  accessor.maxValues = {high[0], high[1], high[2]};
  accessor.sparse.isSparse = true;
  accessor.sparse.count = places.size();
  accessor.sparse.indices.bufferView = accessors[indices].bufferView;
  accessor.sparse.indices.byteOffset = 0;
  accessor.sparse.indices.componentType = component;
  accessor.sparse.values.bufferView = accessors[values].bufferView;
  accessor.sparse.values.byteOffset = 0;
  accessors.resize(accessors.size() - 2);  // those two only brought their views
  accessors.push_back(accessor);
  return int(accessors.size()) - 1;
}

Value error_value(const BakeError& error) {
  return Value(Object{{"frames", Value(error.frames)},
                      {"mean", number(error.mean)},
                      {"rms", number(error.rms)},
                      {"p95", number(error.p95)},
                      {"max", number(error.max)},
                      {"normal_rms_deg", number(error.normal_rms)},
                      {"normal_p95_deg", number(error.normal_p95)}});
}

Value notes(const Bake& bake) {
  Object motions;
  for (const BakedMotion& each : bake.motions) motions[each.name] = error_value(each.error);
  Object object{{"unit", gltf::text("m")},
                {"influences", Value(4)},
                {"helpers", Value(int(bake.helpers.size()))},
                {"morphs", Value(int(bake.morphs.size()))},
                {"error", error_value(bake.error)},
                {"motions", Value(std::move(motions))}};
  Object out;
  out["bake"] = Value(std::move(object));
  return Value(std::move(out));
}

// The skeleton with the helpers as further joints.
Skeleton with_helpers(const Skeleton& skeleton, const Bake& bake) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  Skeleton out = skeleton;
  for (std::size_t h = 0; h < bake.helpers.size(); ++h) {
    const BakeHelper& helper = bake.helpers[h];
    Joint joint;
    joint.name = fmt::format("helper_{:02}", h + 1);
    joint.parent = helper.parent;
    joint.X_PJ.translation() = helper.rest - origins[helper.parent];
    out.joints.push_back(std::move(joint));
  }
  return out;
}

// The motion with the helpers' rotations; `places`: positions by helper and frame, from the parent.
Motion with_helpers(const Skeleton& skeleton, const Bake& bake, const BakedMotion& each,
                    std::vector<std::vector<float>>& places) {
  Motion out = each.motion;
  places.assign(bake.helpers.size(), {});
  std::vector<Transform> X_WJ;
  for (std::size_t f = 0; f < out.frames.size(); ++f) {
    forward_kinematics(skeleton, quantized(each.motion.frames[f]), X_WJ);
    for (std::size_t h = 0; h < bake.helpers.size(); ++h) {
      const Transform X = X_WJ[bake.helpers[h].parent].inverse() * each.helpers[f][h];
      out.frames[f].rotations.emplace_back(X.linear());
      for (int k = 0; k < 3; ++k) places[h].push_back(float(X.translation()[k]));
    }
  }
  return out;
}

void add_curves(gltf::GlbBuilder& glb, const BakedMotion& each, int node, int times) {
  std::vector<std::int16_t> weights;
  for (Eigen::Index f = 0; f < each.curves.rows(); ++f)
    for (Eigen::Index m = 0; m < each.curves.cols(); ++m)
      weights.push_back(
          std::int16_t(std::lround(32767 * std::clamp(each.curves(f, m), -1.0f, 1.0f))));
  gltf::add_channel(glb.model().animations.back(), node, "weights", times,
                    glb.add_normalized_shorts(weights, TINYGLTF_TYPE_SCALAR, 1));
}

// The mesh with places on the texture, its material with the normal map.
void add_textured_skin(gltf::GlbBuilder& glb, const TriMesh& skin, const BakeTexture& texture) {
  const int material = glb.material(kSkinLook);
  const SkinTexture& at = texture.texture;
  tinygltf::Primitive primitive = glb.surface(
      textured_rows(at, skin.V), textured_rows(at, gltf::GlbBuilder::unit_normals(skin)),
      glb.add_indices(at.F), material);
  primitive.attributes["TEXCOORD_0"] = glb.add_texture_coordinates(at.places);
  glb.add_mesh("skin", {std::move(primitive)});
  tinygltf::Model& model = glb.model();
  tinygltf::Image image;
  image.name = "skin_normals";
  image.mimeType = "image/png";
  image.bufferView =
      model
          .accessors[glb.add_accessor(texture.normals_png, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                      TINYGLTF_TYPE_SCALAR, 1, 0)]
          .bufferView;
  model.accessors.pop_back();  // it only brought its view
  model.images.push_back(std::move(image));
  tinygltf::Texture map;
  map.source = int(model.images.size()) - 1;
  model.textures.push_back(std::move(map));
  model.materials[material].normalTexture.index = int(model.textures.size()) - 1;
}

std::vector<std::array<Influence, 4>> split_influences(const Bake& bake,
                                                       const SkinTexture& texture) {
  std::vector<std::array<Influence, 4>> out;
  for (const int v : texture.vertex) out.push_back(bake.influences[std::size_t(v)]);
  return out;
}

}  // namespace

void write_bake(const std::filesystem::path& file, const std::string& name, const TriMesh& skin,
                const Skeleton& skeleton, const Bake& bake, const BakeTexture* texture) {
  if (bake.influences.size() != std::size_t(skin.V.rows()))
    throw std::invalid_argument("write_bake: the bake is of another skin");
  AtomicFile out(file);
  gltf::GlbBuilder glb;
  const Skeleton bones = with_helpers(skeleton, bake);
  gltf::add_joints(glb, bones);
  if (texture)
    add_textured_skin(glb, skin, *texture);
  else
    glb.add_mesh("skin", skin, glb.material(kSkinLook));
  // By index from here on: adding accessors does not move meshes, but the reference would not
  // outlive another mesh.
  tinygltf::Mesh& mesh = glb.model().meshes.back();
  const auto rows = [&](const Points& values) {
    return texture ? textured_rows(texture->texture, values) : values;
  };
  glb.add_influences(mesh.primitives[0],
                     texture ? split_influences(bake, texture->texture) : bake.influences);
  Array names;
  const bool small =
      (texture ? Eigen::Index(texture->texture.vertex.size()) : skin.V.rows()) <= 65536;
  for (std::size_t m = 0; m < bake.morphs.size(); ++m) {
    const auto add = [&](const Points& shape) {
      return small ? add_sparse<std::uint16_t>(glb, shape, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
                   : add_sparse<std::uint32_t>(glb, shape, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    };
    const int places = add(rows(bake.morphs[m])), normals = add(rows(bake.morph_normals[m]));
    mesh.primitives[0].targets.push_back({{"POSITION", places}, {"NORMAL", normals}});
    names.push_back(gltf::text(fmt::format("corrective_{:02}", m + 1)));
  }
  mesh.weights.assign(bake.morphs.size(), 0);
  if (!names.empty()) mesh.extras = Value(Object{{"targetNames", Value(std::move(names))}});
  tinygltf::Node node;
  node.name = "skin";
  node.mesh = 0;
  node.skin = 0;
  const int skin_node = glb.add_node(std::move(node));
  for (const BakedMotion& each : bake.motions) {
    std::vector<std::vector<float>> places;
    const int times = gltf::add_motion(glb, bones, with_helpers(skeleton, bake, each, places),
                                       each.name, gltf::RotationKeys::shorts);
    for (std::size_t h = 0; h < places.size(); ++h)
      gltf::add_channel(
          glb.model().animations.back(), int(skeleton.joints.size() + h), "translation", times,
          glb.add_accessor(places[h], TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, 0));
    if (!bake.morphs.empty()) add_curves(glb, each, skin_node, times);
  }
  glb.scene().name = name.empty() ? "bake" : name;
  glb.scene().extras = notes(bake);
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&glb.model(), out.stream(), false, true))
    out.fail();
  out.commit();
}

}  // namespace ecorche::inline v1
