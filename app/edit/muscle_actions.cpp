#include "app/edit/muscle_actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/muscle_file.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

constexpr double kMillilitre = 1e-6, kCentimetre = 1e-2;
// As women have it where nobody says: the mean of the table's ratios after Janssen 2000.
constexpr double kFemaleShare = 0.62;
// Of a fusiform belly: width over the largest, at shares of the belly's length.
constexpr double kBellyPlaces[] = {0, 0.2, 0.4, 0.6, 0.8, 1};
constexpr double kBellyWidths[] = {0.28, 0.75, 1, 0.96, 0.68, 0.28};
constexpr double kTendonWidth = 0.24;
// Of that profile: volume over length times the largest section.
constexpr double kFilling = 0.55;

void check_name(const Document& document, const std::string& key, const std::string& name) {
  const bool letters = std::ranges::all_of(
      name, [](unsigned char c) { return std::isdigit(c) || std::islower(c) || c == '_'; });
  if (!letters || name.ends_with("_l") || name.ends_with("_r"))
    throw InputError(fmt::format(
        "argument '{}': '{}': expected small letters, digits and _, without _l or _r at the end",
        key, name));
  if (find_entry(document, name) >= 0)
    throw InputError(fmt::format("argument '{}': '{}': there is a muscle of that name", key, name));
}

// Across the line, as far to the side as it goes.
Vec3 width_across(const Vec3& along) {
  Vec3 side = Vec3::UnitX() - along.x() * along;
  if (side.norm() < 0.3) side = Vec3::UnitZ() - along.z() * along;
  return side.normalized();
}

void add_sections(const NewMuscle& x, const Vec3& line, TableStrip& strip) {
  const double belly = (x.belly_end - x.belly_begin) * line.norm();
  const double round =
      std::sqrt(4 * x.volume * kMillilitre / (std::numbers::pi * kFilling * std::max(belly, 1e-3)));
  Vec2 size(1e-3 * x.width, 1e-3 * x.thickness);
  if (size.x() <= 0 && size.y() <= 0) size.setConstant(round);
  if (size.x() <= 0) size.x() = round * round / size.y();
  if (size.y() <= 0) size.y() = round * round / size.x();
  const Vec3 width = width_across(line.normalized());
  const auto add = [&](double s, double share) {
    if (strip.sections.empty() || s > strip.sections.back().s + 1e-3)
      strip.sections.push_back({s, share * size / 2, width});
  };
  add(0, x.belly_begin > 0 ? kTendonWidth : kBellyWidths[0]);
  for (int k = 0; k < 6; ++k) {
    const double s = x.belly_begin + kBellyPlaces[k] * (x.belly_end - x.belly_begin);
    if (s > 0 && s < 1) add(s, kBellyWidths[k]);
  }
  if (1 - strip.sections.back().s < 1e-3) strip.sections.pop_back();
  add(1, x.belly_end < 1 ? kTendonWidth : kBellyWidths[5]);
}

std::string words_of(const MuscleTable& frame, const TablePoint& point) {
  const SourceLandmark& landmark = frame.landmarks[std::size_t(point.landmark)];
  return landmark.carrier + ": " + (landmark.rule.empty() ? landmark.id : landmark.rule);
}

}  // namespace

void arguments(Arguments& a, Pick& x) {
  a.text("muscle", "muscle", x.muscle, Need::required, "that later actions without one mean");
}

Document apply(Workshop&, const Document& document, const Pick& x) {
  meant_muscle(document, x.muscle);
  Document out = document;
  out.picked = x.muscle;
  return out;
}

