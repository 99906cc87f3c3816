// Forces that plates have measured, for the frames of a motion.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/dynamics/inverse_dynamics.h"

namespace ecorche {

// How a motion lies to its file: plates are in the file's clock and places.
struct PlateFrame {
  double start = 0;              // s, of the motion's first frame by the file's clock
  double scale = 1;              // places of the file -> ours
  Mat3 turn = Mat3::Identity();  // axes of the file -> ours
  double floor = 0;              // m, ours
};

// Reads OpenSim's table of ground forces (.mot, .sto; columns NAME_vx .. _vz, NAME_px .. _pz, and
// torques where it has them; N, m, N m, y up) and gives each contact to the foot that is nearest to
// its centre of pressure. Throws InputError as parse_coordinates; UnfitError for a table without
// such columns, or of another time than the motion's.
std::vector<std::array<FootForce, 2>> open_plates(const std::filesystem::path& file,
                                                  const Skeleton& skeleton, const Motion& motion,
                                                  const PlateFrame& frame);

}  // namespace ecorche
