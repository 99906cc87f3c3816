#include "morph/registration/register_scan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "morph/measures/body_volume.h"
#include "morph/measures/measure_table.h"
#include "morph/registration/body_proportions.h"
#include "morph/registration/even_points.h"
#include "morph/registration/judge_registration.h"
#include "morph/registration/pose_search.h"
#include "morph/registration/surface_fit.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kSearched = 20000;  // points that poses are searched with

double milliseconds_since(std::chrono::steady_clock::time_point from) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
}

std::vector<PlaceHint> known_places(const RegistrationModel& model, const Scan& scan,
                                    const RegistrationOptions& options) {
  std::vector<PlaceHint> out;
  // Joints of our skeleton that are joints of the segments, too.
  static const std::map<std::string, std::string> segments{
      {"pelvis", "pelvis"},   {"hip", "thigh"},    {"knee", "shank"},    {"ankle", "foot"},
      {"mtp2", "toes"},       {"shoulder", "arm"}, {"elbow", "forearm"}, {"wrist", "hand"},
      {"clavicle", "girdle"}, {"c7", "neck"},      {"head", "head"}};
  for (const Landmark& joint : options.joints) {
    std::string name = joint.name, side;
    if (name.ends_with("_l") || name.ends_with("_r")) {
      side = name.substr(name.size() - 2);
      name.resize(name.size() - 2);
    }
    const auto known = segments.find(name);
    const int segment =
        find_segment(model.body, known != segments.end() ? known->second + side : joint.name);
    if (segment >= 0)
      out.push_back({segment, -1, scan.unit * joint.position, options.joint_accuracy});
  }
  const auto vertices = registration_landmarks(model);
  for (const Landmark& landmark : options.landmarks) {
    const auto known = std::find_if(vertices.begin(), vertices.end(),
                                    [&](const auto& v) { return v.first == landmark.name; });
    if (known != vertices.end())
      out.push_back({-1, known->second, scan.unit * landmark.position, 0.01});
  }
  return out;
}

struct AtRest {
  Points skin;             // #skin x 3, in the units of the articulated body
  std::vector<Mat3> turn;  // #skin
};

// What the surface differs from the articulated shape by, carried back to the rest pose. Where
// joints are bent far, blends of turns lose their volume and say little about the rest: there it
// is continued from around.
AtRest to_rest(const ArticulatedBody& body, const ArticulatedPose& pose, const Points& start,
               const Points& posed) {
  const Eigen::Index n = posed.rows();
  Points residual(n, 3);
  std::vector<double> weight(std::size_t(n), 1);
  AtRest out;
  out.turn.resize(std::size_t(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const Mat3 blend = blended_turn(body, pose, int(i)) / pose.scale;
    const Mat3 turn = nearest_rotation(blend);
    out.turn[std::size_t(i)] = turn;
    residual.row(i) =
        (turn.transpose() * (posed.row(i) - start.row(i)).transpose() / pose.scale).transpose();
    weight[std::size_t(i)] = std::clamp((svd(blend).S[2] - 0.75) / 0.2, 0.0, 1.0);
  }
  const Points smooth = smooth_over_skin(body, pose.shape.skin, residual, weight, 0.012);
  out.skin = pose.shape.skin;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double w = weight[std::size_t(i)];
    out.skin.row(i) += w * residual.row(i) + (1 - w) * smooth.row(i);
  }
  return out;
}

// The nearest turn by quarters about the axes, else the turn itself: files keep their axes where
// these are ours in another order.
Mat3 up_turn(const Mat3& turn) {
  Mat3 best = turn;
  double nearest = 20 * kDegree;
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) {
      if (a / 2 == b / 2) continue;
      Vec3 up = Vec3::Zero(), front = Vec3::Zero();
      up[a / 2] = a % 2 == 0 ? 1 : -1;
      front[b / 2] = b % 2 == 0 ? 1 : -1;
      Mat3 one;
      one.row(0) = up.cross(front).transpose();
      one.row(1) = up.transpose();
      one.row(2) = front.transpose();
      const double angle = Eigen::AngleAxisd(Mat3(one * turn.transpose())).angle();
      if (angle < nearest) {
        nearest = angle;
        best = one;
      }
    }
  }
  return best;
}

// Whether a size that was not told by a person can be one's stature.
bool is_stature(double stature, const Scan& scan) {
  constexpr double kLeast = 0.9, kMost = 2.3;  // m
  return scan.unit_told || (stature > kLeast && stature < kMost);
}

