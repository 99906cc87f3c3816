// A smooth map of a body's inside from rest to pose, which carries muscles so that what touched at
// rest touches still: neighbours hardly part, cross or tear, since they move by nearly one map.
//
//   p(X) = (1 - a) D(X) + a L(X) + u(X) + v(X)
//
// D blends the joints' motions as dual quaternions, L linearly (Kavan et al. 2007,
// 10.1145/1230100.1230107), by harmonic weights in a lattice of the body (harmonic_weights.h): 1 on
// a joint's bones, the mean of the neighbours elsewhere. Between two bones that close, D turns
// tissue evenly about the joint; where they open, it would swing outwards like a bag, and straight
// lines between the two sides, L, are nearer to taut muscles: `a` rises from 0 to 1 as D comes to
// stretch volume by 1.6. u brings what the settled skin has pushed in along, fading to nought on
// bones. v gives cells that muscles fill their volumes back (pressure_projection.h).
//
// Muscles in the fat of the skin go with the skin, nearer to bone the more with the map
// (skin_bonds.h).
//
// A muscle is moved less by joints that its line does not pass: layers slide over one another.
// Within 5 cm of an end on a bone that bone carries it, wholly at the end.
// Sections take centre and axes from the map, evened along each strip; where the strip has opened
// or closed more than it may, they slide along it (slide_sections.h). From pose_anatomy() they take
// the share by which their substance has slid along the line, bulged or turned rounder. Volumes of
// bellies are kept but for what cells are too coarse for: restore_volumes() brings the rest. Sheets
// that glide over a bone rise over it last (bone_beds.h).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "anatomy/posed_anatomy.h"
#include "anatomy/queries/skin_bonds.h"
#include "skinning/interior/bone_beds.h"
#include "skinning/interior/map_points.h"
#include "skinning/interior/pressure_projection.h"
#include "skinning/interior/slide_sections.h"

namespace ecorche::inline v1 {

struct MapSection {
  double width = 0, thickness = 0;  // from left to right, from down to up, at rest, m
  double gap = 0;                   // to the strip's next section at rest, m; 0 at the last
  double lean = 0;                  // of its normal from the line of centres at most, rad
  Ellipse rest;
  int strip = 0, begin = 0, end = 0;  // and the strip's sections
  bool sheet = false;
  // of a muscle in the skin's fat: in BodyMap, of its centre and the four points of its outline
  int bonds = -1;
  double held = 0;  // by the bone of an end, 0 to 1
};

struct MapWeights;  // map_weights.h

// Constant after it is made.
struct BodyMap {
  std::vector<MapSection> sections;  // #all slices
  MapPoints centers;                 // #sections
  MapPoints outlines;                // #sections x 4: right, left, up, down
  // vertices of the skin whose displacement the tissue about them takes part in, and where they are
  std::vector<int> control_vertices;
  MapPoints controls;
  std::vector<SkinBond> bonds;  // vertices as they are sorted in frames
  PressureTable pressure;
  BoneBeds beds;
  MapPoints nodes;           // of the pressure's lattice
  std::vector<Vec3> joints;  // at rest
  std::vector<int> parents;
  std::shared_ptr<const MapWeights> weights;  // by which its points were placed
  // of each strip, the flesh that it has in the pressure's cells, m^3
  std::vector<std::vector<LatticeShare>> flesh;
};

// The map of a body with the same skin, bones and joints, and with many of the same muscles.
struct BodyMapBefore {
  const BodyMap* map = nullptr;  // null: there is none
  std::vector<int> sections{};   // #sections now, which of the map's each is, -1: none
};

// Memory of carry_muscles(). Its content has no meaning between calls.
struct BodyMapWorkspace {
  JointMotions motions;
  std::vector<Vec3> controls;         // #controls, where the map alone brings them
  std::vector<float> shifts;          // (#controls + 1) x 4, m
  std::vector<Vec3> lines;            // #sections, centres by their action lines
  std::vector<Mat3> gradients;        // #sections, of the map
  std::vector<MappedSection> mapped;  // #sections
  std::vector<Vec3> before, after;    // #nodes, world; without and with flow
  std::vector<float> flow;            // #nodes x 4, m
  std::vector<Mat3> turns;            // #nodes
  std::vector<float> straight;        // #nodes, share of straight lines
  PressureWorkspace pressure;
  BoneBedWorkspace beds;
};

// `skin`: closed but for small openings, the mesh that relaxes. `order`: its vertices as they are
// sorted in frames, or empty. `rest`: of the anatomy. Throws UnfitError where no bone lies in the
// skin. About a second for a whole body. What lies in `before`, too, is taken over.
BodyMap make_body_map(const Anatomy& anatomy, const TriMesh& skin, std::span<const int> order,
                      const PosedAnatomy& rest, const BodyMapBefore& before = {});

// Carries the sections of `posed`, which pose_muscles() has filled. `positions`, `normals`: of the
// skin in this pose, #V x 4, sorted. The rest pose stays as it is, but for rounding. The same bytes
// at any number of threads.
void carry_muscles(const BodyMap& map, std::span<const float> positions,
                   std::span<const float> normals, PosedAnatomy& posed,
                   BodyMapWorkspace& workspace);

}  // namespace ecorche::inline v1
