#include "morph/registration/articulated_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/cross_matrix.h"
#include "anatomy/compute/parallel_ranges.h"

namespace ecorche::inline v1 {
namespace {

// A point of the body, what it should come to, and how much that counts.
struct Match {
  int vertex = -1, joint = -1;
  Vec3 target = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double weight = 0;
  double across = 1;  // weight of the distance across the normal; 1: of the whole distance
};

struct Normal {
  Eigen::MatrixXf A;
  Eigen::VectorXf b;
};

constexpr Eigen::Index kPlace = 4;        // shift and scale come first
constexpr std::size_t kChunk = 96;        // matches gathered into one product
constexpr double kNoise = 0.006;          // m, of a match
constexpr double kIndependent = 400;      // matches that count as independent, of each side
constexpr double kScaleSpread = 0.1;      // of the logarithm of sizes beside the shape
constexpr double kLongestTurn = 0.35;     // rad a round
constexpr double kLimitStiffness = 0.05;  // rad beyond a hinge's end that counts as one deviation

Eigen::Index size_of(const ArticulatedBody& body) {
  return kPlace + 3 * Eigen::Index(body.joints.size()) + body.basis.cols();
}

// Derivatives of a body's points.
class Derivatives {
 public:
  Derivatives(const ArticulatedBody& body, const ArticulatedPose& pose, bool shape)
      : body_(body), pose_(pose), shape_(shape) {
    if (!shape) return;
    const std::size_t count = body.joints.size();
    std::vector<Eigen::MatrixXf> placed(count);
    carried_.resize(count);
    for (std::size_t j = 0; j < count; ++j) {
      const auto own = body.joint_basis.middleRows(Eigen::Index(3 * j), 3);
      const int p = body.joints[j].parent;
      placed[j] = own;
      if (p >= 0)
        placed[j] = placed[std::size_t(p)] +
                    pose.turns[std::size_t(p)].cast<float>() *
                        (own - body.joint_basis.middleRows(Eigen::Index(3 * p), 3));
      carried_[j] = placed[j] - pose.turns[j].cast<float>() * own;
    }
    placed_ = std::move(placed);
  }

  // 3 x P rows of one point, and the point itself.
  Vec3 fill(int vertex, int joint, Eigen::Ref<Eigen::MatrixXf> out) const {
    out.setZero();
    std::array<Vec3, 64> moment;
    std::array<double, 64> weight;
    std::array<int, 64> touched;
    std::size_t count = 0;
    weight.fill(0);
    Vec3 sum = Vec3::Zero();
    const auto add = [&](int bone, double w, const Vec3& rest) {
      const Vec3 x = pose_.turns[bone] * (rest - pose_.shape.centres.row(bone).transpose()) +
                     pose_.places[bone];
      sum += w * x;
      for (int j = bone; j >= 0; j = body_.joints[j].parent) {
        const auto at = std::size_t(j);
        if (weight[at] == 0) {
          touched[count++] = j;
          moment[at] = Vec3::Zero();
        }
        weight[at] += w;
        moment[at] += w * x;
      }
    };
    if (joint >= 0) {
      add(joint, 1, pose_.shape.centres.row(joint).transpose());
    } else {
      const Vec3 rest = pose_.shape.skin.row(vertex);
      for (int k = body_.weights.start[vertex]; k < body_.weights.start[vertex + 1]; ++k)
        if (body_.weights.weight[k] > 1e-4)
          add(body_.weights.bone[k], body_.weights.weight[k], rest);
    }
    const double scale = pose_.scale;
    out.block<3, 3>(0, 0).setIdentity();
    out.col(3) = (scale * sum).cast<float>();
    for (std::size_t c = 0; c < count; ++c) {
      const int j = touched[c], p = body_.joints[j].parent;
      const Vec3 arm = scale * (moment[std::size_t(j)] - weight[std::size_t(j)] * pose_.places[j]);
      const Mat3 turned = p < 0 ? Mat3::Identity() : pose_.turns[p];
      out.block<3, 3>(0, kPlace + 3 * j) = (-cross_matrix(arm) * turned).cast<float>();
    }
    if (shape_) {
      const Eigen::Index K = body_.basis.cols();
      auto shape = out.rightCols(K);
      if (joint >= 0) {
        shape = float(scale) * placed_[std::size_t(joint)];
      } else {
        Mat3 blend = Mat3::Zero();
        for (int k = body_.weights.start[vertex]; k < body_.weights.start[vertex + 1]; ++k) {
          blend += body_.weights.weight[k] * pose_.turns[body_.weights.bone[k]];
          shape += float(scale * body_.weights.weight[k]) * carried_[body_.weights.bone[k]];
        }
        shape.noalias() +=
            (scale * blend).cast<float>() * body_.basis.middleRows(Eigen::Index(3) * vertex, 3);
      }
    }
    return scale * sum + pose_.shift;
  }

