#include "app/edit/document/edit_muscle.h"

#include <fmt/format.h>

#include <algorithm>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/files/similar_names.h"
#include "app/edit/document/arguments.h"
#include "app/edit/document/edited_skeleton.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

std::vector<std::string> muscle_names(const Document& document) {
  std::vector<std::string> out;
  for (const auto& muscle : document.muscles) out.push_back(muscle->left.name);
  return out;
}

TableMuscle changed(const Document& document, TableMuscle muscle, const MuscleChange& change) {
  change(muscle);
  return read_block(document, muscle_text(*document.frame, muscle), muscle.name);
}

Vec3 triple(const std::string& place, const std::string& text) {
  Vec3 out = Vec3::Zero();
  try {
    ArgumentReader({text}).vector("place", out, ArgumentUnit::millimetre, Need::required, "");
  } catch (const InputError&) {
    throw InputError(fmt::format(
        "place '{}': '{}': expected left,up,front in mm, as asis+0,-6.7,-4.2", place, text));
  }
  return metres(out);
}

}  // namespace

Vec3 metres(const Vec3& millimetres) { return 1e-3 * millimetres; }

MeantMuscle meant_muscle(const Document& document, const std::string& name) {
  const std::string& given = name.empty() ? document.picked : name;
  if (given.empty())
    throw InputError("argument 'muscle' is missing, and none is picked; say muscle=NAME");
  if (const int whole = find_entry(document, given); whole >= 0) return {whole, Side::middle};
  const auto [base, side] = split_side(given);
  const int entry = find_entry(document, base);
  if (entry < 0)
    throw InputError(fmt::format("argument 'muscle': '{}': there is no such muscle{}", given,
                                 did_you_mean(base, muscle_names(document))));
  return {entry, side};
}

Document with_change(const Document& document, const MeantMuscle& meant,
                     const MuscleChange& change) {
  const EditedMuscle& before = *document.muscles[std::size_t(meant.entry)];
  auto after = std::make_shared<EditedMuscle>(before);
  if (meant.side != Side::middle && !after->right) after->right = before.left;
  if (meant.side != Side::right) after->left = changed(document, after->left, change);
  if (meant.side != Side::left && after->right)
    after->right = changed(document, *after->right, change);
  if (after->right &&
      muscle_text(*document.frame, *after->right) == muscle_text(*document.frame, after->left))
    after->right.reset();
  Document out = document;
  out.muscles[std::size_t(meant.entry)] = std::move(after);
  return out;
}

TableStrip& strip_of(TableMuscle& muscle, int strip) {
  const int count = int(muscle.strips.size());
  if (strip < 1 || strip > count)
    throw InputError(
        fmt::format("argument 'strip': '{}': {} has strips 1 .. {}", strip, muscle.name, count));
  return muscle.strips[std::size_t(strip - 1)];
}

TablePoint& point_of(TableMuscle& muscle, int strip, int point) {
  std::vector<TablePoint>& path = strip_of(muscle, strip).path;
  if (point < 1 || point > int(path.size()))
    throw InputError(fmt::format("argument 'point': '{}': strip {} of {} has points 1 .. {}", point,
                                 strip, muscle.name, path.size()));
  return path[std::size_t(point - 1)];
}

TablePoint place_on_bone(Workshop& workshop, const Document& document, const std::string& bone,
                         const Vec3& place) {
  const auto own = std::ranges::find_if(document.skeleton->bones, [&](const OwnBone& each) {
    return split_side(each.name).first == bone;
  });
  const Vec3 snapped =
      own == document.skeleton->bones.end()
          ? workshop.on_bone(bone, place)
          : NearestSurface(placed_bone(workshop, document, *own)).nearest(place).point;
  const std::vector<SourceLandmark>& all = document.frame->landmarks;
  int best = -1;
  for (int i = 0; i < int(all.size()); ++i) {
    if (all[std::size_t(i)].carrier != bone) continue;
    if (best < 0 || (all[std::size_t(i)].position - snapped).norm() <
                        (all[std::size_t(best)].position - snapped).norm())
      best = i;
  }
  if (best < 0)
    throw InputError(fmt::format(
        "bone '{}': no landmark of data/landmarks lies on it, by which a point could be said",
        bone));
  return {best, snapped - all[std::size_t(best)].position};
}

Vec3 table_place(const Vec3& source, Side side) {
  const double left = source.x() - kSourceMidPlane;
  return {side == Side::right ? -left : left, source.y(), source.z()};
}

TablePoint read_place(Workshop& workshop, const Document& document, const std::string& text) {
  if (const auto at = text.find('@'); at != std::string::npos) {
    const Vec3 place = triple(text, text.substr(at + 1)) + Vec3(kSourceMidPlane, 0, 0);
    return place_on_bone(workshop, document, text.substr(0, at), place);
  }
  const auto plus = text.find('+');
  const std::string name = text.substr(0, plus);
  const int landmark = find_landmark(*document.frame, name);
  if (landmark < 0) {
    std::vector<std::string> names;
    for (const SourceLandmark& each : document.frame->landmarks) names.push_back(each.id);
    throw InputError(
        fmt::format("place '{}': there is no landmark '{}'{}; data/landmarks lists them, and "
                    "BONE@LEFT,UP,FRONT "
                    "is a place on a bone",
                    text, name, did_you_mean(name, names)));
  }
  const Vec3 offset =
      plus == std::string::npos ? Vec3(Vec3::Zero()) : triple(text, text.substr(plus + 1));
  return {landmark, offset};
}

}  // namespace ecorche
