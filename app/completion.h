// Shell completion and the manual page, generated from the definition of the command line.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ecorche {

// A script for `source`, or for bash-completion's folder.
std::string bash_completion(const CLI::App& app);

// A file `_ecorche` for a folder of zsh's fpath.
std::string zsh_completion(const CLI::App& app);

// ecorche.1 in man(7) macros.
std::string man_page(const CLI::App& app);

}  // namespace ecorche