 private:
  const ArticulatedBody& body_;
  const ArticulatedPose& pose_;
  bool shape_;
  std::vector<Eigen::MatrixXf> carried_, placed_;
};

// Normal equations of the matches, summed in the same order on any number of threads.
Normal gather(const ArticulatedBody& body, const ArticulatedPose& pose,
              const std::vector<Match>& matches, bool shape) {
  const Derivatives derivatives(body, pose, shape);
  const Eigen::Index P = size_of(body);
  const std::size_t chunks = (matches.size() + kChunk - 1) / kChunk;
  constexpr std::size_t kParts = 8;
  std::array<Normal, kParts> parts;
  parallel_for_ranges(kParts, 1, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part) {
      Normal& own = parts[part];
      own.A.setZero(P, P);
      own.b.setZero(P);
      Eigen::MatrixXf rows(Eigen::Index(4 * kChunk), P), jacobian(3, P);
      Eigen::VectorXf right(Eigen::Index(4 * kChunk));
      for (std::size_t chunk = part; chunk < chunks; chunk += kParts) {
        Eigen::Index used = 0;
        for (std::size_t m = chunk * kChunk; m < std::min(matches.size(), (chunk + 1) * kChunk);
             ++m) {
          const Match& match = matches[m];
          const Vec3 x = derivatives.fill(match.vertex, match.joint, jacobian);
          const Vec3 r = match.target - x;
          if (match.across > 0) {
            const float w = float(std::sqrt(match.weight * match.across));
            rows.middleRows(used, 3) = w * jacobian;
            right.segment(used, 3) = w * r.cast<float>();
            used += 3;
          }
          if (match.across < 1) {
            const float w = float(std::sqrt(match.weight * (1 - match.across)));
            rows.row(used) = w * (match.normal.cast<float>().transpose() * jacobian);
            right[used] = w * float(match.normal.dot(r));
            ++used;
          }
        }
        own.A.selfadjointView<Eigen::Lower>().rankUpdate(rows.topRows(used).transpose());
        own.b.noalias() += rows.topRows(used).transpose() * right.head(used);
      }
    }
  });
  Normal out = std::move(parts[0]);
  for (std::size_t part = 1; part < kParts; ++part) {
    out.A += parts[part].A;
    out.b += parts[part].b;
  }
  return out;
}

// Outward normals of chosen vertices, from the triangles about them.
Points normals_at(const ArticulatedBody& body, const ArticulatedPose& pose,
                  const std::vector<int>& vertices) {
  Points out(Eigen::Index(vertices.size()), 3);
  for (std::size_t r = 0; r < vertices.size(); ++r)
    out.row(Eigen::Index(r)) =
        (blended_turn(body, pose, vertices[r]) * pose.shape.normals.row(vertices[r]).transpose())
            .normalized()
            .transpose();
  return out;
}

double robust(double distance, double width) {
  const double q = 1 / (1 + distance * distance / (width * width));
  return q * q;
}

// Whether most of the vertex hangs on one of the joints.
bool hangs_on(const ArticulatedBody& body, int vertex, const std::vector<int>& joints) {
  double on = 0;
  for (int k = body.weights.start[vertex]; k < body.weights.start[vertex + 1]; ++k)
    if (std::find(joints.begin(), joints.end(), body.weights.bone[k]) != joints.end())
      on += body.weights.weight[k];
  return on > 0.5;
}

std::vector<Match> find_matches(const ArticulatedFit& fit, const FitStage& stage,
                                const BodySamples& samples, const PointTree& scan_tree,
                                const SurfacePoints& posed) {
  const SurfacePoints& scan = fit.scan.surface;
  const std::size_t own = samples.vertices.size();
  const std::size_t theirs =
      std::min<std::size_t>(std::size_t(stage.samples), fit.scan.spread.size());
  std::vector<Match> out(own + theirs);
  const PointTree body_tree(posed, stage.reach);
  // While much is still off, matches are as rough as their width.
  const double noise = std::max(kNoise, stage.width / 8);
  const double one = kIndependent / (noise * noise);
  parallel_for_ranges(own, 64, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const NearPoint near =
          scan_tree.nearest(posed.points.row(Eigen::Index(i)), posed.normals.row(Eigen::Index(i)));
      Match& match = out[i];
      match.vertex = samples.vertices[i];
      match.target = scan.points.row(near.index);
      match.normal = scan.normals.row(near.index);
      match.across = match.normal.squaredNorm() > 0.5 ? stage.across : 1;
      match.weight = (fit.scan.one_sided ? 0.3 : 1) * one * samples.weights[i] *
                     robust(near.distance, stage.width);
      // Beyond an edge of what was seen there may be more of the body.
      if (stage.shape && !fit.scan.border.empty() && fit.scan.border[std::size_t(near.index)])
        match.weight = 0;
      if (!fit.still.empty() && hangs_on(fit.body, match.vertex, fit.still)) match.weight = 0;
    }
  });
  parallel_for_ranges(theirs, 64, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const int i = fit.scan.spread[k];
      const NearPoint near = body_tree.nearest(scan.points.row(i), scan.normals.row(i));
      Match& match = out[own + k];
      match.vertex = samples.vertices[std::size_t(near.index)];
      match.target = scan.points.row(i);
      match.normal = posed.normals.row(near.index);
      match.across = stage.across;
      match.weight = one / double(theirs) * robust(near.distance, stage.width);
    }
  });
  return out;
}

