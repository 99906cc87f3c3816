// A character ready to move, and what its motion is judged by. Shared by the verbs animate, render, view, bench and demo.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/body_package.h"
#include "anatomy/pose_anatomy.h"
#include "anatomy/subdivide.h"
#include "app/verb.h"
#include "skinning/activation.h"
#include "skinning/character_io.h"
#include "skinning/deform.h"
#include "skinning/quality.h"
#include "skinning/retarget.h"
#include "skinning/skin_methods.h"

namespace ecorche {

struct Actor {
  Character character;
  PosingTable table;
  Binding binding;
  SkinMethod method = SkinMethod::ecorche;   // what play() moves the skin by
  std::shared_ptr<const RivalSkins> rivals;  // set for every other method
};

// What a refined skin comes from: it is bound by way of its base mesh.
struct BaseSkin {
  TriMesh mesh;
  Refinement refinement;
};

// The base mesh of a skin that is the body package's fine one in any shape; none for other skins or without the package.
std::optional<BaseSkin> find_base(const TriMesh& skin);

// Builds the tables and binds the skin. Timings: posing_table, anchoring. `base`: that of a refined skin, when it is at hand.
Actor make_actor(Character character, Report& report, const BaseSkin* base = nullptr);

struct ActorFrame {
  PosedAnatomy posed;
  SkinFrame skin;
  RivalScratch scratch;
};

// Makes play() move the skin by another method: "lbs", "dqs", "deltamush", "paper", "anchors" (ours, but it does not settle) or "ecorche". Reads the body package for all but the
// last one. Throws UsageError for another name, InputError without the package, UnfitError for a skin of another topology.
void choose_skin(Actor& actor, const std::string& method);

// One frame: kinematics, muscles, skin with normals. Reuses the memory of `frame`. `activation` as in pose_anatomy; `flesh` that lags
// (FleshState::seen) counts for "ecorche" alone.
void play(const Actor& actor, const Pose& pose, ActorFrame& frame, std::span<const double> activation = {}, std::span<const float> flesh = {});

// A body of ours (.glb), or a bare skin in the base mesh's topology and vertex order. What was found out about the
// latter's units and axes goes to the report under `body`. Throws InputError or UnfitError.
Body open_body(const std::filesystem::path& file, const BodyPackage& package, const Common& common, Report& report, std::optional<double> unit = {});

// Reads a BVH file and retargets it to the character. What was assumed goes to the report under `motion`, warnings to people too.
Motion open_motion(const std::filesystem::path& file, const Character& character, const RetargetOptions& options, const Common& common,
                   Report& report);

// What a motion did to muscles and skin, over all frames.
struct MotionQuality {
  int frames = 0;
  double volume_drift_max = 0;        // largest relative change of any muscle's volume
  std::string volume_drift_muscle;    // whose
  double flipped_share_max = 0;       // of the skin's triangles, worst frame
  double flipped_share_mean = 0;
  int flipped_worst_frame = 0;
  double stretch_p99_max = 0;
  int not_finite = 0;
  int strips_clamped_max = 0;
  // The same poses with linear blend skinning and the body package's own weights; absent for skins of another topology.
  std::optional<double> linear_flipped_share_max;
  std::optional<double> linear_flipped_share_mean;
  std::optional<double> linear_stretch_p99_max;
};

// The same poses by every way to move a skin that there is: flipped triangles and stretch, worst frame, under
// `skins.<method>`. Without the body package or with a skin of another topology only our own is measured.
void compare_skins(const Actor& actor, const Motion& motion, Report& report);

MotionQuality survey_motion(const Actor& actor, const Motion& motion, const BodyPackage* package, const Activations& activations = {});

// Accuracy targets that a motion misses, with the figures; empty when it meets them all. Exit code 8 rests on it.
std::vector<std::string> missed_targets(const MotionQuality& quality);

// Under `prefix`: stable names, see docs/report.md.
void report_quality(const MotionQuality& quality, const std::string& prefix, Report& report);

}  // namespace ecorche
