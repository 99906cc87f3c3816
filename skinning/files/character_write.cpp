#include "skinning/files/character_write.h"

#include <algorithm>
#include <span>
#include <utility>

#include "anatomy/bones/cartilage.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/muscles/muscle_surface.h"
#include "skinning/files/character_nodes.h"
#include "skinning/files/fibre_attributes.h"
#include "skinning/files/layer_mesh.h"
#include "skinning/files/morph_targets.h"
#include "skinning/files/own_skin_file.h"
#include "skinning/files/slice_influences.h"
#include "skinning/files/tissue_meshes.h"

namespace ecorche::inline v1 {
namespace {

using gltf::GlbBuilder;

// What of the anatomy lies nearest to each of the skin's vertices.
void add_anchors(GlbBuilder& glb, const Character& character, const Binding& binding,
                 const SkinTexture& texture) {
  const int bones = character.anatomy.bones.size();
  const std::size_t count = texture.empty() ? binding.anchors.size() : texture.vertex.size();
  std::vector<float> parts, distances;
  for (std::size_t i = 0; i < count; ++i) {
    const Anchor& anchor = binding.anchors[texture.empty() ? i : std::size_t(texture.vertex[i])];
    parts.push_back(float(anchor.kind == Anchor::Kind::muscle ? bones + anchor.part : anchor.part));
    distances.push_back(float(anchor.distance));
  }
  auto& attributes = glb.model().meshes.back().primitives[0].attributes;
  attributes["_ANCHOR_PART"] = glb.add_scalars(parts, false, TINYGLTF_TARGET_ARRAY_BUFFER);
  attributes["_ANCHOR_DISTANCE"] = glb.add_scalars(distances, false, TINYGLTF_TARGET_ARRAY_BUFFER);
}

void add_bones(GlbBuilder& glb, const Anatomy& anatomy, const std::vector<CartilageRule>& rules) {
  const auto positions = rest_positions(anatomy.skeleton);
  for (const Bone& bone : anatomy.bones) {
    TriMesh local = bone.mesh;
    local.V.rowwise() -= positions[bone.joint].transpose();
    tinygltf::Node node;
    node.name = "bone/" + bone.name;
    const std::vector<char> cartilage = cartilage_faces(rules, bone);
    const bool has = std::count(cartilage.begin(), cartilage.end(), 1) > 0;
    const int material = glb.material(kBoneLook),
              other = has ? glb.material(kCartilageLook) : material;
    const Points normals = GlbBuilder::unit_normals(local);
    node.mesh =
        glb.add_mesh(node.name, gltf::two_tissues(glb, local, normals, cartilage, material, other));
    node.extras = gltf::bone_extras(bone);
    glb.add_node(std::move(node), bone.joint);
  }
}

// Returns the first muscle's node; the others follow.
int add_muscles(GlbBuilder& glb, const Anatomy& anatomy,
                std::span<const std::array<Influence, 4>> influences) {
  const int first = int(glb.model().nodes.size());
  const auto [surface, positions] = gltf::lofted_muscles(anatomy);
  const std::vector<Ellipse> slices = rest_slices(anatomy);
  for (const MuscleSurface::Part& part : surface.parts) {
    const Muscle& muscle = anatomy.muscles[part.muscle];
    std::vector<std::array<Influence, 4>> shares;
    for (int i = part.vertex_begin; i < part.vertex_end; ++i)
      shares.push_back(influences[surface.slice[i]]);
    const TriMesh mesh = part_mesh(surface, part, positions);
    const std::span<const float> belly(surface.belly.data() + part.vertex_begin,
                                       surface.belly.data() + part.vertex_end);
    auto tissues = gltf::muscle_tissues(glb, mesh, gltf::muscle_tints(part.muscle, belly, mesh.F));
    glb.add_influences(tissues.front(), shares);
    const gltf::FibreAttributes fibres = gltf::fibre_attributes(muscle, surface, part, slices);
    tissues.front().attributes["TEXCOORD_0"] = glb.add_texture_coordinates(fibres.places);
    tissues.front().attributes["_FIBRE"] = glb.add_vectors(fibres.directions, false);
    for (const char* name : {"JOINTS_0", "WEIGHTS_0", "TEXCOORD_0", "_FIBRE"})
      tissues.back().attributes[name] = tissues.front().attributes[name];
    tinygltf::Node node;
    node.name = "muscle/" + muscle.name;
    node.mesh = glb.add_mesh(node.name, std::move(tissues));
    node.skin = 0;
    node.extras = gltf::muscle_extras(muscle, glb.keep_text(gltf::strips_text(muscle)));
    glb.add_node(std::move(node));
  }
  return first;
}

// Returns the first sheet's node; the others follow.
int add_fascia(GlbBuilder& glb, const Anatomy& anatomy,
               std::span<const std::array<Influence, 4>> slices) {
  const int first = int(glb.model().nodes.size());
  if (anatomy.fascia.empty()) return first;
  const FasciaSurface surface = make_fascia_surface(anatomy);
  const auto influences = fascia_influences(surface, slices);
  for (const FasciaSurface::Part& part : surface.parts) {
    const FasciaSheet& sheet = anatomy.fascia[part.sheet];
    tinygltf::Primitive tissue = gltf::fascia_tissue(glb, sheet);
    glb.add_influences(tissue, std::span(influences)
                                   .subspan(std::size_t(part.vertex_begin),
                                            std::size_t(part.vertex_end - part.vertex_begin)));
    tissue.attributes["_BELLY"] = glb.add_scalars(sheet.belly, false, TINYGLTF_TARGET_ARRAY_BUFFER);
    tinygltf::Node node;
    node.name = "fascia/" + sheet.name;
    node.mesh = glb.add_mesh(node.name, {std::move(tissue)});
    node.skin = 0;
    node.extras = gltf::fascia_extras(sheet);
    glb.add_node(std::move(node));
  }
  return first;
}

void add_eyes(GlbBuilder& glb, const Skeleton& skeleton, std::span<const Eyeball> eyes) {
  const auto positions = rest_positions(skeleton);
  for (Eyeball eye : eyes) {
    tinygltf::Node node;
    node.name = eye.center.x() > 0 ? "eye/left" : "eye/right";
    eye.center -= positions[eye.joint];
    node.mesh = glb.add_mesh(node.name, gltf::eye_tissues(glb, eye));
    glb.add_node(std::move(node), eye.joint);
  }
}

}  // namespace

void write_character(const std::filesystem::path& file, const Character& character,
                     const Binding& binding, const Motion* motion, const CharacterLook& look,
                     const ClipShapes* shapes) {
  gltf::check_parts(character, binding, motion, look);
  gltf::check_shapes(character, motion, shapes);
  AtomicFile out(file);  // before the work, so that a bad place is told at once
  GlbBuilder glb;
  gltf::add_joints(glb, character.anatomy.skeleton);
  gltf::Object notes;
  gltf::MorphedNodes morphed;
  if (character.own) {
    notes["own"] = gltf::add_own_skin(glb, character, binding);
  } else {
    const int node = gltf::add_skin(glb, character.body.skin, binding.joint_weights, look.texture);
    add_anchors(glb, character, binding, look.texture);
    if (shapes) morphed.emplace_back(node, gltf::seamed_shapes(shapes->skin, look.texture));
  }
  add_bones(glb, character.anatomy, look.cartilage);
  const auto slices = slice_influences(character.anatomy);
  const int first_muscle = add_muscles(glb, character.anatomy, slices);
  if (shapes)
    for (std::size_t m = 0; m < shapes->muscles.size(); ++m)
      morphed.emplace_back(first_muscle + int(m), shapes->muscles[m]);
  const int first_fascia = add_fascia(glb, character.anatomy, slices);
  if (shapes)
    for (std::size_t n = 0; n < shapes->fascia.size(); ++n)
      morphed.emplace_back(first_fascia + int(n), shapes->fascia[n]);
  add_eyes(glb, character.anatomy.skeleton, look.eyes);
  if (motion) {
    const int times = gltf::add_motion(glb, character.anatomy.skeleton, *motion, "motion");
    gltf::add_morphs(glb, morphed, times);
  }
  if (shapes) notes["shapes"] = gltf::shapes_notes(glb, morphed);
  gltf::finish(glb, character.body, std::move(notes), out, character.own.get());
}

void write_body(const std::filesystem::path& file, const Body& body) {
  AtomicFile out(file);
  GlbBuilder glb;
  glb.add_mesh("skin", body.skin, glb.material(kSkinLook));
  tinygltf::Node node;
  node.name = "skin";
  node.mesh = 0;
  glb.add_node(std::move(node));
  gltf::finish(glb, body, {}, out);
}

}  // namespace ecorche::inline v1
