#include "skinning/bake.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "anatomy/errors.h"
#include "anatomy/mesh_measures.h"
#include "skinning/bake_errors.h"
#include "skinning/bake_helpers.h"
#include "skinning/bake_shapes.h"
#include "skinning/bake_weights.h"
#include "skinning/skin_survey.h"

namespace ecorche {
namespace {

using Eigen::Index;

constexpr std::size_t kMostCandidates = 12;
constexpr int kBatch = 16;                // helpers that are added before weights are solved again
constexpr int kHelperRounds = 3;          // of placing helpers in a frame
constexpr double kHelperReach = 0.25;     // m about a helper in which skin may hang on it, ...
constexpr double kHelperSpread = 0.10;    // ... and in which it is likely to
constexpr int kShapeRounds = 6, kMoreRounds = 6;
constexpr double kFar = 3e-3;             // m: a frame in which something is farther off gets its curves weighted

std::vector<Transform> rest_to_pose(const std::vector<Vec3>& origins, std::span<const Transform> X_WJ) {
  std::vector<Transform> out(X_WJ.begin(), X_WJ.end());
  for (std::size_t j = 0; j < out.size(); ++j) out[j].translate(-origins[j]);
  return out;
}

// The inverse, or that of the nearest rotation where the blend has fallen flat.
Mat3 back_to_rest(const Mat3& A) {
  if (A.determinant() > 0.2) return A.inverse();
  const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixV() * svd.matrixU().transpose();
}

// The angle between a normal as an engine has it and the exact one, degrees.
double angle_off(const std::array<Influence, 4>& influences, std::span<const Transform> bones, const Vec3& shaped, const Vec3& exact) {
  const Vec3 played = blended(influences, bones).linear() * shaped;
  return std::atan2(played.cross(exact).norm(), played.dot(exact)) * 180 / std::numbers::pi;
}

Points shaped(const Points& rest, const std::vector<Points>& shapes, const Eigen::VectorXf& curves) {
  Points out = rest;
  for (std::size_t m = 0; m < shapes.size(); ++m) out += static_cast<double>(curves[static_cast<Index>(m)]) * shapes[m];
  return out;
}

class Baker {
 public:
  Baker(const TriMesh& skin, const Skeleton& skeleton, std::span<const std::array<Influence, 4>> start, const ExactSkin& exact, const BakeOptions& options,
        Bake& bake)
      : skin_(skin), start_(start), exact_(exact), options_(options), bake_(bake), origins_(rest_positions(skeleton)), joints_(skeleton.joints.size()),
        parents_(skeleton.joints), rings_(vertex_neighbours(skin)), rest_normals_(vertex_normals(skin)) {
    bake_.influences.assign(start.begin(), start.end());
  }

  void run() {
    take_samples();
    solve_weights(std::vector<char>(start_.size(), 1));
    add_helpers();
    std::vector<Leftover> left = leftovers();
    Shapes shapes;
    if (options_.morphs > 0) {
      shapes = fit_shapes(left, options_.morphs, kShapeRounds);
      // The samples may have missed the frames that are hardest: those count too from now on.
      add_hardest(shapes, left);
      shapes = fit_shapes(left, options_.morphs, kMoreRounds, shapes);
    }
    leave_out_little(shapes);
    fit_normals(shapes, left);
    left.clear();
    follow(shapes);
  }

 private:
  void look(const Pose& pose, BakeFrame& frame) {
    exact_(pose, X_WJ_, skin_frame_);
    frame.bones = rest_to_pose(origins_, X_WJ_);
    frame.bones.resize(joints_ + patches_.size(), Transform::Identity());
    const Index n = static_cast<Index>(skin_frame_.normals.size() / 4);
    using Rows4f = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;
    to_points(skin_frame_, points_);
    frame.exact = points_.cast<float>();
    frame.normals = Eigen::Map<const Rows4f>(skin_frame_.normals.data(), n, 4).leftCols<3>();
    pose_helpers(skin_.V, patches_, bake_.influences, kHelperRounds, frame);
  }

