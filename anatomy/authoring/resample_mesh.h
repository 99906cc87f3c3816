// A muscle given as a triangle mesh, resampled into elliptic slices along an action line, and
// lofted back.
//
// The action line is a Bezier curve through origin and insertion with n free controls, laid through
// the middles of cross-sections. Rays in the plane of each slice find the mesh; an ellipse is
// fitted to where they meet it (direct least squares) and gets an outline (anatomy.h) that follows
// the section, and its area; where the mesh is closed all radii are then scaled alike, by at most 5
// %, so that the loft holds its volume. Units are those of the mesh: pass metres.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/geometry/bezier.h"
#include "anatomy/geometry/mesh_sections.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct ResampleOptions {
  int control_points = 3;  // of the action line, between origin and insertion: 0 .. 12
  int slices = 32;         // 3 .. 200
  int rays = 48;           // per slice: 8 .. 1000
  int ring = 32;           // vertices of a slice in the loft: 8 .. 200
};

struct ResampleReport {
  double length = 0;  // of the action line, m
  // signed sum over the mesh's triangles, m^3; only exact where the mesh is closed
  double mesh_volume = 0;
  double loft_volume = 0;  // m^3
  double scale = 1;        // of all radii, to hold the volume of a closed mesh
  bool mesh_closed = false;
  SurfaceDistance loft_to_mesh;  // m
  SurfaceDistance mesh_to_loft;  // m
  int rays = 0;
  int missed_rays = 0;   // met no triangle of their section
  int empty_slices = 0;  // planes that met nothing; interpolated from their neighbours
  // share of all outlines' length that belongs to branches beside the one followed
  double forked = 0;
  // share of the rays' length behind bays of the outlines: what no outline about one point can hold
  double hidden = 0;
  double mean_distance() const { return 0.5 * (loft_to_mesh.mean + mesh_to_loft.mean); }
  double volume_error() const { return loft_volume / mesh_volume - 1; }
};

struct Resampled {
  Bezier line;
  std::vector<double> parameters;  // of the slices on the line
  std::vector<Ellipse> slices;     // world
  TriMesh loft;                    // closed, outward; the ends are origin and insertion
  ResampleReport report;
};

// Throws UnfitError when origin and insertion coincide or lie further from the mesh than a tenth of
// its size, or when more than half of the slices meet nothing; std::invalid_argument for options
// outside their ranges.
Resampled resample_muscle(const TriMesh& mesh, const Vec3& origin, const Vec3& insertion,
                          const ResampleOptions& options = {});

// As a strip of an anatomy, carried by one joint at each end: the path runs along the action line,
// slices keep their ellipses.
Strip make_strip(const Resampled& resampled, int origin_joint, int insertion_joint);

}  // namespace ecorche::inline v1
