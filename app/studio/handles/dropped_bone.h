// A mesh that was dropped into the window, until it hangs on a joint as a bone.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "anatomy/mesh_files/mesh_file.h"
#include "anatomy/types.h"

namespace ecorche {

struct BoneUnit {
  const char* name;
  double metres;
};
inline constexpr BoneUnit kBoneUnits[] = {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", 0.0254}};

struct DroppedBone {
  std::filesystem::path file;
  std::string name;                              // of the bone, small letters, digits and _
  std::string unit;                              // "m", "cm", "mm" or "in"
  Vec3 size = Vec3::Zero(), low = Vec3::Zero();  // of its box, in the file's unit, +Y up
  bool centred = false;                          // its middle comes to the joint's centre
};

// A bone of a mesh: named after its file, by a name that is not taken, in the unit that the file
// says, or else in the first of m, cm and mm that makes it no larger than a thigh bone, with its
// middle at the joint where the file's origin lies far off. Throws UnfitError without vertices.
DroppedBone dropped_bone(const std::filesystem::path& file, const MeshFile& mesh,
                         std::span<const std::string> taken);

// The line of a script that hangs it on a joint.
std::string line_of(const DroppedBone& bone, const std::string& joint);

// As large as it is where the file has this unit.
Vec3 millimetres(const DroppedBone& bone, const std::string& unit);

}  // namespace ecorche
