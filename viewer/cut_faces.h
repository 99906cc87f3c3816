// The faces that a plane leaves of what it cuts: fat under the skin, muscles, sheets, bones.
#pragma once

#include "viewer/draw_list.h"

namespace ecorche {

// Faces of all items of the list with a colour of their own tissue, later ones over earlier: fat
// where there is skin, muscles in their colours, sheets as thin lines, bones, the skin as a rim.
// plane: n . x = w. Meshes need not be closed; what they go around is filled.
DrawMesh cut_faces(const Vec4f& plane, const DrawList& list);

// Cuts what is in the list, and lays the faces over it.
void add_cut(const Vec4f& plane, DrawMesh faces, DrawList& list);

}  // namespace ecorche
