// Draw list of a character: visible layers, their colours and opacities.
//
// SceneModel holds everything that is constant over the frames and is made once per character;
// update_scene() writes one frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/eyes.h"
#include "anatomy/base_mesh/tissue_look.h"
#include "anatomy/muscles/fascia_again.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/skin_frame.h"
#include "viewer/draw_list.h"

namespace ecorche {

// Part numbers of the id buffer.
inline constexpr std::uint32_t kSkinPart = 1;
inline constexpr std::uint32_t kEyesPart = 2;  // can be hidden, not picked
inline constexpr std::uint32_t kFirstBonePart = 1000;
inline constexpr std::uint32_t kFirstMusclePart = 100000;
inline constexpr std::uint32_t kFirstFasciaPart = 200000;
inline constexpr std::uint32_t kFirstRoomPart = 300000;  // of kOrganRooms; seen in cuts alone

struct Part {
  enum class Kind { none, skin, eyes, bone, muscle, fascia, room };
  Kind kind = Kind::none;
  int index = -1;  // of the bone, muscle, sheet of fascia or room of organs
};
Part part_of(std::uint32_t number);

struct SceneOptions {
  MuscleSurfaceOptions surface;
  double fascicle = 0.0035;   // m, width of the fibre lines on muscles
  std::vector<Eyeball> eyes;  // seen with the skin as well as without it
  std::uint64_t key = 1;      // unique per character while several are drawn with one renderer
  FasciaBefore before{};      // whose sheets are taken over where they are the same
};

// A number that was not returned before.
std::uint64_t fresh_scene_key();

// A part's triangles in a mesh.
struct PartFaces {
  std::uint32_t part = 0;
  std::size_t begin = 0, end = 0;
};

struct SceneModel {
  std::uint64_t number = 0;  // no other model has it
  MuscleSurface surface;
  FasciaSurface fascia_surface;
  DrawMesh skin, muscles, fascia;  // at rest; fascia is seen where muscles are
  std::vector<DrawMesh> bones;     // world, at rest
  std::vector<DrawMesh> eyes;      // world, at rest
  std::vector<int> eye_joints;     // #eyes
  std::vector<int> bone_joints;    // #bones
  // #bones, 1: casts a shadow also where muscles are drawn (muscles enclose the other bones)
  std::vector<char> bone_shadows;
  std::vector<Vec3> joint_rest;  // #joints, world
  std::vector<SliceRange> strips;
  std::vector<double> rest_lengths;  // #strips, m
  int muscle_count = 0;
  // Triangles of parts in the meshes, in the order of parts.
  std::vector<PartFaces> muscle_faces, fascia_faces;
  // Of quick pictures, with the same parts over fewer vertices (coarse_scene.h); null: this one.
  std::shared_ptr<const SceneModel> coarse;
  // In such a model: by vertex of the mesh, the vertex of the skin's frame that it is; empty: the
  // same.
  std::vector<std::uint32_t> skin_from;
  // In such a model: all bones are the mesh bones[0], a vertex of it carried by its joint here.
  std::vector<int> together_joints;
  std::vector<PartFaces> bone_faces;
};

// Model of `anatomy`; without a skin layer if `skin` has no vertices.
SceneModel make_scene_model(const Anatomy& anatomy, const TriMesh& skin,
                            const SceneOptions& options = {});

// The model's sheets of fascia, and their mesh but for fibres.
void set_fascia(FasciaSurface surface, SceneModel& model);

enum class MuscleColors {
  flesh,       // towards orange when shortened, towards violet when stretched
  shortening,  // yellow shortened, light grey at rest, blue stretched; safe for colour-blind eyes
  activation   // pale relaxed, orange, dark red at full effort; ever darker
};

// The colour of a belly in sRGB. activity: as of muscle_shortening, -1 .. 1; of activation, 0 .. 1.
Vec3f muscle_color(MuscleColors colors, float activity);

// One figure of the character; several stand side by side by their offsets.
struct Look {
  Vec3f offset = Vec3f::Zero();  // m
  float skin = 1;                // opacities 0..1
  float skin_edge = 0;           // additional opacity at grazing angles (glass skin)
  // share of the skin that has dissolved, 0..1, patch by patch from the feet
  float skin_dissolved = 0;
  float muscles = 1;
  float bones = 1;

  bool operator==(const Look&) const = default;
};

struct Appearance {
  std::vector<Look> looks{Look{}};
  MuscleColors muscle_colors = MuscleColors::flesh;
  Vec3f skin_color = kSkinLook.color;
  Vec3f bone_color = kBoneLook.color;
  std::uint32_t selected = 0;           // part in the colour of the selection
  std::vector<std::uint32_t> hidden{};  // parts that are not drawn, ascending
  std::vector<std::uint32_t> marked{};  // muscles in the colour of what has changed, ascending

  bool operator==(const Appearance&) const = default;
};

// A muscle's colours with these looks, sRGB.
struct MuscleTones {
  Vec3f belly, tendon;
};
MuscleTones muscle_tones(const Appearance& appearance, int muscle, float activity);

// One frame: the draw list and its workspace.
struct Scene {
  DrawList list;
  PointsF muscle_positions, muscle_normals, fascia_positions, fascia_normals;
  // parts without triangles in `list` that others of their mesh have
  std::vector<std::uint32_t> parts_left_away;
};

// Change of each muscle's length from rest: +1 shortened by 20 % or more, -1 stretched by 20 % or
// more. #muscles
void muscle_shortening(const SceneModel& model, const PosedAnatomy& posed, std::vector<float>& out);

// Sets meshes, items and focus of `scene.list`; camera, light and ground stay as they are. Give the
// same scene again: nothing is allocated from the second frame on, unless other parts are hidden.
// `revision` differs from frame to frame, also between scenes that one renderer draws in turn.
// `skin` null: the skin as at rest. `activity` (#muscles, -1..1) colours the muscles; empty: all 0.
// Throws std::invalid_argument if `posed`, `skin` or `activity` belongs to another character.
void update_scene(const SceneModel& model, const PosedAnatomy& posed, const SkinFrame* skin,
                  std::span<const float> activity, const Appearance& appearance,
                  std::uint64_t revision, Scene& scene);

}  // namespace ecorche