void arguments(Arguments& a, NewMuscle& x) {
  a.text("name", "name", x.name, Need::required, "small letters, digits and _; without side");
  a.text("from", "place", x.from, Need::required, "origin: LANDMARK, LANDMARK+L,U,F or BONE@L,U,F");
  a.text("to", "place", x.to, Need::required, "insertion, likewise");
  a.number("volume", x.volume, {ArgumentUnit::millilitre, 0.01, 5000}, Need::required,
           "of one side of a man of 77 kg");
  a.number("female", x.female, {ArgumentUnit::millilitre, 0.01, 5000},
           "of a woman of 62 kg; 0.62 of it");
  a.number("fibre", x.fibre, {ArgumentUnit::centimetre, 0.1, 100},
           "optimal length; by the belly's");
  a.number("width", x.width, {ArgumentUnit::millimetre, 0, 500}, Need::optional,
           "in mid-belly; round, by the volume, where left out");
  a.number("thickness", x.thickness, {ArgumentUnit::millimetre, 0, 500}, Need::optional,
           "likewise");
  a.number("belly_begin", x.belly_begin, {ArgumentUnit::none, 0, 0.98}, Need::optional,
           "where the flesh begins, as a share of the line");
  a.number("belly_end", x.belly_end, {ArgumentUnit::none, 0.02, 1}, Need::optional,
           "and where it ends");
  a.text("label", "words", x.label, Need::optional, "as people write it");
  a.text("group", "name", x.group, Need::optional, "region, as arm or thigh");
  a.choice("layer", x.layer, {"subcutaneous", "superficial", "intermediate", "deep"},
           Need::optional, "how deep it lies");
  a.choice("shape", x.shape, {"strap", "fusiform", "fan", "sheet", "pennate"}, Need::optional,
           "a word for people");
}

Document apply(Workshop& workshop, const Document& document, const NewMuscle& x) {
  check_name(document, "name", x.name);
  if (x.belly_begin >= x.belly_end)
    throw InputError(
        fmt::format("argument 'belly_end': '{:g}': expected more than belly_begin {:g}",
                    x.belly_end, x.belly_begin));
  TableMuscle muscle;
  muscle.name = x.name;
  muscle.label = x.label.empty() ? x.name : x.label;
  std::ranges::replace(muscle.label, '_', ' ');
  muscle.group = x.group;
  muscle.layer = x.layer;
  muscle.shape = x.shape;
  TableStrip strip;
  strip.path = {read_place(workshop, document, x.from), read_place(workshop, document, x.to)};
  const Vec3 line =
      position(*document.frame, strip.path[1]) - position(*document.frame, strip.path[0]);
  strip.belly_begin = x.belly_begin;
  strip.belly_end = x.belly_end;
  add_sections(x, line, strip);
  muscle.origin = words_of(*document.frame, strip.path[0]);
  muscle.insertion = words_of(*document.frame, strip.path[1]);
  muscle.volume_male = x.volume * kMillilitre;
  muscle.volume_female = x.female.value_or(kFemaleShare * x.volume) * kMillilitre;
  muscle.fibre_length = x.fibre
                            ? *x.fibre * kCentimetre
                            : std::max(1e-3, 0.75 * (x.belly_end - x.belly_begin) * line.norm());
  muscle.strips.push_back(std::move(strip));
  Document out = document;
  place_entry(out, workshop.built_in(),
              std::make_shared<EditedMuscle>(EditedMuscle{
                  read_block(document, muscle_text(*document.frame, muscle), x.name), {}}));
  return out;
}

void arguments(Arguments& a, CopyMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::required, "to copy");
  a.text("as", "name", x.as, Need::required, "name of the copy, without side");
}

Document apply(Workshop& workshop, const Document& document, const CopyMuscle& x) {
  const MeantMuscle meant = meant_muscle(document, x.muscle);
  check_name(document, "as", x.as);
  auto copy = std::make_shared<EditedMuscle>(*document.muscles[std::size_t(meant.entry)]);
  copy->left.name = x.as;
  if (copy->right) copy->right->name = x.as;
  Document out = document;
  place_entry(out, workshop.built_in(), std::move(copy));
  return out;
}

void arguments(Arguments& a, RemoveMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "to remove, on both sides");
}

Document apply(Workshop&, const Document& document, const RemoveMuscle& x) {
  const MeantMuscle meant = meant_muscle(document, x.muscle);
  if (meant.side != Side::middle)
    throw InputError(fmt::format(
        "argument 'muscle': '{}': muscles are there on both sides or on none; leave the side away",
        x.muscle));
  Document out = document;
  const std::string name = document.muscles[std::size_t(meant.entry)]->left.name;
  out.muscles.erase(out.muscles.begin() + meant.entry);
  if (split_side(out.picked).first == name) out.picked.clear();
  return out;
}

void arguments(Arguments& a, RenameMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::required, "to rename");
  a.text("as", "name", x.as, Need::required, "new name, without side");
}

