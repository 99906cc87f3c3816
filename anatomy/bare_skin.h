// A skin from elsewhere in the base mesh's topology and vertex order: a shape of it that somebody saved, in whatever units and axes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/body_package.h"
#include "anatomy/mesh_io.h"

namespace ecorche {

struct BareSkin {
  Body body;         // metres, +Y up, facing +Z, soles on y = 0, mid-plane at x = 0; sex, age and mass are not known
  Points points;     // #skin x 3, or #P x 3 when the file had the helper geometry too; in the same frame
  double unit = 1;   // metres in one unit of the file
  std::string up;    // axis of the file that points up: "+Y", "-Z", ... ; "oblique" when none does to 15 degrees
  std::string front; // axis of the file that the face looks along
  bool mirrored = false;  // the file's axes were left-handed
  std::vector<std::string> notes;  // everything that was found out or changed, for people
};

// The file may hold other meshes beside the skin, and more vertices after it (eyes, clothes, helper geometry).
// Throws as read_mesh_file does, and UnfitError that names the counts: another number of vertices, another order (fewer than 99 % of
// the base mesh's edges), no unit of m, dm, cm or mm that gives a human height, limbs away from the base pose.
BareSkin read_bare_skin(const std::filesystem::path& file, const BodyPackage& package);
BareSkin bare_skin(const MeshFile& file, const std::string& name, const BodyPackage& package);

}  // namespace ecorche
