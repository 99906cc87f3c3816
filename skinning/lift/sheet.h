// A sheet of cloth that hangs on straps: a triangle mesh whose edges are springs, and the loops at
// its rim by which a spreader bar lifts it.
//
// Springs take the stiffness of a membrane from the triangles beside them, so that a finer mesh of
// the same cloth is as stiff (Van Gelder 1998, 10.1080/10867651.1998.10487490).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct SheetMaterial {
  double stiffness = 6e4;  // Young's modulus times thickness, N/m: woven polyester
  double mass = 0.35;      // kg/m^2
  // Share of the stiffness against compression: cloth folds. Larger: the sheet stands like card.
  double slack = 0.02;
};

struct SheetSpring {
  int a = 0, b = 0;      // nodes, a > b
  double rest = 0;       // m
  double stiffness = 0;  // N/m
};

// A strap from a hook of the spreader bar to a loop, which spreads the pull over the nodes around
// it.
struct Strap {
  std::string name;          // "shoulder_l"
  Vec3 hook = Vec3::Zero();  // from the middle of the bar
  double length = 0.4;       // m
  double stiffness = 4e4;    // N/m
  std::vector<int> nodes;
  std::vector<double> shares;  // #nodes, sum 1
};

struct Sheet {
  TriMesh mesh;  // laid out, upper side counter-clockwise
  SheetMaterial material;
  std::vector<double> area;  // #V, m^2
  std::vector<double> mass;  // #V, kg
  std::vector<SheetSpring> springs;
  std::vector<Strap> straps;
  std::vector<std::vector<int>> around;      // #V, triangles
  std::vector<std::array<int, 3>> edges_of;  // #F, springs opposite to no corner: 01, 12, 20
  std::vector<char> rim;                     // #V, 1 on the sheet's edge
};

// Springs, masses and rim of a mesh. Throws std::invalid_argument for one without triangles, with
// triangles without area, or with nodes of no triangle.
Sheet make_sheet(const TriMesh& mesh, const SheetMaterial& material = {});

// A rectangle in the plane y = 0 with its middle at (0, 0, z), `width` along x and `length` along
// z, in cells near `spacing`.
TriMesh rectangle(double width, double length, double z, double spacing);

// Adds a strap to the loop at `place`: nodes within `radius` share the pull. At least the nearest.
void add_strap(Sheet& sheet, const std::string& name, const Vec3& place, const Vec3& hook,
               double length, double radius = 0.07);

}  // namespace ecorche::inline v1
