#include "skinning/filters/motion_filters.h"

#include <algorithm>

#include "skinning/filters/edit_path.h"
#include "skinning/filters/mirror_motion.h"
#include "skinning/filters/smooth_frames.h"
#include "skinning/filters/warp_time.h"

namespace ecorche::inline v1 {
namespace {

struct Apply {
  const std::string& name;
  const Skeleton& skeleton;
  FilteredMotion& filtered;

  void operator()(const LockFeet& lock) const { filtered.lock = lock.strength; }
  void operator()(const SmoothFrames& smooth) const {
    smooth_frames(smooth.width, filtered.motion);
  }
  void operator()(const WarpTime& warp) const { warp_time(warp.speed, filtered); }
  void operator()(const FitLength& fit) const { fit_length(fit.length, filtered); }
  void operator()(const ChangeRate& rate) const { change_rate(rate.fps, filtered); }
  void operator()(const MirrorMotion&) const { mirror_motion(skeleton, filtered); }
  void operator()(const LoopOptions& loop) const { make_loop(name, skeleton, loop, filtered); }
  void operator()(const StraightenPath&) const { straighten_path(name, filtered); }
  void operator()(const BendPath& bend) const { bend_path(name, bend.angle, filtered); }
  void operator()(const FollowPoints& follow) const {
    follow_points(name, follow.points, filtered);
  }
  void operator()(const TurnMotion& turn) const { turn_motion(turn.angle, filtered); }
  void operator()(const SlopeGround& ground) const { filtered.slope = ground.angle; }
  void operator()(const GoOver& go) const { go_over_to(name, go.second, go.transition, filtered); }
  void operator()(const MixWith& mix) const { mix_with(mix.second, mix.share, filtered); }
};

}  // namespace

bool moves_feet(const std::vector<MotionFilter>& filters) {
  return std::ranges::any_of(filters, [](const MotionFilter& one) {
    return !std::holds_alternative<MirrorMotion>(one) && !std::holds_alternative<TurnMotion>(one) &&
           !std::holds_alternative<SlopeGround>(one) && !std::holds_alternative<WarpTime>(one) &&
           !std::holds_alternative<FitLength>(one) && !std::holds_alternative<ChangeRate>(one);
  });
}

void apply_filters(const std::string& name, const Skeleton& skeleton,
                   const std::vector<MotionFilter>& filters, FilteredMotion& filtered) {
  for (const MotionFilter& one : filters) std::visit(Apply{name, skeleton, filtered}, one);
}

}  // namespace ecorche::inline v1
