#include "skinning/constraints/plant_feet.h"

#include <algorithm>
#include <cmath>

#include "anatomy/chain_kinematics.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/joint_angles.h"
#include "skinning/constraints/contact_spans.h"
#include "skinning/constraints/ground_heights.h"
#include "skinning/constraints/leg_ik.h"
#include "skinning/constraints/leg_room.h"
#include "skinning/constraints/reach_planted.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kFade = 0.10;      // s; corrections fade around a stance. Shorter: feet snap
constexpr double kHandOver = 0.05;  // s; transition of the fixed point between heel and ball
constexpr double kSunk = 0.001;     // m; flesh that is shallower stays in the ground
constexpr double kLanding = 0.06, kLandingHeight = 0.04;  // s, m
constexpr double kShortFlat = 0.01;  // s; feet that are flat for less are not levelled
constexpr double kSampled = 240;     // a second, of medians
constexpr double kStep = 0.06;       // m; a higher contact stands on an object and is not lowered
constexpr double kMostDrop = 0.10;   // m; the pelvis is lowered by at most so much
// Of its length: a leg that carries the body, as who kneels or squats does not.
constexpr double kBentLeg = 0.75, kNearStraight = 0.9;
constexpr double kMostRise = 10 * kDegree;  // of a heel whose leg is too short
// rad (35 deg); a foot with more pitch, or more than its toes extend, rolls over the tip of its
// toes
constexpr double kToeExtension = 0.61;
constexpr double kOnTips = 0.87;    // sine of a foot's pitch that no walk has: 60 deg
constexpr double kMostBent = 0.75;  // rad; largest extension of the toes

