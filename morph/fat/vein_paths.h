// Superficial veins on the skin of any body.
//
// data/veins.csv gives each vein by sites like those of data/fat.csv, in order, from the periphery
// to where it dives: a place on the line between two joints, and the way out from there. Between
// sites places and ways go on smooth curves (Catmull and Rom), and the skin is met from inside at
// each.
#pragma once

#include <filesystem>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"
#include "anatomy/vein_path.h"

namespace ecorche::inline v1 {

// `tables`: Assets::tables; `skin` and `skeleton` at rest. Veins of both sides. Throws InputError
// that names file, line and value for a table that cannot be read, unknown joints, a vein of one
// site and a ridge that is not above 0.
std::vector<VeinPath> vein_paths(const std::filesystem::path& tables, const Skeleton& skeleton,
                                 const TriMesh& skin);

}  // namespace ecorche::inline v1
