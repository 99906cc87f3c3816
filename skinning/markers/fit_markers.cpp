#include "skinning/markers/fit_markers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/errors.h"
#include "skinning/markers/marker_calibration.h"
#include "skinning/markers/marker_pose.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kFewestMarkers = 10, kSampleFrames = 40;
constexpr double kBlind = 0.4;              // of the markers: with fewer a pose is not believed
constexpr double kLost = 0.06;              // m: a frame is solved once more from another pose
constexpr double kHoldTurn = 30 * kDegree;  // from frame to frame, standard deviation

// Which way is up in the file: along which axis markers lie that are high on a body.
Vec3 measured_up(const MarkerTake& take, const std::vector<BodyMarker>& markers) {
  Vec3 sum = Vec3::Zero();
  const std::size_t step = std::max<std::size_t>(1, take.frames.size() / 100);
  for (std::size_t f = 0; f < take.frames.size(); f += step) {
    Vec3 middle = Vec3::Zero();
    double height = 0, count = 0;
    for (const BodyMarker& marker : markers) {
      if (!take.frames[f].row(marker.column).allFinite()) continue;
      middle += take.frames[f].row(marker.column).transpose();
      height += marker.height;
      ++count;
    }
    if (count == 0) continue;
    for (const BodyMarker& marker : markers)
      if (take.frames[f].row(marker.column).allFinite())
        sum += (marker.height - height / count) *
               (take.frames[f].row(marker.column).transpose() - middle / count);
  }
  return sum;
}

// The file's axes -> ours.
Mat3 upright(const MarkerTake& take, const std::vector<BodyMarker>& markers,
             const std::optional<char>& wanted, char& up) {
  const Vec3 measured = measured_up(take, markers);
  int axis = 0;
  measured.cwiseAbs().maxCoeff(&axis);
  if (wanted) {
    axis = *wanted - 'x';
    if (std::abs(measured[axis]) < 0.2 * measured.norm())
      throw UsageError(fmt::format("{}: --up {}: its figure does not stand along that axis",
                                   take.name, *wanted));
  }
  up = char('x' + axis);
  const double sense = measured[axis] < 0 ? -1 : 1;
  Mat3 W;  // rows: where our x, y, z are in the file
  W.row(1) = sense * Vec3::Unit(axis).transpose();
  W.row(2) = Vec3::Unit((axis + 1) % 3).transpose();
  W.row(0) = W.row(1).cross(W.row(2));
  if (axis == 1 && sense > 0) W.setIdentity();
  return W;
}

std::vector<Points> seen_places(const MarkerTake& take, const std::vector<BodyMarker>& markers,
                                const Mat3& W) {
  std::vector<Points> out;
  for (const Points& frame : take.frames) {
    Points& places = out.emplace_back(Eigen::Index(markers.size()), 3);
    for (std::size_t m = 0; m < markers.size(); ++m)
      places.row(Eigen::Index(m)) = frame.row(markers[m].column) * W.transpose();
  }
  return out;
}

int count_seen(const Points& places) {
  int count = 0;
  for (const auto& p : places.rowwise()) count += p.allFinite();
  return count;
}

void require_body(const MarkerTake& take, const std::vector<BodyMarker>& markers,
                  const Skeleton& skeleton) {
  int pelvis = 0, legs = 0;
  for (const BodyMarker& marker : markers) {
    pelvis += marker.joint == 0;
    for (int j = marker.joint; j > 0; j = skeleton.joints[j].parent)
      legs += skeleton.joints[j].name.starts_with("hip");
  }
  if (int(markers.size()) >= kFewestMarkers && pelvis >= 2 && legs >= 4) return;
  throw UnfitError(fmt::format(
      "{}: of its {} markers {} are known, {} on the pelvis and {} on the legs; at least {}, 2 and "
      "4 are needed; --markers FILE.csv (columns marker, place) says where each is stuck",
      take.name, take.markers.size(), markers.size(), pelvis, legs, kFewestMarkers));
}

class MarkerFitter {
 public:
  MarkerFitter(const MarkerTake& take, const std::vector<BodyMarker>& markers,
               const Skeleton& skeleton, const MarkerFitOptions& options)
      : take_(take), options_(options) {
    model_.figure = make_figure(skeleton);
    model_.markers = markers;
    model_.offsets.assign(markers.size(), Vec3::Zero());
  }

  MarkerFit run() {
    seen_ =
        seen_places(take_, model_.markers, upright(take_, model_.markers, options_.up, out_.up));
    choose_samples();
    const std::vector<FigurePose> first = pose_samples();
    if (options_.sizes) calibrate(first);
    track(first);
    if (bridge_gaps()) track_again();
    go_through_blind();
    measure();
    write_clip();
    out_.figure = model_.figure;
    return std::move(out_);
  }

