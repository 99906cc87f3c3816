#include "skinning/bake.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "anatomy/errors.h"
#include "anatomy/mesh_measures.h"
#include "skinning/bake_shapes.h"
#include "skinning/bake_weights.h"
#include "skinning/skin_survey.h"

namespace ecorche {
namespace {

constexpr int kMostCandidates = 12;

using Directions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct Samples {
  std::vector<std::vector<Transform>> bones;  // a frame: maps of rest points by each joint
  std::vector<Points> exact;                  // a frame: #V x 3
  std::vector<Directions> normals;            // a frame: #V x 3, unit
};

std::vector<Transform> rest_to_pose(const std::vector<Vec3>& origins, std::span<const Transform> X_WJ) {
  std::vector<Transform> out(X_WJ.begin(), X_WJ.end());
  for (std::size_t j = 0; j < out.size(); ++j) out[j].translate(-origins[j]);
  return out;
}

Directions normals_of(const SkinFrame& frame) {
  const Eigen::Index n = static_cast<Eigen::Index>(frame.normals.size() / 4);
  return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>>(frame.normals.data(), n, 4).leftCols<3>();
}

Samples take_samples(const Skeleton& skeleton, const ExactSkin& exact, const std::vector<BakedMotion>& motions, int wanted) {
  std::size_t total = 0;
  for (const BakedMotion& each : motions) total += each.motion.frames.size();
  if (total == 0) throw UnfitError("there is nothing to bake: the motions hold no frames");
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const double stride = std::max(1.0, static_cast<double>(total) / wanted);
  Samples out;
  std::vector<Transform> X_WJ;
  SkinFrame frame;
  std::size_t at = 0;
  double next = 0;
  for (const BakedMotion& each : motions)
    for (const Pose& pose : each.motion.frames) {
      if (static_cast<double>(at++) < next) continue;
      next += stride;
      exact(pose, X_WJ, frame);
      out.bones.push_back(rest_to_pose(origins, X_WJ));
      to_points(frame, out.exact.emplace_back());
      out.normals.push_back(normals_of(frame));
    }
  return out;
}

// Joints that a vertex may hang on: those that it and its neighbours hang on already, and those next to them in the tree.
std::vector<int> candidates(const Skeleton& skeleton, std::span<const std::array<Influence, 4>> start, const std::vector<int>& ring, int vertex) {
  std::vector<double> share(skeleton.joints.size(), 0);
  const auto add = [&](int i, double scale) {
    for (const Influence& influence : start[static_cast<std::size_t>(i)]) share[static_cast<std::size_t>(influence.joint)] += scale * influence.weight;
  };
  add(vertex, 1);
  for (int i : ring) add(i, 0.5 / static_cast<double>(ring.size()));
  std::vector<double> spread = share;
  for (std::size_t j = 1; j < share.size(); ++j) {
    const std::size_t parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    spread[parent] += 0.1 * share[j];
    spread[j] += 0.1 * share[parent];
  }
  std::vector<int> order;
  for (std::size_t j = 0; j < spread.size(); ++j)
    if (spread[j] > 0) order.push_back(static_cast<int>(j));
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return spread[static_cast<std::size_t>(a)] > spread[static_cast<std::size_t>(b)]; });
  if (order.size() > kMostCandidates) order.resize(kMostCandidates);
  return order;
}

std::array<Influence, 4> solve_vertex(const Samples& samples, const Vec3& X, const Vec3& N, Eigen::Index vertex, const std::vector<int>& joints,
                                      const std::array<Influence, 4>& start, const BakeOptions& options) {
  const Eigen::Index n = static_cast<Eigen::Index>(joints.size());
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n), D(6, n);
  for (std::size_t f = 0; f < samples.bones.size(); ++f) {
    const Vec3 wanted = samples.exact[f].row(vertex).transpose(), facing = samples.normals[f].row(vertex).transpose().cast<double>();
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Matrix4d& T = samples.bones[f][static_cast<std::size_t>(joints[static_cast<std::size_t>(k)])].matrix();
      for (Eigen::Index r = 0; r < 3; ++r) {
        D(r, k) = T(r, 0) * X[0] + T(r, 1) * X[1] + T(r, 2) * X[2] + T(r, 3) - wanted[r];
        D(r + 3, k) = options.normal_arm * (T(r, 0) * N[0] + T(r, 1) * N[1] + T(r, 2) * N[2] - facing[r]);
      }
    }
    G.noalias() += D.transpose() * D;
  }
  Eigen::VectorXd given = Eigen::VectorXd::Zero(n);
  for (const Influence& influence : start)
    for (Eigen::Index k = 0; k < n; ++k)
      if (joints[static_cast<std::size_t>(k)] == influence.joint) given[k] += influence.weight;
  const Eigen::VectorXd w = simplex_weights(G, given, static_cast<double>(samples.bones.size()) * options.keep_weights * options.keep_weights, 4);
  std::array<Influence, 4> out{};
  std::size_t at = 0;
  for (Eigen::Index k = 0; k < n; ++k)
    if (w[k] > 0) out[at++] = {joints[static_cast<std::size_t>(k)], w[k]};
  std::stable_sort(out.begin(), out.end(), [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  return out;
}

Eigen::Affine3d blended(const std::array<Influence, 4>& influences, std::span<const Transform> bones) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Influence& influence : influences)
    if (influence.weight > 0) sum += influence.weight * bones[static_cast<std::size_t>(influence.joint)].matrix();
  return Eigen::Affine3d(sum);
}

