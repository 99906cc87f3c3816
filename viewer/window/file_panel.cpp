#include "viewer/window/file_panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <system_error>

namespace ecorche {
namespace {

namespace fs = std::filesystem;
using Asking = ViewDocument::Asking;

// The typed text, and the folder whose entries are listed for it.
struct Entry {
  std::array<char, 1024> text{};
  fs::path listed;
  std::vector<FolderEntry> files;
  bool fresh = true;

  void set(const fs::path& path) {
    const std::string words = path.string();
    text.fill(0);
    std::memcpy(text.data(), words.data(), std::min(words.size(), text.size() - 1));
  }
  // The folder of the typed text.
  fs::path folder() const {
    const fs::path path = text.data();
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return path;
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
  }
};

void begin(Asking asking, Entry& entry) {
  std::error_code ignored;
  const fs::path here = fs::current_path(ignored);
  entry.set(asking == Asking::save ? here / "body.glb" : here / "");
  entry.fresh = false;
  entry.listed.clear();
}

// The entry that was clicked; folders are entered.
std::optional<fs::path> draw_folder(Entry& entry) {
  const fs::path folder = entry.folder();
  if (folder != entry.listed) {
    entry.files = list_folder(folder);
    entry.listed = folder;
  }
  std::optional<fs::path> chosen;
  ImGui::BeginChild("files", {0, -1.6f * ImGui::GetFrameHeight()}, true);
  if (ImGui::Selectable(".."))
    entry.set(fs::absolute(folder).lexically_normal().parent_path().parent_path() / "");
  for (const FolderEntry& file : entry.files) {
    if (!ImGui::Selectable((file.name + (file.folder ? "/" : "")).c_str())) continue;
    if (file.folder)
      entry.set(folder / file.name / "");
    else
      chosen = folder / file.name;
  }
  ImGui::EndChild();
  return chosen;
}

}  // namespace

std::vector<FolderEntry> list_folder(const fs::path& folder) {
  std::vector<FolderEntry> entries;
  std::error_code error;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with(".")) continue;
    std::error_code ignored;
    const bool inner = it->is_directory(ignored);
    const fs::path kind = it->path().extension();
    if (inner || kind == ".glb" || kind == ".gltf" || kind == ".bvh")
      entries.push_back({name, inner});
  }
  std::ranges::sort(entries, [](const FolderEntry& a, const FolderEntry& b) {
    return a.folder != b.folder ? a.folder : a.name < b.name;
  });
  return entries;
}

void draw_file_panel(const ViewSubject& subject, ViewDocument& document) {
  static Entry entry;
  const Asking asking = document.asking;
  const auto& serve = asking == Asking::save ? subject.save : subject.open;
  if (asking != Asking::nothing && !serve) {
    document.message = asking == Asking::save
                           ? "there is nothing to write: only --sliders make a body"
                           : "this window opens no files";
    document.asking = Asking::nothing;
  }
  if (document.asking == Asking::nothing) {
    entry.fresh = true;
    return;
  }
  if (entry.fresh) begin(asking, entry);
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(40 * em, size.x), std::min(28 * em, size.y)},
                           ImGuiCond_Appearing);
  bool open = true;
  std::optional<fs::path> chosen;
  if (ImGui::Begin(asking == Asking::save ? "Save the character###file"
                                          : "Open a character (.glb) or a motion (.bvh)###file",
                   &open, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
    ImGui::SetNextItemWidth(-1);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    if (ImGui::InputText("##path", entry.text.data(), entry.text.size(),
                         ImGuiInputTextFlags_EnterReturnsTrue))
      chosen = entry.text.data();
    const std::optional<fs::path> clicked = draw_folder(entry);
    if (clicked && asking == Asking::open)
      chosen = clicked;
    else if (clicked)
      entry.set(*clicked);
    if (ImGui::Button(asking == Asking::save ? "save" : "open")) chosen = entry.text.data();
    ImGui::SameLine();
    if (ImGui::Button("cancel")) open = false;
  }
  ImGui::End();
  std::error_code ignored;
  if (chosen && !chosen->empty() && !fs::is_directory(*chosen, ignored)) {
    serve(*chosen);
    open = false;
  }
  if (!open) document.asking = Asking::nothing;
}

}  // namespace ecorche
