#include "morph/registration/pose_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/compute/parallel_ranges.h"
#include "morph/registration/limb_ends.h"

namespace ecorche::inline v1 {
namespace {

// Hypotheses kept after each look at them: as they are, posed, shaped.
constexpr std::size_t kPlaced = 20, kPosed = 4, kShaped = 3;
// Of the ways that a limb may be, those that are looked at closely.
constexpr std::size_t kLimbs = 4;
constexpr std::size_t kSpread = 6000;  // points of the scan that misfits count
constexpr double kFar = 0.15;  // m, distances that all count alike when hypotheses are compared
constexpr double kOtherBody = 0.1;    // m, mean distance of two results that are not the same
constexpr double kTurnCost = 0.001;   // of a squared deviation a joint, as a misfit
constexpr std::size_t kLaidOver = 4;  // known places that a body is laid over
constexpr double kOtherUp = 0.05;     // of another up than the file's, as a misfit

// Coarse to fine.
constexpr FitStage kRough{.rounds = 7,
                          .samples = 400,
                          .width = 0.25,
                          .reach = 0.12,
                          .across = 1,
                          .shape = false,
                          .scale = true,
                          .pose_prior = 1,
                          .shape_prior = 1};
constexpr FitStage kPose{.rounds = 7,
                         .samples = 500,
                         .width = 0.12,
                         .reach = 0.12,
                         .across = 0.5,
                         .shape = false,
                         .scale = true,
                         .pose_prior = 0.5,
                         .shape_prior = 1};
constexpr FitStage kLimb{.rounds = 5,
                         .samples = 400,
                         .width = 0.15,
                         .reach = 0.12,
                         .across = 0.7,
                         .shape = false,
                         .scale = true,
                         .pose_prior = 1,
                         .shape_prior = 1};
constexpr FitStage kShapeStart{.rounds = 8,
                               .samples = 1200,
                               .width = 0.12,
                               .reach = 0.1,
                               .across = 0.5,
                               .shape = true,
                               .scale = true,
                               .pose_prior = 2,
                               .shape_prior = 3};
constexpr FitStage kShape{.rounds = 8,
                          .samples = 1500,
                          .width = 0.07,
                          .reach = 0.1,
                          .across = 0.3,
                          .shape = true,
                          .scale = true,
                          .pose_prior = 2,
                          .shape_prior = 2};
constexpr FitStage kClose{.rounds = 10,
                          .samples = 5000,
                          .width = 0.05,
                          .reach = 0.08,
                          .across = 0.2,
                          .shape = true,
                          .scale = true,
                          .pose_prior = 2.4,
                          .shape_prior = 2,
                          .settled = true};
constexpr FitStage kClosest{.rounds = 10,
                            .samples = 5000,
                            .width = 0.03,
                            .reach = 0.06,
                            .across = 0.1,
                            .shape = true,
                            .scale = true,
                            .pose_prior = 2.4,
                            .shape_prior = 2,
                            .settled = true};

struct Spread {
  Vec3 centre = Vec3::Zero();
  double radius = 0;  // root mean square distance from it
};

Spread spread_of(const Points& points) {
  Spread out;
  out.centre = points.colwise().mean().transpose();
  out.radius =
      std::sqrt((points.rowwise() - out.centre.transpose()).rowwise().squaredNorm().mean());
  return out;
}

bool by_misfit(const PoseHypothesis& a, const PoseHypothesis& b) { return a.misfit < b.misfit; }

void keep(std::vector<PoseHypothesis>& found, std::size_t count) {
  std::stable_sort(found.begin(), found.end(), by_misfit);
  if (found.size() > count) found.resize(count);
}

// Ways that the body's +Y may point in the file, and what each costs.
std::vector<std::pair<Vec3, double>> up_candidates(const Points& points,
                                                   const std::optional<Vec3>& known) {
  std::vector<std::pair<Vec3, double>> out;
  if (known) out.emplace_back(known->normalized(), 0);
  const auto add = [&](const Vec3& up, double cost) {
    for (const auto& [other, unused] : out)
      if (other.dot(up) > 0.97) return;
    out.emplace_back(up, cost);
  };
  const double other = known ? kOtherUp : 0;
  add(Vec3::UnitY(), other);
  add(Vec3::UnitZ(), other);
  add(-Vec3::UnitY(), other + 0.005);
  add(-Vec3::UnitZ(), other + 0.005);
  add(Vec3::UnitX(), other + 0.005);
  add(-Vec3::UnitX(), other + 0.005);
  const Points away = points.rowwise() - points.colwise().mean();
  const auto axes = symmetric_eigen<3>(Mat3(away.transpose() * away));
  add(axes.vectors.col(2), other + 0.005);
  add(-axes.vectors.col(2), other + 0.005);
  return out;
}

// Turns that bring +Y to `up`, about it in eight steps.
std::vector<Mat3> turns_about(const Vec3& up) {
  const Mat3 upright = Quat::FromTwoVectors(Vec3::UnitY(), up).toRotationMatrix();
  std::vector<Mat3> out;
  for (int k = 0; k < 8; ++k)
    out.push_back(upright * Eigen::AngleAxisd(k * 45 * kDegree, Vec3::UnitY()).toRotationMatrix());
  return out;
}

}  // namespace

PoseSearch::PoseSearch(const ArticulatedBody& body, EvenPoints points, PoseSearchOptions options)
    : body_(body),
      mean_(rest_shape(body, Eigen::VectorXd::Zero(body.basis.cols()))),
      options_(std::move(options)),
      coarse_(spread_vertices(body, 160)),
      middle_(spread_vertices(body, 700)),
      fine_(spread_vertices(body, 2500)),
      target_{std::move(points.surface),
              {},
              options_.one_view,
              std::move(points.border),
              std::move(points.covering)},
      tree_(target_.surface, 0.1) {
  target_.spread.resize(std::min(kSpread, std::size_t(target_.surface.points.rows())));
  std::iota(target_.spread.begin(), target_.spread.end(), 0);
}

std::vector<PoseHypothesis> PoseSearch::find_poses() const {
  std::vector<PoseHypothesis> found = placed();
  keep(found, kPlaced);
  posed(found);
  keep(found, kPosed);
  other_limbs(found);
  keep(found, kShaped);
  return found;
}

// A depth frame in a known unit shows a part of somebody whose size is no matter of the fit.
FitStage PoseSearch::sized(FitStage stage) const {
  stage.scale &= !(options_.one_view && options_.scale_known);
  return stage;
}

// Every pose in every orientation, laid over the scan by centre and size; of a depth frame, which
// may show the upper part alone, by centres further down, too.
std::vector<PoseHypothesis> PoseSearch::placed() const {
  std::vector<BodyPose> poses = standing_poses(body_);
  if (options_.pose) {
    const std::string arms = *options_.pose == "t" ? "arms t-pose" : "arms a-pose";
    std::erase_if(poses, [&](const BodyPose& pose) { return !pose.name.ends_with(arms); });
  }
  const Spread scan_spread =
      spread_of(target_.surface.points.topRows(Eigen::Index(target_.spread.size())));
  std::vector<double> drops{0};  // m
  if (options_.one_view) drops = {0, 0.25, 0.5};
  std::vector<PoseHypothesis> out;
  for (const auto& [up, cost] : up_candidates(target_.surface.points, options_.up)) {
    for (const Mat3& turn : turns_about(up)) {
      for (const BodyPose& pose : poses) {
        for (const double drop : drops) {
          PoseHypothesis one{rest_state(body_), cost, pose.name};
          one.state.turns = pose.turns;
          one.state.turns[0] = turn;
          one.state.shift = -drop * up;
          out.push_back(std::move(one));
        }
      }
    }
  }
  if (options_.hints.size() >= kLaidOver) out.push_back(as_known());
  parallel_for_ranges(out.size(), 16, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t h = first; h < last; ++h) {
      PoseHypothesis& one = out[h];
      ArticulatedState unmoved = one.state;
      unmoved.shift.setZero();
      const Spread own =
          spread_of(posed_points(body_, articulate(body_, mean_, unmoved), coarse_.vertices));
      double ratio = scan_spread.radius / own.radius;
      if (target_.one_sided) ratio = 1;
      one.state.log_scale = std::log(std::clamp(ratio, 0.5, 2.0));
      one.state.shift += scan_spread.centre - std::exp(one.state.log_scale) * own.centre;
      if (options_.hints.size() >= kLaidOver) lay_over_hints(one.state);
      one.misfit += two_way_misfit(fit(), coarse_, tree_, mean_, one.state, 200, kFar);
      if (!options_.hints.empty()) one.misfit += hint_misfit(one.state);
    }
  });
  return out;
}

