#include "anatomy/model_files/musculoskeletal_model.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

// Bound of every coordinate.
constexpr double kFarthest = 100;  // m

void require_near(const Vec3& place, const std::string& where) {
  if (place.allFinite() && place.cwiseAbs().maxCoeff() <= kFarthest) return;
  throw InputError(fmt::format("{}: it lies at {:.3g}, {:.3g}, {:.3g} m, further than {} m away",
                               where, place.x(), place.y(), place.z(), kFarthest));
}

void require_most(double value, double most, const std::string& where, const char* what) {
  if (!(value >= 0 && value <= most))
    throw InputError(
        fmt::format("{}: {} is {:.6g}; expected 0 to {:.6g}", where, what, value, most));
}

}  // namespace

void check_model(const MusculoskeletalModel& model) {
  const auto where = [&](const char* kind, const std::string& name) {
    return fmt::format("{}: {} '{}'", model.file, kind, printable(name));
  };
  for (const ModelBody& body : model.bodies)
    for (int pose = 0; pose < kModelPoses; ++pose) {
      require_near(body.X_WB[pose].translation(), where("body", body.name));
      require_near(body.center[pose], where("body", body.name) + ": its joint");
      if (!body.X_WB[pose].linear().allFinite())
        throw InputError(where("body", body.name) + ": its orientation is not finite");
    }
  for (const ModelWrap& wrap : model.wraps) {
    require_near(wrap.X_BO.translation(), where("wrap object", wrap.name));
    require_near(wrap.radii, where("wrap object", wrap.name) + ": radii");
    if (!wrap.X_BO.linear().allFinite())
      throw InputError(where("wrap object", wrap.name) + ": its orientation is not finite");
  }
  for (const ModelMuscle& muscle : model.muscles) {
    const std::string at = where("muscle", muscle.name);
    for (const ModelPoint& point : muscle.points)
      for (const Vec3& place : point.place)
        require_near(place, fmt::format("{}: path point '{}'", at, printable(point.name)));
    require_most(muscle.max_force, 1e6, at, "max_isometric_force");
    require_most(muscle.fibre_length, 10, at, "optimal_fiber_length");
    require_most(muscle.tendon_slack, 10, at, "tendon_slack_length");
    require_most(muscle.pennation, 1.6, at, "pennation_angle");
  }
}

}  // namespace ecorche::inline v1
