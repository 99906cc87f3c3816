// Meshes of muscles as they come: which of them are single clean shells, and how well those survive resampling.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

struct CappedMesh {
  TriMesh mesh;          // each loop of open edges closed by a fan about its middle
  double cap_share = 0;  // area of the fans over that of the mesh
  double piece_share = 0;  // area of the largest piece over that of all
};
CappedMesh capped(const TriMesh& mesh);

struct ShellMuscle {
  std::string name;
  TriMesh mesh;     // m
  int strips = 1;   // of the template's muscle that stands for it: more than one where one belly does not make it
};

// Resamples all meshes, prints and writes (unless `csv` is empty) a row each: what is no single clean shell of one belly is flagged with
// the reason. True if four in five of the others come back within 1.5 mm and 2 % of their volume.
bool resample_shells(const std::vector<ShellMuscle>& muscles, const std::filesystem::path& csv);

}  // namespace ecorche