  void take_samples() {
    std::size_t total = 0;
    for (const BakedMotion& each : bake_.motions) total += each.motion.frames.size();
    if (total == 0) throw UnfitError("there is nothing to bake: the motions hold no frames");
    const double stride = std::max(1.0, static_cast<double>(total) / options_.sample_frames);
    std::size_t at = 0;
    double next = 0;
    for (const BakedMotion& each : bake_.motions)
      for (const Pose& pose : each.motion.frames) {
        if (static_cast<double>(at++) < next) continue;
        next += stride;
        sampled_.insert(&pose);
        look(pose, samples_.emplace_back());
      }
  }

  // Bones that a vertex may hang on: joints that it and its neighbours hang on already, those next to them in the tree, and helpers nearby.
  std::vector<int> candidates(std::size_t vertex) const {
    std::vector<double> share(joints_, 0);
    const auto add = [&](std::size_t i, double scale) {
      for (const Influence& influence : start_[i]) share[static_cast<std::size_t>(influence.joint)] += scale * influence.weight;
    };
    add(vertex, 1);
    for (const int i : rings_[vertex]) add(static_cast<std::size_t>(i), 0.5 / static_cast<double>(rings_[vertex].size()));
    std::vector<double> spread = share;
    for (std::size_t j = 1; j < share.size(); ++j) {
      const std::size_t parent = static_cast<std::size_t>(parents_[j].parent);
      spread[parent] += 0.1 * share[j];
      spread[j] += 0.1 * share[parent];
    }
    double sum = 0;
    for (const double s : spread) sum += s;
    for (const HelperPatch& patch : patches_) {
      const double distance = (skin_.V.row(static_cast<Index>(vertex)) - skin_.V.row(patch.center)).norm();
      spread.push_back(distance < kHelperReach ? 2 * sum * std::exp(-std::pow(distance / kHelperSpread, 2)) : 0);
    }
    std::vector<int> order;
    for (std::size_t j = 0; j < spread.size(); ++j)
      if (spread[j] > 0) order.push_back(static_cast<int>(j));
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return spread[static_cast<std::size_t>(a)] > spread[static_cast<std::size_t>(b)]; });
    if (order.size() > kMostCandidates) order.resize(kMostCandidates);
    return order;
  }

