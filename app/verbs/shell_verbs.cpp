#include "app/verbs/shell_verbs.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/completion.h"
#include "app/options/option_values.h"

namespace ecorche {

void add_shell_verbs(VerbRegistry& registry) {
  CLI::App& app = registry.app;
  auto shell = std::make_shared<std::string>();
  CLI::App* completion = add_verb(
      registry, app, "completion", "Print the completion of verbs, options and names for a shell",
      "source <(ecorche completion bash)\n  mkdir -p ~/.zfunc; ecorche completion zsh > "
      "~/.zfunc/_ecorche",
      [shell, &app](const Common&, Report&) {
        fmt::print("{}", *shell == "zsh" ? zsh_completion(app) : bash_completion(app));
        return 0;
      });
  completion->add_option("shell", *shell, "bash or zsh")
      ->required()
      ->check(one_of({"bash", "zsh"}));
  add_verb(registry, app, "man", "Print the manual page",
           "ecorche man > ecorche.1; man ./ecorche.1", [&app](const Common&, Report&) {
             fmt::print("{}", man_page(app));
             return 0;
           });
}

}  // namespace ecorche