// All limbs whose joints are known along these at once: crossed legs would not be found one by one.
PoseHypothesis PoseSearch::as_known() const {
  PoseHypothesis out{rest_state(body_), 0, "as its joints"};
  for (int round = 0; round < 3; ++round) {
    lay_over_hints(out.state);
    for (const bool arm : {true, false})
      for (const Side side : {Side::left, Side::right})
        if (const auto known = known_limb(arm, side, out.state))
          set_limb(body_, arm, side, *known, out.state.turns);
  }
  return out;
}

Vec3 PoseSearch::hint_point(const PlaceHint& hint, const ArticulatedPose& pose) const {
  if (hint.vertex >= 0) return posed_points(body_, pose, {hint.vertex}).row(0).transpose();
  return pose.scale * pose.places[std::size_t(hint.joint)] + pose.shift;
}

// Mean distance from what is known, as a share of kFar.
double PoseSearch::hint_misfit(const ArticulatedState& state) const {
  const RestShape shape = rest_shape(body_, state.z);
  const ArticulatedPose pose = articulate(body_, shape, state);
  double sum = 0;
  for (const PlaceHint& hint : options_.hints)
    sum += std::min(1.0, (hint_point(hint, pose) - hint.place).norm() / (2 * kFar));
  return sum / double(options_.hints.size());
}

