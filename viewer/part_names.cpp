#include "viewer/part_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <sstream>

#include "anatomy/errors.h"
#include "skinning/motion/name_pattern.h"
#include "viewer/organ_rooms.h"
#include "viewer/scene.h"

namespace ecorche {
namespace {

std::uint32_t bone_part(std::size_t index) { return kFirstBonePart + std::uint32_t(index); }
std::uint32_t muscle_part(std::size_t index) { return kFirstMusclePart + std::uint32_t(index); }

std::uint32_t fascia_part(std::size_t index) { return kFirstFasciaPart + std::uint32_t(index); }

std::string spelled(std::string_view text) {
  std::string out;
  for (const char c : text)
    out += c == ' ' ? '_' : char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string_view without_side(std::string_view name) {
  return name.ends_with("_l") || name.ends_with("_r") ? name.substr(0, name.size() - 2) : name;
}

// "femur" is femur_l and femur_r, "biceps" all that begin with it, "rectus_femoris_l" itself.
bool is_called(const std::string& name, std::string_view asked) {
  const std::string_view bare = without_side(name);
  if (matches_pattern(asked, name) || matches_pattern(asked, bare)) return true;
  const std::string_view part = without_side(asked);
  const bool begins =
      bare.size() > part.size() && bare.starts_with(part) && bare[part.size()] == '_';
  return begins && (part == asked || name.ends_with(asked.substr(part.size())));
}

// Of a muscle or a sheet of fascia.
bool is_of_region(const auto& part, std::string_view asked) {
  const std::string_view region = without_side(asked);
  const bool within =
      part.group == region || (part.group.starts_with(region) && part.group[region.size()] == '_');
  return within && (region == asked || part.name.ends_with(asked.substr(region.size())));
}

const char* side_word(Side side) {
  return side == Side::left ? ", left" : side == Side::right ? ", right" : "";
}

std::vector<std::string> known_names(const Anatomy& anatomy) {
  std::vector<std::string> names{"skin",         "eyes",        "muscles",      "bones", "fascia",
                                 "subcutaneous", "superficial", "intermediate", "deep"};
  for (const Muscle& muscle : anatomy.muscles) {
    names.push_back(muscle.name);
    names.emplace_back(without_side(muscle.name));
    names.push_back(muscle.group);
  }
  for (const FasciaSheet& sheet : anatomy.fascia) {
    names.push_back(sheet.name);
    names.emplace_back(without_side(sheet.name));
  }
  for (const Bone& bone : anatomy.bones) {
    names.push_back(bone.name);
    names.emplace_back(without_side(bone.name));
  }
  return names;
}

// Letters to be changed, put in or left out (Levenshtein 1966).
std::size_t distance_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t before = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = before + (a[i] != b[j]);
      before = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string part_name(const Anatomy& anatomy, std::uint32_t number) {
  const Part part = part_of(number);
  const std::size_t index = std::max(part.index, 0);
  if (part.kind == Part::Kind::skin) return "skin";
  if (part.kind == Part::Kind::eyes) return "eyes";
  if (part.kind == Part::Kind::bone && index < anatomy.bones.size())
    return anatomy.bones[index].name;
  if (part.kind == Part::Kind::muscle && index < anatomy.muscles.size())
    return anatomy.muscles[index].name;
  if (part.kind == Part::Kind::fascia && index < anatomy.fascia.size())
    return anatomy.fascia[index].name;
  if (part.kind == Part::Kind::room && index < std::size(kOrganRooms))
    return kOrganRooms[index].name;
  return {};
}

std::string part_label(const Anatomy& anatomy, std::uint32_t number) {
  const Part part = part_of(number);
  const std::string name = part_name(anatomy, number);
  if (name.empty()) return name;
  if (part.kind == Part::Kind::muscle) {
    const Muscle& muscle = anatomy.muscles[part.index];
    return (muscle.label.empty() ? std::string(without_side(name)) : muscle.label) +
           side_word(muscle.side);
  }
  if (part.kind == Part::Kind::fascia)
    return anatomy.fascia[part.index].label + side_word(anatomy.fascia[part.index].side);
  if (part.kind == Part::Kind::room) return kOrganRooms[part.index].label;
  if (part.kind != Part::Kind::bone) return name;
  std::string label(without_side(name));
  std::replace(label.begin(), label.end(), '_', ' ');
  return label + side_word(anatomy.bones[part.index].side);
}

std::vector<std::uint32_t> all_parts(const Anatomy& anatomy) {
  std::vector<std::uint32_t> parts{kSkinPart, kEyesPart};
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) parts.push_back(muscle_part(m));
  for (std::size_t n = 0; n < anatomy.fascia.size(); ++n) parts.push_back(fascia_part(n));
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) parts.push_back(bone_part(b));
  return parts;
}

std::vector<std::uint32_t> parts_named(const Anatomy& anatomy, std::string_view name) {
  const std::string asked = spelled(name);
  std::vector<std::uint32_t> parts;
  if (asked.empty()) return parts;
  if (asked == "skin") parts.push_back(kSkinPart);
  if (asked == "eyes") parts.push_back(kEyesPart);
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b)
    if (asked == "bones" || is_called(anatomy.bones[b].name, asked)) parts.push_back(bone_part(b));
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    const Muscle& muscle = anatomy.muscles[m];
    if (asked == "muscles" || is_called(muscle.name, asked) || muscle.layer == asked ||
        is_of_region(muscle, asked))
      parts.push_back(muscle_part(m));
  }
  for (std::size_t n = 0; n < anatomy.fascia.size(); ++n) {
    const FasciaSheet& sheet = anatomy.fascia[n];
    if (asked == "fascia" || is_called(sheet.name, asked) || is_of_region(sheet, asked))
      parts.push_back(fascia_part(n));
  }
  return parts;
}

std::vector<std::uint32_t> parts_of_list(const Anatomy& anatomy, const std::string& names,
                                         const std::string& where) {
  std::vector<std::uint32_t> all;
  std::istringstream text(names);
  for (std::string name; std::getline(text, name, ',');) {
    const std::vector<std::uint32_t> parts = parts_named(anatomy, name);
    if (parts.empty()) {
      const std::string near = nearest_name(spelled(name), known_names(anatomy));
      throw UsageError(
          fmt::format("{}: no part is called '{}'{}; name a bone, a muscle, a sheet of fascia, a "
                      "region of muscles, a layer, skin, muscles, fascia or bones",
                      where, name, near.empty() ? "" : fmt::format(": did you mean '{}'?", near)));
    }
    all.insert(all.end(), parts.begin(), parts.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& names) {
  std::size_t least = 1 + name.size() / 3;
  std::string nearest;
  for (const std::string& known : names) {
    const std::size_t far = distance_between(name, known);
    if (far < least || (far == least && nearest.empty())) least = far, nearest = known;
  }
  return nearest;
}

}  // namespace ecorche
