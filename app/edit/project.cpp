#include "app/edit/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/edit/action_list.h"
#include "app/edit/comparison.h"
#include "app/edit/journal.h"
#include "app/edit/muscle_file.h"
#include "morph/placement/bone_groups.h"
#include "morph/template/template_cache.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

std::string whole_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_if_changed(const fs::path& file, const std::string& text) {
  if (!fs::exists(file) || whole_file(file) != text) write_file_atomically(file, text);
}

// Versions of the packages and the hash of the tables with the code that builds the template.
std::vector<std::string> stands_on(Workshop& workshop) {
  std::vector<std::string> out;
  for (const PinnedPackage& package : read_pins(workshop.assets().packages.pins))
    out.push_back(fmt::format("stands_on {} {} {}", package.name, package.version,
                              package.sha256.substr(0, 16)));
  out.push_back("stands_on tables " + template_key(workshop.assets().tables).substr(0, 16));
  return out;
}

bool holds_other_files(const fs::path& folder) {
  return std::ranges::any_of(fs::directory_iterator(folder), [](const auto& entry) {
    const std::string name = entry.path().filename().string();
    return name != kJournalFile &&
           std::ranges::find(kAsideFolders, name) == std::end(kAsideFolders);
  });
}

// Those that the project names, within its folder `muscles`.
std::vector<std::string> muscle_files(const fs::path& folder) {
  std::vector<std::string> out;
  std::istringstream lines(whole_file(folder / "project.txt"));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("muscle muscles/")) out.push_back(fs::path(line).filename().string());
  return out;
}

std::vector<std::string> own_wrap_lines(const Document& document, const Document& built_in) {
  std::set<std::string> known;
  for (const TableWrap& wrap : built_in.frame->wraps)
    known.insert(wrap_text(*built_in.frame, wrap));
  std::vector<std::string> out;
  for (const TableWrap& wrap : document.frame->wraps)
    if (std::string text = wrap_text(*document.frame, wrap); !known.contains(text))
      out.push_back(std::move(text));
  return out;
}

bool as_built_in(const Document& document, const Document& built_in, std::size_t entry) {
  const auto& muscle = document.muscles[entry];
  const int own = find_entry(built_in, muscle->left.name);
  if (own < 0) return false;
  const auto& before = built_in.muscles[std::size_t(own)];
  return muscle == before || blocks_of(document, *muscle) == blocks_of(built_in, *before);
}

void add_joints(const Document& document, std::string& out) {
  for (const auto& [name, joint] : *document.joints) {
    if (!joint.moved.isZero()) out += action_line(MoveJoint{name, joint.moved}) + "\n";
    if (!joint.turned.isZero())
      out +=
          action_line(TurnAxes{name, joint.turned.x(), joint.turned.y(), joint.turned.z()}) + "\n";
    for (int axis = 0; axis < 3; ++axis)
      if (const auto& limits = joint.limits[axis])
        out += action_line(
                   SetLimits{name, kAngleNames[std::size_t(axis)], limits->first, limits->second}) +
               "\n";
  }
}

// `mm` values are written as add_bone and set_group read them.
void add_skeleton(const Document& document, std::string& out) {
  const EditedSkeleton& skeleton = *document.skeleton;
  // what hangs on what: a joint may be placed by a bone, a bone hang on a joint
  std::set<std::string> written;
  const auto bones_on = [&](const std::string& joint) {
    for (const OwnBone& bone : skeleton.bones)
      if (bone.joint == joint && written.insert(bone.name).second)
        out += action_line(AddBone{bone.name, bone.joint, "bones/" + bone.name + ".obj", "m", "y",
                                   bone.at, bone.turn, bone.scale}) +
               "\n";
  };
  std::set<std::string> own;
  for (const OwnJoint& joint : skeleton.joints) own.insert(joint.name);
  for (const OwnBone& bone : skeleton.bones)
    if (!own.contains(bone.joint)) bones_on(bone.joint);
  for (const OwnJoint& joint : skeleton.joints) {
    const bool one_side = split_side(joint.name).second != Side::middle;
    out += action_line(AddJoint{joint.name, joint.parent, place_text(*document.frame, joint.at),
                                joint.to ? place_text(*document.frame, *joint.to) : "", joint.child,
                                one_side       ? ""
                                : joint.paired ? "yes"
                                               : "no"}) +
           "\n";
    bones_on(joint.name);
  }
  for (const std::string& name : skeleton.removed)
    out += action_line(RemoveJoint{name, "remove"}) + "\n";
  for (const auto& [name, values] : skeleton.groups) {
    SetGroup set{name, {}};
    for (std::size_t k = 0; k < values.size(); ++k)
      if (values[k] != GroupScale::unchanged()[k]) set.values[k] = values[k];
    out += action_line(set) + "\n";
  }
}

