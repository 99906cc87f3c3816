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

namespace ecorche {
namespace {

using Eigen::Index;

constexpr int kShapeRounds = 6, kMoreRounds = 4, kPolishes = 2;
// frames that are looked at one by one and then solved at once
constexpr std::size_t kTogether = 16;

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
    take_samples();
    tell(kSampled, "joints and weights");
    rig_ = solve_rig(scene_, samples_);
    hung_ = hung_on_helpers(rig_.influences, scene_.joints(), rig_.helpers.size());
    bake_.influences = rig_.influences;
    bake_.helpers = rig_.helpers;
    Shapes shapes;
    if (scene_.options.morphs > 0) {
      tell(kRigged, "shapes");
      shapes = fit_shapes(leftovers(), scene_.options.morphs, kShapeRounds);
      // Helpers make room for what shapes do better. The samples may have missed the frames that
      // are hardest: those count too from now on.
      settle_samples(shapes, true);
      tell(kShaped, "hardest frames");
      add_hardest(shapes);
      tell(kSearched, "shapes");
      shapes = fit_shapes(leftovers(), scene_.options.morphs, kMoreRounds, shapes);
      for (int round = 0; round < kPolishes; ++round) {
        const Eigen::MatrixXd curves = settle_samples(shapes, false);
        polish_shapes(leftovers(), curves, shapes);
        tell(kSearched + (kPolished - kSearched) * (round + 1) / kPolishes, "shapes");
      }
    }
    tell(kPolished, "normals");
    leave_out_little(shapes);
    bake_.morph_normals =
        fit_normals(scene_, rig_.influences, samples_, settle_samples(shapes, true));
    samples_.clear();
    tell(kNormals, "every frame");
    follow(shapes);
    tell(1, "every frame");
  }

 private:
  // Shares of the whole work at the ends of the stages, as measured on the long jump.
  static constexpr double kSampled = 0.1, kRigged = 0.3, kShaped = 0.5, kSearched = 0.6,
                          kPolished = 0.7, kNormals = 0.75;

  void tell(double share, const char* stage) const {
    if (progress_) progress_(stage, share);
  }

  // The bones are as the file has them, so that helpers and shapes make up for what it rounds off.
  void look(const Pose& pose, BakeFrame& frame) {
    exact_(pose, skin_frame_);
    forward_kinematics(scene_.skeleton, kept_in_shorts(pose), X_WJ_);
    frame.bones = rest_to_pose(scene_.origins, X_WJ_);
    frame.bones.resize(scene_.joints() + rig_.helpers.size(), Transform::Identity());
    const Index n = skin_frame_.normals.size() / 4;
    using Rows4f = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;
    to_points(skin_frame_, points_);
    frame.exact = points_.cast<float>();
    frame.normals = Eigen::Map<const Rows4f>(skin_frame_.normals.data(), n, 4).leftCols<3>();
  }

