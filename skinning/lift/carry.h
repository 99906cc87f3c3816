// A patient on a mattress, on the pads of a chair and in a sheet, over time.
//
// One implicit step has sheet, straps, body, contact and friction in one linear system
// (contact_system.h). Contact forces are those that acted over the step, so that they add up to
// the weight and the change of momentum to rounding.
#pragma once

#include <memory>
#include <vector>

#include "skinning/lift/carried_skin.h"
#include "skinning/lift/contact_system.h"
#include "skinning/lift/patient.h"
#include "skinning/lift/sheet.h"
#include "skinning/lift/skin_contact.h"
#include "skinning/multibody/articulated_body.h"

namespace ecorche::inline v1 {

struct CarryOptions {
  double step = 1.0 / 60;  // s
  double gravity = 9.81;   // m/s^2
  // Coulomb's coefficient of skin, clothes and sheet, and of the sheet on the mattress; viscous
  // below `creep`, m/s. Larger creep: what should stick slides down slowly.
  double friction = 0.4, creep = 0.005;
  double stiffness_damping = 0.01;  // s, of cloth, straps and tissue
  // 1/s, of the sheet's and the body's motion through the air and by an attendant's hand. Larger:
  // swinging ends sooner. 0: it goes on.
  double drag = 0.8;
  // s between calls of the skin's shaper, over which its shape is taken on.
  double shape_time = 1.0 / 3;
};

struct CarryModel {
  Patient patient;
  std::shared_ptr<const Sheet> sheet;  // null: none
  Mattress mattress;
  CarryOptions options;
  SkinShaper shaper{};  // empty: the skin is the blend of its joints
  std::vector<Pad> pads{};
};

// What acted over the last step.
struct CarryForces {
  std::vector<double> pressure;      // #V of the skin, Pa; 0 where nothing touches
  std::vector<double> contact_area;  // #V, m^2
  std::vector<int> pad;              // #V, of the pads; -1: none
  std::vector<Vec3> region;          // #regions, N, on the body, world
  std::vector<double> straps;        // N, tension
  Vec3 strap_sum = Vec3::Zero();     // N, on the sheet
  Vec3 mattress = Vec3::Zero();      // N, on sheet and body
  std::vector<Vec3> pads;            // #pads, N, on the body
};

struct CarryState {
  double time = 0;  // s
  BodyState body;
  Points nodes, node_velocities;      // of the sheet, #nodes x 3
  Vec3 bar = Vec3::Zero();            // middle of the spreader bar
  std::vector<double> strap_lengths;  // m; they may be drawn in
  CarryForces forces;
  // of the last step's beginning: the skin without and with the depth by which it is pressed in
  Points skin, pressed;

  // From step to step.
  PassiveRest rest;
  ContactMemory memory;
  Points shape, wanted_shape;
  int steps = 0;
  std::shared_ptr<ContactSystem> system;
};

// The person in `pose`, the sheet as it was laid out, moved by `sheet_offset`; all at rest.
CarryState start_carrying(const CarryModel& model, const Pose& pose, const Vec3& sheet_offset,
                          const Vec3& bar);

// One step; the bar moves at `bar_velocity` through it.
void carry(const CarryModel& model, const Vec3& bar_velocity, CarryState& state);

// Kinetic energy and that of height, J, of body and sheet.
double carried_energy(const CarryModel& model, const CarryState& state);

}  // namespace ecorche::inline v1