Document apply(Workshop& workshop, const Document& document, const RenameMuscle& x) {
  const MeantMuscle meant = meant_muscle(document, x.muscle);
  check_name(document, "as", x.as);
  auto renamed = std::make_shared<EditedMuscle>(*document.muscles[std::size_t(meant.entry)]);
  Document out = document;
  if (split_side(out.picked).first == renamed->left.name) out.picked = x.as;
  renamed->left.name = x.as;
  if (renamed->right) renamed->right->name = x.as;
  out.muscles.erase(out.muscles.begin() + meant.entry);
  place_entry(out, workshop.built_in(), std::move(renamed));
  return out;
}

void arguments(Arguments& a, MirrorMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "whose sides become alike");
  a.choice("from", x.from, {"left", "right"}, Need::optional, "the side that stays");
}

Document apply(Workshop&, const Document& document, const MirrorMuscle& x) {
  const MeantMuscle meant = meant_muscle(document, x.muscle);
  auto even = std::make_shared<EditedMuscle>(*document.muscles[std::size_t(meant.entry)]);
  if (even->right && x.from == "right") even->left = *even->right;
  even->right.reset();
  Document out = document;
  out.muscles[std::size_t(meant.entry)] = std::move(even);
  return out;
}

void arguments(Arguments& a, SetMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "whose figures are set");
  a.number("volume", x.volume, {ArgumentUnit::millilitre, 0.01, 5000},
           "of one side of a man of 77 kg");
  a.number("female", x.female, {ArgumentUnit::millilitre, 0.01, 5000}, "of a woman of 62 kg");
  a.number("fibre", x.fibre, {ArgumentUnit::centimetre, 0.1, 100}, "optimal fibre length");
  a.number("pennation", x.pennation, {ArgumentUnit::degree, 0, 89},
           "angle of the fibres to the line");
  a.number("force", x.force, {ArgumentUnit::newton, 0.1, 1e5},
           "isometric; else of volume and fibres");
  a.number("tendon", x.tendon, {ArgumentUnit::none, 0, 0.99},
           "share of tendon in the whole length");
  a.number("tense", x.tense, {ArgumentUnit::none, 0.5, 3},
           "thickness at full effort over the relaxed");
}

Document apply(Workshop&, const Document& document, const SetMuscle& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    // a woman's goes along where it is not said
    if (x.volume) muscle.volume_female *= *x.volume * kMillilitre / muscle.volume_male;
    if (x.volume) muscle.volume_male = *x.volume * kMillilitre;
    if (x.female) muscle.volume_female = *x.female * kMillilitre;
    if (x.fibre) muscle.fibre_length = *x.fibre * kCentimetre;
    if (x.pennation) muscle.pennation = *x.pennation * kDegree;
    if (x.force) muscle.max_force = *x.force;
    if (x.tendon) muscle.tendon_fraction = *x.tendon;
    if (x.tense) muscle.tense_thickness = *x.tense;
  });
}

void arguments(Arguments& a, DescribeMuscle& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "that is described");
  a.text("label", "words", x.label, Need::optional, "as people write it");
  a.text("group", "name", x.group, Need::optional, "region");
  a.choice("layer", x.layer, {"subcutaneous", "superficial", "intermediate", "deep"},
           Need::optional, "how deep it lies");
  a.choice("shape", x.shape, {"strap", "fusiform", "fan", "sheet", "pennate"}, Need::optional,
           "a word for people");
  a.text("from", "words", x.from, Need::optional, "origin, in words");
  a.text("to", "words", x.to, Need::optional, "insertion, in words");
  a.text("action", "words", x.action, Need::optional, "what it does");
  a.text("note", "words", x.note, Need::optional, "what else there is to say");
  a.text("source", "words", x.source, Need::optional, "of the figures; added to those there are");
}

Document apply(Workshop&, const Document& document, const DescribeMuscle& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    const auto set = [](std::string& field, const std::string& words) {
      if (!words.empty()) field = words;
    };
    set(muscle.label, x.label);
    set(muscle.group, x.group);
    set(muscle.layer, x.layer);
    set(muscle.shape, x.shape);
    set(muscle.origin, x.from);
    set(muscle.insertion, x.to);
    set(muscle.action, x.action);
    set(muscle.note, x.note);
    if (!x.source.empty()) muscle.sources.push_back(x.source);
  });
}

void arguments(Arguments& a, ImportMuscle& x) {
  a.text("file", "file", x.file, Need::required,
         "of export_muscle; a muscle of the same name is replaced");
}

Document apply(Workshop& workshop, const Document& document, const ImportMuscle& x) {
  return read_muscle_file(document, workshop.built_in(), x.file);
}

}  // namespace ecorche
