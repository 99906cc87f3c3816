// Where the skin of a patient touches the sheet, the mattress or a chair's pads, and how deep.
//
// Every vertex of the skin that faces the sheet is compared with its nearest triangle, which is
// found from the one of the step before. The tissue under it is an elastic foundation: its pressure
// rises with depth, and steeply where it is pressed to half of its thickness. A vertex stands for
// that part of its area which faces along the contact, so that cloth round a limb is not counted
// twice. Outside the sheet the skin meets mattress and pads themselves, tissue and foam in series.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "skinning/lift/patient.h"
#include "skinning/lift/sheet.h"
#include "skinning/multibody/articulated_body.h"

namespace ecorche::inline v1 {

struct Mattress {
  bool present = true;
  double height = 0;       // y of its top, m
  double stiffness = 4e5;  // Pa/m: foam of 40 kPa, 0.1 m thick; larger: harder
  // Pressure over stiffness times depth rises to twice at this depth: the foam bottoms out, m
  double bottom = 0.08;
};

// A plane cushion with rounded edges: the seat or the back of a chair, a floor.
struct Pad {
  std::string name;                        // "seat"
  Transform X_WP = Transform::Identity();  // middle of its surface; y towards the person
  double half_width = 0, half_length = 0;  // m, along x and z
  double edge = 0.03;                      // m, radius of the rounded edge
  double stiffness = 8e5;                  // as Mattress
  double bottom = 0.04;                    // likewise
};

struct SkinContact {
  int vertex = 0;
  int triangle = -1;               // of the sheet; -1: none
  int pad = -1;                    // of the pads; -1: the mattress, where triangle is -1, too
  Vec3 corners = Vec3::Zero();     // barycentric
  Vec3 normal = Vec3::UnitY();     // unit, towards the body
  double depth = 0;                // m
  double area = 0;                 // m^2, across the normal
  double pressure = 0, slope = 0;  // Pa, Pa/m
};

// What one step hands to the next.
struct ContactMemory {
  std::vector<int> triangle;  // #V of the skin, nearest; -1: not yet searched
  std::vector<int> wait;      // steps for which a vertex is too far away to touch
};

// A pressure that rises with depth and is twice as steep as k where depth is a third of
// `thickness`.
void foundation(double stiffness, double thickness, double depth, double& pressure, double& slope);

// `skin`, `normals`: #V x 3. `nodes`: of the sheet; null: there is none. `seconds`: of a step.
// A vertex may touch several pads.
void find_contacts(const Patient& patient, const Points& skin, const Points& normals,
                   const Sheet* sheet, const Points& nodes, const Mattress& mattress,
                   std::span<const Pad> pads, double seconds, ContactMemory& memory,
                   std::vector<SkinContact>& out);

}  // namespace ecorche::inline v1
