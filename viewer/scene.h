// Values -> draw list: which layers are seen, in which colours. Draws nothing and owns nothing.
//
// What stays the same from frame to frame is made once a character (SceneModel); update_scene
// writes one frame of it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/eyes.h"
#include "anatomy/base_mesh/tissue_look.h"
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

struct Part {
  enum class Kind { none, skin, eyes, bone, muscle };
  Kind kind = Kind::none;
  int index = -1;  // of the bone or muscle
};
Part part_of(std::uint32_t number);

struct SceneOptions {
  MuscleSurfaceOptions surface;
  double fascicle = 0.0035;   // m, width of the fibre lines on muscles
  std::vector<Eyeball> eyes;  // seen with the skin as well as without it
  std::uint64_t key = 1;  // a character's number; another one while two are drawn with one renderer
};

// Another number each time.
std::uint64_t fresh_scene_key();

struct SceneModel {
  MuscleSurface surface;
  DrawMesh skin, muscles;        // at rest
  std::vector<DrawMesh> bones;   // world, at rest
  std::vector<DrawMesh> eyes;    // world, at rest
  std::vector<int> eye_joints;   // #eyes
  std::vector<int> bone_joints;  // #bones
  // #bones, 1: casts a shadow of its own though muscles are there (the others lie within them)
  std::vector<char> bone_shadows;
  std::vector<Vec3> joint_rest;  // #joints, world
  std::vector<SliceRange> strips;
  std::vector<double> rest_lengths;  // #strips, m
  int muscle_count = 0;
};

// Bones and muscles of `anatomy`; a `skin` without vertices leaves that layer away.
SceneModel make_scene_model(const Anatomy& anatomy, const TriMesh& skin,
                            const SceneOptions& options = {});

enum class MuscleColors {
  flesh,      // towards orange while it shortens, towards violet while it is stretched
  shortening  // yellow shortened, light grey at rest, blue stretched; safe for colour-blind eyes
};

// The colour of a belly in sRGB. activity: as of muscle_shortening, -1 .. 1.
Vec3f muscle_color(MuscleColors colors, float activity);

// One appearance of the character; several stand side by side by their offsets.
struct Look {
  Vec3f offset = Vec3f::Zero();  // m
  float skin = 1;                // opacities 0..1
  float skin_edge = 0;           // further opacity where the skin turns away (glass skin)
  float skin_dissolved = 0;  // share of the skin that is gone, 0..1, patch by patch from the feet
  float muscles = 1;
  float bones = 1;
};

struct Appearance {
  std::vector<Look> looks{Look{}};
  MuscleColors muscle_colors = MuscleColors::flesh;
  Vec3f skin_color = kSkinLook.color;
  Vec3f bone_color = kBoneLook.color;
  std::uint32_t selected = 0;           // part that is shown in another colour
  std::vector<std::uint32_t> hidden{};  // parts that are left away, rising
};

// One frame: the draw list and the memory it is made in.
struct Scene {
  DrawList list;
  PointsF muscle_positions, muscle_normals;
  std::vector<std::uint32_t> muscles_left_away;  // parts that the muscles' triangles in `list` lack
};

// How far each muscle is from its rest length: +1 shortened by 20 % or more, -1 stretched by as
// much. #muscles
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
