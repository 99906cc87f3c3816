#include "skinning/dynamics/auto_activations.h"

#include <stdexcept>

#include "anatomy/errors.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/dynamics/segment_inertia.h"
#include "skinning/motion/center_of_mass.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kUnknownMass = 70;   // kg
constexpr double kPointRadius = 0.1;  // m, of gyration, where only a segment's mass is known
constexpr std::size_t kLeastFrames = 3;

std::vector<BodySegment> table_segments(const Skeleton& skeleton, double mass) {
  std::vector<BodySegment> out;
  const CenterOfMass center(skeleton);
  for (const CenterOfMass::Segment& s : center.segments())
    out.push_back({skeleton.joints[s.joint].name, s.joint, mass * s.mass, s.centre,
                   mass * s.mass * kPointRadius * kPointRadius * Mat3::Identity()});
  return out;
}

}  // namespace

AutoActivations auto_activations(const PosingTable& table, const Anatomy& anatomy, const Body& body,
                                 std::span<const JointWeights> weights, const Motion& motion) {
  if (motion.frames.empty() || !(motion.fps > 0))
    throw std::invalid_argument("auto_activations: a motion without frames");
  AutoActivations out;
  const Skeleton& skeleton = anatomy.skeleton;
  std::vector<BodySegment> segments;
  try {
    segments = segment_inertia(anatomy, body, weights).segments;
  } catch (const UnfitError&) {
    out.table_masses = true;
    segments = table_segments(skeleton, body.mass > 0 ? body.mass : kUnknownMass);
  }
  Motion held = motion;
  while (held.frames.size() < kLeastFrames) held.frames.push_back(held.frames.back());
  const double sole =
      body.skin.V.rows() > 0 ? body.skin.V.col(1).minCoeff() : guess_sole_height(skeleton);
  const MotionDynamics dynamics = inverse_dynamics(skeleton, segments, sole, held);
  out.ground_force_peak = dynamics.peak_vertical;
  out.residual_force = dynamics.residual_force_rms;
  out.efforts = static_optimization(table, anatomy, dynamics);
  out.activations = activations_of(out.efforts);
  return out;
}

}  // namespace ecorche::inline v1
