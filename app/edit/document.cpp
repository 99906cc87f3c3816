#include "app/edit/document.h"

#include <fmt/format.h>

#include <algorithm>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"

namespace ecorche {

namespace {

constexpr int kRounds = 8;  // directions are made unit vectors: rounding settles in two or three

// As their text says them, so that it gives them back to the last digit.
std::vector<TableMuscle> settled_muscles(const MuscleTable& from) {
  MuscleTable table = from;
  std::string written;
  for (int round = 0;; ++round) {
    std::string again;
    for (const TableMuscle& muscle : table.muscles) again += muscle_text(table, muscle);
    if (again == written || round == kRounds) return std::move(table.muscles);
    written = std::move(again);
    table.muscles.clear();
    read_muscle_text(written, "data/muscles", table);
  }
}

}  // namespace

Document built_in_document(const std::filesystem::path& tables) {
  auto frame = std::make_shared<MuscleTable>(read_muscle_table(tables));
  std::vector<TableMuscle> muscles = settled_muscles(*frame);
  frame->muscles.clear();
  Document out;
  out.frame = std::move(frame);
  for (TableMuscle& muscle : muscles)
    out.muscles.push_back(
        std::make_shared<EditedMuscle>(EditedMuscle{std::move(muscle), std::nullopt}));
  out.joints = std::make_shared<std::map<std::string, EditedJoint>>();
  out.body = std::make_shared<EditedBody>();
  out.trial = std::make_shared<Trial>();
  return out;
}

int find_entry(const Document& document, std::string_view name) {
  const auto at = std::ranges::find_if(
      document.muscles, [&](const auto& muscle) { return muscle->left.name == name; });
  return at == document.muscles.end() ? -1 : int(at - document.muscles.begin());
}

void place_entry(Document& document, const Document& built_in, Shared<EditedMuscle> muscle) {
  if (const int known = find_entry(document, muscle->left.name); known >= 0) {
    document.muscles[std::size_t(known)] = std::move(muscle);
    return;
  }
  const int rank = find_entry(built_in, muscle->left.name);
  auto at = document.muscles.end();
  if (rank >= 0)
    at = std::ranges::find_if(document.muscles, [&](const auto& each) {
      const int other = find_entry(built_in, each->left.name);
      return other < 0 || other > rank;
    });
  document.muscles.insert(at, std::move(muscle));
}

MuscleBlocks blocks_of(const Document& document, const EditedMuscle& muscle) {
  return {muscle_text(*document.frame, muscle.left),
          muscle.right ? muscle_text(*document.frame, *muscle.right) : std::string()};
}

TableMuscle read_block(const Document& document, std::string_view text, const std::string& name) {
  MuscleTable table = *document.frame;
  std::string written(text);
  for (int round = 0;; ++round) {
    table.muscles.clear();
    read_muscle_text(written, name, table);
    if (table.muscles.size() != 1)
      throw InputError(fmt::format("{}: {} muscles; expected one block that begins with 'muscle'",
                                   name, table.muscles.size()));
    std::string again = muscle_text(table, table.muscles.front());
    if (again == written || round == kRounds) break;
    written = std::move(again);
  }
  return std::move(table.muscles.front());
}

std::string document_text(const Document& document) {
  std::string out;
  for (const TableWrap& wrap : document.frame->wraps) out += wrap_text(*document.frame, wrap);
  for (const auto& muscle : document.muscles) {
    const MuscleBlocks blocks = blocks_of(document, *muscle);
    out += blocks.left;
    if (!blocks.right.empty()) out += "right " + blocks.right;
  }
  for (const auto& [name, joint] : *document.joints) {
    out += fmt::format("joint {} {} {} {} {} {} {}", name, joint.moved.x(), joint.moved.y(),
                       joint.moved.z(), joint.turned.x(), joint.turned.y(), joint.turned.z());
    for (const auto& limits : joint.limits)
      out += limits ? fmt::format(" {} {}", limits->first, limits->second) : " - -";
    out += "\n";
  }
  const EditedBody& body = *document.body;
  out += fmt::format("body '{}' layer {}\n", body.file.string(), body.layer);
  for (const auto& [name, value] : body.targets) out += fmt::format("measure {} {}\n", name, value);
  const FitSettings& fit = document.fit;
  out += fmt::format("fit {} {} {} {} {}\n", int(fit.method), fit.rays, fit.alpha, fit.clearance,
                     fit.slices);
  const Trial& trial = *document.trial;
  out += fmt::format("trial '{}' '{}' {}\n", trial.pose, trial.motion.string(), trial.seconds);
  for (const auto& [name, angles] : trial.angles)
    out += fmt::format("turn {} {} {} {}\n", name, angles.x(), angles.y(), angles.z());
  for (const auto& [name, value] : trial.activations)
    out += fmt::format("activation {} {}\n", name, value);
  return out + "picked " + document.picked + "\n";
}

}  // namespace ecorche