  void take_samples() {
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
        tell(kSampled * double(at) / double(total), "samples");
        sampled_.insert(&pose);
        look(pose, samples_.emplace_back());
      }
  }

  // Looks at the poses, calls use(slot, frame), with the helpers posed, for several at once, and
  // then done(slot, index, frame) for each in turn.
  template <class Use, class Done>
  void for_frames(std::span<const Pose* const> poses, Use use, Done done) {
    std::vector<BakeFrame> frames(std::min(kTogether, poses.size()));
    for (std::size_t first = 0; first < poses.size(); first += kTogether) {
      const std::size_t count = std::min(kTogether, poses.size() - first);
      for (std::size_t k = 0; k < count; ++k) look(*poses[first + k], frames[k]);
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        pose_helpers(scene_.skin.V, rig_.patches, hung_, rig_.influences, frames[k]);
        use(k, frames[k]);
      });
      for (std::size_t k = 0; k < count; ++k) done(k, first + k, frames[k]);
    }
  }

  Settler settler(const Shapes& shapes) const {
    std::vector<Vec3> places;
    for (const BakeHelper& helper : rig_.helpers) places.push_back(helper.rest);
    return Settler(scene_.skin.V, shapes.offsets, rig_.influences, std::move(places));
  }

  // Returns the curves. `even`: for the sum of squares alone. #shapes x #samples
  Eigen::MatrixXd settle_samples(const Shapes& shapes, bool even) {
    const Settler settler = this->settler(shapes);
    Eigen::MatrixXd out(shapes.offsets.cols(), Index(samples_.size()));
    tbb::parallel_for(std::size_t{0}, samples_.size(), [&](std::size_t f) {
      Eigen::VectorXf curves;
      if (even)
        settler.settle_evenly(samples_[f], curves);
      else
        settler.settle(samples_[f], curves);
      out.col(Index(f)) = curves.cast<double>();
    });
    return out;
  }

  std::vector<Leftover> leftovers() const {
    std::vector<Leftover> out(samples_.size());
    tbb::parallel_for(std::size_t{0}, samples_.size(),
                      [&](std::size_t f) { out[f] = leftover(samples_[f]); });
    return out;
  }

  Leftover leftover(const BakeFrame& frame) const {
    Leftover out;
    out.blend.resize(scene_.skin.V.rows(), 9);
    out.left.resize(scene_.skin.V.rows(), 3);
    for (Index i = 0; i < scene_.skin.V.rows(); ++i) {
      const Eigen::Affine3d A = blended(rig_.influences[i], frame.bones);
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> linear = A.linear();
      out.blend.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 9>>(linear.data()).cast<float>();
      out.left.row(i) =
          (frame.exact.row(i).transpose().cast<double>() - A * scene_.place(std::size_t(i)))
              .transpose()
              .cast<float>();
    }
    return out;
  }

  void add_hardest(const Shapes& shapes) {
    const Settler settler = this->settler(shapes);
    const std::size_t wanted = samples_.size() / 5;
    std::vector<const Pose*> poses;
    for (const BakedMotion& each : bake_.motions)
      for (const Pose& pose : each.motion.frames)
        if (sampled_.count(&pose) == 0) poses.push_back(&pose);
    std::multimap<double, BakeFrame> hardest;
    std::array<double, kTogether> most;
    const auto settle = [&](std::size_t slot, BakeFrame& frame) {
      Eigen::VectorXf curves;
      settler.settle_evenly(frame, curves);
      most[slot] = settler.distances(frame, curves).maxCoeff();
    };
    for_frames(poses, settle, [&](std::size_t slot, std::size_t index, const BakeFrame& frame) {
      hardest.emplace(most[slot], frame);
      if (hardest.size() > wanted) hardest.erase(hardest.begin());
      tell(kShaped + (kSearched - kShaped) * double(index) / double(poses.size()),
           "hardest frames");
    });
    for (auto& [distance, frame] : hardest) samples_.push_back(std::move(frame));
  }

  // What a shape hardly moves is left out of it, before curves are found for good.
  void leave_out_little(Shapes& shapes) const {
    for (Index m = 0; m < shapes.offsets.cols(); ++m)
      for (Index i = 0; i < scene_.skin.V.rows(); ++i)
        if (auto offset = shapes.offsets.col(m).segment<3>(3 * i);
            offset.norm() < float(scene_.options.least_offset))
          offset.setZero();
  }

  // Curves and helpers of every frame, and the errors that they leave. Shapes and curves are scaled
  // so that no curve leaves -1 .. 1.
  void follow(const Shapes& shapes) {
    for (Index m = 0; m < shapes.offsets.cols(); ++m)
      bake_.morphs.push_back(
          Eigen::Map<const Rows3f>(shapes.offsets.col(m).data(), scene_.skin.V.rows(), 3)
              .cast<double>());
    const Settler settler = this->settler(shapes);
    BakeErrors all;
    double squares = 0;
    std::size_t total = 0, done = 0;
    for (const BakedMotion& each : bake_.motions) total += each.motion.frames.size();
    std::array<Measured, kTogether> measured;
    for (BakedMotion& each : bake_.motions) {
      BakeErrors here;
      std::vector<const Pose*> poses;
      for (const Pose& pose : each.motion.frames) poses.push_back(&pose);
      each.curves.resize(Index(poses.size()), shapes.offsets.cols());
      const auto settle = [&](std::size_t slot, BakeFrame& frame) {
        Measured& out = measured[slot];
        out.alone =
            settler.distances(frame, Eigen::VectorXf::Zero(shapes.offsets.cols())).squaredNorm();
        settler.settle(frame, out.curves);
        out.helpers = keep_helpers(frame);
        measure(frame, out);
      };
      for_frames(poses, settle, [&](std::size_t slot, std::size_t f, const BakeFrame&) {
        const Measured& out = measured[slot];
        each.curves.row(Index(f)) = out.curves.transpose();
        each.helpers.push_back(out.helpers);
        squares += out.alone;
        tell(kNormals + (1 - kNormals) * double(++done) / double(total), "every frame");
        here.add(out.distances, out.angles);
        all.add(out.distances, out.angles);
      });
      each.error = here.summary(int(poses.size()));
      bake_.error.frames += each.error.frames;
    }
    bake_.error = all.summary(bake_.error.frames);
    bake_.influences_only_rms =
        std::sqrt(squares / (double(bake_.error.frames) * double(scene_.skin.V.rows())));
    scale();
  }

  // The helpers' world frames, turns as the file has them; the bones follow.
  std::vector<Transform> keep_helpers(BakeFrame& frame) const {
    std::vector<Transform> out;
    for (std::size_t h = 0; h < rig_.helpers.size(); ++h) {
      const BakeHelper& helper = rig_.helpers[h];
      const Quat parent(frame.bones[helper.parent].linear());
      Transform& bone = frame.bones[scene_.joints() + h];
      Transform X_WH = bone * Eigen::Translation3d(helper.rest);
      X_WH.linear() =
          (parent * kept_in_shorts(parent.conjugate() * Quat(X_WH.linear()))).toRotationMatrix();
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

  void scale() {
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
  std::vector<std::vector<int>> hung_;  // by helper
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

}  // namespace ecorche
