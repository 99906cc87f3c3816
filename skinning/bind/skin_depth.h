// The components of the anatomy beneath each vertex of a skin at rest. Private to the library.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/queries/nearest_surface.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

struct SkinDepth {
  std::vector<Anchor> anchors;  // #V nearest component, exact
  std::vector<Anchor> muscles;  // #V nearest muscle, exact; kind none without muscles
  // #V joint of the nearest bone, if a straight line inside the body leads to it; else -1
  std::vector<int> joint;
  std::vector<double> depth;   // #V to that bone, m
  std::vector<double> radius;  // #V half the thickness of the body beneath, smoothed, m
  std::vector<Vec3> normal;    // #V rest
};

// Bones as one mesh, and the strips as one mesh of tubes; with the part of each triangle.
struct PartMesh {
  TriMesh mesh;
  std::vector<int> part;  // #F: bone index, or flat index of the slice where the triangle begins
};
PartMesh bone_mesh(const Anatomy& anatomy);
PartMesh muscle_mesh(const Anatomy& anatomy, const PosedAnatomy& rest, int sides = 12);

// Bones and muscles at rest, ready to be searched.
struct AnatomySurfaces {
  // Precondition: at least one bone with triangles.
  AnatomySurfaces(const Anatomy& anatomy, const PosedAnatomy& rest);

  PartMesh bones, muscles;
  std::vector<int> bone_joint;  // #bones
  std::unique_ptr<NearestSurface> bone_surface;
  std::unique_ptr<NearestSurface> muscle_surface;  // null without muscles
};

SkinDepth measure_skin_depth(const AnatomySurfaces& surfaces, const TriMesh& skin);

// The nearest components alone, exact. #V
std::vector<Anchor> find_anchors(const AnatomySurfaces& surfaces, const TriMesh& skin);

}  // namespace ecorche::inline v1
