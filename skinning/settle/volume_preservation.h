// Volume preservation for the body, the lower body, limbs, elbows and knees, shoulders. Private to
// the library.
//
// What is lost is given back where it was lost: belly and hips keep the volume below the chest, and
// only the chest pays for what shoulders take and give.
// Volume lost to bending or to the membrane's tension is restored by moving vertices along their
// normals, in proportion to the soft tissue beneath and less where the surface is strongly curved
// (swelling_limits.h). One Newton step a region, which suffices for changes of a few per cent;
// concave folds do not move.
#pragma once

#include <span>
#include <vector>

#include "anatomy/geometry/mesh_rims.h"
#include "anatomy/skeleton.h"
#include "skinning/binding.h"
#include "skinning/relaxed_skin.h"
#include "skinning/settle/membrane.h"

namespace ecorche::inline v1 {

struct VolumeParameters {
  // Radius of inward curvature, m, at which skin does not swell at all. Larger: shallow hollows
  // stay as they are; smaller: folds press into themselves.
  float hollow = 0.03f;
  int openness_rounds = 3;  // of smoothing
  // Bound of the swelling, in units of VolumeRegion::swelling: no edge changes by more than this
  // fraction of its length.
  double most_swelling = 0.4;
  // The same of a shoulder: what a raised arm's loses at its top would make a ball of its back.
  double most_shoulder_swelling = 0.2;
  // Fraction of the upper arm at which the shoulder's region ends, and over which its swelling
  // fades.
  double shoulder_end = 0.5, shoulder_fade = 0.4;
  // Fraction of its volume that a shoulder may lose: flesh of a raised arm goes to chest and back.
  double shoulder_give = 0.02;
  // Fraction of its volume that the whole body may gain: raised arms draw the chest open, and
  // breath fills it. Were all of it taken back, hips and waist would sink.
  double body_take = 0.004;
  // The same of the lower body: breath and raised arms draw the belly's flesh up.
  double lower_body_take = 0.02;
  // Share of the skin that the lower body must hold for all of its swelling to be the lower body's.
  // Larger: where the belly's skin begins, which has the thickest flesh of the trunk, it pays for
  // what arms and chest have gained.
  double belly_share = 0.5;
};

struct VolumeRegion {
  int within = -1;     // region that it is a part of
  bool hinge = false;  // the tissue about an elbow or a knee
  // joint: apex of the cones over the triangles, so that a cut near it needs no lid
  int origin = 0;
  std::vector<int> corners;   // 3 a triangle
  std::vector<float> share;   // a triangle: fraction of it that is the region's
  std::vector<MeshRim> rims;  // edges of cuts that are closed by fans about their middles
  double volume = 0;          // rest, m^3
  double give = 0, take = 0;  // fractions of it that it may lose and gain
  double most_swelling = 0;   // units a step
  std::vector<int> vertices;
  std::vector<float> swelling, area;  // a vertex: m a unit; m^2 at rest
};

struct VolumeRegions {
  // The whole body first, to which the chest swells; then all below the chest, to which belly and
  // hips do (without a joint "thorax" the trunk swells to the body as one); then arms and legs,
  // each followed by its hinge; then the shoulders with their girdles.
  std::vector<VolumeRegion> regions;
};

// `positions`: #V x 4, rest. `tissue`: m, #V.
VolumeRegions make_volume_regions(const Skeleton& skeleton, std::span<const float> positions,
                                  std::span<const int> triangles,
                                  std::span<const JointWeights> joint_weights,
                                  std::span<const double> tissue);

// Fills skin.openness. `working`: memory, sized on first use.
void find_openness(const Membrane& rings, RelaxedSkin& skin, std::vector<float>& working);

// Whether the tissue about elbows and knees keeps a volume of its own, or only its limb does.
enum class HingeVolumes { free, kept };

// Moves skin.positions along skin.normals, by skin.openness. Allocates nothing.
void restore_volumes(const VolumeRegions& volumes, std::span<const Transform> X_WJ,
                     RelaxedSkin& skin, HingeVolumes hinges = HingeVolumes::kept);

}  // namespace ecorche::inline v1
