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

void muscle_row(DesignSession& session, const TableMuscle& muscle, ViewDocument& document) {
  ImGui::PushID(muscle.name.c_str());
  std::vector<std::uint32_t> parts;
  for (const char* side : {"_l", "_r"})
    if (const int own = find_muscle(session.anatomy(), muscle.name + side); own >= 0)
      parts.push_back(kFirstMusclePart + std::uint32_t(own));
  bool seen = std::ranges::none_of(parts, [&](auto part) { return is_hidden(document, part); });
  if (ImGui::Checkbox("##seen", &seen))
    for (const std::uint32_t part : parts) set_hidden(part, !seen, document);
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
  std::map<std::string, std::vector<const TableMuscle*>> regions;
  const Document& seen = session.seen();
  int found = 0;
  for (const auto& muscle : seen.muscles)
    if (is_found(muscle->left, state.find)) {
      regions[muscle->left.group].push_back(&muscle->left);
      ++found;
    }
  if (entered && found > 0) session.run("pick " + regions.begin()->second.front()->name, "list");
  quiet_text(state.find.empty() ? fmt::format("{} muscles, both sides of each", found)
                                : fmt::format("{} of {} muscles", found, seen.muscles.size()));
  show_fault(session, "list");
  ImGui::BeginChild("muscles");
  // A copy of the pointers' document: a row that is clicked makes a new one.
  const Document held = seen;
  const int picked = find_entry(held, held.picked);
  for (const auto& [region, muscles] : regions) {
    if (!state.find.empty() && found < 40) ImGui::SetNextItemOpen(true);
    const bool own = picked >= 0 && held.muscles[std::size_t(picked)]->left.group == region;
    const std::string title = fmt::format("{}  ({})###{}", spaced(region), muscles.size(), region);
    if (!ImGui::TreeNodeEx(title.c_str(), own ? ImGuiTreeNodeFlags_DefaultOpen : 0)) continue;
    for (const TableMuscle* muscle : muscles) muscle_row(session, *muscle, document);
    ImGui::TreePop();
  }
  ImGui::EndChild();
}

}  // namespace ecorche