// Values over a span, `fine` a frame, of what is linear between frames; `values`: by frame, where
// they go.
template <typename Get, typename Values>
void add_samples(const Interval& when, int fine, Get get, Values values) {
  const int steps = int(std::lround((when.lift() - when.onset()) * fine));
  for (int k = 0; k <= steps; ++k) {
    const double at = when.onset() + double(k) / fine;
    const int f = int(at);
    const double share = at - f;
    values(f).push_back(share > 1e-9 ? (1 - share) * get(f) + share * get(f + 1) : get(f));
  }
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Anchor {
  Interval when;
  Vec3 position = Vec3::Zero();
  double height = 0;  // m, of the unplanted point: its median
};

// Contacts and corrections of one foot over the whole motion.
struct FootPlan {
  FootShape shape;
  double most_pitch = kToeExtension;
  std::vector<FootPoints> before;  // points of the unplanted foot
  std::vector<Anchor> heels, balls;
  std::vector<Interval> flat;     // both stand
  std::vector<Interval> stances;  // either stands
  // by frame of a stance: weight of the heel's anchor; the ball's has the rest
  std::vector<double> heel_weight;
  std::vector<double> heel_height, ball_height;  // over their anchors, m
  std::vector<Vec3> heel_position, ball_position;
  std::vector<Quat> rotation;     // correction of the foot: rotated by this in the world, ...
  std::vector<Vec3> shift;        // ... then shifted, ...
  std::vector<double> rise;       // ... and its heel raised over the ball, rad
  std::vector<double> held;       // 1 in a stance, fading around it
  std::vector<double> stretched;  // of a planted leg, of its length; 0: it is free
};

const Anchor* anchor_at(const std::vector<Anchor>& anchors, int f) {
  for (const Anchor& a : anchors)
    if (inside(a.when, f)) return &a;
  return nullptr;
}

FootPoints rotated_about(FootPoints points, const Mat3& turn, const Vec3& pivot) {
  for (Vec3* p : {&points.heel, &points.ball, &points.tip}) *p = pivot + turn * (*p - pivot);
  return points;
}

class Planter {
 public:
  Planter(const Skeleton& skeleton, double sole_height, double strength, const GroundPoints* flesh,
          Motion& motion)
      : skeleton_(skeleton),
        flesh_(flesh),
        joints_(feet_joints(skeleton)),
        motion_(motion),
        frames_(int(motion.frames.size())),
        fine_(std::max(1, int(std::lround(kSampled / motion.fps)))),
        strength_(strength) {
    for (int side = 0; side < 2; ++side) {
      feet_[side].shape = foot_shape(skeleton, side == 0 ? Side::left : Side::right, sole_height);
      const FootShape& shape = feet_[side].shape;
      const Vec3 forward = (shape.ball - shape.heel).normalized(), up = shape.toes_up - shape.ball;
      feet_[side].most_pitch = std::clamp(std::atan2(up.y(), up.dot(forward)), 0.0, kToeExtension);
    }
  }

  void run(const std::vector<Contact>& contacts, const std::vector<double>& lift) {
    for (const Contact& one : contacts) {
      FootPlan& foot = feet_[one.side == Side::left ? 0 : 1];
      (one.heel ? foot.heels : foot.balls)
          .push_back({{one.begin, one.end, one.begin > 0 ? one.early : 0,
                       one.end < frames_ ? one.late : 0},
                      Vec3::Zero()});
    }
    read_feet();
    stand_on_ground();
    for (FootPlan& foot : feet_) position_anchors(foot), keep_landings(foot);
    if (!lift.empty()) rise(lift);
    for (FootPlan& foot : feet_) blend_anchors(foot), plan_corrections(foot);
    const std::vector<double> sunk = lower_pelvis(lift);
    for (int f = 0; f < frames_; ++f) plant_frame(f, sunk[f]);
  }

 private:
  void read_feet() {
    for (const Pose& pose : motion_.frames) {
      chain_kinematics(skeleton_, joints_, pose, X_);
      for (FootPlan& foot : feet_) foot.before.push_back(foot_points(skeleton_, foot.shape, X_));
    }
  }

  // Moves the whole motion up or down so that the contacts lie at 0. How high a foot is that stands
  // on the tips of its toes, as one who kneels has it, depends on its length: it counts only where
  // none stands otherwise.
  void stand_on_ground() {
    std::vector<double> flatter, steep;
    for (const FootPlan& foot : feet_) {
      const auto add = [&](const std::vector<Anchor>& anchors, auto point) {
        for (const Anchor& a : anchors)
          add_samples(
              a.when, fine_, [&](int f) { return point(foot.before[f]).y(); },
              [&](int f) -> std::vector<double>& {
                const FootPoints& p = foot.before[f];
                return -(p.ball - p.heel).normalized().y() > kOnTips ? steep : flatter;
              });
      };
      add(foot.heels, [](const FootPoints& p) { return p.heel; });
      add(foot.balls, [](const FootPoints& p) { return p.ball; });
    }
    std::vector<double>& heights = flatter.empty() ? steep : flatter;
    if (heights.empty())
      for (int f = 0; f < frames_; ++f)
        heights.push_back(std::min(feet_[0].before[f].ball.y(), feet_[1].before[f].ball.y()));
    const Vec3 shift(0, -median(heights), 0);
    for (Pose& pose : motion_.frames) pose.root += shift;
    for (FootPlan& foot : feet_)
      for (FootPoints& p : foot.before) p.heel += shift, p.ball += shift, p.tip += shift;
  }

  void rise(const std::vector<double>& lift) {
    for (int f = 0; f < frames_; ++f) {
      const Vec3 up(0, lift[std::size_t(f)], 0);
      motion_.frames[f].root += up;
      for (FootPlan& foot : feet_)
        for (Vec3* p : {&foot.before[f].heel, &foot.before[f].ball, &foot.before[f].tip}) *p += up;
    }
  }

  void position_anchors(FootPlan& foot) const {
    auto place = [&](Anchor& anchor, auto point) {
      for (int k = 0; k < 3; ++k) {
        std::vector<double> values;
        add_samples(
            anchor.when, fine_, [&](int f) { return point(foot.before[f])[k]; },
            [&](int) -> std::vector<double>& { return values; });
        anchor.position[k] = median(std::move(values));
      }
      anchor.height = anchor.position.y();
      if (anchor.position.y() < kStep) anchor.position.y() = 0;
    };
    for (Anchor& a : foot.heels) place(a, [](const FootPoints& p) { return p.heel; });
    for (Anchor& a : foot.balls) place(a, [](const FootPoints& p) { return p.ball; });
    // On a flat foot both points are a foot's length apart; the heel's anchor is adjusted.
    const double length = (foot.shape.ball - foot.shape.heel).norm();
    for (Anchor& heel : foot.heels)
      for (const Anchor& ball : foot.balls) {
        const Interval both = common(heel.when, ball.when);
        if (both.begin >= both.end || both.lift() - both.onset() < kShortFlat * motion_.fps)
          continue;
        foot.flat.push_back(both);
        Vec3 along = Vec3::Zero();
        for (int f = both.begin; f < both.end; ++f)
          along += (foot.before[f].ball - foot.before[f].heel).normalized();
        along.y() = ball.position.y() - heel.position.y();
        heel.position = ball.position - length * along.normalized();
      }
  }

  // A point that comes down, or is about to leave, is as high over its place as it was.
  void keep_landings(FootPlan& foot) const {
    const auto keep = [&](const std::vector<Anchor>& anchors, auto point, auto& heights) {
      heights.assign(frames_, 0);
      for (const Anchor& a : anchors)
        for (int f = a.when.begin; f < a.when.end; ++f) {
          const double from_edge =
              std::min(f - a.when.onset(), a.when.lift() - f) / (kLanding * motion_.fps);
          heights[f] = (1 - smooth_step(from_edge)) *
                       std::clamp(point(foot.before[f]).y() - a.height, 0.0, kLandingHeight);
        }
    };
    keep(
        foot.heels, [](const FootPoints& p) { return p.heel; }, foot.heel_height);
    keep(
        foot.balls, [](const FootPoints& p) { return p.ball; }, foot.ball_height);
  }

  // Stances, and the blend between the anchors of heel and ball while both stand.
  void blend_anchors(FootPlan& foot) const {
    const double hand_over = kHandOver * motion_.fps;
    foot.heel_weight.assign(frames_, 0);
    foot.heel_position.assign(frames_, Vec3::Zero());
    foot.ball_position.assign(frames_, Vec3::Zero());
    for (int f = 0; f < frames_; ++f) {
      const Anchor *heel = anchor_at(foot.heels, f), *ball = anchor_at(foot.balls, f);
      if (heel == nullptr && ball == nullptr) continue;
      const auto begins = [&](const Anchor* a) {
        return a && a->when.begin == f ? a->when.early : 0;
      };
      const auto ends = [&](const Anchor* a) {
        return a && a->when.end == f + 1 ? a->when.late : 0;
      };
      if (foot.stances.empty() || foot.stances.back().end != f)
        foot.stances.push_back({f, f, std::max(begins(heel), begins(ball)), 0});
      foot.stances.back().end = f + 1;
      foot.stances.back().late = std::max(ends(heel), ends(ball));
      if (heel != nullptr)
        foot.heel_position[f] = heel->position + foot.heel_height[f] * Vec3::UnitY();
      if (ball != nullptr)
        foot.ball_position[f] = ball->position + foot.ball_height[f] * Vec3::UnitY();
      if (heel != nullptr && ball != nullptr) turn_about_lower(foot, f);
      auto share = [&](const Anchor* mine, const std::vector<Anchor>& other) {
        if (mine == nullptr) return 0.0;
        double in = 1;
        if (anchor_at(other, mine->when.begin - 1) != nullptr)
          in = std::min(in, smooth_step((f - mine->when.onset()) / hand_over));
        if (anchor_at(other, mine->when.end) != nullptr)
          in = std::min(in, smooth_step((mine->when.lift() - f) / hand_over));
        return in;
      };
      const double h = share(heel, foot.balls), b = share(ball, foot.heels);
      foot.heel_weight[f] = heel == nullptr   ? 0
                            : ball == nullptr ? 1
                            : h + b > 1e-9    ? h / (h + b)
                                              : 0.5;
    }
  }

  // A point of a standing foot that is higher than the other turns about it.
  static void turn_about_lower(FootPlan& foot, int f) {
    const Vec3 along = foot.ball_position[f] - foot.heel_position[f];
    const double length = (foot.shape.ball - foot.shape.heel).norm(),
                 nearer =
                     length - std::sqrt(std::max(0.0, length * length - along.y() * along.y()));
    const Vec3 shift = nearer * Vec3(along.x(), 0, along.z()).normalized();
    if (along.y() < 0)
      foot.heel_position[f] += shift;
    else
      foot.ball_position[f] -= shift;
  }

  // Rotation and shift of every frame: in stances from the anchors, between them fading.
  void plan_corrections(FootPlan& foot) {
    const Vec3 own = foot.shape.ball - foot.shape.heel;
    const double fade = kFade * motion_.fps;
    std::vector<Mat3> rotation;
    std::vector<Vec3> pivot;
    for (const Pose& pose : motion_.frames) {
      chain_kinematics(skeleton_, joints_, pose, X_);
      rotation.push_back(X_[foot.shape.subtalar].linear());
      pivot.push_back(X_[foot.shape.subtalar].translation());
    }
    // What puts the foot as it is in frame f where it stands in frame `stands`.
    const auto standing_turn = [&](int f, int stands) {
      const Vec3 along = foot.ball_position[stands] - foot.heel_position[stands];
      const double heading = std::atan2(along.x(), along.z()) - std::atan2(own.x(), own.z()),
                   pitch = std::asin(std::clamp(-along.normalized().y(), -1.0, 1.0));
      return Quat(Mat3(heel_up(along, pitch) *
                       Eigen::AngleAxisd(heading, Vec3::UnitY()).toRotationMatrix() *
                       rotation[f].transpose()));
    };
    const auto standing_shift = [&](int f, int stands) {
      const FootPoints now =
          rotated_about(foot.before[f], foot.rotation[f].toRotationMatrix(), pivot[f]);
      const double h = foot.heel_weight[stands];
      Vec3 out = Vec3::Zero();
      if (h > 0) out += h * (foot.heel_position[stands] - now.heel);
      if (h < 1) out += (1 - h) * (ball_goal(foot, stands, now) - now.ball);
      return out;
    };
    foot.rotation.assign(frames_, Quat::Identity());
    correct(
        foot.flat, standing_turn, foot.rotation, fade, Quat(Quat::Identity()),
        [](const Quat& a, const Quat& b, double t) { return a.slerp(t, b); },
        [](const Quat& rest, const Quat& edge, double share) {
          return (Quat::Identity().slerp(share, edge) * rest).normalized();
        });
    foot.held.assign(frames_, 0);
    for (const Interval& stance : foot.stances)
      std::fill(foot.held.begin() + stance.begin, foot.held.begin() + stance.end, 1.0);
    fade_out(foot.stances, std::vector<std::array<double, 2>>(foot.stances.size(), {1, 1}),
             foot.held, fade, 0.0,
             [](double rest, double edge, double share) { return rest + share * edge; });
    foot.shift.assign(frames_, Vec3::Zero());
    correct(
        foot.stances, standing_shift, foot.shift, fade, Vec3(Vec3::Zero()),
        [](const Vec3& a, const Vec3& b, double t) { return Vec3((1 - t) * a + t * b); },
        [](const Vec3& rest, const Vec3& edge, double share) { return Vec3(rest + share * edge); });
    if (strength_ == 1) return;
    for (Quat& turn : foot.rotation) turn = Quat::Identity().slerp(strength_, turn);
    for (Vec3& shift : foot.shift) shift *= strength_;
  }

  // Values of every frame: of `value` inside of the intervals, fading from its edges between them.
  template <typename Get, typename Value, typename Mix, typename Blend>
  void correct(const std::vector<Interval>& intervals, Get value, std::vector<Value>& values,
               double fade, const Value& nothing, Mix mix, Blend blend) const {
    std::vector<std::array<Value, 2>> edges;
    for (const Interval& i : intervals) {
      const int first = i.begin, last = i.end - 1;
      for (int f = first; f <= last; ++f) values[f] = value(f, f);
      edges.push_back({values[first], values[last]});
      if (i.early > 0) edges.back()[0] = mix(values[first], value(first - 1, first), i.early);
      if (i.late > 0) edges.back()[1] = mix(values[last], value(last + 1, last), i.late);
    }
    fade_out(intervals, edges, values, fade, nothing, blend);
  }

  // Target of the ball: its anchor, or, with a high heel, rotated up about the tip of the toes.
  static Vec3 ball_goal(const FootPlan& foot, int f, const FootPoints& now) {
    const Vec3 along = now.ball - now.heel;
    const double excess =
        std::asin(std::clamp(-along.normalized().y(), -1.0, 1.0)) - foot.most_pitch;
    if (excess <= 0) return foot.ball_position[f];
    const double toes = (foot.shape.tip - foot.shape.ball).norm();
    const Vec3 forward = Vec3(along.x(), 0, along.z()).normalized();
    return foot.ball_position[f] +
           toes * ((1 - std::cos(excess)) * forward + std::sin(excess) * Vec3::UnitY());
  }

  // Of a leg in the frame whose kinematics are X_; one that neither stands nor is in the ground
  // needs nothing. `lift`: by which the figure is to be higher than its feet, m. Moves the leg's
  // frames in X_.
  LegReach leg_reach(const FootPlan& foot, int f, double lift) {
    LegReach out{anchor_at(foot.heels, f) != nullptr, anchor_at(foot.balls, f) != nullptr};
    const bool stands = out.heel || out.ball;
    const FootShape& shape = foot.shape;
    const Mat3 turn = foot.rotation[f].toRotationMatrix(), R = turn * X_[shape.subtalar].linear();
    const Vec3 pivot = X_[shape.subtalar].translation(), hip = X_[shape.hip].translation(),
               ankle = pivot + turn * (X_[shape.ankle].translation() - pivot) + foot.shift[f];
    const FootPoints points = rotated_about(foot_points(skeleton_, shape, X_), turn, pivot);
    const double low = std::min(points.heel.y(), points.ball.y()) + foot.shift[f].y();
    if (!stands && low >= 0) return out;
    const double length = straight_leg(skeleton_, shape, X_), reach = kStraight * length;
    scratch_ = motion_.frames[f];
    out.folded = fold_rise(skeleton_, shape, ankle - Vec3(0, stands ? 0 : low, 0), R, scratch_, X_);
    if (!stands) return out;
    const auto drop = [&](const Vec3& goal) {
      return std::min(kMostDrop, hip_drop(hip, goal, reach));
    };
    out.length = length;
    out.ankle = ankle - hip;
    out.flat = out.raised = drop(ankle);
    out.low = (-foot.shift[f].y() - lift) *
              smooth_step(kBentLeg, kNearStraight, (ankle - hip).norm() / reach);
    if (!out.ball) return out;
    const Vec3 along = (points.ball - points.heel).normalized(), ball = points.ball + foot.shift[f];
    const double room =  // until its toes extend no further
        std::max(0.0, foot.most_pitch + std::asin(std::clamp(along.y(), -1.0, 1.0)));
    out.most = std::min(kMostRise, room);
    out.raised = std::min(out.flat, drop(ball + heel_up(along, out.most) * (ankle - ball)));
    const Vec3 lower(0, -out.folded, 0);
    out.bent =
        std::min(room, bent_rise(skeleton_, shape, ankle + lower, R, ball + lower, scratch_, X_));
    return out;
  }

  // Moves the pelvis so that planted legs reach, and sets how far heels rise. Returns by how much
  // it is lowered, a frame, m.
  std::vector<double> lower_pelvis(const std::vector<double>& lift) {
    std::array<std::vector<LegReach>, 2> legs;
    for (int f = 0; f < frames_; ++f) {
      chain_kinematics(skeleton_, joints_, motion_.frames[f], X_);
      for (std::size_t s = 0; s < 2; ++s)
        legs[s].push_back(leg_reach(feet_[s], f, lift.empty() ? 0 : lift[std::size_t(f)]));
    }
    ReachPlan plan = plan_reach(legs, motion_.fps);
    for (std::size_t s = 0; s < 2; ++s) {
      feet_[s].rise = std::move(plan.rise[s]);
      feet_[s].stretched.assign(frames_, 0);
      for (int f = 0; f < frames_; ++f)
        if (const LegReach& leg = legs[s][f]; leg.heel || leg.ball)
          feet_[s].stretched[f] =
              std::min(kStraight, (leg.ankle + Vec3(0, plan.sunk[f], 0)).norm() / leg.length);
    }
    for (int f = 0; f < frames_; ++f) motion_.frames[f].root.y() -= plan.sunk[f];
    return std::move(plan.sunk);
  }

  // `sunk`: by which the pelvis was lowered, m. Feet stay; free ones follow a pelvis that rises.
  void plant_frame(int f, double sunk) {
    Pose& pose = motion_.frames[f];
    chain_kinematics(skeleton_, joints_, pose, X_);
    for (FootPlan& foot : feet_) {
      const FootShape& shape = foot.shape;
      const Mat3 turn = foot.rotation[f].toRotationMatrix();
      Mat3 R = turn * X_[shape.subtalar].linear();
      FootPoints goal =
          rotated_about(foot_points(skeleton_, shape, X_), turn, X_[shape.subtalar].translation());
      const Vec3 move = foot.shift[f] + Vec3(0, std::max(sunk, sunk * foot.held[f]), 0);
      for (Vec3* p : {&goal.heel, &goal.ball, &goal.tip}) *p += move;
      if (foot.rise[f] > 0) {
        const Mat3 up = heel_up((goal.ball - goal.heel).normalized(), foot.rise[f]);
        R = up * R;
        goal = rotated_about(goal, up, goal.ball);
      }
      if (foot.stretched[f] == 0) give_way(foot, f, R, goal);
      keep_above_ground(foot, f, goal, R);
      for (int lift = 0; lift < 3; ++lift) {
        put_foot(shape, goal, R, pose);
        double low = bend_toes(shape, pose);
        low = std::min(low, flesh_depth(foot));
        if (low > -1e-4) break;
        goal.heel.y() -= low, goal.ball.y() -= low;
      }
    }
  }

  // Up to which part of its length a free leg stretches as it likes: further beside a stance in
  // which it does.
  double stretches(const FootPlan& foot, int f) const {
    const double fade = kFade * motion_.fps;
    double out = kStretches;
    for (const int way : {-1, 1})
      for (int k = 1; k < fade && f + way * k >= 0 && f + way * k < frames_; ++k) {
        const double edge = foot.stretched[f + way * k];
        if (edge == 0) continue;
        out = std::max(out, edge - (edge - kStretches) * smooth_step(k / fade));
        break;
      }
    return out;
  }

  // A free foot that a fading correction would pull from its leg gives way towards the hip. X_ are
  // the frames before the correction.
  void give_way(const FootPlan& foot, int f, const Mat3& R, FootPoints& goal) const {
    const FootShape& shape = foot.shape;
    const Vec3 hip = X_[shape.hip].translation(), was = X_[shape.ankle].translation(),
               ankle = goal.heel + R * X_[shape.subtalar].linear().transpose() *
                                       (was - foot_points(skeleton_, shape, X_).heel);
    const double length = straight_leg(skeleton_, shape, X_), far = (ankle - hip).norm();
    if (far <= kStretches * length) return;
    const double near = eased_reach(far, (was - hip).norm(), length, stretches(foot, f));
    const Vec3 back = (near / far - 1) * (ankle - hip);
    for (Vec3* p : {&goal.heel, &goal.ball, &goal.tip}) *p += back;
  }

  // How much deeper than it may be a sole's skin is (negative), m.
  double flesh_depth(const FootPlan& foot) const {
    if (flesh_ == nullptr) return 0;
    const std::size_t side = &foot == feet_.data() ? 0 : 1;
    const double low = height_over_ground(flesh_->feet[side], X_) + kSunk;
    return low < 0 ? share_on_sole(X_[foot.shape.subtalar]) * low : 0;
  }

  // Solves leg and foot so that the foot has rotation R and its sole lies at `goal`. Iterates,
  // since the subtalar joint moves with the talus, whose rotation is part of the solution.
  void put_foot(const FootShape& shape, const FootPoints& goal, const Mat3& R, Pose& pose) {
    const FootPoints now = foot_points(skeleton_, shape, X_);
    if ((now.heel - goal.heel).norm() < 1e-9 && (now.ball - goal.ball).norm() < 1e-9) return;
    const Vec3 middle = 0.5 * (goal.heel + goal.ball);
    Vec3 ankle = X_[shape.ankle].translation() + middle - 0.5 * (now.heel + now.ball);
    for (int round = 0; round < 5; ++round) {
      reach_with_leg(skeleton_, shape, ankle, R, pose, X_);
      const FootPoints got = foot_points(skeleton_, shape, X_);
      ankle += middle - 0.5 * (got.heel + got.ball);
    }
  }

  // Keeps soles above the ground: a planted foot rotates about its standing point, a free one is
  // lifted.
  static void keep_above_ground(const FootPlan& foot, int f, FootPoints& goal, Mat3& R) {
    const double low = std::min(goal.heel.y(), goal.ball.y());
    if (low >= 0) return;
    const bool on_heel = anchor_at(foot.heels, f) != nullptr && goal.ball.y() < goal.heel.y();
    const bool on_ball = anchor_at(foot.balls, f) != nullptr && goal.heel.y() < goal.ball.y();
    if (on_heel || on_ball) {
      const Vec3 pivot = on_heel ? goal.heel : goal.ball, along = goal.ball - goal.heel;
      const double length = along.norm(),
                   least = std::asin(std::clamp(pivot.y() / length, 0.0, 1.0)),  // to touch down
          pitch = std::asin(std::clamp(-along.y() / length, -1.0, 1.0));
      const Mat3 back = heel_up(along, (on_heel ? least : -least) - pitch);
      R = back * R;
      goal = rotated_about(goal, back, pivot);
    } else {
      for (Vec3* p : {&goal.heel, &goal.ball, &goal.tip}) p->y() -= low;
    }
  }

  // Extends toes whose tip is below the ground, within their range. Returns the remaining depth of
  // the tip (negative), m.
  double bend_toes(const FootShape& shape, Pose& pose) {
    double low = 0;
    for (int round = 0; round < 4; ++round) {
      const FootPoints now = foot_points(skeleton_, shape, X_);
      low = std::min(0.0, now.tip.y());
      if (low > -1e-4) break;
      const Vec3 lever = now.tip - X_[shape.mtp[1]].translation();
      const double bent = pose.rotations[shape.mtp[1]].angularDistance(Quat::Identity());
      const double angle =
          std::min(-low / std::max(0.02, std::hypot(lever.x(), lever.z())), kMostBent - bent);
      if (angle <= 0) break;
      const Mat3 up =
          Eigen::AngleAxisd(angle, lever.cross(Vec3::UnitY()).normalized()).toRotationMatrix();
      for (int mtp : shape.mtp) {
        X_[mtp].linear() = up * X_[mtp].linear();
        pose.rotations[mtp] =
            Quat(Mat3(X_[shape.subtalar].linear().transpose() * X_[mtp].linear())).normalized();
      }
    }
    return low;
  }

  const Skeleton& skeleton_;
  const GroundPoints* flesh_;
  const std::vector<int> joints_;  // whose frames are needed
  Motion& motion_;
  int frames_;
  int fine_;  // samples a frame, of medians
  double strength_;
  std::array<FootPlan, 2> feet_;
  std::vector<Transform> X_;
  Pose scratch_;
};

}  // namespace

std::vector<Contact> find_contacts(const std::array<FootPaths, 2>& paths, const Motion& motion) {
  std::vector<Contact> out;
  if (motion.frames.empty()) return out;
  const std::vector<double> floor = floor_heights(paths, motion);
  for (size_t s = 0; s < 2; ++s) {
    const Side side = s == 0 ? Side::left : Side::right;
    // A low ball beside a heel that stands does, too; a low heel beside a ball may be raised.
    const std::vector<Interval> heels = standing_intervals(paths[s].heel, floor, motion.fps),
                                balls = standing_intervals(paths[s].ball, floor, motion.fps, heels);
    for (const Interval& i : split_heels(heels, balls))
      out.push_back({side, true, i.begin, i.end, 0, i.early, i.late});
    for (const Interval& i : balls)
      out.push_back({side, false, i.begin, i.end, 0, i.early, i.late});
  }
  return out;
}

void plant_feet(const Skeleton& skeleton, double sole_height, const std::vector<Contact>& contacts,
                double strength, const std::vector<double>& lift, const GroundPoints* flesh,
                Motion& motion) {
  if (!motion.frames.empty())
    Planter(skeleton, sole_height, strength, flesh, motion).run(contacts, lift);
}

}  // namespace ecorche::inline v1
