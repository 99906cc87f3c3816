// Muscles as triangle meshes: tubes with round caps, sheets as one surface over their strips.
//
// Topology and coefficients are made once; a frame only evaluates them. Muscles are separate closed
// meshes in one buffer.
#pragma once

#include <span>
#include <vector>

#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

using PointsF = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;  // #V x 3

struct MuscleSurfaceOptions {
  int points_per_slice = 16;  // 8 .. 64, even
  bool loft_sheets = true;    // Muscle::sheet drawn as one surface; otherwise strip by strip
  int rows_between = 0;       // of vertices, on Catmull-Rom curves through neighbouring slices
};

struct MuscleSurface {
  // A vertex is a weighted sum of terms: weight * (center + f (u a width + v b thickness) + w
  // min(a, b) tangent) of one slice, f its outline's factor at `place` (slice_outline.h).
  struct Term {
    int slice = 0;
    float weight = 1, u = 0, v = 0, w = 0, place = 0;
  };
  struct Part {
    int muscle = 0;
    int vertex_begin = 0, vertex_end = 0;
    int face_begin = 0, face_end = 0;
    bool sheet = false;
    // of its sections as they are drawn; a sheet's differ so that it keeps its strips' volume
    float thickness = 1;
  };
  Triangles F;                  // #F x 3, outward
  std::vector<int> term_begin;  // #V + 1
  std::vector<Term> terms;
  std::vector<int> muscle;   // #V
  std::vector<int> slice;    // #V, the slice a vertex belongs to first
  std::vector<float> angle;  // #V, eccentric angle about that slice, rad, 0 at +width
  std::vector<float> belly;  // #V, 1 on the belly, 0 on tendon, smooth between (for colour)
  std::vector<float> along;  // #V, s of its slice (for fibre stripes)
  std::vector<Part> parts;   // one a muscle, in the anatomy's order
  int vertices() const { return int(muscle.size()); }
};

// Precondition: a valid anatomy whose strips have two slices or more.
MuscleSurface make_muscle_surface(const Anatomy& anatomy, const MuscleSurfaceOptions& options = {});

// Positions, and outward unit normals if `normals` is not null. `out` is resized once and then
// reused.
void update_muscle_surface(const MuscleSurface& surface, const PosedAnatomy& posed,
                           PointsF& positions, PointsF* normals = nullptr);
void update_muscle_surface(const MuscleSurface& surface, const PosedAnatomy& posed,
                           Points& positions);
// From slices alone, for example rest_slices(anatomy).
void update_muscle_surface(const MuscleSurface& surface, std::span<const Ellipse> slices,
                           Points& positions);

// Unit normals of the vertices, by the areas of their triangles; zero where there is none.
void find_normals(const Triangles& F, const PointsF& positions, PointsF& normals);

// Volume enclosed by one part, by the divergence theorem, m^3.
double part_volume(const MuscleSurface& surface, const MuscleSurface::Part& part,
                   const Points& positions);

// One muscle as a mesh of its own (export, containment tests).
TriMesh part_mesh(const MuscleSurface& surface, const MuscleSurface::Part& part,
                  const Points& positions);

}  // namespace ecorche::inline v1
