// Quality of a character's anatomy: containment, overlap and voids at rest, the same and more at
// the joints' limits, muscle by muscle.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/muscles/torn_muscles.h"
#include "morph/fit/shown_through.h"
#include "morph/template/template.h"
#include "skinning/character/character_model.h"
#include "skinning/checks/bone_overlap.h"
#include "skinning/checks/fascia_check.h"
#include "skinning/motion/limit_poses.h"

namespace ecorche::inline v1 {

// Told before the first of `total` steps (done = 0), and once after each (done > 0), from any
// thread; may be empty.
using CheckProgress = std::function<void(int done, int total)>;

struct CheckOptions {
  double rest_spacing = 0.0015;  // m, between the lines that volumes are measured along
  double pose_spacing = 0.0025;
  double sweep_step = 0.017453292519943295;  // rad; not above 0: no sweeps
  // What the muscles were made from, in its own body. Null: nothing is known of muscles torn at
  // rest, nor of what shows through.
  const Template* reference = nullptr;
  const LayerOrder* layers = nullptr;  // of it, where it is at hand; made anew otherwise
};

// Of one muscle. Shares are of its volume, or of the points of its surface.
struct MuscleCheck {
  double volume = 0;                   // of its surface, m^3
  int points = 0, points_outside = 0;  // at rest
  double overlap = 0, in_bone = 0;     // shares at rest
  MuscleTear tear;                     // at rest, against the reference
  double slits = 0;                    // m^2 open beside it at rest
  double shown = 0;                    // m^2 by which it shows through what covers it, at rest
  int neighbour = -1;                  // the muscle it shares most with, -1 none
  double neighbour_volume = 0;         // m^3
  double posed_outside = 0, posed_overlap = 0, posed_in_bone = 0;  // shares, each in its worst pose
  int outside_pose = -1, overlap_pose = -1;
  double drift = 0;  // of its strips' volume, largest over poses and sweeps
  double jump = 0;  // m, a path's length from one degree to the next but one against going steadily
  int jump_joint = -1, jump_axis = 0;
  double jump_angle = 0;  // rad
  // m, by which a section goes farther than at rest and than its neighbours along the muscle, in
  // its worst pose
  double spike = 0;
  int spike_pose = -1;
  // How whole it stays (wholeness.h), each in its worst pose: share of its edges' length that is
  // creased, needles, m^2 of daylight and buried, stretch, kink of tendons in rad/m, m of ends off
  // bones.
  double creased = 0, daylight = 0, buried = 0, stretch = 1, kink = 0, end_off = 0;
  int needles = 0;
  int creased_pose = -1, daylight_pose = -1, buried_pose = -1, stretch_pose = -1, kink_pose = -1,
      needles_pose = -1, end_off_pose = -1;
  // m, of its ends on bones, the farthest from the bones of the joint that carries it
  double end_distance = 0;
};

// Of one bone: the points of it that leave the skin, and how far, each in its worst pose.
struct BoneCheck {
  int posed_outside = 0;
  double posed_depth = 0;  // m
  int outside_pose = -1, depth_pose = -1;
};

struct PoseCheck {
  std::string name;
  int muscle_points_outside = 0;
  FasciaFigures fascia;
  int bone_points_outside = 0;
  double bone_depth = 0;  // m, of the bones' points outside the skin, the farthest
  double overlap_share = 0, bone_share = 0;
  int spikes = 0;  // sections that stick out by more than 20 mm
  // How whole the muscles are (wholeness.h): over all of them; stretch and kink of the worst.
  double creased_share = 0;
  int needles = 0;
  double daylight = 0, buried = 0;  // m^2
  double stretch = 1;
  double kink = 0;     // rad/m
  int loose_ends = 0;  // muscles with an end off its bone by more than 10 mm
};

struct AnatomyCheck {
  int bone_points = 0, bone_points_outside = 0;
  int muscle_points = 0, muscle_points_outside = 0;
  FasciaFigures fascia;
  double furthest_outside = 0;  // m, of muscles at rest
  // sum of the muscles' volumes over their union, less 1
  double overlap_share = 0;
  double bone_share = 0;  // of the muscles' volume in bones
  // the largest share of one muscle's volume that lies in bones, and whose
  double pierced_share = 0;
  std::string pierced_muscle;
  BoneOverlap bone_overlap;           // at rest
  bool compared = false;              // with the reference
  int torn = 0, needles_at_rest = 0;  // muscles, points (torn_muscles.h)
  std::string torn_muscle;            // the worst
  // of the area under the fat layer of limbs and trunk, what muscle, bone or fascia fills
  // (layer_gaps.h); NaN: not known
  double filled_share = 0;
  double gap_median = 0, gap_p95 = 0;  // m, from there to one of these
  // m^2 of that area that is open between muscles or bones beside it (slits.h), and the muscle that
  // most of it is beside; NaN: not known
  double slits = 0;
  std::string slit_muscle;
  // m^2 of that area where a muscle or bone is met first that others cover in the reference, and
  // of it the bone or deep muscle that shows most (shown_through.h); NaN: not known
  double shown = std::numeric_limits<double>::quiet_NaN(), shown_by_one = 0;
  std::string shown_most;
  std::vector<PoseCheck> poses;
  double posed_outside_share = 0;  // of muscle points, mean over the poses
  double posed_outside_worst = 0;
  double posed_fascia_outside = 0, posed_fascia_pierced = 0;  // of fascia's points, likewise
  int posed_bone_points_outside = 0;                          // of the worst pose
  double posed_overlap_mean = 0, posed_overlap_worst = 0, posed_bone_share_worst = 0;
  double posed_spikes = 0,
         posed_spike_max = 0;  // sections that stick out by more than 20 mm, mean over the poses; m
  // How whole the muscles stay: means over the poses, and of the worst pose.
  double posed_creased_mean = 0, posed_creased_worst = 0;  // shares
  double posed_needles = 0;
  double posed_daylight = 0, posed_buried = 0;       // m^2
  double posed_stretch_max = 1, posed_kink_max = 0;  // rad/m
  double posed_loose_ends = 0;                       // muscles
  bool swept = false;  // joints were swept; otherwise nothing is known of jumps
  double drift_max = 0, jump_max = 0;
  int paths_that_jump = 0;  // muscles by more than 1 mm
  double end_distance_median = 0, end_distance_max = 0;
  int ends = 0, loose_ends = 0;      // farther than 10 mm
  long long open_columns = 0;        // places where a mesh is not closed and so was not measured
  std::vector<MuscleCheck> muscles;  // #muscles
  std::vector<BoneCheck> bones;      // #bones
};

// `package`: closes the skin's mouth and eyes and knows its parts, where the skin has its topology.
// The same figures at any number of threads.
AnatomyCheck check_anatomy(const CharacterModel& model, const BodyPackage& package,
                           const std::vector<LimitPose>& poses, const CheckOptions& options,
                           const CheckProgress& progress = {});

}  // namespace ecorche::inline v1
