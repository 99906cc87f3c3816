#include "app/studio/handles/dropped_bone.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/edit/document/arguments.h"

namespace ecorche {
namespace {

constexpr double kThighBone = 0.6;  // m, and more than any is long
constexpr double kFarOff = 1;       // of its size, from the file's origin to its box

double metres_of(std::string_view unit) {
  for (const BoneUnit& each : kBoneUnits)
    if (unit == each.name) return each.metres;
  return 1;
}

std::string bone_name(const std::filesystem::path& file, std::span<const std::string> taken) {
  std::string base;
  for (const char c : file.stem().string()) {
    const auto letter = static_cast<unsigned char>(c);
    base += std::isalnum(letter) && letter < 128 ? char(std::tolower(letter)) : '_';
  }
  if (base.find_first_not_of('_') == std::string::npos) base = "bone";
  std::string out = base;
  for (int k = 2; std::ranges::find(taken, out) != taken.end(); ++k)
    out = fmt::format("{}_{}", base, k);
  return out;
}

// As far as its box lies from the origin.
double distance_of(const DroppedBone& bone) {
  const Vec3 high = bone.low + bone.size;
  return Vec3::Zero().cwiseMax(bone.low).cwiseMin(high).norm();
}

}  // namespace

DroppedBone dropped_bone(const std::filesystem::path& file, const MeshFile& mesh,
                         std::span<const std::string> taken) {
  const Points V = all_parts(mesh).V;
  if (V.rows() == 0) throw UnfitError(fmt::format("{}: it has no vertices", file.string()));
  Vec3 low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
  if (mesh.up && mesh.up->z() > 0.5) {
    low = Vec3(low.x(), low.z(), -high.y());
    high = Vec3(high.x(), V.col(2).maxCoeff(), -V.col(1).minCoeff());
  }
  DroppedBone out{file, bone_name(file, taken), "mm", high - low, low};
  const double most = out.size.maxCoeff();
  for (const char* unit : {"mm", "cm", "m"})
    if (most * metres_of(unit) <= kThighBone) out.unit = unit;
  if (mesh.unit)
    for (const BoneUnit& unit : kBoneUnits)
      if (std::abs(*mesh.unit / unit.metres - 1) < 1e-6) out.unit = unit.name;
  out.centred = distance_of(out) > kFarOff * out.size.norm();
  return out;
}

Vec3 millimetres(const DroppedBone& bone, const std::string& unit) {
  return 1e3 * metres_of(unit) * bone.size;
}

std::string line_of(const DroppedBone& bone, const std::string& joint) {
  std::string out = fmt::format("add_bone {} {} file={} unit={}", quoted(bone.name), joint,
                                quoted(bone.file.string()), bone.unit);
  if (!bone.centred) return out;
  const Vec3 at = -1e3 * metres_of(bone.unit) * (bone.low + 0.5 * bone.size);
  return out + fmt::format(" at={:.1f},{:.1f},{:.1f}", at.x(), at.y(), at.z());
}

}  // namespace ecorche
