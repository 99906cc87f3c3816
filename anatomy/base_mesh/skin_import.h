// A skin from elsewhere in the base mesh's topology and vertex order: a shape of it that somebody
// saved, in whatever units and axes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/mesh_files/mesh_io.h"

namespace ecorche::inline v1 {

struct BareSkin {
  // metres, +Y up, facing +Z, soles on y = 0, mid-plane at x = 0; sex, age and mass are not known
  Body body;
  Points
      points;  // #skin x 3, or #P x 3 when the file had the helper geometry too; in the same frame
  double unit = 1;  // metres in one unit of the file
  // axis of the file that points up: "+Y", "-Z", ... ; "oblique" when none does to 15 degrees
  std::string up;
  std::string front;               // axis of the file that the face looks along
  bool mirrored = false;           // the file's axes were left-handed
  std::vector<std::string> notes;  // everything that was found out or changed, for people
};

// Metres in a unit by its short name (m, dm, cm, mm, in, ft); nothing for another name.
std::optional<double> metres_in(const std::string& unit);

// Whether one of the meshes has the base mesh's vertices and, to 99 %, its edges, split along the
// seams of a texture or not: what read_bare_skin takes.
bool has_base_skin(const MeshFile& file, const BodyPackage& package);

// The file may hold other meshes beside the skin, and more vertices after it (eyes, clothes, helper
// geometry); a skin may be split along the seams of its texture. `unit`: metres in one unit of the
// file; found out when left out. Throws as read_mesh_file does, and UnfitError that names the
// counts: another number of vertices, another order (fewer than 99 % of the base mesh's edges), a
// second skin after the first, a height that is not human in the given unit or in m, dm, cm and mm,
// or one that is a child's in centimetres and an adult's in inches; limbs away from the base pose;
// a crumpled surface.
BareSkin read_bare_skin(const std::filesystem::path& file, const BodyPackage& package,
                        std::optional<double> unit = {});
BareSkin bare_skin(const MeshFile& file, const std::string& name, const BodyPackage& package,
                   std::optional<double> unit = {});

}  // namespace ecorche::inline v1
