// A motion file's movement on our skeleton.
//
// What each joint of the file stands for is found from names, tree and geometry; units, up axis and
// facing from the figure's own size and posture, never from the header. Rest poses are aligned bone
// by bone, so that T-, A- and arms-down files give the same movement; a file whose rest pose is
// already ours (the body package's rigs) is taken over rotation for rotation, and place for place,
// with nothing planted, if its rig sits in this very body (skinning/retarget/matching_rig.h). The
// trunk's and neck's turning is spread over our vertebrae by how far each can move, the shoulder
// girdle follows the arm (de Groot & Brand 2001, 10.1016/S0268-0033(01)00065-3), twist of the hand
// goes to the radius. The root's path is scaled by leg length; planted feet are held by two-bone
// inverse kinematics (after Kovar et al. 2002, 10.1145/545261.545277), joints are brought inside
// their limits with hands and feet as near to their places as can be, limbs are kept from passing
// through the body, and flights keep to gravity.
//
// Results live in the world frame with the ground at y = 0.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/collision_proxies.h"
#include "skinning/motion_files/bvh_io.h"

namespace ecorche {

struct RetargetOptions {
  // The file's joint -> our joint, before any guess of ours; an empty name leaves the joint out.
  // See read_joint_map().
  std::map<std::string, std::string> joint_map;
  // 'x', 'y' or 'z' of the file, instead of the guess; refused where the figure is plainly upright
  // along another axis.
  std::optional<char> up;
  // world y of the soles in the skeleton's rest pose; from the toe joints if absent
  std::optional<double> sole_height;
  // Absent: unless the file's rig sits in this very body (skinning/retarget/matching_rig.h), since
  // such a file is where its author has put it.
  std::optional<bool> plant_feet;
  std::optional<bool> keep_flights;  // centre of mass in free flight on a parabola of 9.81 m/s^2
  bool shoulder_rhythm = true;
  // Bring joints back inside their limits (skinning/constraints/joint_limits.h); otherwise those
  // beyond are only reported. Absent: unless the file's rest pose is ours, since such a file is
  // taken over as it is.
  std::optional<bool> clamp_limits;
  // Where joints are brought back, limbs are also kept from passing through each other, the trunk
  // and the head (skinning/constraints/self_collision.h), if the body that is moved is told.
  bool keep_apart = true;
  std::optional<BodyRounds> rounds;
};

struct JointMatch {
  std::string source;  // the file's joint
  // "shoulder_l", or "spine" / "neck" for joints whose turning is spread, or "" where it is not
  // used
  std::string ours;
  std::string how;  // "map", "name", "tree"
};

struct Contact {
  Side side = Side::left;
  bool heel = false;       // else the ball of the foot
  int begin = 0, end = 0;  // frames [begin, end)
  double slide = 0;        // largest horizontal distance of the planted point from its place, m
};

struct Flight {
  int begin = 0, end = 0;     // frames [begin, end)
  double gravity_before = 0;  // of the scaled source, m/s^2; 9.81 afterwards
};

struct LimitBreak {
  std::string joint;
  int frames = 0;  // how many frames are outside
  int worst_frame = 0;
  double worst = 0;  // rad beyond the limit
};

// Limbs that passed through one another, the trunk or the head before they were kept apart.
struct MeetingBreak {
  std::string what;  // "leg and leg", ...
  int frames = 0;
  double worst = 0;  // m beyond what flesh gives
  int worst_frame = 0;
  double left = 0;  // m, of the motion as it is
};

// By how much keeping the limits moved what a limb ends in, over all frames, m. Against where the
// file has it; a foot's ball while it stands also against where it was planted.
struct EndMove {
  std::string end;  // "head", "wrist_l", "subtalar_l", ...
  double mean = 0, most = 0;
  int worst_frame = 0;
};

struct RetargetReport {
  // guessed from leg length, for people: paths are scaled by leg length. "cm", "m", "inch", "CMU
  // unit", ... or "unknown"
  std::string unit;
  double metres_per_unit = 1;
  char up = 'y';           // of the file
  std::string facing;      // of the rest pose, file axes: "+z"
  double source_leg = 0;   // hip to ankle along the leg, file units
  double scale = 1;        // file units -> metres of our figure
  bool same_rest = false;  // taken over rotation for rotation
  bool own_rig = false;    // and place for place: the rig sits in this very body
  // pose the rest alignment starts from: -1 the file's rest pose, else a frame near standing
  int reference_frame = -1;
  int dropped_frames = 0;           // at the start: a marker pose
  std::vector<JointMatch> matches;  // one a joint of the file
  std::vector<std::string> warnings;
  std::vector<Contact> contacts;
  std::vector<Flight> flights;
  double slide_p95 = 0;                  // of the contacts' slides, m
  double penetration = 0;                // deepest point of a sole below the ground, m
  std::vector<LimitBreak> limit_breaks;  // of the motion as it is
  std::vector<LimitBreak>
      limited;  // what was beyond before joints were brought back; empty where none were
  std::vector<EndMove> ends_moved;
  std::vector<MeetingBreak> parted;  // empty where none met
};

// Throws UnfitError that lists what could not be matched (hips, chest, head, both arms, both legs
// are needed) with the table so far, or names the first frame in which the figure is more than 10
// km away. Precondition (std::invalid_argument): `ours` has the joints of data/joints.csv.
Motion retarget(const BvhMotion& source, const Skeleton& ours, const RetargetOptions& options,
                RetargetReport& report);

// The matches as a table for people, one joint a line.
std::string format_matches(const RetargetReport& report);

// Lines "file joint = our joint", '#' comments. Throws InputError with file and line, also for a
// map that names no joint.
std::map<std::string, std::string> read_joint_map(const std::filesystem::path& file);
std::map<std::string, std::string> parse_joint_map(std::string_view text, const std::string& name);

}  // namespace ecorche
