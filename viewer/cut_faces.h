// The faces that a plane leaves of what it cuts: fat under the skin, rooms of organs, muscles,
// sheets, bones with compact bone around their marrow.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "viewer/draw_list.h"

namespace ecorche {

// Faces of all items of the list with a colour of their own tissue, later ones over earlier: fat
// where there is skin, rooms of organs in that (posed_room()), muscles in their colours, sheets as
// thin lines, bones, the room of the skull, the skin as a rim. plane: n . x = w. Meshes need not be
// closed; what they go around is filled.
//
// Bones are marrow and spongy bone within a shell: 1 mm, and thicker on the shafts of long ones, by
// 0.45 of the shaft's radius, which is where healthy bones begin (Barnett and Nordin 1960).
DrawMesh cut_faces(const Vec4f& plane, const DrawList& list, std::span<const DrawMesh> rooms = {});

// Where a face of a part lies in a cut, for its name: the middle of its area.
struct FacePlace {
  std::uint32_t part = 0;
  Vec3f middle = Vec3f::Zero();
  float area = 0;  // m^2
};
// Of the rooms of organs.
std::vector<FacePlace> room_places(const DrawMesh& faces);

// Cuts what is in the list, and lays the faces over it.
void add_cut(const Vec4f& plane, DrawMesh faces, DrawList& list);

}  // namespace ecorche
