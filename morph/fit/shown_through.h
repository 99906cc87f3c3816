// What shows through: a muscle or bone that lies outermost over another that covers it in the
// template.
//
// Rays go straight in from within the layer of fat. In the template they say, triangle by triangle
// of the skin, what lies over what within 2 cm of it; bodies have the same triangles. In another
// body the outermost shows through where under it lies what in the template covers it there, and
// nowhere about is covered by it. A border that has moved shows nothing: what has left it bare is
// not beneath. Sheets of fascia cover, too. Muscles in the fat of the skin are left out.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_rig.h"
#include "morph/fat/fat_layer.h"
#include "morph/template/template.h"

namespace ecorche::inline v1 {

// Asked at most of one bone, or muscle below the superficial layer, m^2.
inline constexpr double kShownAsked = 20e-4;

// A body at rest, and its layer of fat.
struct LayeredBody {
  const Anatomy& anatomy;
  const TriMesh& wall;                   // of chest_wall_skin
  const FatLayer& fat;                   // of its vertices
  const std::vector<VertexPart>& parts;  // vertex_parts of its package
};

// Places in a list of names, #names for fascia.
struct OrderedPair {
  int over = 0, under = 0;
  auto operator<=>(const OrderedPair&) const = default;
};

// Of limbs and trunk.
struct LayerOrder {
  std::vector<std::string> names;  // of muscles and bones, in alphabetical order
  // by triangle of the wall: pairs that lie one over the other within 2 cm of it, ascending
  std::vector<std::vector<OrderedPair>> pairs;
};
LayerOrder order_of_layers(const LayeredBody& body);
// Of the template in its own body. `package`: that of the bodies that are compared with it.
LayerOrder template_layers(const Template& body_template, const BodyPackage& package);

struct ShownThrough {
  double area = 0;                     // m^2 of the layer's underside
  std::vector<double> muscles, bones;  // of it, in the anatomy's order
  // The bone, or muscle below the superficial layer, that shows most, and how much, m^2.
  std::string most;
  double by_one = 0;
};
// Precondition: a wall of as many triangles as the reference's.
ShownThrough measure_shown_through(const LayerOrder& reference, const LayeredBody& body);

}  // namespace ecorche::inline v1