// World of the registered pose: upright, on the floor, in metres.
void place(const RegistrationModel& model, const Scan& scan, const std::optional<double>& known,
           const ArticulatedState& state, const ArticulatedPose& pose, const Points& posed,
           AtRest at_rest, Registration& out) {
  const ArticulatedBody& body = model.body;
  Points rest = std::move(at_rest.skin);
  double scale = 1;
  if (known) {
    scale = *known / stature(model.package, rest);
    rest *= scale;
    scale /= pose.scale;
  } else if (!scan.unit_known || !is_stature(pose.scale * stature(model.package, rest), scan)) {
    scale = 1 / pose.scale;
  } else {
    rest *= pose.scale;
  }
  const double size = scale * pose.scale;  // rest body's own units to ours
  const Mat3 upright = up_turn(state.turns[0].transpose());
  out.scale = scale * scan.unit;
  out.axes = upright;
  Points moved = scale * posed * upright.transpose();
  Vec3 shift = -moved.colwise().mean().transpose();
  shift.y() = -moved.col(1).minCoeff();
  moved.rowwise() += shift.transpose();
  out.shift = shift;
  out.posed = std::move(moved);
  out.turn = std::move(at_rest.turn);
  for (Mat3& turn : out.turn) turn = upright * turn;
  const double floor = rest.col(1).minCoeff();
  rest.col(1).array() -= floor;
  out.body.skin = {rest, body.F};
  out.body.sex = told_sex(model.sexes, rest);
  out.body.age = 0;
  out.body.mass = kBodyDensity * skin_volume(model.package, rest);
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    out.pose.joints.push_back(body.joints[j].name);
    out.pose.parents.push_back(body.joints[j].parent);
    Vec3 centre = size * pose.shape.centres.row(Eigen::Index(j)).transpose();
    centre.y() -= floor;
    out.pose.rest.push_back(centre);
    out.pose.posed.push_back(upright * (scale * (pose.scale * pose.places[j] + pose.shift)) +
                             shift);
    out.pose.rotations.push_back(Quat(j == 0 ? Mat3(upright * state.turns[0]) : state.turns[j]));
  }
}

Registration register_known(const RegistrationModel& model, const Scan& scan,
                            const std::vector<PlaceHint>& hints,
                            const RegistrationOptions& options) {
  const ArticulatedBody& body = model.body;
  const auto watch = [&](const char* stage, const ArticulatedState& state) {
    if (!options.watch) return;
    const RestShape shape = rest_shape(body, state.z);
    options.watch(stage, posed_points(body, articulate(body, shape, state)));
  };
  Registration out;
  const EvenPoints points = even_points(scan);
  const PoseSearch search(body, spread_points(points, kSearched),
                          {scan.one_view, scan.unit_known, scan.up, hints, options.pose});
  auto begin = std::chrono::steady_clock::now();
  std::vector<PoseHypothesis> found = search.find_poses();
  out.report.pose_ms = milliseconds_since(begin);
  watch("pose", found.front().state);
  begin = std::chrono::steady_clock::now();
  search.fit_shapes(found);
  out.report.shape_ms = milliseconds_since(begin);
  const ArticulatedState& state = found.front().state;
  watch("shape", state);
  begin = std::chrono::steady_clock::now();
  const RestShape shape = rest_shape(body, state.z);
  const ArticulatedPose pose = articulate(body, shape, state);
  const Points start = posed_points(body, pose);
  SurfaceFit fitted = fit_surface(
      {body, points.surface, points.area, points.border, points.covering, points.spacing}, start);
  out.seen = std::move(fitted.seen);
  place(model, scan, options.stature ? options.stature : scan.stature, state, pose, fitted.posed,
        to_rest(body, pose, start, fitted.posed), out);
  out.report.surface_ms = milliseconds_since(begin);
  out.report.shape_distance = std::sqrt(state.z.squaredNorm() / double(state.z.size()));
  out.report.doubt = search.rivalry(found);
  out.report.turn_deviation = std::sqrt(mean_squared_turn(body, state.turns));
  judge_registration({body, scan, search.target(), search.tree(), start, fitted.posed, hints}, out);
  return out;
}

}  // namespace

RegistrationModel make_registration_model(const Assets& assets) {
  const BodyModel model(assets);
  return {model.package(), make_articulated_body(model), make_sex_laws(model)};
}

std::vector<std::pair<std::string, int>> registration_landmarks(const RegistrationModel& model) {
  return landmark_vertices(model.package,
                           read_measure_table(model.package, model.package.tables / "body"));
}

Registration register_scan(const RegistrationModel& model, const Scan& scan,
                           const RegistrationOptions& options) {
  if (scan.points.rows() < 100) throw UnfitError("the scan has hardly any points");
  const std::vector<PlaceHint> hints = known_places(model, scan, options);
  const std::vector<std::string> unusual = unusual_proportions(model.body, scan, hints);
  const std::string stylised =
      unusual.empty() ? ""
                      : fmt::format("beside its trunk, {} as people's, by the file's joints",
                                    fmt::join(unusual, ", "));
  try {
    Registration out = register_known(model, scan, hints, options);
    if (!stylised.empty()) out.report.doubts.push_back(stylised);
    return out;
  } catch (const UnfitError& error) {
    if (stylised.empty()) throw;
    throw UnfitError(fmt::format("a stylised character: {}; {}", stylised, error.what()));
  }
}

}  // namespace ecorche::inline v1