// Where joints that a vertex hangs on turn far against each other, their blend falls flat and no shape could push through it: such a
// vertex leans as far on its first joint as keeps the blend open in every sample.
void keep_open(const Samples& samples, std::array<Influence, 4>& influences) {
  constexpr double kLeastVolume = 0.35;
  constexpr int kSteps = 32;
  const std::array<Influence, 4> solved = influences;
  for (int step = 0; step <= kSteps; ++step) {
    const double lean = static_cast<double>(step) / kSteps;
    for (std::size_t k = 0; k < 4; ++k) influences[k].weight = (1 - lean) * solved[k].weight + (k == 0 ? lean : 0);
    double least = 1;
    for (const std::vector<Transform>& bones : samples.bones) least = std::min(least, blended(influences, bones).linear().determinant());
    if (least >= kLeastVolume) return;
  }
}

// The inverse, or that of the nearest rotation where the blend has fallen flat.
Mat3 back_to_rest(const Mat3& A) {
  if (A.determinant() > 0.2) return A.inverse();
  const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixV() * svd.matrixU().transpose();
}

// What the influences leave over, in the rest pose. 3 #V
Eigen::VectorXd leftover(const Bake& bake, const TriMesh& skin, std::span<const Transform> bones, const Points& exact) {
  Eigen::VectorXd out(3 * skin.V.rows());
  tbb::parallel_for(Eigen::Index{0}, skin.V.rows(), [&](Eigen::Index i) {
    const Eigen::Affine3d A = blended(bake.influences[static_cast<std::size_t>(i)], bones);
    out.segment<3>(3 * i) = back_to_rest(A.linear()) * (Vec3(exact.row(i)) - A * Vec3(skin.V.row(i)));
  });
  return out;
}

// Errors in ten thousand bins, so that percentiles of any number of frames need no memory.
class Errors {
 public:
  explicit Errors(double bin) : bin_(bin) {}
  void add(double d) {
    ++count_;
    sum_ += d;
    squares_ += d * d;
    max_ = std::max(max_, d);
    ++bins_[std::min(static_cast<std::size_t>(d / bin_), bins_.size() - 1)];
  }
  double mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }
  double rms() const { return count_ == 0 ? 0 : std::sqrt(squares_ / static_cast<double>(count_)); }
  double max() const { return max_; }
  double p95() const {
    std::size_t below = 0, bin = 0;
    while (bin + 1 < bins_.size() && (below += bins_[bin]) < static_cast<std::size_t>(0.95 * static_cast<double>(count_))) ++bin;
    return std::min(bin_ * static_cast<double>(bin + 1), max_);
  }

 private:
  double bin_;
  std::vector<std::size_t> bins_ = std::vector<std::size_t>(10000, 0);
  std::size_t count_ = 0;
  double sum_ = 0, squares_ = 0, max_ = 0;
};

// Curves of every frame, by projection on the shapes. Returns what influences left over in the `wanted` frames that the shapes miss most.
std::vector<Eigen::VectorXd> follow_shapes(const TriMesh& skin, const Skeleton& skeleton, const ExactSkin& exact, const Shapes& shapes,
                                           std::size_t wanted, Bake& bake) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::multimap<double, Eigen::VectorXd> missed;
  std::vector<Transform> X_WJ;
  SkinFrame frame;
  Points points;
  for (BakedMotion& each : bake.motions) {
    each.curves.resize(static_cast<Eigen::Index>(each.motion.frames.size()), shapes.offsets.cols());
    for (std::size_t f = 0; f < each.motion.frames.size(); ++f) {
      exact(each.motion.frames[f], X_WJ, frame);
      to_points(frame, points);
      Eigen::VectorXd left = leftover(bake, skin, rest_to_pose(origins, X_WJ), points);
      const Eigen::VectorXd c = shapes.projector.transpose() * left;
      each.curves.row(static_cast<Eigen::Index>(f)) = c.cast<float>();
      if (wanted == 0) continue;
      const Eigen::VectorXd rest = left - shapes.offsets * c;
      missed.emplace(Eigen::Map<const Points>(rest.data(), skin.V.rows(), 3).rowwise().squaredNorm().maxCoeff(), std::move(left));
      if (missed.size() > wanted) missed.erase(missed.begin());
    }
  }
  std::vector<Eigen::VectorXd> out;
  for (auto& [distance, left] : missed) out.push_back(std::move(left));
  return out;
}

