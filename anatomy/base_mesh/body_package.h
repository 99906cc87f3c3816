// The body package: a base mesh of the human skin, the targets that shape it, and the rigs that
// others move it with.
//
// The package's own frame is the world frame of all rooms (+X the body's left, +Y up, +Z forward),
// in decimetres; everything below is in metres. "Points" of the package are all points of its mesh
// file: the skin first (#skin = 13,380), then helper geometry and the small cubes that mark the
// rigs' joints. Targets move all of them, so that rigs can be placed in any shape.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/shape_targets.h"
#include "anatomy/files/assets.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

using Quads = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;

// A hole that the skin is cut open at: the surface behind it dives into the mouth or an eye socket.
struct Cavity {
  std::string name;        // "mouth", "eye_l", "eye_r"
  std::vector<int> loop;   // vertices around the opening, in the winding of the faces behind it
  std::vector<int> quads;  // faces behind it
};

struct BodyPackage {
  Points points;        // #P x 3, undeformed
  int skin_size = 0;    // the first rows of `points` are the skin
  Quads quads;          // #Q x 4, the skin, counter-clockwise seen from outside
  Triangles triangles;  // #F x 3, two a quad in order (2q, 2q+1), mirror-symmetric split
  std::vector<std::pair<std::string, std::vector<int>>>
      groups;  // helper groups ("joint-l-knee") and their points
  std::vector<Cavity> cavities;
  std::vector<int> mirror;  // #P: index of the point on the other side; itself on the mid-plane
  std::shared_ptr<const ShapeTargets> targets;
  PackageReader reader;
  std::filesystem::path tables;  // Assets::tables: our tables about it lie in its folder body
};

// Throws InputError when the package is missing, altered, or not what is expected: 13,380 skin
// vertices in 13,378 quads.
BodyPackage read_body_package(const Assets& assets);
BodyPackage read_body_package(const PackageReader& reader, const std::filesystem::path& tables);

// The skin of a shape: the first rows of `points`, which has at least #skin rows, and the package's
// triangles.
TriMesh skin_mesh(const BodyPackage& package, const Points& points);

// The skin with mouth and eye cavities removed and the openings closed by fans: closed, one
// component. For inside tests. The skin's vertices keep their indices (those of the cavities are
// left unused); one vertex a cavity follows them. Precondition: V has at least #skin rows; further
// rows are ignored.
TriMesh capped_skin(const BodyPackage& package, const Points& V);

// Centres of the joint cubes, named as in the package ("joint-l-knee"). Several are not where the
// anatomical joint is. Precondition: points has all #P rows.
std::vector<Landmark> joint_cubes(const BodyPackage& package, const Points& points);

}  // namespace ecorche::inline v1
