// A stranger's character (.glb) as its file has it: meshes where they stand, joints, weights.
//
// Positions are those that a viewer shows when the file is opened and no animation plays, in the
// file's units and axes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/mesh_files/part_kind.h"
#include "skinning/binding.h"
#include "skinning/retarget/joint_names.h"

namespace ecorche::inline v1 {

// One primitive of one mesh node.
struct SourcePiece {
  std::string name;                               // of the node, or of the mesh
  std::string material;                           // its name
  PartKind kind = PartKind::body;                 // by its names and how it hangs on the rig
  std::size_t node = 0, mesh = 0, primitive = 0;  // in the file
  int first_vertex = 0, vertex_count = 0;
  int first_triangle = 0, triangle_count = 0;  // none for points and lines
  int skin = -1;                               // of the file
  int joint = -1;  // without a skin: the joint of the rig under which it hangs
  // Whether all its vertices are placed by one map of the file's positions, `place`; otherwise its
  // joints bend it as it stands.
  bool is_straight = true;
  Affine place = Affine::Identity();
};

struct SourceJoint {
  std::string name;
  std::size_t node = 0;
  int parent = -1;                   // the nearest joint above it; parents precede children
  Affine X_W = Affine::Identity();   // as it stands
  Affine bind = Affine::Identity();  // the inverse of its first inverse bind matrix
};

struct SourceRig {
  TriMesh mesh;  // of all pieces
  std::vector<SourcePiece> pieces;
  std::vector<SourceJoint> joints;              // of all skins
  std::vector<std::vector<Influence>> weights;  // #V, by `joints`; empty: the piece has no skin
  std::vector<std::string> takes;               // animations by name
  std::size_t node_count = 0;
  std::vector<int> piece_of;  // #V
  // #V: of its piece; body where an island that is called eyes, mouth or hair lies elsewhere
  std::vector<PartKind> kinds;
};

// `name` is what messages call it. Throws InputError for a damaged file, UnfitError for one without
// a mesh in its scene, LimitError.
SourceRig read_source_rig(std::string_view glb, const std::string& name);

// Pieces of eyes, teeth, headgear and props move as one: number of the piece for each of their
// vertices, -1 for others. #V
std::vector<int> rigid_pieces(const SourceRig& rig);

// What is body, as far as kinds tell it; else all that does not move as one.
TriMesh body_mesh(const SourceRig& rig);

// The part that each joint moves, as joint_names.h calls it, besides
//   "trunk", "neck"  what joins the pelvis to head and shoulders
// Helpers below a joint of a limb or the head (twist bones, ends, what is held) are of its part;
// "": names do not tell. #joints
std::vector<NamedPart> joint_parts(const SourceRig& rig);

// Joint places as the mesh stands, by our joints' names (data/joints.csv), of joints that names
// tell. Empty without a rig.
std::vector<Landmark> joint_hints(const SourceRig& rig);

}  // namespace ecorche::inline v1