void write_bones(const Document& document, const fs::path& folder) {
  std::set<std::string> own;
  for (const OwnBone& bone : document.skeleton->bones) {
    const fs::path file = folder / "bones" / (bone.name + ".obj");
    own.insert(file.filename().string());
    make_output_folder(folder / "bones");
    const fs::path fresh = folder / "bones" / (bone.name + ".new.obj");
    write_obj(fresh, *bone.mesh);
    write_if_changed(file, whole_file(fresh));
    fs::remove(fresh);
  }
  if (!fs::exists(folder / "bones")) return;
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(folder / "bones"))
    if (entry.path().extension() == ".obj" && !own.contains(entry.path().filename().string()))
      left.push_back(entry.path());
  for (const fs::path& file : left) fs::remove(file);
}

// Joints and bones come before what stands on them: wraps and muscles.
bool is_of_skeleton(const std::string& line) {
  return line.starts_with("add_joint ") || line.starts_with("add_bone ");
}

void add_body(const Document& document, std::string& out) {
  const EditedBody& body = *document.body;
  if (!body.file.empty())
    out += action_line(SetBody{fs::absolute(body.file).lexically_normal().string()}) + "\n";
  for (const auto& [name, value] : body.targets)
    out +=
        action_line(SetMeasure{name, fmt::format("{}{}", value, name == "weight" ? "kg" : "m")}) +
        "\n";
  if (body.layer != 1) out += action_line(SetLayer{body.layer, {}}) + "\n";
  for (const auto& [site, factor] : body.layer_sites)
    out += action_line(SetLayer{factor, site}) + "\n";
  const FitSettings &fit = document.fit, usual;
  SetFit set;
  if (fit.method != usual.method) set.method = "paper";
  if (fit.alpha != usual.alpha) set.alpha = fit.alpha;
  if (fit.clearance != usual.clearance) set.clearance = fit.clearance;
  if (fit.rays != usual.rays) set.rays = fit.rays;
  if (fit.slices != usual.slices) set.slices = fit.slices;
  if (fit != usual) out += action_line(set) + "\n";
}

void add_trial(const Document& document, std::string& out) {
  const Trial& trial = *document.trial;
  if (!trial.pose.empty()) out += action_line(SetPose{trial.pose}) + "\n";
  if (!trial.motion.empty()) {
    out += action_line(PlayMotion{fs::absolute(trial.motion).lexically_normal().string()}) + "\n";
    out += action_line(ShowMoment{trial.seconds}) + "\n";
  }
  for (const auto& [name, angles] : trial.angles) {
    TurnJoint turn{name, {}, {}, {}};
    if (std::isfinite(angles.x())) turn.flexion = angles.x();
    if (std::isfinite(angles.y())) turn.abduction = angles.y();
    if (std::isfinite(angles.z())) turn.rotation = angles.z();
    out += action_line(turn) + "\n";
  }
  for (const auto& [name, effort] : trial.activations) {
    const std::string muscles = name == "*" ? "all" : name;
    if (effort.keys.empty() || effort.value != 0)
      out += action_line(Activate{muscles, effort.value, {}, {}}) + "\n";
    for (const auto& [at, value] : effort.keys)
      out += action_line(Activate{muscles, value, at, {}}) + "\n";
  }
  if (const Comparison& beside = trial.comparison; !beside.with.empty())
    out += action_line(Compare{names_file(beside.with)
                                   ? fs::absolute(beside.with).lexically_normal().string()
                                   : beside.with,
                               beside.wiped ? "wiped" : "beside", beside.share}) +
           "\n";
  if (!document.picked.empty()) out += action_line(Pick{document.picked}) + "\n";
}

void read_wraps_file(const fs::path& file, Document& document) {
  const std::vector<TableWrap> wraps = read_wraps(*document.frame, whole_file(file), file.string());
  document = with_part(document, &Document::frame, [&](MuscleTable& frame) {
    for (const TableWrap& wrap : wraps) place_wrap(frame, wrap);
  });
}

