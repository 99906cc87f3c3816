#include "skinning/bake/bake.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "anatomy/errors.h"
#include "skinning/bake/bake_errors.h"
#include "skinning/bake/bake_influences.h"
#include "skinning/bake/bake_normals.h"
#include "skinning/bake/bake_polish.h"
#include "skinning/bake/bake_shapes.h"
#include "skinning/bake/bake_solve.h"
#include "skinning/files/quantized_rotations.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;

// Alternations of curves and shapes on the first and on the extended samples, and polishes after.
constexpr int kShapeRounds = 6, kMoreRounds = 4, kPolishes = 2;
// frames that are evaluated one by one and then solved in parallel
constexpr std::size_t kBatch = 16;

Points shaped(const Points& rest, const std::vector<Points>& shapes,
              const Eigen::VectorXf& curves) {
  Points out = rest;
  for (std::size_t m = 0; m < shapes.size(); ++m) out += double(curves[Index(m)]) * shapes[m];
  return out;
}

class Baker {
 public:
  Baker(const TriMesh& skin, const Skeleton& skeleton, Influences start, const ExactSkin& exact,
        const BakeOptions& options, const BakeProgress& progress, Bake& bake)
      : scene_{skin, skeleton, start, options}, exact_(exact), progress_(progress), bake_(bake) {}

  void run() {
    evaluate_samples();
    report_progress(kSampled, "joints and weights");
    rig_ = solve_rig(scene_, samples_);
    skinned_ = vertices_of_helpers(rig_.influences, scene_.joints(), rig_.helpers.size());
    bake_.influences = rig_.influences;
    bake_.helpers = rig_.helpers;
    Shapes shapes;
    if (scene_.options.morphs > 0) {
      report_progress(kRigged, "shapes");
      shapes = fit_shapes(residuals(), scene_.options.morphs, kShapeRounds);
      // Helpers are solved again beside the shapes. The samples may have missed the frames with the
      // largest errors: those are added.
      solve_samples(shapes, true);
      report_progress(kShaped, "hardest frames");
      add_hardest(shapes);
      report_progress(kSearched, "shapes");
      shapes = fit_shapes(residuals(), scene_.options.morphs, kMoreRounds, shapes);
      for (int round = 0; round < kPolishes; ++round) {
        const Eigen::MatrixXd curves = solve_samples(shapes, false);
        polish_shapes(residuals(), curves, shapes);
        report_progress(kSearched + (kPolished - kSearched) * (round + 1) / kPolishes, "shapes");
      }
    }
    report_progress(kPolished, "normals");
    drop_small_offsets(shapes);
    bake_.morph_normals =
        fit_normals(scene_, rig_.influences, samples_, solve_samples(shapes, true));
    samples_.clear();
    report_progress(kNormals, "every frame");
    solve_all_frames(shapes);
    report_progress(1, "every frame");
  }

 private:
  // Finished fractions of the whole at the ends of the stages, as measured on the long jump.
  static constexpr double kSampled = 0.1, kRigged = 0.3, kShaped = 0.5, kSearched = 0.6,
                          kPolished = 0.7, kNormals = 0.75;

  void report_progress(double share, const char* stage) const {
    if (progress_) progress_(stage, share);
  }

  // The bones are quantised as in the file, so that helpers and shapes correct the rounding.
  void evaluate(const Pose& pose, BakeFrame& frame) {
    exact_(pose, skin_frame_);
    forward_kinematics(scene_.skeleton, quantized(pose), X_WJ_);
    frame.bones = rest_to_pose(scene_.origins, X_WJ_);
    frame.bones.resize(scene_.joints() + rig_.helpers.size(), Transform::Identity());
    const Index n = skin_frame_.normals.size() / 4;
    using Rows4f = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;
    to_points(skin_frame_, points_);
    frame.exact = points_.cast<float>();
    frame.normals = Eigen::Map<const Rows4f>(skin_frame_.normals.data(), n, 4).leftCols<3>();
  }

  void evaluate_samples() {
    std::size_t total = 0;
    for (const BakedMotion& each : bake_.motions) total += each.motion.frames.size();
    if (total == 0) throw UnfitError("there is nothing to bake: the motions hold no frames");
    const double stride = std::max(1.0, double(total) / scene_.options.sample_frames);
    std::size_t at = 0;
    double next = 0;
    for (const BakedMotion& each : bake_.motions)
      for (const Pose& pose : each.motion.frames) {
        if (double(at++) < next) continue;
        next += stride;
        report_progress(kSampled * double(at) / double(total), "samples");
        sampled_.insert(&pose);
        evaluate(pose, samples_.emplace_back());
      }
  }

