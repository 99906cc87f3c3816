#include "morph/placement/scale_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

// The group of the first bone on a joint, or on the nearest joint above that has one; -1: none.
std::vector<int> group_of_joints(const FitRules& rules, const Anatomy& source) {
  std::vector<int> out(source.skeleton.joints.size(), -1);
  for (const Bone& bone : source.bones) {
    int& group = out[std::size_t(bone.joint)];
    const auto found = rules.group_of_bone.find(split_side(bone.name).first);
    if (group < 0 && found != rules.group_of_bone.end()) group = found->second;
  }
  for (std::size_t j = 0; j < out.size(); ++j)
    if (const int parent = source.skeleton.joints[j].parent; out[j] < 0 && parent >= 0)
      out[j] = out[std::size_t(parent)];
  return out;
}

// How far what begins at each group goes along with what it hangs on: of one side, left-hand
// coordinates.
void follow_groups(const FitRules& rules, const Anatomy& source, const std::vector<BoneMap>& before,
                   std::vector<BoneMap>& maps) {
  const std::vector<int> group_of = group_of_joints(rules, source);
  const std::vector<Vec3> rest = rest_positions(source.skeleton);
  std::vector<Vec3> shift(maps.size(), Vec3::Zero());
  std::vector<bool> known(maps.size(), false);
  const auto carry = [&](int group, int joint) {
    if (group < 0 || known[std::size_t(group)]) return;
    known[std::size_t(group)] = true;
    const int parent = source.skeleton.joints[std::size_t(joint)].parent;
    const int above = parent < 0 ? -1 : group_of[std::size_t(parent)];
    if (above < 0 || above == group) return;
    const std::size_t a = std::size_t(above);
    const Vec3& centre = rest[std::size_t(joint)];
    shift[std::size_t(group)] = shift[a] + maps[a](centre) - before[a](centre);
  };
  for (std::size_t j = 0; j < rest.size(); ++j) {
    if (split_side(source.skeleton.joints[j].name).second == Side::right) continue;
    carry(group_of[j], int(j));
    for (const Bone& bone : source.bones)
      if (bone.joint == int(j))
        if (const auto found = rules.group_of_bone.find(split_side(bone.name).first);
            found != rules.group_of_bone.end())
          carry(found->second, int(j));
  }
  for (std::size_t g = 0; g < maps.size(); ++g) maps[g].target_origin += shift[g];
}

}  // namespace

const std::array<GroupMeasure, kGroupMeasures>& group_measures() {
  static const std::array<GroupMeasure, kGroupMeasures> all{{
      {"length", BoneMap::log_length, true, "from the near to the far end"},
      {"width", BoneMap::log_width_x, true, "from side to side"},
      {"depth", BoneMap::log_width_z, true, "from front to back"},
      {"taper", BoneMap::taper_x, true, "the far end's width over the near one's"},
      {"taper_depth", BoneMap::taper_z, true, "the same of the depth"},
      {"flare", BoneMap::flare_x, true, "the width at both ends over that in the middle"},
      {"flare_depth", BoneMap::flare_z, true, "the same of the depth"},
      {"bow", BoneMap::bow_x, false, "how far the middle bends outwards"},
      {"bow_depth", BoneMap::bow_z, false, "how far the middle bends to the front"},
      {"slide", BoneMap::shear_z, false, "how far the far end lies before the near one"},
      {"tuck", BoneMap::tuck_z, false, "how far the near end's front is drawn in"},
  }};
  return all;
}

std::array<double, kGroupMeasures> GroupScale::unchanged() {
  std::array<double, kGroupMeasures> out{};
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = group_measures()[k].factor ? 1 : 0;
  return out;
}

void scale_groups(const std::vector<GroupScale>& scales, const FitRules& rules,
                  const Anatomy& source, SidedPlacement& placement) {
  if (scales.empty()) return;
  const std::vector<BoneMap> left = placement.left.maps, right = placement.right.maps;
  for (const GroupScale& scale : scales) {
    const auto rule = std::ranges::find(rules.groups, scale.group, &GroupRule::name);
    if (rule == rules.groups.end())
      throw UnfitError(fmt::format("there is no group of bones '{}'", scale.group));
    for (Placement* side : {&placement.left, &placement.right}) {
      BoneMap& map = side->maps[std::size_t(rule - rules.groups.begin())];
      for (std::size_t k = 0; k < scale.values.size(); ++k) {
        const GroupMeasure& measure = group_measures()[k];
        map.shape[measure.way] += measure.factor ? std::log(scale.values[k]) : scale.values[k];
      }
    }
  }
  follow_groups(rules, source, left, placement.left.maps);
  follow_groups(rules, source, right, placement.right.maps);
}

}  // namespace ecorche::inline v1