// Shapes and curves are scaled so that no curve leaves -1 .. 1, and what a shape hardly moves is left out of it. Returns what the curves
// were divided by.
Eigen::VectorXd scale_shapes(const TriMesh& skin, const Shapes& shapes, const BakeOptions& options, Bake& bake) {
  Eigen::ArrayXf reach = Eigen::ArrayXf::Constant(shapes.offsets.cols(), 1e-9f);
  for (const BakedMotion& each : bake.motions)
    if (each.curves.rows() > 0) reach = reach.max(each.curves.cwiseAbs().colwise().maxCoeff().transpose().array());
  for (BakedMotion& each : bake.motions) each.curves.array().rowwise() /= reach.transpose();
  for (Eigen::Index m = 0; m < shapes.offsets.cols(); ++m) {
    Points shape = Eigen::Map<const Points>(shapes.offsets.col(m).data(), skin.V.rows(), 3) * static_cast<double>(reach[m]);
    for (Eigen::Index i = 0; i < shape.rows(); ++i)
      if (shape.row(i).norm() < options.least_offset) shape.row(i).setZero();
    bake.morphs.push_back(shape.cast<float>().cast<double>());
  }
  return reach.cast<double>();
}

// The shapes' changes of the normals: those that, with the curves that the samples have, bring the turned normals closest to the exact ones.
// `curves`: #morphs x #samples.
void fit_normals(const TriMesh& skin, const Samples& samples, const Eigen::MatrixXd& curves, const BakeOptions& options, Bake& bake) {
  const Points rest = vertex_normals(skin);
  const Eigen::Index morphs = curves.rows(), count = curves.cols();
  Eigen::MatrixXd gram = curves * curves.transpose();
  gram.diagonal().array() += 1e-4 * static_cast<double>(count);
  const Eigen::MatrixXd projector = gram.ldlt().solve(curves);  // #morphs x #samples
  bake.morph_normals.assign(static_cast<std::size_t>(morphs), Points::Zero(rest.rows(), 3));
  tbb::parallel_for(Eigen::Index{0}, rest.rows(), [&](Eigen::Index i) {
    Eigen::MatrixXd left(count, 3);
    for (Eigen::Index f = 0; f < count; ++f) {
      const auto& bones = samples.bones[static_cast<std::size_t>(f)];
      const Mat3 back = back_to_rest(blended(bake.influences[static_cast<std::size_t>(i)], bones).linear());
      const Vec3 wanted = (back * samples.normals[static_cast<std::size_t>(f)].row(i).transpose().cast<double>()).normalized();
      left.row(f) = wanted.transpose() - rest.row(i);
    }
    const Eigen::MatrixXd changes = projector * left;
    for (Eigen::Index m = 0; m < morphs; ++m)
      if (changes.row(m).norm() >= options.least_turn) bake.morph_normals[static_cast<std::size_t>(m)].row(i) = changes.row(m).cast<float>().cast<double>();
  });
}

// The angle between a normal as an engine has it and the exact one, degrees.
double angle_off(const std::array<Influence, 4>& influences, std::span<const Transform> bones, const Vec3& shaped, const Vec3& exact) {
  const Vec3 played = blended(influences, bones).linear() * shaped;
  return std::atan2(played.cross(exact).norm(), played.dot(exact)) * 180 / std::numbers::pi;
}

Points shaped_normals(const Bake& bake, const Points& rest, const Eigen::VectorXf& curves) {
  Points out = rest;
  for (std::size_t m = 0; m < bake.morph_normals.size(); ++m) out += static_cast<double>(curves[static_cast<Eigen::Index>(m)]) * bake.morph_normals[m];
  return out;
}

struct BakeErrors {
  Errors distances{1e-5}, angles{0.02};
  BakeError summary(int frames) const {
    return {frames, distances.mean(), distances.rms(), distances.p95(), distances.max(), angles.rms(), angles.p95()};
  }
};