  // Evaluates the poses, calls use(slot, frame), with the helpers posed, for several in parallel,
  // and then done(slot, index, frame) for each in order.
  template <class Use, class Done>
  void for_frames(std::span<const Pose* const> poses, Use use, Done done) {
    std::vector<BakeFrame> frames(std::min(kBatch, poses.size()));
    for (std::size_t first = 0; first < poses.size(); first += kBatch) {
      const std::size_t count = std::min(kBatch, poses.size() - first);
      for (std::size_t k = 0; k < count; ++k) evaluate(*poses[first + k], frames[k]);
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        pose_helpers(scene_.skin.V, rig_.patches, skinned_, rig_.influences, frames[k]);
        use(k, frames[k]);
      });
      for (std::size_t k = 0; k < count; ++k) done(k, first + k, frames[k]);
    }
  }

  FrameSolver solver(const Shapes& shapes) const {
    std::vector<Vec3> places;
    for (const BakeHelper& helper : rig_.helpers) places.push_back(helper.rest);
    return FrameSolver(scene_.skin.V, shapes.offsets, rig_.influences, std::move(places));
  }

  // Returns the curves, #shapes x #samples. `least_squares`: for the sum of squares alone.
  Eigen::MatrixXd solve_samples(const Shapes& shapes, bool least_squares) {
    const FrameSolver solver = this->solver(shapes);
    Eigen::MatrixXd out(shapes.offsets.cols(), Index(samples_.size()));
    tbb::parallel_for(std::size_t{0}, samples_.size(), [&](std::size_t f) {
      Eigen::VectorXf curves;
      if (least_squares)
        solver.solve_least_squares(samples_[f], curves);
      else
        solver.solve(samples_[f], curves);
      out.col(Index(f)) = curves.cast<double>();
    });
    return out;
  }

  std::vector<FrameResidual> residuals() const {
    std::vector<FrameResidual> out(samples_.size());
    tbb::parallel_for(std::size_t{0}, samples_.size(),
                      [&](std::size_t f) { out[f] = residual(samples_[f]); });
    return out;
  }

  FrameResidual residual(const BakeFrame& frame) const {
    FrameResidual out;
    out.blend.resize(scene_.skin.V.rows(), 9);
    out.residual.resize(scene_.skin.V.rows(), 3);
    for (Index i = 0; i < scene_.skin.V.rows(); ++i) {
      const Eigen::Affine3d A = blended(rig_.influences[i], frame.bones);
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> linear = A.linear();
      out.blend.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 9>>(linear.data()).cast<float>();
      out.residual.row(i) =
          (frame.exact.row(i).transpose().cast<double>() - A * scene_.place(std::size_t(i)))
              .transpose()
              .cast<float>();
    }
    return out;
  }

  void add_hardest(const Shapes& shapes) {
    const FrameSolver solver = this->solver(shapes);
    const std::size_t wanted = samples_.size() / 5;
    std::vector<const Pose*> poses;
    for (const BakedMotion& each : bake_.motions)
      for (const Pose& pose : each.motion.frames)
        if (sampled_.count(&pose) == 0) poses.push_back(&pose);
    std::multimap<double, BakeFrame> hardest;
    std::array<double, kBatch> most;
    const auto solve = [&](std::size_t slot, BakeFrame& frame) {
      Eigen::VectorXf curves;
      solver.solve_least_squares(frame, curves);
      most[slot] = solver.distances(frame, curves).maxCoeff();
    };
    for_frames(poses, solve, [&](std::size_t slot, std::size_t index, const BakeFrame& frame) {
      hardest.emplace(most[slot], frame);
      if (hardest.size() > wanted) hardest.erase(hardest.begin());
      report_progress(kShaped + (kSearched - kShaped) * double(index) / double(poses.size()),
                      "hardest frames");
    });
    for (auto& [distance, frame] : hardest) samples_.push_back(std::move(frame));
  }

  // Sets small offsets to zero, before the curves are solved for the last time.
  void drop_small_offsets(Shapes& shapes) const {
    for (Index m = 0; m < shapes.offsets.cols(); ++m)
      for (Index i = 0; i < scene_.skin.V.rows(); ++i)
        if (auto offset = shapes.offsets.col(m).segment<3>(3 * i);
            offset.norm() < float(scene_.options.least_offset))
          offset.setZero();
  }

  // Curves, helpers and errors of every frame. Shapes and curves are scaled so that curves keep
  // within -1 .. 1.
  void solve_all_frames(const Shapes& shapes) {
    for (Index m = 0; m < shapes.offsets.cols(); ++m)
      bake_.morphs.push_back(
          Eigen::Map<const Rows3f>(shapes.offsets.col(m).data(), scene_.skin.V.rows(), 3)
              .cast<double>());
    const FrameSolver solver = this->solver(shapes);
    BakeErrors all;
    double squares = 0;
    std::size_t total = 0, done = 0;
    for (const BakedMotion& each : bake_.motions) total += each.motion.frames.size();
    std::array<Measured, kBatch> measured;
    for (BakedMotion& each : bake_.motions) {
      BakeErrors here;
      std::vector<const Pose*> poses;
      for (const Pose& pose : each.motion.frames) poses.push_back(&pose);
      each.curves.resize(Index(poses.size()), shapes.offsets.cols());
      const auto solve = [&](std::size_t slot, BakeFrame& frame) {
        Measured& out = measured[slot];
        out.alone =
            solver.distances(frame, Eigen::VectorXf::Zero(shapes.offsets.cols())).squaredNorm();
        solver.solve(frame, out.curves);
        out.helpers = quantize_helpers(frame);
        measure(frame, out);
      };
      for_frames(poses, solve, [&](std::size_t slot, std::size_t f, const BakeFrame&) {
        const Measured& out = measured[slot];
        each.curves.row(Index(f)) = out.curves.transpose();
        each.helpers.push_back(out.helpers);
        squares += out.alone;
        report_progress(kNormals + (1 - kNormals) * double(++done) / double(total), "every frame");
        here.add(out.distances, out.angles);
        all.add(out.distances, out.angles);
      });
      each.error = here.summary(int(poses.size()));
      bake_.error.frames += each.error.frames;
    }
    bake_.error = all.summary(bake_.error.frames);
    bake_.influences_only_rms =
        std::sqrt(squares / (double(bake_.error.frames) * double(scene_.skin.V.rows())));
    normalize_curves();
  }

  // The helpers' world frames with quantised rotations; the bones get the same.
  std::vector<Transform> quantize_helpers(BakeFrame& frame) const {
    std::vector<Transform> out;
    for (std::size_t h = 0; h < rig_.helpers.size(); ++h) {
      const BakeHelper& helper = rig_.helpers[h];
      const Quat parent(frame.bones[helper.parent].linear());
      Transform& bone = frame.bones[scene_.joints() + h];
      Transform X_WH = bone * Eigen::Translation3d(helper.rest);
      X_WH.linear() =
          (parent * quantized(parent.conjugate() * Quat(X_WH.linear()))).toRotationMatrix();
      bone = X_WH * Eigen::Translation3d(-helper.rest);
      out.push_back(X_WH);
    }
    return out;
  }

  struct Measured {
    Eigen::VectorXf curves;
    std::vector<Transform> helpers;
    double alone = 0;  // sum of squares by joints and helpers alone
    Eigen::VectorXd distances, angles;
  };

  void measure(const BakeFrame& frame, Measured& out) const {
    const Points places = shaped(scene_.skin.V, bake_.morphs, out.curves),
                 normals = shaped(scene_.normals, bake_.morph_normals, out.curves);
    out.distances.resize(places.rows());
    out.angles.resize(places.rows());
    for (Index i = 0; i < places.rows(); ++i) {
      const auto& influences = rig_.influences[i];
      out.distances[i] = (blended(influences, frame.bones) * Vec3(places.row(i)) -
                          frame.exact.row(i).transpose().cast<double>())
                             .norm();
      out.angles[i] = angle_off(influences, frame.bones, normals.row(i),
                                frame.normals.row(i).transpose().cast<double>());
    }
  }

  void normalize_curves() {
    for (std::size_t m = 0; m < bake_.morphs.size(); ++m) {
      float reach = 1e-9f;
      for (const BakedMotion& each : bake_.motions)
        if (each.curves.rows() > 0)
          reach = std::max(reach, each.curves.col(Index(m)).cwiseAbs().maxCoeff());
      for (BakedMotion& each : bake_.motions) each.curves.col(Index(m)) /= reach;
      bake_.morphs[m] = (double(reach) * bake_.morphs[m]).cast<float>().cast<double>();
      bake_.morph_normals[m] =
          (double(reach) * bake_.morph_normals[m]).cast<float>().cast<double>();
    }
  }

  const BakeScene scene_;
  const ExactSkin& exact_;
  const BakeProgress& progress_;
  Bake& bake_;
  BakeRig rig_;
  std::vector<std::vector<int>> skinned_;  // by helper
  std::vector<BakeFrame> samples_;
  std::set<const Pose*> sampled_;
  std::vector<Transform> X_WJ_;
  SkinFrame skin_frame_;
  Points points_;
};

}  // namespace

