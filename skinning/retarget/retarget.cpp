#include "skinning/retarget/retarget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "anatomy/errors.h"
#include "anatomy/joint_angles.h"
#include "skinning/constraints/ballistic_flight.h"
#include "skinning/constraints/belt.h"
#include "skinning/constraints/contact_snaps.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/ground_lift.h"
#include "skinning/constraints/keep_off_ground.h"
#include "skinning/constraints/leg_ik.h"
#include "skinning/constraints/measure_feet.h"
#include "skinning/constraints/motion_limits.h"
#include "skinning/constraints/plant_feet.h"
#include "skinning/constraints/steady_limbs.h"
#include "skinning/filters/loop_motion.h"
#include "skinning/filters/motion_filters.h"
#include "skinning/filters/slope_ground.h"
#include "skinning/filters/warp_time.h"
#include "skinning/motion/require_joint.h"
#include "skinning/retarget/handedness.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/lost_frames.h"
#include "skinning/retarget/matching_rig.h"
#include "skinning/retarget/pose_transfer.h"
#include "skinning/retarget/refine_frames.h"
#include "skinning/retarget/rest_alignment.h"

namespace ecorche::inline v1 {
namespace {
constexpr double kLimitTolerance = 0.5 * kDegree;
// Of limbs after foot planting.
constexpr LimbTolerance kPlanted{2e-3, 4 * kDegree, true};
// Where the ground is not y = 0.
constexpr LimbTolerance kOnSlope{2e-3, 4 * kDegree, false};

// s to either side of a snap in which a foot is let go, by round: little, since another rate of
// frames may just not show the snap; at last altogether.
constexpr std::array<double, 5> kLetGo{0.04, 0.08, 0.15, HUGE_VAL, HUGE_VAL};
constexpr int kGroundPasses = 4;  // what is still in the ground before the last lifts the figure

// Does the figure leap from a frame to the next, as no body can?
bool leaps(const Motion& motion, std::size_t frame) {
  constexpr double kFastest = 30, kShortest = 0.5;  // m/s, m
  const double way = (motion.frames[frame + 1].root - motion.frames[frame].root).norm();
  return way >= kShortest && way * motion.fps >= kFastest;
}

// Number of frames at the start that belong to a calibration pose. Some files begin with a T-pose,
// or move out of one in a few frames: those five times as fast as the movement that follows that
// together rotate some joint by more than 30 deg, or those before a leap of the figure to another
// place; and the next ones in which these joints settle, likewise five times as fast as later.
int calibration_frames(const Motion& motion) {
  const std::vector<Pose>& frames = motion.frames;
  constexpr size_t kAtMost = 6, kLookAhead = 30;
  constexpr double kSettling = 0.05;  // s
  if (frames.size() < 2 * kAtMost + 1) return 0;
  const size_t steps = std::min(frames.size() - 1, kAtMost + kLookAhead);
  const auto step = [&](size_t f, size_t j) {
    return frames[f].rotations[j].angularDistance(frames[f + 1].rotations[j]);
  };
  const auto usual = [&](size_t from, const auto& speed) {
    std::vector<double> later;
    for (size_t f = from; f < steps; ++f) later.push_back(speed(f));
    std::nth_element(later.begin(), later.begin() + std::ptrdiff_t(later.size() / 2), later.end());
    return later[later.size() / 2];
  };
  const auto fastest = [&](size_t f) {
    double most = 0;
    for (size_t j = 0; j < frames[f].rotations.size(); ++j) most = std::max(most, step(f, j));
    return most;
  };
  const double fast = 5 * usual(kAtMost, fastest);
  size_t count = 0;
  double total = 0;
  for (size_t f = 0; f < kAtMost; ++f)
    if (leaps(motion, f)) count = f + 1;
  const bool elsewhere = count > 0;
  while (count < (elsewhere ? 2 : 1) * kAtMost && fastest(count) > fast) total += fastest(count++);
  if (!elsewhere && (count == kAtMost || total <= 30 * kDegree)) return 0;
  size_t settled = count;
  for (size_t j = 0; j < frames[0].rotations.size(); ++j) {
    double turned = 0;
    for (size_t f = 0; f < count; ++f) turned += step(f, j);
    if (turned <= 30 * kDegree) continue;
    const size_t settling = size_t(std::lround(kSettling * motion.fps)),
                 last = std::min(count + std::clamp(settling, size_t(1), kAtMost), steps);
    const double slow =
        std::max(0.5 * kDegree, 5 * usual(last - 1, [&](size_t f) { return step(f, j); }));
    for (size_t f = settled; f < last; ++f)
      if (step(f, j) > slow) settled = f + 1;
  }
  return int(settled);
}

// Makes quaternions continuous: of q and -q, which are the same rotation, the one nearer to the
// frame before.
void unwrap(std::vector<Pose>& frames) {
  for (size_t f = 1; f < frames.size(); ++f)
    for (size_t j = 0; j < frames[f].rotations.size(); ++j)
      if (frames[f].rotations[j].dot(frames[f - 1].rotations[j]) < 0)
        frames[f].rotations[j].coeffs() *= -1;
}

// Shifts that keep the file's stance width, whose hips may be wider or narrower than ours.
// `hips`: ours from the root at rest, left and right.
LimbShifts stance_shifts(const PoseTransfer& transfer, const std::vector<Transform>& X,
                         const std::array<Vec3, 2>& hips, const Pose& pose) {
  constexpr double kMost = 0.04;  // m
  LimbShifts out;
  for (size_t s = 0; s < 2; ++s) {
    const Side side = s == 0 ? Side::left : Side::right;
    const Vec3 across = pose.rotations[0] * Vec3::UnitX(),
               here = pose.root + pose.rotations[0] * hips[s];
    const double wider = std::clamp((transfer.file_hip(X, side) - here).dot(across), -kMost, kMost);
    out[s] = {0.5 * wider * across, wider * across};
  }
  return out;
}

// Heel and ball of our foot placed at the file's ankle. `rest`: our ankle at rest.
void add_foot(const PoseTransfer& transfer, const std::vector<Transform>& X, Side side,
              const FootShape& shape, const Vec3& rest, FootPaths& foot) {
  const Vec3 ankle = transfer.file_ankle(X, side);
  const Mat3 R = transfer.file_ankle_rotation(X, side);
  foot.heel.push_back(ankle + R * (shape.heel - rest));
  foot.ball.push_back(ankle + R * (shape.ball - rest));
}

std::vector<LimitBreak> limit_breaks(const Skeleton& skeleton, const Motion& motion) {
  std::vector<LimitBreak> out;
  for (size_t j = 1; j < skeleton.joints.size(); ++j) {
    if (skeleton.joints[j].name.starts_with("patella")) continue;  // it follows the knee
    LimitBreak broken{skeleton.joints[j].name};
    const Mat3 zero = joint_zero(skeleton.joints[j]);
    double excess = 0;
    for (size_t f = 0; f < motion.frames.size(); ++f) {
      const Quat& turn = motion.frames[f].rotations[j];
      // Fingers stay as they are for long.
      if (f == 0 || turn.coeffs() != motion.frames[f - 1].rotations[j].coeffs())
        excess = limit_excess(skeleton.joints[j], turn, zero);
      if (excess <= kLimitTolerance) continue;
      ++broken.frames;
      if (excess > broken.worst) broken.worst = excess, broken.worst_frame = int(f);
    }
    if (broken.frames > 0) out.push_back(broken);
  }
  return out;
}

// No recording goes so far; and further out single precision does not know millimetres.
void check_nearness(const std::string& name, const Motion& motion, double metres_per_unit) {
  constexpr double kFarthest = 10e3;  // m
  for (size_t f = 0; f < motion.frames.size(); ++f) {
    const Vec3& root = motion.frames[f].root;
    const bool turned =
        std::all_of(motion.frames[f].rotations.begin(), motion.frames[f].rotations.end(),
                    [](const Quat& q) { return q.coeffs().allFinite(); });
    if (turned && root.cwiseAbs().maxCoeff() <= kFarthest) continue;
    throw UnfitError(
        fmt::format("{}: frame {}: the figure is at {:.3g}, {:.3g}, {:.3g} m, further than {:.0f} "
                    "km from the origin (a unit of the file is taken as {:.3g} m); "
                    "correct that frame, or move the motion to the origin",
                    name, f, root.x(), root.y(), root.z(), kFarthest / 1000, metres_per_unit));
  }
}

// Leaps that no body makes are a fault of the recording: reported, not corrected.
void warn_of_leaps(const std::string& name, const Motion& motion,
                   std::vector<std::string>& warnings) {
  int count = 0;
  size_t worst_frame = 0;
  double worst = 0;
  for (size_t f = 1; f < motion.frames.size(); ++f) {
    if (!leaps(motion, f - 1)) continue;
    const double way = (motion.frames[f].root - motion.frames[f - 1].root).norm();
    ++count;
    if (way > worst) worst = way, worst_frame = f;
  }
  if (count > 0)
    warnings.push_back(
        fmt::format("{}: the figure leaps {} times from one frame to the next, the furthest by "
                    "{:.3g} m into frame {}",
                    name, count, worst, worst_frame));
}

// Small excesses are in most recordings and are not worth a warning.
void warn_of_limited(const std::string& name, const std::vector<LimitBreak>& limited,
                     std::vector<std::string>& warnings) {
  constexpr double kFar = 15 * kDegree;
  const LimitBreak* worst = nullptr;
  int joints = 0;
  for (const LimitBreak& one : limited) {
    if (one.worst < kFar) continue;
    ++joints;
    if (!worst || one.worst > worst->worst) worst = &one;
  }
  if (worst)
    warnings.push_back(fmt::format(
        "{}: {} joints go beyond their limits by more than 15 deg and are brought back; the worst, "
        "{}, by {:.0f} deg in frame {} ({} frames); "
        "--limits keep leaves them",
        name, joints, worst->joint, worst->worst / kDegree, worst->worst_frame, worst->frames));
}

// The motion as it has been transferred, and where the file's feet and hips were.
struct Transferred {
  Motion motion;
  std::array<FootPaths, 2> feet;
  std::vector<LimbShifts> shifts;
};

Transferred transfer_frames(const MotionClip& source, const Skeleton& ours, double sole,
                            PoseTransfer& transfer) {
  Transferred out;
  out.motion = {source.fps, std::vector<Pose>(std::max(source.frame_count, 1))};
  const std::vector<Vec3> rest = rest_positions(ours);
  const std::array<Vec3, 2> hips{rest[joint_of(ours, "hip_l")] - rest[0],
                                 rest[joint_of(ours, "hip_r")] - rest[0]};
  const std::array<FootShape, 2> shapes{foot_shape(ours, Side::left, sole),
                                        foot_shape(ours, Side::right, sole)};
  std::vector<Transform> X;
  for (size_t f = 0; f < out.motion.frames.size(); ++f) {
    clip_kinematics(source, source.frame_count == 0 ? -1 : int(f), X);
    transfer.transfer(X, out.motion.frames[f]);
    out.shifts.push_back(stance_shifts(transfer, X, hips, out.motion.frames[f]));
    for (int side = 0; side < 2; ++side)
      add_foot(transfer, X, side == 0 ? Side::left : Side::right, shapes[side],
               rest[shapes[side].ankle], out.feet[side]);
  }
  return out;
}

// What the report counts in frames, in those of another rate: `step` of the first ones each.
void count_in_frames(double step, RetargetReport& report) {
  const auto first_from = [&](int frame) { return int(std::ceil(frame / step - 1e-9)); };
  const auto nearest = [&](int frame) { return int(std::lround(frame / step)); };
  for (Flight& one : report.flights)
    one.begin = first_from(one.begin), one.end = first_from(one.end);
  for (EndMove& one : report.ends_moved) one.worst_frame = nearest(one.worst_frame);
  for (Penetration& one : report.self_collisions) {
    one.frames = first_from(one.frames);
    one.worst_frame = nearest(one.worst_frame);
  }
}

void drop_calibration(const std::string& name, Transferred& moved, RetargetReport& report) {
  const int n = report.dropped_frames = calibration_frames(moved.motion);
  if (n == 0) return;
  moved.motion.frames.erase(moved.motion.frames.begin(), moved.motion.frames.begin() + n);
  moved.shifts.erase(moved.shifts.begin(), moved.shifts.begin() + n);
  for (FootPaths& foot : moved.feet)
    foot.heel.erase(foot.heel.begin(), foot.heel.begin() + n),
        foot.ball.erase(foot.ball.begin(), foot.ball.begin() + n);
  report.warnings.push_back(
      fmt::format("{}: a marker pose at the start is left out ({} frames)", name, n));
}

// That heels and balls stand, together.
double frames_of(const std::vector<Contact>& contacts) {
  double out = 0;
  for (const Contact& one : contacts) out += one.end - one.begin;
  return out;
}

struct Constraints {
  bool keep, plant, fall;
  double sole;
};

// Plants feet, and lets go of them for as long as no leg within its limits keeps them without a
// snap: `rounds` times at most, none or those of kLetGo. `source`: the motion whose speeds limbs
// are to keep; null: as it is given.
void plant_within_limits(const std::string& name, const Skeleton& ours, double sole,
                         const std::optional<GroundPoints>& ground, const Motion* source,
                         FilteredMotion& filtered, MotionLimiter& limiter, int rounds,
                         std::vector<std::string>& warnings) {
  Motion& motion = filtered.motion;
  const Motion free = motion;
  std::vector<Contact>& contacts = filtered.contacts;
  const double found = frames_of(contacts);
  GroundClearance clearance;
  const auto plant = [&] {
    plant_feet(ours, sole, contacts, filtered.lock, clearance.lift, ground ? &*ground : nullptr,
               motion);
    limiter.run(kPlanted, contacts, clearance.shifts, motion, source != nullptr);
  };
  const auto steady = [&](Motion& planted) {
    steady_limbs(ours, limiter.tables(), source != nullptr ? *source : free, free, contacts,
                 planted);
  };
  const auto no_snap = [](const std::vector<std::vector<int>>& snaps) {
    return std::ranges::all_of(snaps, [](const auto& one) { return one.empty(); });
  };
  for (int round = 0;; ++round) {
    plant();
    if (round >= rounds) break;
    if (no_snap(contact_snaps(ours, free, motion, contacts))) break;
    // What legs can be slowed for is kept.
    Motion slowed = motion;
    steady(slowed);
    const std::vector<std::vector<int>> snaps = contact_snaps(ours, free, slowed, contacts);
    if (no_snap(snaps)) break;
    contacts = contacts_between_snaps(contacts, snaps, kLetGo[std::size_t(round)], motion.fps);
    motion = free;
  }
  // Of the motion with its hands open; none where nothing is known of the body.
  const auto opened_heights = [&] {
    std::vector<GroundHeights> out;
    if (ground) out = ground_heights(ours, *ground, motion);
    if (ground && open_hands(ours, *ground, out, motion))
      out = ground_heights(ours, *ground, motion);
    return out;
  };
  for (int pass = 0; ground && pass < kGroundPasses; ++pass) {
    if (!renew_clearance(opened_heights(), pass + 1 == kGroundPasses, motion.fps, clearance)) break;
    motion = free;
    plant();
  }
  if (rounds > 0) steady(motion);
  lift_from_ground(ours, sole, opened_heights(), motion);
  if (const double left = frames_of(contacts); left < found)
    warnings.push_back(
        fmt::format("{}: {:.0f} % of the time that feet stand they are not planted, since legs "
                    "within their limits would snap; --limits keep plants them",
                    name, std::max(1.0, 100 * (1 - left / found))));
}

// Limits, planted feet and flights; what was found goes to the report.
void constrain(const std::string& name, const Skeleton& ours, const RetargetOptions& options,
               const Constraints& wanted, Transferred& moved, RetargetReport& report) {
  const auto [keep, plant, fall, sole] = wanted;
  if (keep) {
    report.limit_breaks_before = limit_breaks(ours, moved.motion);
    warn_of_limited(name, report.limit_breaks_before, report.warnings);
  }
  const double file_rate = moved.motion.fps;
  if (keep || plant || fall) refine_frames(moved.motion, moved.feet, moved.shifts);
  FilteredMotion filtered{.motion = std::move(moved.motion)};
  Motion& motion = filtered.motion;
  // Feet that stand on a treadmill are planted on its belt.
  const Vec3 belt = plant || fall ? belt_velocity(moved.feet, motion) : Vec3(Vec3::Zero());
  const bool treadmill = !belt.isZero();
  if (treadmill) {
    move_by_belt(belt, moved.feet, motion);
    report.warnings.push_back(
        fmt::format("{}: a treadmill of {:.1f} m/s; feet stand on its belt", name, belt.norm()));
  }
  MotionLimiter limiter(
      ours, sole, options.avoid_self_collision && options.proxies ? &*options.proxies : nullptr);
  Motion given;  // as the source moves
  if (keep) {
    given = motion;
    limiter.run({}, {}, moved.shifts, motion);
    steady_limbs(ours, limiter.tables(), given, given, {}, motion);
    report.self_collisions = limiter.initial_penetrations();
  }
  filtered.belt = belt;
  if (plant) filtered.contacts = find_contacts(moved.feet, motion);
  // The file's own rate, as another one, only picks times out of the result.
  std::vector<MotionFilter> filters = options.filters;
  std::optional<double> rate;
  if (motion.fps != file_rate) rate = file_rate;
  std::erase_if(filters, [&](const MotionFilter& one) {
    const ChangeRate* change = std::get_if<ChangeRate>(&one);
    if (change != nullptr) rate = change->fps;
    return change != nullptr;
  });
  // Feet that are locked wholly are planted as they are without it.
  const auto is_lock = [](const MotionFilter& one, bool partly) {
    const LockFeet* lock = std::get_if<LockFeet>(&one);
    return lock != nullptr && (lock->strength < 1) == partly;
  };
  if (std::ranges::none_of(filters, [&](const auto& one) { return is_lock(one, true); }))
    std::erase_if(filters, [&](const auto& one) { return is_lock(one, false); });
  apply_filters(name, ours, filters, filtered);
  if (keep && plant)
    // What filters have moved is faster where it is brought back to its place, and is wanted so.
    plant_within_limits(name, ours, sole, options.ground, filters.empty() ? &given : nullptr,
                        filtered, limiter, moves_feet(filters) ? 0 : int(kLetGo.size()),
                        report.warnings);
  else if (plant) {
    plant_feet(ours, sole, filtered.contacts, filtered.lock, {},
               options.ground ? &*options.ground : nullptr, motion);
    lift_from_ground(ours, sole, {}, motion);
  }
  if (keep && !plant && !filters.empty()) limiter.run({}, {}, {}, motion);
  if (!keep && plant)
    for (Pose& pose : motion.frames) complete_pose(ours, pose);  // knees have moved
  if (keep) report.ends_moved = limiter.end_moves();
  if (fall) report.flights = make_flights_ballistic(ours, sole, filtered.gravity, motion);
  if (rate) {
    count_in_frames(motion.fps / *rate, report);
    change_rate(*rate, filtered);
  }
  const FootMeasures measured = measure_feet(ours, sole, motion, filtered.contacts);
  report.slide_p95 = measured.slide_p95;
  report.penetration = measured.penetration;
  if (treadmill) move_by_belt(-filtered.belt, motion);
  if (filtered.loop) close_loop(filtered);
  if (filtered.slope != 0) {
    put_on_slope(ours, sole, filtered.slope, motion);
    if (keep) limiter.run(kOnSlope, filtered.contacts, {}, motion);
  }
  report.contacts = std::move(filtered.contacts);
  unwrap(motion.frames);
  report.limit_breaks = limit_breaks(ours, motion);
  if (!report.self_collisions.empty()) {
    const std::vector<Penetration> left = limiter.penetrations(motion);
    for (size_t k = 0; k < left.size(); ++k) report.self_collisions[k].left = left[k].worst;
    std::erase_if(report.self_collisions, [](const Penetration& one) { return one.frames == 0; });
  }
  moved.motion = std::move(motion);
}

}  // namespace

void measure_body(const Skeleton& ours, const Points& skin, RetargetOptions& options) {
  if (!options.sole_height) options.sole_height = skin.col(1).minCoeff();
  if (options.avoid_self_collision && !options.proxies)
    options.proxies = measure_proxies(ours, skin);
  if (!options.ground) options.ground = measure_ground_points(ours, skin);
}

Motion retarget(const MotionClip& given, const Skeleton& ours, const RetargetOptions& options,
                RetargetReport& report) {
  report = RetargetReport{};
  report.warnings = given.warnings;
  const JointMapping mapping = map_joints(given, ours, options.joint_map);
  std::optional<MotionClip> turned_over;
  if (is_mirrored(given, mapping)) {
    turned_over = mirrored(given);
    report.warnings.push_back(
        fmt::format("{}: its toes and knees tell left-handed axes; it is read in a mirror, so that "
                    "left is left (swapped names look the same: --filter mirror undoes it)",
                    given.name));
  }
  const MotionClip& source = turned_over ? *turned_over : given;
  const RestAlignment alignment = align_rest(source, mapping, ours, options.up);
  report.matches = mapping.matches;
  report.warnings.insert(report.warnings.end(), mapping.warnings.begin(), mapping.warnings.end());
  report.warnings.insert(report.warnings.end(), alignment.warnings.begin(),
                         alignment.warnings.end());
  report.up = alignment.up;
  report.facing = alignment.facing;
  report.reference_frame = alignment.reference_frame;
  report.same_rest = alignment.same_rest;
  report.source_leg = alignment.leg;
  std::tie(report.unit, report.metres_per_unit) = guess_unit(alignment.leg);

  const std::optional<MatchingRig> matching_rig =
      find_matching_rig(source, mapping, alignment, ours);
  report.matching_rig = matching_rig.has_value();
  PoseTransfer transfer(source, mapping, alignment, matching_rig ? &*matching_rig : nullptr, ours,
                        options.shoulder_rhythm);
  report.scale = transfer.scale();
  report.turn = alignment.W;
  if (source.frame_count == 0)
    report.warnings.push_back(
        fmt::format("{}: it holds no frames; its rest pose is taken as one", source.name));
  const double sole = options.sole_height.value_or(guess_sole_height(ours));
  Transferred moved = transfer_frames(source, ours, sole, transfer);
  check_nearness(source.name, moved.motion, report.metres_per_unit);
  drop_calibration(source.name, moved, report);
  warn_of_leaps(source.name, moved.motion, report.warnings);
  report.faults = find_faults(source, mapping, report.dropped_frames);
  for (std::string& line : describe_faults(source.name, source.fps, report.faults))
    report.warnings.push_back(std::move(line));
  for (std::string& line : describe_uneven_steps(
           source.name, find_uneven_steps(source, mapping, report.dropped_frames)))
    report.warnings.push_back(std::move(line));
  if (!alignment.same_rest)
    for (const Side side : {Side::left, Side::right}) {
      const FootShape foot = foot_shape(ours, side, sole);
      for (Pose& pose : moved.motion.frames) turn_shin_with_foot(ours, foot, pose);
    }
  const bool strange = !matching_rig || source.captured;
  constrain(source.name, ours, options,
            {options.clamp_limits.value_or(!alignment.same_rest || source.captured),
             options.plant_feet.value_or(strange || moves_feet(options.filters)),
             options.ballistic_flights.value_or(strange), sole},
            moved, report);
  return std::move(moved.motion);
}

void constrain_own_motion(const std::string& name, const Skeleton& ours,
                          const RetargetOptions& options, Motion& motion, RetargetReport& report) {
  report.same_rest = report.matching_rig = true;
  const double sole = options.sole_height.value_or(guess_sole_height(ours));
  check_nearness(name, motion, report.metres_per_unit);
  warn_of_leaps(name, motion, report.warnings);
  Transferred moved{std::move(motion), {}, {}};
  std::vector<Transform> X;
  for (int side = 0; side < 2; ++side) {
    const FootShape foot = foot_shape(ours, side == 0 ? Side::left : Side::right, sole);
    for (const Pose& pose : moved.motion.frames) {
      forward_kinematics(ours, pose, X);
      const FootPoints points = foot_points(ours, foot, X);
      moved.feet[side].heel.push_back(points.heel);
      moved.feet[side].ball.push_back(points.ball);
    }
  }
  constrain(name, ours, options,
            {options.clamp_limits.value_or(false),
             options.plant_feet.value_or(moves_feet(options.filters)),
             options.ballistic_flights.value_or(false), sole},
            moved, report);
  motion = std::move(moved.motion);
}

}  // namespace ecorche::inline v1
