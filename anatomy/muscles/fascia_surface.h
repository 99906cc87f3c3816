// Sheets of fascia as triangle meshes that go with muscles and bones.
//
// Each point is carried by the sections and bones that it lies near at rest, by weights that fall
// with the distance and are smoothed along the sheet. A section carries a point rigidly, but for
// the outline: as that swells or flattens towards the point, the point goes with it.
//
// Capsules of joints are sleeves whose rows are carried by the bone at either end, in proportion;
// what that sinks into the ends of the bones is pushed out of them again, away from the middle of
// the joint, and so are bands that both bones carry over the joint (tendons over knuckles).
//
// Sheets rise where a muscle comes out through them (fascia_lift.h).
#pragma once

#include <vector>

#include "anatomy/muscles/bone_reach.h"
#include "anatomy/muscles/fascia_lift.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

struct FasciaSurface {
  // The share of a point that a section or a joint carries.
  struct Term {
    int carrier = 0;  // slice, or number of slices + joint
    float weight = 1;
    // m, in the section's frame (width, thickness, tangent) or from the joint in the world's at
    // rest
    Eigen::Vector3f at = Eigen::Vector3f::Zero();
    float place = 0;  // of the direction from the centre, in steps of the outline
    Eigen::Vector2f toward = Eigen::Vector2f::Zero();   // cos and sin of it
    Eigen::Vector2f outline = Eigen::Vector2f::Zero();  // m, the outline there at rest
    float share = 0;                                    // by which the point follows the outline
    Eigen::Vector3f out = Eigen::Vector3f::Zero();      // outwards at rest, in the same frame as at
  };
  struct Part {
    int sheet = 0;
    int vertex_begin = 0, vertex_end = 0;
    int face_begin = 0, face_end = 0;
    int rows = 0, columns = 0;
    bool sleeve = false;
    bool rises = false;        // over muscles
    std::vector<int> reaches;  // of bones that push it
    int push_begin = 0;        // of its points' clearances, point after point
  };
  Triangles F;                  // outward
  std::vector<int> term_begin;  // #V + 1
  std::vector<Term> terms;
  std::vector<float> belly;          // #V, as FasciaSheet has it
  std::vector<float> across, along;  // #V, m, of a sheet's mean rows and columns (for fibres)
  std::vector<Part> parts;           // one a sheet, in the anatomy's order
  std::vector<BoneReach> reaches;    // of bones in capsules
  // m that a point keeps over a bone's reach; negative: it lies within at rest and is not pushed
  std::vector<float> clearances;
  FasciaLift lift;
  int slices = 0;  // of all muscles
  int vertices() const { return int(belly.size()); }
};

// m from a section or bone, beyond which it carries no point.
constexpr double kFasciaReach = 0.03;

// A sleeve: the last column lies on the first. Its first row is carried by the first of its bones,
// its last row by the last.
bool is_sleeve(const FasciaSheet& sheet);

// Cells between a point of a grid, counted row after row, and the nearest edge.
int cells_from_edge(int rows, int columns, int point, bool sleeve = false);

// Adds a point with what carries it and comes over it, but for its clearances.
void append_point(const FasciaSurface& from, int point, FasciaSurface& to);

// Makes F, and the parts' faces, of their rows and columns.
void triangulate(FasciaSurface& surface);

// Precondition: a valid anatomy.
FasciaSurface make_fascia_surface(const Anatomy& anatomy);

// Positions, and outward unit normals if `normals` is not null. `out` is resized once and then
// reused.
void update_fascia_surface(const FasciaSurface& surface, const PosedAnatomy& posed,
                           PointsF& positions, PointsF* normals = nullptr);

}  // namespace ecorche::inline v1
