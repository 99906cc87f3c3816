// Mass, centre and inertia of a body's segments, from the volumes and densities of its tissues.
//
// The skin is cut at joints: where the joint's plane passes, as far as the skin's weights leave it
// open which side a vertex moves with. The pieces' integrals are exact (solid_moments.h) and sum to
// the whole. A piece is filled with what lies between the organs that are drawn, and bones, muscles
// and lungs are put into it by the difference of their density to that filling:
//   bones     1300 kg/m^3, whole, with marrow and cartilage (ICRP Publication 89)
//   muscles   1056 (Ward and Lieber 2005); bellies that are drawn fill the skin, so they are muscle
//             by that share that makes a person's muscle mass (morph/fat/muscle_mass.h)
//   adipose    950 (ICRP 89), as much as estimate_fat_share() says; it fills limbs and the gaps in
//             muscles first, the trunk has the rest
//   skin      1100, 1.3 mm thick (ICRP 89), over all
//   organs    1050 in the trunk, 1040 in the head (brain) (ICRP 89)
//   lungs      260 with blood and air (ICRP 89), as large as at rest after breathing out (Quanjer
//   et
//             al. 1993, 10.1183/09041950.005s1693) and their tissue, as ellipsoids within the ribs
// All of it is scaled to the body's mass; `tissue_mass` is what it was before.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/body_segment.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

struct SegmentInertia {
  std::vector<BodySegment> segments;  // head, neck, three of the trunk, three a limb
  std::vector<double> volumes;        // #segments, of skin, m^3
  double mass = 0;                    // kg: the body's, tissue_mass where that is not known
  double tissue_mass = 0;             // kg
  // kg, before scaling; the rest is organs
  double bone_mass = 0, muscle_mass = 0, fat_mass = 0, lung_mass = 0;
};

// `weights`: #V of body.skin. Throws UnfitError for a skin that has no inside or a segment without
// mass. Preconditions (std::invalid_argument): the skeleton has our joints, a row of weights a
// vertex.
SegmentInertia segment_inertia(const Anatomy& anatomy, const Body& body,
                               std::span<const JointWeights> weights);

// A segment of a body whose shape is changed by factors along the axes of the joint's frame, as the
// statistics paper does it (equations 8 to 10): mass and centre as there; for the inertia its
// second moments are scaled, m_s S (tr(I)/2 - I) S, since equation 10 as printed leaves the mass
// out and scales moments by their own axis.
BodySegment scaled_segment(const BodySegment& segment, const Vec3& factors);

}  // namespace ecorche::inline v1
