// One layer of a character as a single mesh with a group a part, posed frame by frame: the content
// of vertex caches of a layer and of the OBJ file they belong to.
//
// Vertex order, the same in the OBJ file, in every frame and in the cache: the skin's own vertices;
// the bones', bone after bone as in the anatomy; the muscles', muscle after muscle as in the
// anatomy, each as make_muscle_surface() lofts it, and behind them in the same layer the points of
// fascia, sheet after sheet.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "anatomy/base_mesh/tissue_look.h"
#include "anatomy/bones/cartilage.h"
#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/muscles/muscle_surface.h"
#include "skinning/files/character_look.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

// Points around a muscle's section in files: half of those in pictures.
inline constexpr int kLoftPoints = 12;

struct MeshGroup {
  std::string name;  // "skin", "bone/femur_l", "muscle/soleus_l", "fascia/linea_alba"
  TissueLook look;
  Triangles F;  // over the layer's vertices; the group of a muscle of two tissues comes twice
};

// Posing needs the anatomy and the skin that it was made from.
struct LayerMesh {
  enum class Kind { skin, bones, muscles };
  Kind kind = Kind::skin;
  PointsF rest;  // #V x 3, world
  std::vector<MeshGroup> groups;
  SkinTexture texture;           // of the skin, where it is known
  MuscleSurface surface;         // of the muscles
  FasciaSurface fascia;          // in the same layer
  std::vector<int> joint;        // #V of the bones
  std::vector<Vec3> joint_rest;  // #joints, of the bones
};

LayerMesh skin_layer(const TriMesh& skin, const SkinTexture& texture);
LayerMesh bone_layer(const Anatomy& anatomy, const std::vector<CartilageRule>& rules);
LayerMesh muscle_layer(const Anatomy& anatomy);

// Positions of a frame. `out` is resized once and then reused. Precondition: `posed` and `skin` are
// of the layer's character.
void pose_layer(const LayerMesh& layer, const PosedAnatomy& posed, const SkinFrame& skin,
                PointsF& out);

// The material library that layer_faces() refers to: colours in proportion to light.
std::string layer_materials(std::span<const LayerMesh> layers);

// OBJ lines of texture coordinates, groups and faces; of several layers one after the other, with
// their vertices numbered consecutively.
std::string layer_faces(std::span<const LayerMesh> layers);

// OBJ lines of vertices; positions survive exactly.
void append_vertices(std::span<const float> positions, int stride, std::string& out);

}  // namespace ecorche::inline v1
