#include "anatomy/authoring/path_carriers.h"

#include <fmt/format.h>

#include <algorithm>

#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"

namespace ecorche::inline v1 {

PathPoint PathCarriers::carry(const std::string& carrier, const Vec3& rest,
                              const std::string& where) const {
  PathPoint point;
  point.rest = side_ == Side::right ? mirror_point(rest) : rest;
  for (const JointBlend& soft : table_.carriers) {
    if (soft.name != carrier) continue;
    point.joints = {joint(soft.joints[0], soft.where), joint(soft.joints[1], soft.where)};
    point.share = soft.high > 0
                      ? std::clamp((rest.y() - soft.low) / (soft.high - soft.low), 0.0, 1.0)
                      : soft.share;
    if (point.share >= 1) point.joints[1] = -1;
    if (point.share <= 0) point = PathPoint{point.rest, {point.joints[1], -1}, 1};
    return point;
  }
  const int bone = find_bone(source_, bone_name(carrier));
  if (bone < 0)
    throw InputError(fmt::format("{}: no bone or carrier '{}' in the skeleton", where, carrier));
  point.joints[0] = source_.bones[bone].joint;
  return point;
}

PathPoint PathCarriers::carry(const TablePoint& point) const {
  const SourceLandmark& landmark = table_.landmarks[point.landmark];
  const Vec3 place = position(table_, point);
  PathPoint out = carry(landmark.carrier, place, landmark.where);
  if (point.glides.empty()) return out;
  const int placing_joint = out.joints[0];
  out = carry(point.glides, place, landmark.where);
  out.placing_joint = placing_joint;
  return out;
}

std::string PathCarriers::bone_name(const std::string& carrier) const {
  const std::string sided = carrier + side_suffix(side_);
  if (find_bone(source_, sided) >= 0) return sided;
  return find_bone(source_, carrier) >= 0 ? carrier : "";
}

int PathCarriers::joint(const std::string& name, const std::string& where) const {
  int index = find_joint(source_.skeleton, name + side_suffix(side_));
  if (index < 0) index = find_joint(source_.skeleton, name);
  if (index < 0) throw InputError(fmt::format("{}: no joint '{}' in the skeleton", where, name));
  return index;
}

}  // namespace ecorche::inline v1