  std::array<Influence, 4> solve_vertex(std::size_t vertex) const {
    const std::vector<int> bones = candidates(vertex);
    const Index n = static_cast<Index>(bones.size()), row = static_cast<Index>(vertex);
    const Vec3 X = skin_.V.row(row), N = rest_normals_.row(row);
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n), D(6, n);
    for (const BakeFrame& frame : samples_) {
      const Vec3 wanted = frame.exact.row(row).transpose().cast<double>(), facing = frame.normals.row(row).transpose().cast<double>();
      for (Index k = 0; k < n; ++k) {
        const Transform& T = frame.bones[static_cast<std::size_t>(bones[static_cast<std::size_t>(k)])];
        D.col(k).head<3>() = T * X - wanted;
        D.col(k).tail<3>() = options_.normal_arm * (T.linear() * N - facing);
      }
      G.noalias() += D.transpose() * D;
    }
    Eigen::VectorXd given = Eigen::VectorXd::Zero(n);
    for (const Influence& influence : start_[vertex])
      for (Index k = 0; k < n; ++k)
        if (bones[static_cast<std::size_t>(k)] == influence.joint) given[k] += influence.weight;
    const Eigen::VectorXd w = simplex_weights(G, given, static_cast<double>(samples_.size()) * options_.keep_weights * options_.keep_weights, 4);
    std::array<Influence, 4> out{};
    std::size_t at = 0;
    for (Index k = 0; k < n; ++k)
      if (w[k] > 0) out[at++] = {bones[static_cast<std::size_t>(k)], w[k]};
    std::stable_sort(out.begin(), out.end(), [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    return out;
  }

  void solve_weights(const std::vector<char>& which) {
    tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t i) {
      if (which[i]) bake_.influences[i] = solve_vertex(i);
    });
  }

  void place_helpers() {
    tbb::parallel_for(std::size_t{0}, samples_.size(), [&](std::size_t f) {
      samples_[f].bones.resize(joints_ + patches_.size(), Transform::Identity());
      pose_helpers(skin_.V, patches_, bake_.influences, kHelperRounds, samples_[f]);
    });
  }

  // The skin that may hang on helpers from `first` on.
  std::vector<char> reached(std::size_t first) const {
    std::vector<char> out(start_.size(), 0);
    for (std::size_t i = 0; i < out.size(); ++i)
      for (std::size_t h = first; h < patches_.size(); ++h)
        if ((skin_.V.row(static_cast<Index>(i)) - skin_.V.row(patches_[h].center)).norm() < kHelperReach) out[i] = 1;
    return out;
  }

  // How far vertices are off, large errors above all, evened out with their neighbours. #V, m. Returns the largest error too.
  std::pair<Eigen::VectorXd, double> errors_of_influences() const {
    Eigen::VectorXd sum(skin_.V.rows()), most(skin_.V.rows());
    tbb::parallel_for(Index{0}, sum.size(), [&](Index i) {
      sum[i] = most[i] = 0;
      for (const BakeFrame& frame : samples_) {
        const Vec3 played = blended(bake_.influences[static_cast<std::size_t>(i)], frame.bones) * Vec3(skin_.V.row(i));
        const double d = (played - frame.exact.row(i).transpose().cast<double>()).norm();
        sum[i] += d * d * d * d / static_cast<double>(samples_.size());
        most[i] = std::max(most[i], d);
      }
      sum[i] = std::sqrt(std::sqrt(sum[i]));
    });
    for (int round = 0; round < 2; ++round) {
      const Eigen::VectorXd before = sum;
      for (Index i = 0; i < sum.size(); ++i)
        for (const int k : rings_[static_cast<std::size_t>(i)]) sum[i] += (before[k] - before[i]) / static_cast<double>(rings_[static_cast<std::size_t>(i)].size());
    }
    return {sum, most.maxCoeff()};
  }

  void add_helpers() {
    while (static_cast<int>(patches_.size()) < options_.helpers) {
      const auto [errors, most] = errors_of_influences();
      if (most < options_.helper_error) break;
      const std::size_t first = patches_.size();
      const int room = options_.helpers - static_cast<int>(first);
      for (HelperPatch& patch : choose_helpers(skin_.V, errors, 0.05 * options_.helper_error, std::min(kBatch, room))) {
        const auto& hangs = start_[static_cast<std::size_t>(patch.center)];
        const auto heaviest = std::max_element(hangs.begin(), hangs.end(), [](const Influence& a, const Influence& b) { return a.weight < b.weight; });
        bake_.helpers.push_back({heaviest->joint, skin_.V.row(patch.center)});
        patches_.push_back(std::move(patch));
      }
      if (patches_.size() == first) break;
      place_helpers();
      solve_weights(reached(first));
      place_helpers();
    }
    if (patches_.empty()) return;
    solve_weights(reached(0));
    place_helpers();
  }

  Leftover leftover(const BakeFrame& frame) const {
    Leftover out;
    out.blend.resize(skin_.V.rows(), 9);
    out.left.resize(skin_.V.rows(), 3);
    tbb::parallel_for(Index{0}, skin_.V.rows(), [&](Index i) {
      const Eigen::Affine3d A = blended(bake_.influences[static_cast<std::size_t>(i)], frame.bones);
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> linear = A.linear();
      out.blend.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 9>>(linear.data()).cast<float>();
      out.left.row(i) = (frame.exact.row(i).transpose().cast<double>() - A * Vec3(skin_.V.row(i))).transpose().cast<float>();
    });
    return out;
  }

  std::vector<Leftover> leftovers() const {
    std::vector<Leftover> out;
    for (const BakeFrame& frame : samples_) out.push_back(leftover(frame));
    return out;
  }

  void add_hardest(const Shapes& shapes, std::vector<Leftover>& left) {
    const std::size_t wanted = samples_.size() / 5;
    std::multimap<float, std::pair<BakeFrame, Leftover>> missed;
    BakeFrame frame;
    for (const BakedMotion& each : bake_.motions)
      for (const Pose& pose : each.motion.frames) {
        if (sampled_.count(&pose) != 0) continue;
        look(pose, frame);
        Leftover here = leftover(frame);
        const float most = distances_left(shapes, here, fit_curves(shapes, here, HUGE_VAL)).maxCoeff();
        missed.emplace(most, std::pair{frame, std::move(here)});
        if (missed.size() > wanted) missed.erase(missed.begin());
      }
    for (auto& [distance, both] : missed) {
      samples_.push_back(std::move(both.first));
      left.push_back(std::move(both.second));
    }
  }

  // What a shape hardly moves is left out of it, before curves are found for good.
  void leave_out_little(Shapes& shapes) const {
    for (Index m = 0; m < shapes.offsets.cols(); ++m)
      for (Index i = 0; i < skin_.V.rows(); ++i)
        if (shapes.offsets.col(m).segment<3>(3 * i).norm() < static_cast<float>(options_.least_offset)) shapes.offsets.col(m).segment<3>(3 * i).setZero();
  }

  // The shapes' changes of the normals: those that, with the curves that the samples have, bring the turned normals closest to the exact ones.
  void fit_normals(const Shapes& shapes, const std::vector<Leftover>& left) {
    const Index morphs = shapes.offsets.cols(), count = static_cast<Index>(samples_.size());
    bake_.morph_normals.assign(static_cast<std::size_t>(morphs), Points::Zero(skin_.V.rows(), 3));
    if (morphs == 0) return;
    Eigen::MatrixXd curves(morphs, count);
    tbb::parallel_for(Index{0}, count, [&](Index f) { curves.col(f) = fit_curves(shapes, left[static_cast<std::size_t>(f)], kFar).cast<double>(); });
    Eigen::MatrixXd gram = curves * curves.transpose();
    gram.diagonal().array() += 1e-4 * static_cast<double>(count);
    const Eigen::MatrixXd projector = gram.ldlt().solve(curves);  // #morphs x #samples
    tbb::parallel_for(Index{0}, skin_.V.rows(), [&](Index i) {
      Eigen::MatrixXd off(count, 3);
      for (Index f = 0; f < count; ++f) {
        const BakeFrame& frame = samples_[static_cast<std::size_t>(f)];
        const Mat3 back = back_to_rest(blended(bake_.influences[static_cast<std::size_t>(i)], frame.bones).linear());
        off.row(f) = (back * frame.normals.row(i).transpose().cast<double>()).normalized().transpose() - rest_normals_.row(i);
      }
      const Eigen::MatrixXd changes = projector * off;
      for (Index m = 0; m < morphs; ++m)
        if (changes.row(m).norm() >= options_.least_turn) bake_.morph_normals[static_cast<std::size_t>(m)].row(i) = changes.row(m).cast<float>().cast<double>();
    });
  }

  // Curves and helpers of every frame, and the errors that they leave. Shapes and curves are scaled so that no curve leaves -1 .. 1.
  void follow(const Shapes& shapes) {
    for (Index m = 0; m < shapes.offsets.cols(); ++m) bake_.morphs.push_back(Eigen::Map<const Rows3f>(shapes.offsets.col(m).data(), skin_.V.rows(), 3).cast<double>());
    BakeErrors all;
    double squares = 0;
    BakeFrame frame;
    for (BakedMotion& each : bake_.motions) {
      BakeErrors here;
      each.curves.resize(static_cast<Index>(each.motion.frames.size()), shapes.offsets.cols());
      for (std::size_t f = 0; f < each.motion.frames.size(); ++f) {
        look(each.motion.frames[f], frame);
        const Leftover left = leftover(frame);
        squares += static_cast<double>(left.left.squaredNorm());
        const Eigen::VectorXf curves = fit_curves(shapes, left, kFar);
        each.curves.row(static_cast<Index>(f)) = curves.transpose();
        settle_helpers(curves, frame);
        std::vector<Transform>& helpers = each.helpers.emplace_back(frame.bones.begin() + static_cast<std::ptrdiff_t>(joints_), frame.bones.end());
        for (std::size_t h = 0; h < helpers.size(); ++h) helpers[h].translate(bake_.helpers[h].rest);
        measure(frame, curves, here, all);
      }
      each.error = here.summary(static_cast<int>(each.motion.frames.size()));
      bake_.error.frames += each.error.frames;
    }
    bake_.error = all.summary(bake_.error.frames);
    bake_.influences_only_rms = std::sqrt(squares / (static_cast<double>(bake_.error.frames) * static_cast<double>(skin_.V.rows())));
    scale();
  }

  // With the shapes in place helpers move once more, above all for what is still far off.
  void settle_helpers(const Eigen::VectorXf& curves, BakeFrame& frame) const {
    constexpr int kRounds = 4;
    constexpr double kOff = 1.5e-3, kMost = 100;  // m off that count twice; of weights
    if (patches_.empty()) return;
    const Points places = shaped(skin_.V, bake_.morphs, curves);
    Eigen::VectorXd weights(places.rows());
    for (int round = 0; round < kRounds; ++round) {
      tbb::parallel_for(Index{0}, places.rows(), [&](Index i) {
        const Vec3 played = blended(bake_.influences[static_cast<std::size_t>(i)], frame.bones) * Vec3(places.row(i));
        const double off = (played - frame.exact.row(i).transpose().cast<double>()).norm() / kOff;
        weights[i] = std::min(1 + off * off * off * off, kMost);
      });
      refine_helpers(places, patches_, bake_.influences, weights, frame);
    }
  }

  void measure(const BakeFrame& frame, const Eigen::VectorXf& curves, BakeErrors& here, BakeErrors& all) const {
    const Points places = shaped(skin_.V, bake_.morphs, curves), normals = shaped(rest_normals_, bake_.morph_normals, curves);
    Eigen::VectorXd distances(places.rows()), angles(places.rows());
    tbb::parallel_for(Index{0}, places.rows(), [&](Index i) {
      const auto& influences = bake_.influences[static_cast<std::size_t>(i)];
      distances[i] = (blended(influences, frame.bones) * Vec3(places.row(i)) - frame.exact.row(i).transpose().cast<double>()).norm();
      angles[i] = angle_off(influences, frame.bones, normals.row(i), frame.normals.row(i).transpose().cast<double>());
    });
    for (BakeErrors* errors : {&here, &all})
      for (Index i = 0; i < distances.size(); ++i) {
        errors->distances.add(distances[i]);
        errors->angles.add(angles[i]);
      }
  }

  void scale() {
    for (std::size_t m = 0; m < bake_.morphs.size(); ++m) {
      float reach = 1e-9f;
      for (const BakedMotion& each : bake_.motions)
        if (each.curves.rows() > 0) reach = std::max(reach, each.curves.col(static_cast<Index>(m)).cwiseAbs().maxCoeff());
      for (BakedMotion& each : bake_.motions) each.curves.col(static_cast<Index>(m)) /= reach;
      bake_.morphs[m] = (static_cast<double>(reach) * bake_.morphs[m]).cast<float>().cast<double>();
      bake_.morph_normals[m] = (static_cast<double>(reach) * bake_.morph_normals[m]).cast<float>().cast<double>();
    }
  }

  const TriMesh& skin_;
  const std::span<const std::array<Influence, 4>> start_;
  const ExactSkin& exact_;
  const BakeOptions& options_;
  Bake& bake_;
  const std::vector<Vec3> origins_;
  const std::size_t joints_;
  const std::vector<Joint>& parents_;
  const std::vector<std::vector<int>> rings_;
  const Points rest_normals_;
  std::vector<HelperPatch> patches_;
  std::vector<BakeFrame> samples_;
  std::set<const Pose*> sampled_;
  std::vector<Transform> X_WJ_;
  SkinFrame skin_frame_;
  Points points_;
};

}  // namespace

void play_bake(const Bake& bake, const TriMesh& skin, const Skeleton& skeleton, std::span<const Transform> X_WJ, std::span<const Transform> helpers,
               const Eigen::VectorXf& curves, Points& out) {
  std::vector<Transform> bones = rest_to_pose(rest_positions(skeleton), X_WJ);
  for (std::size_t h = 0; h < helpers.size(); ++h) bones.push_back(helpers[h] * Eigen::Translation3d(-bake.helpers[h].rest));
  out = shaped(skin.V, bake.morphs, curves);
  for (Index i = 0; i < out.rows(); ++i) out.row(i) = blended(bake.influences[static_cast<std::size_t>(i)], bones) * Vec3(out.row(i));
}

Bake bake_skin(const TriMesh& skin, const Skeleton& skeleton, std::span<const std::array<Influence, 4>> start, const ExactSkin& exact,
               std::vector<BakedMotion> motions, const BakeOptions& options) {
  if (start.size() != static_cast<std::size_t>(skin.V.rows())) throw std::invalid_argument("bake_skin: one row of influences a vertex is needed");
  Bake bake;
  bake.motions = std::move(motions);
  Baker(skin, skeleton, start, exact, options, bake).run();
  return bake;
}

}  // namespace ecorche
