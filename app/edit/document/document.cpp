#include "app/edit/document/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"

namespace ecorche {

namespace {

constexpr int kRounds = 8;  // directions are made unit vectors: rounding settles in two or three

std::string skeleton_text(const Document& document) {
  const EditedSkeleton& skeleton = *document.skeleton;
  std::string out;
  for (const auto& [name, values] : skeleton.groups)
    out += fmt::format("group {} {}\n", name, fmt::join(values, " "));
  for (const OwnJoint& joint : skeleton.joints)
    out += fmt::format("own joint {} {} '{}' {} {} {}\n", joint.name, joint.parent, joint.child,
                       joint.paired, place_text(*document.frame, joint.at),
                       joint.to ? place_text(*document.frame, *joint.to) : "-");
  for (const OwnBone& bone : skeleton.bones) {
    out += fmt::format("own bone {} {} {} {} {} {} {} {} {}\n", bone.name, bone.joint, bone.at.x(),
                       bone.at.y(), bone.at.z(), bone.turn.x(), bone.turn.y(), bone.turn.z(),
                       bone.scale);
    for (Eigen::Index i = 0; i < bone.mesh->V.rows(); ++i)
      out +=
          fmt::format("v {} {} {}\n", bone.mesh->V(i, 0), bone.mesh->V(i, 1), bone.mesh->V(i, 2));
    for (Eigen::Index f = 0; f < bone.mesh->F.rows(); ++f)
      out +=
          fmt::format("f {} {} {}\n", bone.mesh->F(f, 0), bone.mesh->F(f, 1), bone.mesh->F(f, 2));
  }
  for (const std::string& name : skeleton.removed) out += fmt::format("removed {}\n", name);
  return out;
}

}  // namespace

Document built_in_document(const std::filesystem::path& tables) {
  auto frame = std::make_shared<MuscleTable>(read_muscle_table(tables));
  const std::vector<TableMuscle> muscles = std::move(frame->muscles);
  frame->muscles.clear();
  Document out;
  out.frame = std::move(frame);
  for (const TableMuscle& muscle : muscles)
    out.muscles.push_back(std::make_shared<EditedMuscle>(EditedMuscle{
        read_block(out, muscle_text(*out.frame, muscle), "data/muscles"), std::nullopt}));
  out.joints = std::make_shared<std::map<std::string, EditedJoint>>();
  out.skeleton = std::make_shared<EditedSkeleton>();
  out.body = std::make_shared<EditedBody>();
  out.trial = std::make_shared<Trial>();
  return out;
}

int angle_index(std::string_view name) {
  return int(std::ranges::find(kAngleNames, name) - kAngleNames.begin());
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

int find_wrap(const MuscleTable& table, std::string_view name) {
  const auto at = std::ranges::find(table.wraps, name, &TableWrap::name);
  return at == table.wraps.end() ? -1 : int(at - table.wraps.begin());
}

void place_wrap(MuscleTable& table, TableWrap wrap) {
  const int known = find_wrap(table, wrap.name);
  if (known < 0)
    table.wraps.push_back(std::move(wrap));
  else
    table.wraps[std::size_t(known)] = std::move(wrap);
}

std::vector<TableWrap> read_wraps(const MuscleTable& table, std::string_view text,
                                  const std::string& name) {
  MuscleTable read;
  read.landmarks = table.landmarks;
  read_muscle_text(text, name, read);
  return std::move(read.wraps);
}

std::string place_text(const MuscleTable& table, const TablePoint& point) {
  const Vec3 offset = 1e3 * point.offset;
  const auto shown = [](double mm) { return std::round(1e4 * mm) / 1e4 + 0.0; };
  return fmt::format("{}+{},{},{}", table.landmarks[std::size_t(point.landmark)].id,
                     shown(offset.x()), shown(offset.y()), shown(offset.z()));
}

std::set<int> wraps_of(const EditedMuscle& muscle) {
  std::set<int> out;
  const auto add_side = [&out](const TableMuscle& side) {
    for (const TableStrip& strip : side.strips)
      for (const TableStrip::WrapUse& use : strip.wraps) out.insert(use.wrap);
  };
  add_side(muscle.left);
  if (muscle.right) add_side(*muscle.right);
  return out;
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
  out += skeleton_text(document);
  const EditedBody& body = *document.body;
  out += fmt::format("body '{}' layer {}\n", body.file.string(), body.layer);
  for (const auto& [site, factor] : body.layer_sites)
    out += fmt::format("layer {} {}\n", site, factor);
  for (const auto& [name, value] : body.targets) out += fmt::format("measure {} {}\n", name, value);
  const FitSettings& fit = document.fit;
  out += fmt::format("fit {} {} {} {} {}\n", int(fit.method), fit.rays, fit.alpha, fit.clearance,
                     fit.slices);
  const Trial& trial = *document.trial;
  out += fmt::format("trial '{}' '{}' {}\n", trial.pose, trial.motion.string(), trial.seconds);
  for (const auto& [name, angles] : trial.angles)
    out += fmt::format("turn {} {} {} {}\n", name, angles.x(), angles.y(), angles.z());
  for (const auto& [name, effort] : trial.activations) {
    out += fmt::format("activation {} {}", name, effort.value);
    for (const auto& [at, value] : effort.keys) out += fmt::format(" {}:{}", at, value);
    out += "\n";
  }
  const Comparison& comparison = trial.comparison;
  out += fmt::format("compared '{}' {} {}\n", comparison.with, int(comparison.wiped),
                     comparison.share);
  return out + "picked " + document.picked + "\n";
}

}  // namespace ecorche