// Priors on turns and shape, on the diagonal blocks.
void add_priors(const ArticulatedBody& body, const FitStage& stage, const std::vector<Mat3>& prior,
                const ArticulatedState& state, Normal& equations) {
  const auto add = [&](Eigen::Index at, const Mat3& stiffness, const Vec3& away) {
    equations.A.block<3, 3>(at, at) += stiffness.cast<float>();
    equations.b.segment<3>(at) -= (stiffness * away).cast<float>();
  };
  for (std::size_t j = 1; j < body.joints.size(); ++j) {
    const SegmentJoint& joint = body.joints[j];
    const Eigen::AngleAxisd off(Mat3(state.turns[j] * prior[j].transpose()));
    const Vec3 away = off.angle() * off.axis();
    const Mat3 along = joint.axis * joint.axis.transpose();
    const double twist = stage.settled ? joint.skin_twist : joint.twist;
    Mat3 stiffness =
        (Mat3::Identity() - along) / (joint.bend * joint.bend) + along / (twist * twist);
    const Eigen::Index at = kPlace + 3 * Eigen::Index(j);
    if (joint.hinge.squaredNorm() > 0) {
      const Vec3 side = joint.hinge.cross(joint.axis).normalized();
      stiffness += side * side.transpose() / (0.01 * joint.bend * joint.bend);
      const Eigen::AngleAxisd whole(state.turns[j]);
      const double flexed = whole.angle() * whole.axis().dot(joint.hinge);
      const double beyond = flexed < joint.hinge_min   ? flexed - joint.hinge_min
                            : flexed > joint.hinge_max ? flexed - joint.hinge_max
                                                       : 0;
      if (beyond != 0)
        add(at, joint.hinge * joint.hinge.transpose() / (kLimitStiffness * kLimitStiffness),
            beyond * joint.hinge);
    }
    if (const Eigen::AngleAxisd whole(state.turns[j]);
        stage.settled && joint.most > 0 && whole.angle() > joint.most)
      add(at, whole.axis() * whole.axis().transpose() / (kLimitStiffness * kLimitStiffness),
          (whole.angle() - joint.most) * whole.axis());
    add(at, stage.pose_prior * stiffness, away);
  }
  const Eigen::Index K = state.z.size(), first = equations.b.size() - K;
  const float stiff = float(stage.shape ? stage.shape_prior : 1e6);
  for (Eigen::Index k = 0; k < K; ++k) {
    equations.A(first + k, first + k) += stiff;
    if (stage.shape) equations.b[first + k] -= stiff * float(state.z[k]);
  }
}

void hold(Eigen::Index at, Normal& equations) {
  equations.A.row(at).setZero();
  equations.A.col(at).setZero();
  equations.A(at, at) = 1;
  equations.b[at] = 0;
}

// All but the turns of those joints.
void hold_others(const std::vector<int>& joints, Normal& equations) {
  std::vector<char> moves(std::size_t(equations.b.size()), 0);
  for (const int j : joints)
    for (int k = 0; k < 3; ++k) moves[std::size_t(kPlace + 3 * j + k)] = 1;
  for (Eigen::Index at = 0; at < equations.b.size(); ++at)
    if (!moves[std::size_t(at)]) hold(at, equations);
}

}  // namespace

