// Meshes of muscles as they come: which of them are single clean shells, and how well those survive
// resampling.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

struct CappedMesh {
  TriMesh mesh;            // each loop of open edges closed by a fan about its middle
  double cap_share = 0;    // area of the fans over that of the mesh
  double piece_share = 0;  // area of the largest piece over that of all
};
CappedMesh capped(const TriMesh& mesh);

struct ShellMuscle {
  std::string name;
  TriMesh mesh;  // m
};

// Prints and writes (unless `csv` is empty) a row each. A clean shell is one piece (99 % of the
// area), closed but for 3 % of its area and not forked: 95 % of the outlines across its line belong
// to the branch that is followed. All others are flagged with the reason. True if every clean
// shell, and there are a hundred at least, comes back within 1.5 mm on average and 2 % of its
// volume.
bool resample_shells(const std::vector<ShellMuscle>& muscles, const std::filesystem::path& csv);

}  // namespace ecorche
