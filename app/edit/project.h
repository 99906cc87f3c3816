// A project: a folder of plain text that says what differs from the built-in tables.
//
//   project.txt        what it stands on (versions of the packages, a hash of the tables), the
//                      muscles that are its own or taken away, joints, body, fit and trial as lines
//                      of a script
//   muscles/NAME.txt   a muscle that is new or changed, as export_muscle writes it
//   wraps.txt          wraps that are new or changed
//   bones/NAME.obj     meshes of bones of one's own, m
//   journal.txt        the actions since it was last saved
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/edit/document/document.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

// Within a project's folder: what its journal goes on from, as projects of their own.
inline constexpr const char* kAsideFolders[] = {"unsaved-1", "unsaved-2"};

// A folder with a project.txt.
bool is_project(const std::filesystem::path& folder);

struct OpenedProject {
  Document document;
  std::vector<std::string> notes;  // what it stands on that is not here
};
// Throws InputError that names file and line for what cannot be read, or is no such text.
OpenedProject read_project(Workshop& workshop, const std::filesystem::path& folder);

// Throws OutputError for a folder that holds other files, and no project.
void check_project_folder(const std::filesystem::path& folder);

// Files that did not change are left as they are, those of muscles that are no longer its own are
// removed; project.txt comes last. Throws OutputError, as check_project_folder().
void write_project(Workshop& workshop, const Document& document,
                   const std::filesystem::path& folder);

}  // namespace ecorche