BodySamples spread_vertices(const ArticulatedBody& body, int count) {
  double total = 0;
  for (const double a : body.area) total += a;
  BodySamples out;
  const double step = total / count;
  double passed = step / 2;
  // In the order of the mesh neighbouring vertices lie close together, so that even steps of area
  // along it are spread over the skin.
  std::vector<double> gathered;
  for (std::size_t i = 0; i < body.area.size(); ++i) {
    passed += body.area[i];
    if (passed < step || body.area[i] <= 0) continue;
    out.vertices.push_back(int(i));
    gathered.push_back(passed);
    passed = 0;
  }
  double sum = 0;
  for (std::size_t k = 0; k < out.vertices.size(); ++k) {
    const BodyPart part = body.parts[std::size_t(out.vertices[k])].part;
    const double share = part == BodyPart::hand ? 0.5 : 1;
    out.weights.push_back(share * gathered[k]);
    sum += out.weights.back();
  }
  for (double& weight : out.weights) weight /= sum;
  return out;
}

void fit_articulated(const ArticulatedFit& fit, const FitStage& stage, const BodySamples& samples,
                     const PointTree& scan_tree, const std::vector<Mat3>& prior,
                     ArticulatedState& state) {
  const ArticulatedBody& body = fit.body;
  const Eigen::Index joints = Eigen::Index(body.joints.size());
  RestShape shape = rest_shape(body, state.z);
  for (int round = 0; round < stage.rounds; ++round) {
    if (stage.shape && round > 0) shape = rest_shape(body, state.z);
    const ArticulatedPose pose = articulate(body, shape, state);
    SurfacePoints posed{posed_points(body, pose, samples.vertices),
                        normals_at(body, pose, samples.vertices)};
    std::vector<Match> matches = find_matches(fit, stage, samples, scan_tree, posed);
    for (const PlaceHint& hint : fit.hints)
      matches.push_back({hint.vertex, hint.joint, hint.place, Vec3::Zero(),
                         1 / (hint.accuracy * hint.accuracy), 1});
    Normal equations = gather(body, pose, matches, stage.shape);
    add_priors(body, stage, prior, state, equations);
    equations.A(3, 3) += float(1 / (kScaleSpread * kScaleSpread));
    equations.b[3] -= float(state.log_scale / (kScaleSpread * kScaleSpread));
    if (!stage.scale) hold(3, equations);
    if (!fit.joints.empty()) hold_others(fit.joints, equations);
    for (const int j : fit.still)
      for (int k = 0; k < 3; ++k) hold(kPlace + 3 * j + k, equations);
    Eigen::MatrixXd A = equations.A.cast<double>();
    A.diagonal() += 1e-3 * A.diagonal() + Eigen::VectorXd::Constant(A.rows(), 1e-3);
    const Eigen::VectorXd step = solve_llt(A, equations.b.cast<double>());
    if (!step.allFinite()) return;
    double most = 0;
    for (Eigen::Index j = 0; j < joints; ++j)
      most = std::max(most, step.segment<3>(kPlace + 3 * j).norm());
    const double share = std::min(1.0, kLongestTurn / std::max(most, 1e-12));
    state.shift += share * step.head<3>();
    state.log_scale += share * std::clamp(step[3], -0.2, 0.2);
    for (Eigen::Index j = 0; j < joints; ++j) {
      const Vec3 turn = share * step.segment<3>(kPlace + 3 * j);
      const double angle = turn.norm();
      if (angle > 1e-12)
        state.turns[std::size_t(j)] =
            Eigen::AngleAxisd(angle, turn / angle) * state.turns[std::size_t(j)];
    }
    state.z += share * step.tail(state.z.size());
  }
}

double two_way_misfit(const ArticulatedFit& fit, const BodySamples& samples,
                      const PointTree& scan_tree, const RestShape& shape,
                      const ArticulatedState& state, int scan_samples, double most) {
  const ArticulatedPose pose = articulate(fit.body, shape, state);
  const SurfacePoints posed{posed_points(fit.body, pose, samples.vertices),
                            normals_at(fit.body, pose, samples.vertices)};
  double own = 0, theirs = 0;
  for (std::size_t i = 0; i < samples.vertices.size(); ++i) {
    const NearPoint near =
        scan_tree.nearest(posed.points.row(Eigen::Index(i)), posed.normals.row(Eigen::Index(i)));
    own += samples.weights[i] * std::min(1.0, near.distance / most);
  }
  const PointTree body_tree(posed, 0.1);
  const std::size_t count =
      std::min<std::size_t>(std::size_t(scan_samples), fit.scan.spread.size());
  for (std::size_t k = 0; k < count; ++k) {
    const int i = fit.scan.spread[k];
    const NearPoint near =
        body_tree.nearest(fit.scan.surface.points.row(i), fit.scan.surface.normals.row(i));
    theirs += std::min(1.0, near.distance / most);
  }
  const double share = fit.scan.one_sided ? 0.15 : 0.5;
  return share * own + (1 - share) * theirs / double(std::max<std::size_t>(count, 1));
}

}  // namespace ecorche::inline v1