void read_project_line(Workshop& workshop, const fs::path& folder, const std::string& line,
                       const std::vector<std::string>& here, OpenedProject& out) {
  const std::vector<std::string> words = split_words(line);
  if (words.empty()) return;
  if (words[0] == "stands_on") {
    if (std::ranges::find(here, line) == here.end())
      out.notes.push_back(fmt::format(
          "the project stands on {}, and here is another; what it does not say may differ",
          line.substr(line.find(' ') + 1)));
  } else if (words[0] == "muscle" && words.size() == 2) {
    const fs::path file = fs::path(words[1]).lexically_normal();
    if (file.is_absolute() || *file.begin() == "..")
      throw InputError(fmt::format("'{}': muscles lie within the project's folder", words[1]));
    out.document = read_muscle_file(out.document, workshop.built_in(), folder / file);
  } else if (std::optional<Action> action = read_action(line)) {
    if (auto* bone = std::get_if<AddBone>(&*action)) bone->file = (folder / bone->file).string();
    std::optional<Document> next = applied(workshop, out.document, *action);
    if (!next) throw InputError(fmt::format("'{}': no action of a project", words[0]));
    out.document = std::move(*next);
  }
}

}  // namespace

// One that was killed while it was saved for the first time has a copy beside.
void check_project_folder(const fs::path& folder) {
  const auto copied = [&](const char* aside) { return is_project(folder / aside); };
  if (!fs::exists(folder) || is_project(folder) || std::ranges::any_of(kAsideFolders, copied) ||
      !holds_other_files(folder))
    return;
  throw OutputError(
      fmt::format("{}: a folder with other files, and no project; name a new or an empty one",
                  folder.string()));
}

bool is_project(const fs::path& folder) { return fs::exists(folder / "project.txt"); }

OpenedProject read_project(Workshop& workshop, const fs::path& folder) {
  const fs::path file = folder / "project.txt";
  if (!fs::exists(file))
    throw InputError(fmt::format("{}: no project; a folder with project.txt is", folder.string()));
  OpenedProject out{workshop.built_in(), {}};
  const std::vector<std::string> here = stands_on(workshop);
  const auto read_lines = [&](bool of_skeleton) {
    std::istringstream lines(whole_file(file));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      if (is_of_skeleton(line) != of_skeleton) continue;
      try {
        read_project_line(workshop, folder, line, here, out);
      } catch (const Error& error) {
        throw InputError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
      }
    }
  };
  read_lines(true);
  if (fs::exists(folder / "wraps.txt")) read_wraps_file(folder / "wraps.txt", out.document);
  read_lines(false);
  return out;
}

void write_project(Workshop& workshop, const Document& document, const fs::path& folder) {
  const Document& built_in = workshop.built_in();
  check_project_folder(folder);
  const std::vector<std::string> before = muscle_files(folder);
  make_output_folder(folder / "muscles");
  std::string out =
      "# A project of `ecorche studio`: what differs from the built-in tables.\n"
      "# Lines are actions; `ecorche studio --list-actions` explains them.\n";
  for (const std::string& line : stands_on(workshop)) out += line + "\n";
  std::set<std::string> own;
  for (std::size_t m = 0; m < document.muscles.size(); ++m) {
    if (as_built_in(document, built_in, m)) continue;
    const std::string file = document.muscles[m]->left.name + ".txt";
    write_if_changed(folder / "muscles" / file, muscle_file_text(document, built_in, int(m)));
    out += "muscle muscles/" + file + "\n";
    own.insert(file);
  }
  for (const auto& muscle : built_in.muscles)
    if (find_entry(document, muscle->left.name) < 0)
      out += action_line(RemoveMuscle{muscle->left.name}) + "\n";
  for (const TableWrap& wrap : built_in.frame->wraps)
    if (find_wrap(*document.frame, wrap.name) < 0) out += action_line(RemoveWrap{wrap.name}) + "\n";
  add_skeleton(document, out);
  write_bones(document, folder);
  add_joints(document, out);
  add_body(document, out);
  add_trial(document, out);
  const std::vector<std::string> changed = own_wrap_lines(document, built_in);
  if (!changed.empty())
    write_if_changed(folder / "wraps.txt", fmt::format("{}", fmt::join(changed, "")));
  else
    fs::remove(folder / "wraps.txt");
  write_if_changed(folder / "project.txt", out);
  for (const std::string& file : before)
    if (!own.contains(file)) fs::remove(folder / "muscles" / file);
}

}  // namespace ecorche