// A limb along its joints, where all three are known.
std::optional<LimbPose> PoseSearch::known_limb(bool arm, Side side,
                                               const ArticulatedState& state) const {
  const auto place = [&](const char* name) -> std::optional<Vec3> {
    const int joint = find_segment(body_, name + std::string(side_suffix(side)));
    for (const PlaceHint& hint : options_.hints)
      if (hint.joint == joint && joint >= 0) return hint.place;
    return std::nullopt;
  };
  const auto first = place(arm ? "arm" : "thigh"), middle = place(arm ? "forearm" : "shank"),
             last = place(arm ? "hand" : "foot");
  if (!first || !middle || !last) return std::nullopt;
  const auto towards = [&](const Vec3& from, const Vec3& to) -> Vec3 {
    const Vec3 own = state.turns[0].transpose() * (to - from);
    return side == Side::right ? Vec3(-own.x(), own.y(), own.z()) : own;
  };
  return LimbPose{"as its joints", towards(*first, *middle), towards(*middle, *last)};
}

// Shift and turn of the whole by the known places.
void PoseSearch::lay_over_hints(ArticulatedState& state) const {
  const ArticulatedPose pose = articulate(body_, mean_, state);
  Vec3 own = Vec3::Zero(), theirs = Vec3::Zero();
  for (const PlaceHint& hint : options_.hints) {
    own += hint_point(hint, pose) / double(options_.hints.size());
    theirs += hint.place / double(options_.hints.size());
  }
  Mat3 moment = Mat3::Zero();
  double before = 0, after = 0;
  for (const PlaceHint& hint : options_.hints) {
    const Vec3 a = hint_point(hint, pose) - own, b = hint.place - theirs;
    moment += b * a.transpose();
    before += a.squaredNorm();
    after += b.squaredNorm();
  }
  const Mat3 turn = nearest_rotation(moment);
  const double scale = std::clamp(std::sqrt(after / std::max(before, 1e-9)), 0.5, 2.0);
  const Vec3 centre = body_.joint_mean.row(0).transpose();
  // x = s0 (y) + shift, y turned about the root's centre.
  const double s0 = std::exp(state.log_scale);
  const Vec3 root = s0 * centre + state.shift;
  state.turns[0] = turn * state.turns[0];
  state.log_scale += std::log(scale);
  state.shift = theirs + scale * (turn * (root - own)) - s0 * scale * centre;
}

void PoseSearch::posed(std::vector<PoseHypothesis>& found) const {
  parallel_for_ranges(found.size(), 1, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t h = first; h < last; ++h) {
      PoseHypothesis& one = found[h];
      const std::vector<Mat3> prior = one.state.turns;
      fit_articulated(fit(), sized(kRough), coarse_, tree_, prior, one.state);
      fit_articulated(fit(), sized(kPose), coarse_, tree_, prior, one.state);
      one.misfit = misfit(one.state, middle_, 900);
    }
  });
  keep_distinct(found);
}

double PoseSearch::misfit(const ArticulatedState& state, const BodySamples& samples,
                          int count) const {
  double out =
      two_way_misfit(fit(), samples, tree_, rest_shape(body_, state.z), state, count, 0.5 * kFar);
  if (!options_.hints.empty()) out += 0.5 * hint_misfit(state);
  return out + kTurnCost * mean_squared_turn(body_, state.turns);
}

