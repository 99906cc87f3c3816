// A file's meshes or points made ready for registration: what is a person's surface, in metres,
// with normals outwards.
//
// Parts are told apart by their names and materials; the unit by what the file says and by what
// makes a person of human size; 10 million faces are thinned to cells of 3 mm; floors, walls,
// islands, noise and insides go. What was found, taken away or assumed is said in Scan::notes.
#pragma once

#include <optional>
#include <string>

#include "anatomy/mesh_files/mesh_file.h"
#include "morph/registration/scan.h"
#include "morph/registration/scan_points.h"

namespace ecorche::inline v1 {

struct CleanScanOptions {
  std::optional<double> unit;     // metres in a unit of the file
  std::optional<double> stature;  // m, of the person: gives the unit where `unit` does not
  std::string name = "the scan";  // what messages call it
};

// Some 1 s at 100,000 faces, 3 s at 10 million (two cores), 400,000 points at most. Same file,
// same result. Throws UnfitError with the reason for what cannot be a person by plain sight: no
// points, fewer than 300 of them where there are no faces, no extent, a single plane, nothing left.
Scan clean_scan(const MeshFile& file, const CleanScanOptions& options = {});

}  // namespace ecorche::inline v1
