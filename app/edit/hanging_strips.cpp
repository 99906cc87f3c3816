#include "app/edit/hanging_strips.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "anatomy/errors.h"
#include "app/edit/document/edit_muscle.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

bool is_on(const MuscleTable& frame, int landmark, const std::set<std::string>& bones) {
  return bones.contains(frame.landmarks[std::size_t(landmark)].carrier);
}

bool rides_on(const MuscleTable& frame, const TableStrip::WrapUse& use,
              const std::set<std::string>& bones) {
  return is_on(frame, frame.wraps[std::size_t(use.wrap)].landmark, bones);
}

bool lies_on(const MuscleTable& frame, const TableStrip& strip, const std::set<std::string>& bones,
             bool with_wraps) {
  return std::ranges::any_of(
             strip.path, [&](const auto& point) { return is_on(frame, point.landmark, bones); }) ||
         (with_wraps && std::ranges::any_of(strip.wraps, [&](const auto& use) {
            return rides_on(frame, use, bones);
          }));
}

}  // namespace

std::set<std::string> bones_of(Workshop& workshop, const std::vector<std::string>& joints) {
  std::set<std::string> out;
  const Anatomy& source = workshop.source();
  for (const Bone& bone : source.bones) {
    const std::string& joint = source.skeleton.joints[std::size_t(bone.joint)].name;
    if (std::ranges::find(joints, split_side(joint).first) != joints.end())
      out.insert(split_side(bone.name).first);
  }
  return out;
}

std::string HangingStrips::words() const {
  constexpr std::size_t kFew = 6;
  std::vector<std::string> few = muscles;
  if (few.size() > kFew) few.resize(kFew);
  return fmt::format("{}{}", fmt::join(few, ", "), muscles.size() > few.size() ? ", ..." : "");
}

HangingStrips hanging_on(const Document& document, const std::set<std::string>& bones, Side side) {
  HangingStrips out;
  for (const auto& muscle : document.muscles) {
    const auto hangs = [&](const TableMuscle& one) {
      return std::ranges::any_of(one.strips, [&](const TableStrip& strip) {
        return lies_on(*document.frame, strip, bones, true);
      });
    };
    const bool left = side != Side::right && hangs(muscle->left);
    const bool right = side != Side::left && hangs(muscle->right.value_or(muscle->left));
    if (left || right) out.muscles.push_back(muscle->left.name);
  }
  return out;
}

Document without_strips_on(Document document, const std::set<std::string>& bones, Side side) {
  for (const std::string& name : hanging_on(document, bones, side).muscles) {
    const int entry = find_entry(document, name);
    const EditedMuscle& muscle = *document.muscles[std::size_t(entry)];
    const auto stays = [&](const TableMuscle& one) {
      return std::ranges::any_of(one.strips, [&](const TableStrip& strip) {
        return !lies_on(*document.frame, strip, bones, false);
      });
    };
    const bool left = side == Side::right || stays(muscle.left);
    const bool right = side == Side::left || stays(muscle.right.value_or(muscle.left));
    if (!left && !right) {
      document.muscles.erase(document.muscles.begin() + entry);
      if (document.picked == name) document.picked.clear();
      continue;
    }
    if (!left || !right)
      throw InputError(
          fmt::format("argument 'joint': muscle '{}' would be left on one side alone; "
                      "take the joint away on both sides, or move the muscle's ends",
                      name));
    document = with_change(document, {entry, side}, [&](TableMuscle& one) {
      std::erase_if(one.strips, [&](const TableStrip& strip) {
        return lies_on(*document.frame, strip, bones, false);
      });
      for (TableStrip& strip : one.strips)
        std::erase_if(strip.wraps,
                      [&](const auto& use) { return rides_on(*document.frame, use, bones); });
    });
  }
  return document;
}

}  // namespace ecorche
