// The pose that a scan stands in, and its shape, by many hypotheses.
//
// Whole poses in every orientation are laid over the scan; the best are fitted, each limb of those
// is tried in every other way, and what is left is fitted with the shape. See decision 13.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/registration/articulated_body.h"
#include "morph/registration/articulated_fit.h"
#include "morph/registration/even_points.h"
#include "morph/registration/point_tree.h"
#include "morph/registration/pose_hypotheses.h"

namespace ecorche::inline v1 {

struct PoseHypothesis {
  ArticulatedState state;
  double misfit = 1;  // 0 .. 1, and what its turns cost; the less the better
  std::string name;   // "standing, arms down; leg bent"
};

struct PoseSearchOptions {
  bool one_view = false;
  bool scale_known = false;
  std::optional<Vec3> up{};  // where the file tells it
  std::vector<PlaceHint> hints{};
  std::optional<std::string> pose{};  // "a", "t": of those alone
};

class PoseSearch {
 public:
  // Of the points every beginning is even, too. `body` must outlive the search.
  PoseSearch(const ArticulatedBody& body, EvenPoints points, PoseSearchOptions options);

  // Poses of a body in general; the best first. None are alike.
  std::vector<PoseHypothesis> find_poses() const;
  // Shape joins in, for all; the best is fitted closely and comes first.
  void fit_shapes(std::vector<PoseHypothesis>& found) const;
  // How near the best of the others came to the first, if it is another pose: 0 .. 1.
  double rivalry(const std::vector<PoseHypothesis>& found) const;

  const ScanTarget& target() const { return target_; }
  const PointTree& tree() const { return tree_; }

 private:
  ArticulatedFit fit() const { return {body_, target_, options_.hints}; }
  FitStage sized(FitStage stage) const;
  PoseHypothesis as_known() const;
  std::vector<PoseHypothesis> placed() const;
  void posed(std::vector<PoseHypothesis>& found) const;
  void other_limbs(std::vector<PoseHypothesis>& found) const;
  void keep_distinct(std::vector<PoseHypothesis>& found) const;
  Vec3 hint_point(const PlaceHint& hint, const ArticulatedPose& pose) const;
  double hint_misfit(const ArticulatedState& state) const;
  std::optional<LimbPose> known_limb(bool arm, Side side, const ArticulatedState& state) const;
  void lay_over_hints(ArticulatedState& state) const;
  double misfit(const ArticulatedState& state, const BodySamples& samples, int count) const;

  const ArticulatedBody& body_;
  RestShape mean_;  // of nobody in particular
  PoseSearchOptions options_;
  BodySamples coarse_, middle_, fine_;
  ScanTarget target_;
  PointTree tree_;
};

}  // namespace ecorche::inline v1
