// The ground's forces on the feet, estimated without plates from what the body's motion asks for.
//
// Eight points under each foot may be pushed by the ground, each as far as it is low and slow
// (after Fluit et al. 2014, 10.1016/j.jbiomech.2014.04.030, and Skals et al. 2017,
// 10.1007/s11044-016-9537-4); what passes from 1 to 0 does so smoothly. Their vertical forces give
// the whole body's vertical force and its moments about the horizontal axes with the least sum of
// squares, so that a foot takes over from the other as the centre of pressure goes across. Where
// along its foot that lies, the moments tell to some centimetres only, which are the half of what
// an ankle gives. In walking it follows the shank: people roll over their feet as over an arc that
// the shank holds, whatever speed, load or shoe (Hansen and Childress 2010,
// 10.3109/09638288.2010.504442), of a radius of 0.22 of the stature (Hansen and Meier 2010). So the
// faster a body goes along its feet, the more its moments give way to that arc, and the force
// leans so that the moment about the body's middle stays. How far
// feet push against each other cannot be told from the motion; in walking both push towards one
// point of the trunk (Maus et al. 2010, 10.1038/ncomms1073), so that the foot in front brakes. Each
// foot's force is leaned towards a point 0.25 m over the hips, and what is still missing of the
// horizontal force is shared as the vertical force is, and so is the moment about the vertical.
// Nothing pulls, and what the points cannot give stays a residual.
#pragma once

#include <array>
#include <vector>

#include "skinning/dynamics/joint_loads.h"

namespace ecorche::inline v1 {

struct SolePoint {
  int foot = 0;               // 0 left, 1 right
  int joint = 0;              // that carries it
  Vec3 place = Vec3::Zero();  // in the joint's frame
};

// Heel, balls and toes of both feet. sole_height: world y of the soles at rest. Precondition
// (std::invalid_argument): the skeleton has our joints.
std::vector<SolePoint> sole_points(const Skeleton& skeleton, double sole_height);

// A sole point at one moment.
struct SoleContact {
  Vec3 place = Vec3::Zero(), velocity = Vec3::Zero();  // world
  double gate = 0;                                     // 0 in the air .. 1 stands
};

// How far a point takes part: wholly below 20 mm and 0.8 m/s, not at all above 50 mm or 1.6 m/s.
// The speed is that along the floor and upwards: what comes down meets the ground.
double contact_gate(double height, const Vec3& velocity);

struct FootForce {
  Vec3 force = Vec3::Zero();  // on the foot, world, N
  Vec3 place = Vec3::Zero();  // centre of pressure, on the floor; the foot's middle without force
  double free_moment = 0;     // about the vertical, N m
};

struct GroundReaction {
  std::vector<ExternalForce> forces;  // at the points
  std::array<FootForce, 2> feet;
};

// Where a foot is rolled over.
struct RollOver {
  Vec3 place = Vec3::Zero();    // on the arc below its centre, world
  Vec3 heading = Vec3::Zero();  // of the foot, level, unit
  double share = 0;             // 0: the moments alone tell .. 1
};

// `ankle_height`: over the sole at rest, m. `velocity`: of the body over the ground, m/s.
RollOver roll_over(const Vec3& knee, const Vec3& ankle, double ankle_height, const Vec3& heel,
                   const Vec3& ball, const Vec3& velocity);

// wanted: what the root misses, about the world point `root`; `weight`: N.
GroundReaction share_ground_reaction(const JointLoad& wanted, const Vec3& root, double weight,
                                     double floor, const std::vector<SolePoint>& points,
                                     const std::vector<SoleContact>& contacts,
                                     const std::array<RollOver, 2>& rolls);

}  // namespace ecorche::inline v1