void measure(const TriMesh& skin, const Skeleton& skeleton, const ExactSkin& exact, Bake& bake) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const Points rest_normals = vertex_normals(skin);
  BakeErrors all;
  std::vector<Transform> X_WJ;
  SkinFrame frame;
  Points wanted, played;
  for (BakedMotion& each : bake.motions) {
    BakeErrors here;
    for (std::size_t f = 0; f < each.motion.frames.size(); ++f) {
      exact(each.motion.frames[f], X_WJ, frame);
      to_points(frame, wanted);
      play_bake(bake, skin, skeleton, X_WJ, each.curves.row(static_cast<Eigen::Index>(f)).transpose(), played);
      const Directions facing = normals_of(frame);
      const Points shaped = shaped_normals(bake, rest_normals, each.curves.row(static_cast<Eigen::Index>(f)).transpose());
      const std::vector<Transform> bones = rest_to_pose(origins, X_WJ);
      for (Eigen::Index i = 0; i < wanted.rows(); ++i) {
        const double d = (wanted.row(i) - played.row(i)).norm();
        const double a = angle_off(bake.influences[static_cast<std::size_t>(i)], bones, shaped.row(i), facing.row(i).cast<double>());
        for (BakeErrors* each_of : {&here, &all}) {
          each_of->distances.add(d);
          each_of->angles.add(a);
        }
      }
    }
    each.error = here.summary(static_cast<int>(each.motion.frames.size()));
    bake.error.frames += each.error.frames;
  }
  bake.error = all.summary(bake.error.frames);
}

}  // namespace

void play_bake(const Bake& bake, const TriMesh& skin, const Skeleton& skeleton, std::span<const Transform> X_WJ,
               const Eigen::VectorXf& curves, Points& out) {
  const std::vector<Transform> bones = rest_to_pose(rest_positions(skeleton), X_WJ);
  out = skin.V;
  for (std::size_t m = 0; m < bake.morphs.size(); ++m) out += static_cast<double>(curves[static_cast<Eigen::Index>(m)]) * bake.morphs[m];
  for (Eigen::Index i = 0; i < out.rows(); ++i) out.row(i) = blended(bake.influences[static_cast<std::size_t>(i)], bones) * Vec3(out.row(i));
}

Bake bake_skin(const TriMesh& skin, const Skeleton& skeleton, std::span<const std::array<Influence, 4>> start, const ExactSkin& exact,
               std::vector<BakedMotion> motions, const BakeOptions& options) {
  if (start.size() != static_cast<std::size_t>(skin.V.rows())) throw std::invalid_argument("bake_skin: one row of influences a vertex is needed");
  Bake bake;
  bake.motions = std::move(motions);
  const Samples samples = take_samples(skeleton, exact, bake.motions, options.sample_frames);
  const std::vector<std::vector<int>> rings = vertex_neighbours(skin);
  const Points normals = vertex_normals(skin);
  bake.influences.resize(start.size());
  tbb::parallel_for(std::size_t{0}, start.size(), [&](std::size_t i) {
    const std::vector<int> joints = candidates(skeleton, start, rings[i], static_cast<int>(i));
    const Eigen::Index vertex = static_cast<Eigen::Index>(i);
    bake.influences[i] = solve_vertex(samples, skin.V.row(vertex), normals.row(vertex), vertex, joints, start[i], options);
    if (options.morphs > 0) keep_open(samples, bake.influences[i]);
  });
  Eigen::MatrixXd leftovers(3 * skin.V.rows(), static_cast<Eigen::Index>(samples.bones.size()));
  for (std::size_t f = 0; f < samples.bones.size(); ++f)
    leftovers.col(static_cast<Eigen::Index>(f)) = leftover(bake, skin, samples.bones[f], samples.exact[f]);
  bake.influences_only_rms = std::sqrt(3 * leftovers.squaredNorm() / static_cast<double>(leftovers.size()));
  // The samples may have missed the frames that are hardest: those count too in the second round.
  Shapes shapes = even_shapes(leftovers, options.morphs);
  const std::size_t hardest = options.morphs == 0 ? 0 : samples.bones.size() / 5;
  const std::vector<Eigen::VectorXd> missed = follow_shapes(skin, skeleton, exact, shapes, hardest, bake);
  if (!missed.empty()) {
    const Eigen::Index sampled = leftovers.cols();
    leftovers.conservativeResize(Eigen::NoChange, sampled + static_cast<Eigen::Index>(missed.size()));
    for (std::size_t k = 0; k < missed.size(); ++k) leftovers.col(sampled + static_cast<Eigen::Index>(k)) = missed[k];
    shapes = even_shapes(leftovers, options.morphs);
    follow_shapes(skin, skeleton, exact, shapes, 0, bake);
  }
  const Eigen::VectorXd reach = scale_shapes(skin, shapes, options, bake);
  const Eigen::MatrixXd curves =
      reach.cwiseInverse().asDiagonal() * (shapes.projector.transpose() * leftovers.leftCols(static_cast<Eigen::Index>(samples.bones.size())));
  fit_normals(skin, samples, curves, options, bake);
  measure(skin, skeleton, exact, bake);
  return bake;
}

}  // namespace ecorche
