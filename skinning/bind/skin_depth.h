// What lies beneath each vertex of a skin at rest. Private to the room.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/queries/nearest_surface.h"
#include "skinning/bind/bind.h"

namespace ecorche {

struct SkinSurvey {
  std::vector<Anchor> anchors;  // #V nearest component, exact
  std::vector<Anchor> muscles;  // #V nearest muscle, exact; kind none without muscles
  std::vector<int>
      joint;  // #V of the nearest bone, if it can be reached without leaving the body; else -1
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

std::vector<std::vector<int>> vertex_neighbours(const TriMesh& mesh);

// The anatomy at rest, ready to be searched.
struct Surroundings {
  // Precondition: at least one bone with triangles.
  Surroundings(const Anatomy& anatomy, const PosedAnatomy& rest);

  PartMesh bones, muscles;
  std::vector<int> bone_joint;  // #bones
  std::unique_ptr<NearestSurface> bone_surface,
      muscle_surface;  // the second is null without muscles
};

SkinSurvey survey_skin(const Surroundings& inside, const TriMesh& skin);

// The nearest components alone, exact. #V
std::vector<Anchor> find_anchors(const Surroundings& inside, const TriMesh& skin);

}  // namespace ecorche