// Each limb of the best hypotheses in every other way; what fits better stays.
void PoseSearch::other_limbs(std::vector<PoseHypothesis>& found) const {
  std::vector<PoseHypothesis> more;
  for (const PoseHypothesis& one : found) {
    PoseHypothesis best = one;
    for (int limb = 0; limb < 4; ++limb) {
      const bool arm = limb < 2;
      const Side side = limb % 2 == 0 ? Side::left : Side::right;
      std::vector<LimbPose> poses = limb_grid(arm);
      const auto& usual = arm ? arm_poses() : leg_poses();
      poses.insert(poses.end(), usual.begin(), usual.end());
      if (const auto known = known_limb(arm, side, best.state)) poses.push_back(*known);
      std::vector<PoseHypothesis> tries(poses.size(), best);
      parallel_for_ranges(tries.size(), 1, Threads::all, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
          set_limb(body_, arm, side, poses[k], tries[k].state.turns);
          tries[k].name = fmt::format("{}; {} {}", best.name, arm ? "arm" : "leg", poses[k].name);
          tries[k].misfit =
              two_way_misfit(fit(), coarse_, tree_, mean_, tries[k].state, 300, 0.5 * kFar) +
              kTurnCost * mean_squared_turn(body_, tries[k].state.turns);
          if (!options_.hints.empty()) tries[k].misfit += 0.5 * hint_misfit(tries[k].state);
        }
      });
      keep(tries, kLimbs);
      parallel_for_ranges(tries.size(), 1, Threads::all, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
          PoseHypothesis& other = tries[k];
          const std::vector<Mat3> prior = other.state.turns;
          fit_articulated(fit(), sized(kLimb), coarse_, tree_, prior, other.state);
          other.misfit = misfit(other.state, middle_, 900);
        }
      });
      for (PoseHypothesis& other : tries)
        if (other.misfit < best.misfit - 1e-4) best = std::move(other);
    }
    more.push_back(std::move(best));
  }
  found.insert(found.end(), more.begin(), more.end());
  keep_distinct(found);
}

// Those that came to the same place count once, the best of them.
void PoseSearch::keep_distinct(std::vector<PoseHypothesis>& found) const {
  std::stable_sort(found.begin(), found.end(), by_misfit);
  std::vector<PoseHypothesis> distinct;
  std::vector<Points> places;
  for (PoseHypothesis& one : found) {
    Points own = posed_points(body_, articulate(body_, mean_, one.state), coarse_.vertices);
    const bool known = std::any_of(places.begin(), places.end(), [&](const Points& other) {
      return (other - own).rowwise().norm().mean() < 0.03;
    });
    if (known) continue;
    distinct.push_back(std::move(one));
    places.push_back(std::move(own));
  }
  found = std::move(distinct);
}

void PoseSearch::fit_shapes(std::vector<PoseHypothesis>& found) const {
  const std::vector<Mat3> rest(body_.joints.size(), Mat3::Identity());
  FitStage close = kClose, closest = kClosest;
  close.scale = closest.scale = !options_.scale_known;
  for (PoseHypothesis& one : found) {
    fit_articulated(fit(), sized(kShapeStart), middle_, tree_, one.state.turns, one.state);
    fit_articulated(fit(), sized(kShape), middle_, tree_, rest, one.state);
    one.misfit = misfit(one.state, middle_, 1500);
  }
  std::stable_sort(found.begin(), found.end(), by_misfit);
  PoseHypothesis& best = found.front();
  fit_articulated(fit(), close, fine_, tree_, rest, best.state);
  ArticulatedFit held = fit();
  held.still = turn_limb_ends(held, best.state);
  fit_articulated(held, closest, fine_, tree_, rest, best.state);
  best.misfit = misfit(best.state, middle_, 1500);
}

double PoseSearch::rivalry(const std::vector<PoseHypothesis>& found) const {
  const auto places = [&](const PoseHypothesis& one) {
    const RestShape shape = rest_shape(body_, one.state.z);
    return posed_points(body_, articulate(body_, shape, one.state), coarse_.vertices);
  };
  const Points best = places(found.front());
  double out = 0;
  for (std::size_t k = 1; k < found.size(); ++k)
    if ((best - places(found[k])).rowwise().norm().mean() > kOtherBody)
      out = std::max(out, std::clamp(found[0].misfit / std::max(found[k].misfit, 1e-9), 0.0, 1.0));
  return out;
}

}  // namespace ecorche::inline v1
