// Shell completion and the manual page, written from the command line's own definition so that they
// cannot differ from it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace ecorche {

// A script for `source`, or for bash-completion's folder.
std::string bash_completion(const CLI::App& app);

// A file `_ecorche` for a folder of zsh's fpath.
std::string zsh_completion(const CLI::App& app);

// ecorche.1 in man(7) macros.
std::string man_page(const CLI::App& app);

}  // namespace ecorche
