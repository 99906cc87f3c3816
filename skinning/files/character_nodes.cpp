#include "skinning/files/character_nodes.h"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>
#include <utility>

#include "anatomy/errors.h"
#include "skinning/files/character_check.h"
#include "skinning/files/character_format.h"
#include "skinning/files/own_skin_file.h"

namespace ecorche::inline v1::gltf {

using tinygltf::Value;

void check_parts(const Character& character, const Binding& binding, const Motion* motion,
                 const CharacterLook& look) {
  validate(character.anatomy);
  try {
    check_character(character, "");
  } catch (const InputError& error) {
    throw UnfitError(
        fmt::format("no sound anatomy fits this body{}", error.what()));  // ": muscle 'x': ..."
  }
  const TriMesh& skin = character.body.skin;
  const std::size_t vertices = skin.V.rows();
  const std::size_t joints = character.anatomy.skeleton.joints.size();
  if (binding.joint_weights.size() != vertices || binding.anchors.size() != vertices)
    throw std::invalid_argument(fmt::format("a binding of {} vertices for a skin of {}",
                                            binding.joint_weights.size(), vertices));
  if (!look.texture.empty() && look.texture.F.rows() != skin.F.rows())
    throw std::invalid_argument("the texture belongs to another skin");
  if (joints > 65535) throw LimitError("more than 65535 joints cannot be written as glTF");
  if (!motion) return;
  if (motion->frames.empty() || !(motion->fps > 0))
    throw std::invalid_argument("a motion without frames or rate cannot be written");
  for (const Pose& pose : motion->frames)
    if (pose.rotations.size() != joints)
      throw std::invalid_argument("the motion belongs to another skeleton");
}

int add_skin(GlbBuilder& glb, const TriMesh& skin, std::span<const std::array<Influence, 4>> shares,
             const SkinTexture& texture) {
  const int material = glb.material(kSkinLook);
  const Points normals = GlbBuilder::unit_normals(skin);
  tinygltf::Primitive primitive;
  if (texture.empty()) {
    primitive = glb.surface(skin.V, normals, glb.add_indices(skin.F), material);
    glb.add_influences(primitive, shares);
  } else {
    primitive = glb.surface(textured_rows(texture, skin.V), textured_rows(texture, normals),
                            glb.add_indices(texture.F), material);
    std::vector<std::array<Influence, 4>> split;
    std::vector<float> own;
    for (const int v : texture.vertex) {
      split.push_back(shares[v]);
      own.push_back(float(v));
    }
    glb.add_influences(primitive, split);
    primitive.attributes["TEXCOORD_0"] = glb.add_texture_coordinates(texture.places);
    primitive.attributes["_SKIN_VERTEX"] =
        glb.add_scalars(own, false, TINYGLTF_TARGET_ARRAY_BUFFER);
  }
  tinygltf::Node node;
  node.name = "skin";
  node.mesh = glb.add_mesh("skin", {std::move(primitive)});
  node.skin = 0;
  return glb.add_node(std::move(node));
}

void finish(GlbBuilder& glb, const Body& body, Object ecorche, AtomicFile& out,
            const OwnSkin* own) {
  ecorche["schema"] = Value(own ? kOwnSkinSchema : kCharacterSchema);
  ecorche["body"] = body_extras(body);
  Object extras;
  extras["ecorche"] = Value(std::move(ecorche));
  glb.scene().extras = Value(std::move(extras));
  glb.scene().name = body.name.empty() ? "body" : body.name;
  if (own) {
    std::ostringstream ours;
    if (!glb.write(ours)) out.fail();
    if (!(out.stream() << join_own_skin(std::move(ours).str(), *own))) out.fail();
  } else if (!glb.write(out.stream())) {
    out.fail();
  }
  out.commit();
}

}  // namespace ecorche::inline v1::gltf