void play_bake(const Bake& bake, const TriMesh& skin, const Skeleton& skeleton,
               std::span<const Transform> X_WJ, std::span<const Transform> helpers,
               const Eigen::VectorXf& curves, Points& out) {
  std::vector<Transform> bones = rest_to_pose(rest_positions(skeleton), X_WJ);
  for (std::size_t h = 0; h < helpers.size(); ++h)
    bones.push_back(helpers[h] * Eigen::Translation3d(-bake.helpers[h].rest));
  out = shaped(skin.V, bake.morphs, curves);
  for (Index i = 0; i < out.rows(); ++i)
    out.row(i) = blended(bake.influences[i], bones) * Vec3(out.row(i));
}

Bake bake_skin(const TriMesh& skin, const Skeleton& skeleton,
               std::span<const std::array<Influence, 4>> start, const ExactSkin& exact,
               std::vector<BakedMotion> motions, const BakeOptions& options,
               const BakeProgress& progress) {
  if (start.size() != std::size_t(skin.V.rows()))
    throw std::invalid_argument("bake_skin: one row of influences a vertex is needed");
  Bake bake;
  bake.motions = std::move(motions);
  Baker(skin, skeleton, start, exact, options, progress, bake).run();
  return bake;
}

}  // namespace ecorche::inline v1
