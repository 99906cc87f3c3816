// A motion file's movement on our skeleton.
//
// Joints are mapped by names, tree and geometry; units, up axis and facing are measured on the
// figure's own size and posture, never taken from the header. Rest poses are aligned bone by bone,
// so that T-, A- and arms-down files give the same movement. A file whose rest pose is already ours
// (the body package's rigs) is taken over rotation for rotation; if its rig also matches this very
// body (matching_rig.h), it is taken over position for position too, without foot planting. The
// rotation of trunk and neck is spread over our vertebrae in proportion to their ranges of motion,
// the shoulder girdle follows the arm (de Groot & Brand 2001, 10.1016/S0268-0033(01)00065-3), the
// twist of the hand goes to the radius. The root's path is scaled by leg length. Planted feet are
// held by two-bone inverse kinematics (after Kovar et al. 2002, 10.1145/545261.545277), joint
// limits are enforced with hands and feet as near to their positions as possible, self-collision is
// resolved, and flights are made ballistic.
//
// Results are in the world frame with the ground at y = 0.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/collision_proxies.h"
#include "skinning/constraints/ground_points.h"
#include "skinning/constraints/motion_report.h"
#include "skinning/filters/motion_filters.h"
#include "skinning/motion_files/motion_clip.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/recording_faults.h"

namespace ecorche::inline v1 {

struct RetargetOptions {
  // The file's joint -> our joint, before any guess of ours; an empty name leaves the joint out.
  // See joint_map_file.h.
  std::map<std::string, std::string> joint_map;
  // 'x', 'y' or 'z' of the file, instead of the guess; refused where the figure is plainly upright
  // along another axis.
  std::optional<char> up;
  // world y of the soles in the skeleton's rest pose; from the toe joints if absent
  std::optional<double> sole_height;
  // Foot planting. Absent: unless the file's rig matches this very body (matching_rig.h), since
  // its author has placed the feet; also then where markers tell it.
  std::optional<bool> plant_feet;
  // The centre of mass in free flight on a parabola of 9.81 m/s^2. Absent: as plant_feet.
  std::optional<bool> ballistic_flights;
  bool shoulder_rhythm = true;
  // Applied between limits and planting. With filters that move standing feet these are planted
  // also where a matching rig would leave them.
  std::vector<MotionFilter> filters;
  // Enforce the joint limits (joint_limits.h); otherwise joints beyond them are only reported.
  // Absent: unless the file's rest pose is ours by its author's choice, not by fitted markers.
  std::optional<bool> clamp_limits;
  // Where limits are enforced and `proxies` are given, also resolve self-collision
  // (self_collision.h).
  bool avoid_self_collision = true;
  std::optional<CollisionProxies> proxies;
  // Where limits are enforced and feet planted, other parts stay out of the ground, too
  // (keep_off_ground.h).
  std::optional<GroundPoints> ground;
};

struct RetargetReport {
  // guessed from leg length, for people: paths are scaled by leg length. "cm", "m", "inch", "CMU
  // unit", ... or "unknown"
  std::string unit;
  double metres_per_unit = 1;
  char up = 'y';                 // of the file
  std::string facing;            // of the rest pose, file axes: "+z"
  double source_leg = 0;         // hip to ankle along the leg, file units
  double scale = 1;              // file units -> metres of our figure
  Mat3 turn = Mat3::Identity();  // file axes -> ours
  bool same_rest = false;        // taken over rotation for rotation
  bool matching_rig = false;     // and position for position
  // pose the rest alignment starts from: -1 the file's rest pose, else a frame near standing
  int reference_frame = -1;
  int dropped_frames = 0;           // at the start: a calibration pose
  std::vector<JointMatch> matches;  // one a joint of the file
  std::vector<std::string> warnings;
  std::vector<RecordingFault> faults;  // frames of the file
  std::vector<Contact> contacts;
  std::vector<Flight> flights;
  double slide_p95 = 0;                  // of the contacts' slides, m
  double penetration = 0;                // deepest point of a sole below the ground, m
  std::vector<LimitBreak> limit_breaks;  // of the motion as it is
  std::vector<LimitBreak>
      limit_breaks_before;  // before limits were enforced; empty if they were not
  std::vector<EndMove> ends_moved;
  std::vector<Penetration> self_collisions;  // before and after their correction; empty if none
};

// Measures what `options` leave open of a skin at rest, #V x 3: the height of the soles, the limbs'
// proxies where they are to be kept apart, the points that may come down on the ground.
// Precondition (std::invalid_argument): the skeleton has our joints.
void measure_body(const Skeleton& ours, const Points& skin, RetargetOptions& options);

// Throws UnfitError that lists the parts that could not be mapped (hips, chest, head, both arms,
// both legs are needed) with the table so far, or names the first frame in which the figure is more
// than 10 km away. Precondition (std::invalid_argument): `ours` has the joints of data/joints.csv.
Motion retarget(const MotionClip& source, const Skeleton& ours, const RetargetOptions& options,
                RetargetReport& report);

// A motion that is on our skeleton already, place for place, as own_motion.h finds it: limits,
// planted feet and flights where the options ask for them, and the report's figures of all three.
// `name`: of the file. Throws as retarget() for a figure that is too far away.
void constrain_own_motion(const std::string& name, const Skeleton& ours,
                          const RetargetOptions& options, Motion& motion, RetargetReport& report);

}  // namespace ecorche::inline v1
