#include "app/studio/design/muscle_list.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

#include "app/studio/design/fields.h"
#include "viewer/scene.h"

namespace ecorche {
namespace {

std::string lowered(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::vector<std::uint32_t> parts_of(const DesignSession& session, const std::string& muscle) {
  std::vector<std::uint32_t> out;
  for (const char* side : {"_l", "_r"})
    if (const int own = find_muscle(session.anatomy(), muscle + side); own >= 0)
      out.push_back(kFirstMusclePart + std::uint32_t(own));
  return out;
}

bool is_seen(const DesignSession& session, const std::string& muscle,
             const ViewDocument& document) {
  return std::ranges::none_of(parts_of(session, muscle),
                              [&](auto part) { return is_hidden(document, part); });
}

void show_muscle(const DesignSession& session, const std::string& muscle, bool shown,
                 ViewDocument& document) {
  for (const std::uint32_t part : parts_of(session, muscle)) set_hidden(part, !shown, document);
}

// Shown or hidden, all of a group.
void group_box(const DesignSession& session, const std::vector<const TableMuscle*>& muscles,
               ViewDocument& document) {
  bool seen = std::ranges::all_of(
      muscles, [&](const TableMuscle* each) { return is_seen(session, each->name, document); });
  if (ImGui::Checkbox("##all", &seen))
    for (const TableMuscle* each : muscles) show_muscle(session, each->name, seen, document);
  help_of_last("the group shown or hidden");
  ImGui::SameLine();
}

// By the right button on a group: it alone, or its effort.
void group_menu(DesignSession& session, Grouping grouping, const std::string& group,
                const std::vector<const TableMuscle*>& muscles, ViewDocument& document) {
  help_of_last("right button: only these, tense, relax");
  if (!ImGui::BeginPopupContextItem("group")) return;
  if (ImGui::Selectable("only these"))
    for (const auto& each : session.seen().muscles)
      show_muscle(session, each->left.name,
                  std::ranges::find(muscles, each->left.name, &TableMuscle::name) != muscles.end(),
                  document);
  if (ImGui::Selectable("all muscles again"))
    for (const auto& each : session.seen().muscles)
      show_muscle(session, each->left.name, true, document);
  std::string word = group;
  std::ranges::replace(word, ' ', '_');
  if (grouping == Grouping::nerve || grouping == Grouping::function) {
    word = (grouping == Grouping::nerve ? "nerve:" : "function:") + word;
    if (ImGui::Selectable("tense")) session.run("activate " + word + " value=1", "list");
    if (ImGui::Selectable("relax")) session.run("relax " + word, "list");
  }
  ImGui::EndPopup();
}

void muscle_row(DesignSession& session, const TableMuscle& muscle, ViewDocument& document) {
  ImGui::PushID(muscle.name.c_str());
  bool seen = is_seen(session, muscle.name, document);
  if (ImGui::Checkbox("##seen", &seen)) show_muscle(session, muscle.name, seen, document);
  help_of_last("shown or hidden");
  ImGui::SameLine();
  const std::string label = muscle.label.empty() ? spaced(muscle.name) : muscle.label;
  if (ImGui::Selectable(label.c_str(), session.seen().picked == muscle.name))
    session.run("pick " + muscle.name, "list");
  name_place(document, "list:" + muscle.name);
  help_of_last(
      fmt::format("{}\n{}\nfrom {}\nto {}", label, muscle.name, muscle.origin, muscle.insertion));
  ImGui::PopID();
}

}  // namespace

bool is_found(const TableMuscle& muscle, const std::string& find) {
  if (find.empty()) return true;
  const std::string all =
      lowered(fmt::format("{} {} {} {} {} {}", muscle.name, spaced(muscle.name), muscle.label,
                          spaced(muscle.group), muscle.origin, muscle.insertion));
  std::istringstream words(lowered(find));
  for (std::string word; words >> word;)
    if (all.find(word) == std::string::npos) return false;
  return true;
}

std::vector<std::string> groups_of(const TableMuscle& muscle, Grouping grouping,
                                   const MuscleGroups& groups) {
  if (grouping == Grouping::region) return {spaced(muscle.group)};
  if (grouping == Grouping::layer) return {muscle.layer};
  const auto entry = groups.find(muscle.name);
  if (entry == groups.end()) return {"not known (its own)"};
  if (grouping == Grouping::nerve) return {entry->second.nerve};
  return entry->second.functions;
}

void draw_muscle_list(DesignSession& session, PanelState& state, ViewDocument& document) {
  const bool entered =
      text_field("##find", state.find, "find: soleus, heel bone", ImGui::GetContentRegionAvail().x);
  name_place(document, "find");
  help_of_last("Words of its English or Latin name, its region, its origin or insertion");
  if (ImGui::Button("new muscle")) {
    state.bone_click = BoneClick{};
    session.forget_fault();
  }
  name_place(document, "new muscle");
  help_of_last("Draw one: click on a bone where it begins, then where it ends");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##grouped", kGroupings[std::size_t(state.grouped)])) {
    for (int k = 0; k < int(kGroupings.size()); ++k) {
      if (ImGui::Selectable(kGroupings[std::size_t(k)], k == state.grouped)) state.grouped = k;
      name_place(document, fmt::format("grouped:{}", kGroupings[std::size_t(k)]));
    }
    ImGui::EndCombo();
  }
  name_place(document, "grouped");
  help_of_last("Groups by region, by the nerve that moves them, by what they do, or by layer");
  std::map<std::string, std::vector<const TableMuscle*>> groups;
  // A copy of the pointers' document: a row that is clicked makes a new one.
  const Document held = session.seen();
  int found = 0;
  for (const auto& muscle : held.muscles)
    if (is_found(muscle->left, state.find)) {
      for (const std::string& group :
           groups_of(muscle->left, Grouping(state.grouped), session.workshop().groups()))
        groups[group].push_back(&muscle->left);
      ++found;
    }
  if (entered && found > 0) session.run("pick " + groups.begin()->second.front()->name, "list");
  quiet_text(state.find.empty() ? fmt::format("{} muscles, both sides of each", found)
                                : fmt::format("{} of {} muscles", found, held.muscles.size()));
  show_fault(session, "list");
  ImGui::BeginChild("muscles");
  const int picked = find_entry(held, held.picked);
  for (const auto& [group, muscles] : groups) {
    const bool own =
        picked >= 0 &&
        std::ranges::find(muscles, &held.muscles[std::size_t(picked)]->left) != muscles.end();
    ImGui::PushID(group.c_str());
    group_box(session, muscles, document);
    const std::string title = fmt::format("{}  ({})", group, muscles.size());
    if (!state.find.empty() && found < 40) ImGui::SetNextItemOpen(true);
    const bool open = ImGui::TreeNodeEx(title.c_str(), own ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    name_place(document, "group:" + group);
    group_menu(session, Grouping(state.grouped), group, muscles, document);
    if (open) {
      for (const TableMuscle* muscle : muscles) muscle_row(session, *muscle, document);
      ImGui::TreePop();
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
}

}  // namespace ecorche
