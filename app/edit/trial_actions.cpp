#include "app/edit/trial_actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/similar_names.h"
#include "app/edit/comparison.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/document/edited_skeleton.h"

namespace ecorche {
namespace {

// As Trial::activations has it.
std::string entry_of(const std::string& muscles) { return muscles == "all" ? "*" : muscles; }

// Entries of Trial::activations that words mean: all, a pattern, a group, or one muscle.
std::vector<std::string> entries_of(Workshop& workshop, const Document& document,
                                    const std::string& words) {
  if (words.find(':') == std::string::npos) {
    if (words != "all" && words.find('*') == std::string::npos) meant_muscle(document, words);
    return {entry_of(words)};
  }
  std::vector<std::string> out;
  for (const std::string& muscle : muscles_of_group(workshop.groups(), words))
    if (find_entry(document, muscle) >= 0) out.push_back(muscle);
  if (out.empty())
    throw InputError(fmt::format("argument 'muscles': '{}': there is no such group{}", words,
                                 did_you_mean(words, group_words(workshop.groups()))));
  return out;
}

}  // namespace

void arguments(Arguments& a, SetPose& x) {
  a.text("pose", "pose", x.pose, Need::required,
         "of the pose book (`ecorche list poses`); rest: the rest pose. Turned joints turn back");
}
Document apply(Workshop& workshop, const Document& document, const SetPose& x) {
  const std::vector<std::string> poses = workshop.pose_names();
  if (x.pose != "rest" && std::ranges::find(poses, x.pose) == poses.end())
    throw InputError(fmt::format("argument 'pose': '{}': there is no such pose{}", x.pose,
                                 did_you_mean(x.pose, poses)));
  return with_part(document, &Document::trial, [&](Trial& trial) {
    trial.pose = x.pose == "rest" ? std::string() : x.pose;
    trial.angles.clear();
    trial.motion.clear();
  });
}

void arguments(Arguments& a, TurnJoint& x) {
  a.text("joint", "joint", x.joint, Need::required, "that is turned from the pose");
  a.number("flexion", x.flexion, {ArgumentUnit::degree, -270, 270}, "from the anatomical zero");
  a.number("abduction", x.abduction, {ArgumentUnit::degree, -270, 270}, "likewise");
  a.number("rotation", x.rotation, {ArgumentUnit::degree, -270, 270}, "likewise");
}
Document apply(Workshop& workshop, const Document& document, const TurnJoint& x) {
  check_joint(workshop, document, x.joint);
  return with_part(document, &Document::trial, [&](Trial& trial) {
    // not a number: as the pose has it
    Vec3& angles = trial.angles.try_emplace(x.joint, Vec3::Constant(std::nan(""))).first->second;
    if (x.flexion) angles.x() = *x.flexion;
    if (x.abduction) angles.y() = *x.abduction;
    if (x.rotation) angles.z() = *x.rotation;
  });
}

void arguments(Arguments& a, Activate& x) {
  a.text("muscles", "muscles", x.muscles, Need::required,
         "a name, * in it for any letters; nerve:NAME or function:NAME; all: every muscle");
  a.number("value", x.value, {ArgumentUnit::none, 0, 1}, Need::required,
           "0 relaxed, 1 full effort");
  a.number("at", x.at, {ArgumentUnit::second, 0, 1e5},
           "of the motion: a key of its curve, straight between keys; left out: all the time");
  a.number("from", x.from, {ArgumentUnit::second, 0, 1e5}, "the key that is moved there");
}
Document apply(Workshop& workshop, const Document& document, const Activate& x) {
  const std::vector<std::string> entries = entries_of(workshop, document, x.muscles);
  if (x.from && !x.at)
    throw InputError("argument 'at' is missing: it says where the key of 'from' goes");
  for (const std::string& entry : entries) {
    const auto own = document.trial->activations.find(entry);
    if (x.from && (own == document.trial->activations.end() || !own->second.keys.contains(*x.from)))
      throw InputError(fmt::format("argument 'from': '{:g}': there is no key", *x.from));
  }
  return with_part(document, &Document::trial, [&](Trial& trial) {
    if (x.muscles == "all") trial.activations.clear();
    for (const std::string& entry : entries) {
      TriedEffort& effort = trial.activations[entry];
      if (x.from) effort.keys.erase(*x.from);
      if (x.at)
        effort.keys[*x.at] = x.value;
      else
        effort = {x.value, {}};
    }
  });
}

void arguments(Arguments& a, Relax& x) {
  a.text("muscles", "muscles", x.muscles, Need::required,
         "as `activate` has named them, a group of them, or all");
  a.number("at", x.at, {ArgumentUnit::second, 0, 1e5},
           "takes the key there away; left out: all of the curve");
}
Document apply(Workshop& workshop, const Document& document, const Relax& x) {
  const auto& efforts = document.trial->activations;
  std::vector<std::string> entries;
  if (x.muscles == "all")
    for (const auto& each : efforts) entries.push_back(each.first);
  else
    entries = entries_of(workshop, document, x.muscles);
  std::erase_if(entries, [&](const std::string& entry) {
    const auto own = efforts.find(entry);
    return own == efforts.end() || (x.at && !own->second.keys.contains(*x.at));
  });
  if (entries.empty() && x.muscles != "all") {
    std::vector<std::string> names;
    for (const auto& [name, effort] : efforts) names.push_back(name == "*" ? "all" : name);
    throw InputError(fmt::format("argument 'muscles': '{}': {}; there are [{}]", x.muscles,
                                 x.at ? "no key there" : "not activated", fmt::join(names, ", ")));
  }
  return with_part(document, &Document::trial, [&](Trial& trial) {
    for (const std::string& entry : entries) {
      TriedEffort& effort = trial.activations[entry];
      if (x.at) effort.keys.erase(*x.at);
      if (!x.at || effort.keys.empty()) trial.activations.erase(entry);
    }
  });
}

void arguments(Arguments& a, PlayMotion& x) {
  a.text("file", "file", x.file, Need::required, "motion that is played; none: no motion");
}
Document apply(Workshop&, const Document& document, const PlayMotion& x) {
  if (x.file != "none" && !std::filesystem::exists(x.file))
    throw InputError(fmt::format("argument 'file': '{}': there is no such file", x.file));
  return with_part(document, &Document::trial, [&](Trial& trial) {
    trial.motion = x.file == "none" ? std::filesystem::path() : std::filesystem::path(x.file);
    trial.seconds = 0;
    if (!trial.motion.empty()) trial.pose.clear();
  });
}

void arguments(Arguments& a, ShowMoment& x) {
  a.number("seconds", x.seconds, {ArgumentUnit::second, 0, 1e5}, Need::required, "of the motion");
}
Document apply(Workshop&, const Document& document, const ShowMoment& x) {
  if (document.trial->motion.empty())
    throw InputError("argument 'seconds': no motion is played; play_motion FILE first");
  return with_part(document, &Document::trial, [&](Trial& trial) { trial.seconds = x.seconds; });
}

void arguments(Arguments& a, Compare& x) {
  a.text("with", "comparison", x.with, Need::required,
         "linear_blend, dual_quaternion, delta_mush or paper: another skin; saved; before: as "
         "before the last edit; FILE: another body; none");
  a.choice("how", x.how, {"beside", "wiped"}, Need::optional,
           "halves of the picture, or one over the other");
  a.number("share", x.share, {ArgumentUnit::none, 0, 1}, Need::optional,
           "of the picture's width, left of which this one is seen");
}
Document apply(Workshop&, const Document& document, const Compare& x) {
  Comparison comparison{x.with == "none" ? std::string() : x.with, x.how == "wiped", x.share};
  if (names_file(comparison.with) && !std::filesystem::is_regular_file(comparison.with)) {
    std::vector<std::string> words{"saved", "before", "none"};
    for (const ComparedSkin& skin : kComparedSkins) words.emplace_back(skin.name);
    throw InputError(
        fmt::format("argument 'with': '{}': expected linear_blend, dual_quaternion, delta_mush, "
                    "paper, saved, before, none, or a body's file{}",
                    x.with, did_you_mean(x.with, words)));
  }
  return with_part(document, &Document::trial,
                   [&](Trial& trial) { trial.comparison = std::move(comparison); });
}

}  // namespace ecorche
