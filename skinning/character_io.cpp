// Writing. Reading is in character_read.cpp.
#include "skinning/character_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/muscle_line.h"
#include "anatomy/muscle_surface.h"
#include "skinning/glb_builder.h"
#include "skinning/gltf_values.h"
#include "skinning/slice_influences.h"

namespace ecorche {
namespace {

using gltf::GlbBuilder;
using gltf::kSkinColour;
using gltf::Object;
using tinygltf::Value;

void add_skin(GlbBuilder& glb, const Character& character, const Binding& binding) {
  const int material = glb.add_material("skin", kSkinColour, 0.6);
  tinygltf::Primitive& primitive = glb.add_mesh("skin", character.body.skin, material);
  glb.add_influences(primitive, binding.joint_weights);
  const int bones = static_cast<int>(character.anatomy.bones.size());
  std::vector<float> parts, distances;
  for (const Anchor& anchor : binding.anchors) {
    parts.push_back(static_cast<float>(anchor.kind == Anchor::Kind::muscle ? bones + anchor.part : anchor.part));
    distances.push_back(static_cast<float>(anchor.distance));
  }
  primitive.attributes["_ANCHOR_PART"] = glb.add_scalars(parts, false, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["_ANCHOR_DISTANCE"] = glb.add_scalars(distances, false, TINYGLTF_TARGET_ARRAY_BUFFER);

  tinygltf::Node node;
  node.name = "skin";
  node.mesh = static_cast<int>(glb.model().meshes.size()) - 1;
  node.skin = 0;
  glb.add_node(std::move(node));
}

void add_bones(GlbBuilder& glb, const Anatomy& anatomy) {
  const int material = glb.add_material("bone", gltf::kBoneColour, 0.7);
  const auto positions = rest_positions(anatomy.skeleton);
  for (const Bone& bone : anatomy.bones) {
    TriMesh local = bone.mesh;
    local.V.rowwise() -= positions[bone.joint].transpose();
    glb.add_mesh("bone/" + bone.name, local, material);
    tinygltf::Node node;
    node.name = "bone/" + bone.name;
    node.mesh = static_cast<int>(glb.model().meshes.size()) - 1;
    node.extras = gltf::bone_extras(bone);
    glb.add_node(std::move(node), bone.joint);
  }
}

void add_muscles(GlbBuilder& glb, const Anatomy& anatomy) {
  const int material = glb.add_material("muscle", gltf::kMuscleColour, 0.5);
  const auto influences = slice_influences(anatomy);
  MuscleSurfaceOptions options;
  options.points_per_slice = 12;  // enough for the eye, and half the file
  const MuscleSurface surface = make_muscle_surface(anatomy, options);
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  for (const MuscleSurface::Part& part : surface.parts) {
    const Muscle& muscle = anatomy.muscles[part.muscle];
    tinygltf::Primitive& primitive = glb.add_mesh("muscle/" + muscle.name, part_mesh(surface, part, positions), material);
    std::vector<std::array<Influence, 4>> shares;
    for (int i = part.vertex_begin; i < part.vertex_end; ++i) shares.push_back(influences[surface.slice[i]]);
    glb.add_influences(primitive, shares);
    tinygltf::Node node;
    node.name = "muscle/" + muscle.name;
    node.mesh = static_cast<int>(glb.model().meshes.size()) - 1;
    node.skin = 0;
    node.extras = gltf::muscle_extras(muscle, glb.keep_text(gltf::strips_text(muscle)));
    glb.add_node(std::move(node));
  }
}

void finish(GlbBuilder& glb, const Body& body, AtomicFile& out) {
  Object ecorche{{"schema", Value(kCharacterSchema)}, {"body", gltf::body_extras(body)}};
  Object extras;
  extras["ecorche"] = Value(std::move(ecorche));
  glb.scene().extras = Value(std::move(extras));
  glb.scene().name = body.name.empty() ? "body" : body.name;
  if (!glb.write(out.stream())) out.fail();
  out.commit();
}

void check(const Character& character, const Binding& binding, const Motion* motion) {
  validate(character.anatomy);
  const size_t vertices = static_cast<size_t>(character.body.skin.V.rows());
  if (binding.joint_weights.size() != vertices || binding.anchors.size() != vertices)
    throw std::invalid_argument(fmt::format("write_character: binding of {} vertices for a skin of {}", binding.joint_weights.size(), vertices));
  if (character.anatomy.skeleton.joints.size() > 65535) throw LimitError("more than 65535 joints cannot be written as glTF");
  if (!motion) return;
  if (motion->frames.empty() || !(motion->fps > 0)) throw std::invalid_argument("write_character: a motion without frames or rate");
  for (const Pose& pose : motion->frames)
    if (pose.rotations.size() != character.anatomy.skeleton.joints.size())
      throw std::invalid_argument("write_character: the motion belongs to another skeleton");
}

}  // namespace

void write_character(const std::filesystem::path& file, const Character& character, const Binding& binding, const Motion* motion) {
  check(character, binding, motion);
  AtomicFile out(file);  // before the work, so that a bad place is told at once
  GlbBuilder glb;
  gltf::add_joints(glb, character.anatomy.skeleton);
  add_skin(glb, character, binding);
  add_bones(glb, character.anatomy);
  add_muscles(glb, character.anatomy);
  if (motion) gltf::add_motion(glb, character.anatomy.skeleton, *motion, "motion");
  finish(glb, character.body, out);
}

void write_body(const std::filesystem::path& file, const Body& body) {
  AtomicFile out(file);
  GlbBuilder glb;
  glb.add_mesh("skin", body.skin, glb.add_material("skin", kSkinColour, 0.6));
  tinygltf::Node node;
  node.name = "skin";
  node.mesh = 0;
  glb.add_node(std::move(node));
  finish(glb, body, out);
}

}  // namespace ecorche
