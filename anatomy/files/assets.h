// Where the program's own tables and the pinned data packages lie. Opened once by the program and
// handed down: no library looks for them itself.
#pragma once

#include <filesystem>

#include "anatomy/files/package_archive.h"

namespace ecorche::inline v1 {

struct Assets {
  std::filesystem::path tables;  // the folder data/: bones.csv, body/, muscles/, motions/, ...
  Packages packages;
};

// The tables lie in the first of these folders that exists:
//   `folder`/data, where a folder is given
//   the environment variable ECORCHE_DATA, which is believed whether it exists or not
//   ../share/ecorche/data beside the executable, or beside the shared library that this is part of
//   data in the source tree that this was built from
// The packages, likewise:
//   `folder`/packages, where a folder is given
//   the environment variable ECORCHE_PACKAGES, which is believed whether it exists or not
//   ../share/ecorche/packages beside the executable or the shared library
//   build/packages in the source tree
//   $XDG_DATA_HOME/ecorche/packages, else ~/.local/share/ecorche/packages
// Without any of the latter, build/packages, so that the error of who opens a package can name it.
// Throws InputError that names all places where the tables were looked for.
Assets open_assets(const std::filesystem::path& folder = {});

}  // namespace ecorche::inline v1
