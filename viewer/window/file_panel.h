// Asks for a file: a line to write in, and the folder's files to choose from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/window/view_document.h"

namespace ecorche {

// Entries of a folder that can be opened: characters, crowds, motions. Folders first, then files,
// by name, without hidden ones.
struct FolderEntry {
  std::string name;
  bool folder = false;
};
std::vector<FolderEntry> list_folder(const std::filesystem::path& folder);

// Shows while the document asks for a file; then has the subject open it or save to it. Between
// ImGui::NewFrame and ImGui::Render.
void draw_file_panel(const ViewSubject& subject, ViewDocument& document);

}  // namespace ecorche