 private:
  bool is_blind(std::size_t f) const {
    return count_seen(seen_[f]) < std::max(6.0, kBlind * double(model_.markers.size()));
  }

  // Frames evenly over the take, those that see most of each stretch.
  void choose_samples() {
    const std::size_t n = seen_.size(), count = std::min<std::size_t>(n, kSampleFrames);
    for (std::size_t k = 0; k < count; ++k) {
      std::size_t best = k * n / count;
      for (std::size_t f = best; f < std::max(best + 1, (k + 1) * n / count); ++f)
        if (count_seen(seen_[f]) > count_seen(seen_[best])) best = f;
      if (!is_blind(best)) samples_.push_back(best);
    }
    if (samples_.empty())
      throw UnfitError(take_.name + ": no frame sees enough of the markers to tell a pose");
  }

  // Before sizes and offsets are known markers may lie off their places.
  std::vector<FigurePose> pose_samples() {
    PoseOptions loose;
    loose.loose = options_.sizes;
    loose.outlier = 0.3;
    loose.rounds = 40;
    std::vector<FigurePose> out;
    for (const std::size_t f : samples_) {
      FigurePose fresh = place_upright(model_, seen_[f]);
      double best = solve_pose(model_, seen_[f], loose, nullptr, fresh);
      if (!out.empty()) {
        FigurePose warm = out.back();
        const double cost = solve_pose(model_, seen_[f], loose, nullptr, warm);
        if (cost < best) fresh = std::move(warm);
      }
      out.push_back(std::move(fresh));
    }
    return out;
  }

  void calibrate(std::vector<FigurePose> poses) {
    std::vector<Points> frames;
    for (const std::size_t f : samples_) frames.push_back(seen_[f]);
    calibrate_markers(frames, model_, poses);
  }

  void track(const std::vector<FigurePose>& first) {
    PoseOptions each;
    each.hold = 1 / std::pow(kHoldTurn, 2);
    poses_.resize(seen_.size());
    std::size_t sample = 0;
    FigurePose now = first[0];
    for (std::size_t f = 0; f < seen_.size(); ++f) {
      while (sample + 1 < samples_.size() && samples_[sample + 1] <= f) ++sample;
      if (!is_blind(f)) {
        const FigurePose before = now;
        solve_pose(model_, seen_[f], each, f > 0 ? &before : nullptr, now);
        if (pose_residual(model_, seen_[f], now) > kLost) {
          FigurePose other = first[sample];
          PoseOptions fresh = each;
          fresh.rounds = 40;
          solve_pose(model_, seen_[f], fresh, nullptr, other);
          if (pose_residual(model_, seen_[f], other) < pose_residual(model_, seen_[f], now))
            now = std::move(other);
        }
      }
      poses_[f] = now;
    }
  }

  // While a marker is not seen it keeps the place on its segment that it had before and has after,
  // from one to the other.
  bool bridge_gaps() {
    filled_ = seen_;
    std::vector<std::vector<Transform>> X(seen_.size());
    Pose pose;
    bool any = false;
    for (std::size_t m = 0; m < model_.markers.size(); ++m) {
      const BodyMarker& marker = model_.markers[m];
      const auto frame = [&](std::size_t f) -> const Transform& {
        if (X[f].empty()) figure_kinematics(model_.figure, poses_[f], pose, X[f]);
        return X[f][std::size_t(marker.joint)];
      };
      const auto local = [&](std::size_t f) {
        return Vec3(frame(f).inverse() * Vec3(seen_[f].row(Eigen::Index(m)).transpose()));
      };
      const auto seen = [&](std::size_t f) {
        return seen_[f].row(Eigen::Index(m)).allFinite() && !is_blind(f);
      };
      for (std::size_t f = 0; f < seen_.size(); ++f) {
        if (seen(f)) continue;
        std::size_t after = f;
        while (after < seen_.size() && !seen(after)) ++after;
        const bool has_before = f > 0, has_after = after < seen_.size();
        for (std::size_t g = f; g < after && (has_before || has_after); ++g) {
          const double share = !has_before  ? 1
                               : !has_after ? 0
                                            : double(g - f + 1) / double(after - f + 1);
          const Vec3 there = (1 - share) * (has_before ? local(f - 1) : Vec3(Vec3::Zero())) +
                             share * (has_after ? local(after) : Vec3(Vec3::Zero()));
          if (!is_blind(g))
            filled_[g].row(Eigen::Index(m)) = (frame(g) * there).transpose(), any = true;
        }
        f = after;
      }
    }
    return any;
  }

  void track_again() {
    PoseOptions each;
    each.hold = 1 / std::pow(kHoldTurn, 2);
    for (std::size_t f = 0; f < seen_.size(); ++f)
      if (!is_blind(f))
        solve_pose(model_, filled_[f], each, f > 0 ? &poses_[f - 1] : nullptr, poses_[f]);
  }

  void go_through_blind() {
    Eigen::VectorXd way;
    for (std::size_t f = 0; f < seen_.size(); ++f) {
      if (!is_blind(f)) continue;
      std::size_t after = f;
      while (after < seen_.size() && is_blind(after)) ++after;
      out_.blind += int(after - f);
      if (f == 0)
        for (std::size_t g = f; g < after; ++g) poses_[g] = poses_[after];
      for (std::size_t g = f; g < after && f > 0; ++g) {
        poses_[g] = poses_[f - 1];
        if (after == seen_.size()) continue;
        const double share = double(g - f + 1) / double(after - f + 1);
        figure_difference(model_.figure, poses_[f - 1], poses_[after], way);
        way.head<3>() = poses_[after].root - poses_[f - 1].root;
        move_figure(model_.figure, share * way, poses_[g]);
      }
      f = after;
    }
  }

  void measure() {
    double sum = 0, count = 0;
    std::vector<double> sums(model_.markers.size(), 0), counts(model_.markers.size(), 0);
    std::vector<int> run(model_.markers.size(), 0);
    for (std::size_t m = 0; m < model_.markers.size(); ++m)
      out_.markers.push_back({model_.markers[m].name, model_.markers[m].place, 0, 0, 0, 0, 0,
                              model_.offsets[m].norm()});
    std::vector<Transform> X;
    out_.motion.fps = take_.fps;
    for (std::size_t f = 0; f < seen_.size(); ++f) {
      figure_kinematics(model_.figure, poses_[f], out_.motion.frames.emplace_back(), X);
      for (std::size_t m = 0; m < model_.markers.size(); ++m) {
        MarkerResidual& marker = out_.markers[m];
        if (!seen_[f].row(Eigen::Index(m)).allFinite()) {
          ++marker.gaps;
          marker.longest = std::max(marker.longest, ++run[m]);
          continue;
        }
        run[m] = 0;
        if (is_blind(f)) continue;
        const double off = (figure_point(model_.figure, X, model_.markers[m].joint,
                                         model_.markers[m].local, model_.offsets[m]) -
                            seen_[f].row(Eigen::Index(m)).transpose())
                               .norm();
        sums[m] += off * off, counts[m] += 1;
        if (off > marker.worst) marker.worst = off, marker.worst_frame = int(f);
      }
    }
    for (std::size_t m = 0; m < out_.markers.size(); ++m) {
      MarkerResidual& marker = out_.markers[m];
      if (counts[m] > 0) marker.rms = std::sqrt(sums[m] / counts[m]);
      sum += sums[m], count += counts[m];
      if (marker.worst > out_.worst)
        out_.worst = marker.worst, out_.worst_marker = marker.marker,
        out_.worst_frame = marker.worst_frame;
    }
    out_.rms = count > 0 ? std::sqrt(sum / count) : 0;
  }

  void write_clip() {
    MotionClip& clip = out_.clip;
    clip.name = take_.name;
    clip.fps = take_.fps;
    clip.up = 'y';
    clip.metres_per_unit = 1;
    clip.captured = true;
    clip.warnings = take_.warnings;
    for (const Joint& joint : model_.figure.skeleton.joints) {
      ClipJoint& made = clip.joints.emplace_back();
      made.name = joint.name;
      made.parent = joint.parent;
      made.offset = joint.X_PJ.translation();
      made.rotation_track = clip.rotation_tracks++;
      if (joint.parent < 0) made.translation_track = clip.translation_tracks++;
    }
    clip.frame_count = int(out_.motion.frames.size());
    for (const Pose& pose : out_.motion.frames) {
      clip.translations.push_back(pose.root);
      for (const Quat& turn : pose.rotations) clip.rotations.push_back(turn.toRotationMatrix());
    }
  }

  const MarkerTake& take_;
  MarkerFitOptions options_;
  MarkerModel model_;
  MarkerFit out_;
  std::vector<Points> seen_, filled_;  // #frames x #markers, our axes
  std::vector<std::size_t> samples_;
  std::vector<FigurePose> poses_;
};

}  // namespace

MarkerFit fit_markers(const MarkerTake& take, const std::vector<BodyMarker>& markers,
                      const Skeleton& skeleton, const MarkerFitOptions& options) {
  require_body(take, markers, skeleton);
  return MarkerFitter(take, markers, skeleton, options).run();
}

}  // namespace ecorche::inline v1
