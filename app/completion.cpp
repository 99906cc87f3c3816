#include "app/completion.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <functional>
#include <vector>

namespace ecorche {
namespace {

std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

// Every verb with its path ("body new"), the executable itself first with an empty one.
void walk(const CLI::App& app, const std::string& path,
          const std::function<void(const CLI::App&, const std::string&)>& take) {
  take(app, path);
  for (const CLI::App* verb : verbs_of(app))
    walk(*verb, (path.empty() ? "" : path + " ") + verb->get_name(), take);
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> out;
  for (const std::string& name : option.get_snames()) out.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.push_back("--" + name);
  return out;
}

// The words of "{a,b,c}" in an option's type.
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'),
                    close = type.find('}', open == std::string::npos ? 0 : open);
  std::vector<std::string> out;
  if (open == std::string::npos || close == std::string::npos) return out;
  std::string word;
  for (const char c : type.substr(open + 1, close - open)) {
    if (c != ',' && c != '}')
      word += c;
    else if (!word.empty())
      out.push_back(std::move(word)), word.clear();
  }
  return out;
}

// The list of `ecorche list` that holds the values of an option; empty if none does.
std::string list_for(const std::string& option) {
  if (option == "--measure") return "measures";
  if (option == "--joint") return "joints";
  if (option == "--size") return "sizes";
  return {};
}

std::string join(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }
bool is_positional(const CLI::Option& option) {
  return option.get_snames().empty() && option.get_lnames().empty();
}

// Quotes text for a shell.
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4)
    text.replace(at, 1, "'\\''");
  return "'" + text + "'";
}

// Values of an option as a shell command that prints them; empty: files.
std::string value_words(const CLI::Option& option) {
  if (const std::vector<std::string> choices = choices_of(option); !choices.empty())
    return join(choices, " ");
  for (const std::string& name : names_of(option))
    if (const std::string list = list_for(name); !list.empty())
      return fmt::format("$(ecorche list {} --names 2>/dev/null)", list);
  return {};
}

std::string positional_words(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options())
    if (is_positional(*option))
      if (const std::vector<std::string> choices = choices_of(*option); !choices.empty())
        return join(choices, " ");
  return {};
}

// One case of the bash function: completions within a verb.
std::string bash_case(const CLI::App& verb, const std::string& path) {
  std::vector<std::string> options, below;
  std::string values;
  for (const CLI::Option* option : verb.get_options()) {
    if (is_positional(*option)) continue;
    const std::vector<std::string> names = names_of(*option);
    options.insert(options.end(), names.begin(), names.end());
    if (!takes_value(*option)) continue;
    const std::string words = value_words(*option);
    values += words.empty()
                  ? fmt::format("        {}) files=1; return ;;\n", join(names, "|"))
                  : fmt::format("        {}) words=\"{}\"; return ;;\n", join(names, "|"), words);
  }
  for (const CLI::App* each : verbs_of(verb)) below.push_back(each->get_name());
  const std::string first = positional_words(verb);
  std::string out = fmt::format("    {})\n", quoted(path));
  if (!values.empty()) out += "      case \"$prev\" in\n" + values + "      esac\n";
  out += fmt::format("      if [[ $cur == -* ]]; then words={}; ", quoted(join(options, " ")));
  if (!below.empty())
    out += fmt::format("else words={}; fi ;;\n",
                       quoted(join(below, " ") + (path.empty() ? " help" : "")));
  else if (!first.empty())
    out += fmt::format("else words={}; files=1; fi ;;\n", quoted(first));
  else
    out += "else files=1; fi ;;\n";
  return out;
}

std::string escape_zsh(std::string text) {
  std::string out;
  for (const char c : text)
    out += c == '[' || c == ']' || c == ':' || c == '\\' ? std::string("\\") + c
           : c == '\n'                                   ? " "
                                                         : std::string(1, c);
  return out;
}

std::string zsh_values(const CLI::Option& option) {
  if (const std::vector<std::string> choices = choices_of(option); !choices.empty())
    return fmt::format(":value:({})", join(choices, " "));
  for (const std::string& name : names_of(option))
    if (const std::string list = list_for(name); !list.empty())
      return fmt::format(":value:($(ecorche list {} --names 2>/dev/null))", list);
  return ":value:_files";
}

std::string zsh_case(const CLI::App& verb, const std::string& path) {
  std::string out = fmt::format("    {})\n      _arguments -s -S \\\n", quoted(path));
  for (const CLI::Option* option : verb.get_options()) {
    if (is_positional(*option)) continue;
    for (const std::string& name : names_of(*option))
      out += "        " +
             quoted(fmt::format("*{}[{}]{}", name, escape_zsh(option->get_description()),
                                takes_value(*option) ? zsh_values(*option) : "")) +
             " \\\n";
  }
  const std::string first = positional_words(verb);
  return out + "        " +
         quoted(first.empty() ? "*:file:_files" : fmt::format("*:value:({})", first)) + " ;;\n";
}

// Escapes letters that have a meaning in troff.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '`')
      out += "\\(ga";
    else
      out += c;
  }
  if (!out.empty() && out[0] == '.') out = "\\&" + out;
  for (std::size_t at = 0; (at = out.find("\n.", at)) != std::string::npos; at += 2)
    out.replace(at, 2, "\n\\&.");
  return out;
}

std::string man_option(const CLI::Option& option) {
  std::string head;
  for (const std::string& name : names_of(option))
    head += (head.empty() ? "" : ", ") + ("\\fB" + troff(name) + "\\fR");
  if (is_positional(option))
    head = "\\fI" + troff(option.get_name()) + "\\fR";
  else if (takes_value(option))
    head += " \\fI" + troff(option.get_type_name()) + "\\fR";
  std::string help = troff(option.get_description());
  if (!option.get_default_str().empty()) help += " [" + troff(option.get_default_str()) + "]";
  return ".TP\n" + head + "\n" + help + "\n";
}

std::string man_verb(const CLI::App& verb, const std::string& path) {
  std::string out =
      fmt::format(".SS \"ecorche {}\"\n{}\n", troff(path), troff(verb.get_description()));
  for (const CLI::Option* option : verb.get_options()) out += man_option(*option);
  if (!verb.get_footer().empty()) out += ".PP\n.nf\n" + troff(verb.get_footer()) + "\n.fi\n";
  return out;
}

constexpr const char* kExitStatus = R"(.SH EXIT STATUS
.TP
0
Good.
.TP
1
An error of this program.
.TP
2
The command line cannot be meant.
.TP
3
A file cannot be read, or is malformed.
.TP
4
A file is well formed, but not what is needed.
.TP
5
A limit of size, memory or time was met.
.TP
6
An output could not be written.
.TP
8
Written, but an accuracy target was missed.
.TP
130, 143
Ended by Ctrl\-C or SIGTERM; nothing half\-written is left.
.SH ENVIRONMENT
.TP
.B ECORCHE_PACKAGES
Folder of the data packages.
.TP
.B XDG_CACHE_HOME
Where what takes long to make is kept, in the folder ecorche; ~/.cache when not set.
.TP
.B XDG_STATE_HOME
Where sessions of the studio that are not saved are kept until they end, in the folder
ecorche/studio; ~/.local/state when not set.
)";

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string cases, paths;
  walk(app, "", [&](const CLI::App& verb, const std::string& path) {
    cases += bash_case(verb, path);
    if (!path.empty()) paths += (paths.empty() ? "" : "|") + quoted(path);
  });
  return "# Completion of ecorche for bash: "
         "source it, or save it as bash-completion's completions/ecorche.\n"
         R"(_ecorche_words() {
  case "$verb" in
)" + cases +
         R"(  esac
}
_ecorche() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} verb= words= files= i next
  for ((i = 1; i < COMP_CWORD; i++)); do
    next="${verb:+$verb }${COMP_WORDS[i]}"
    case "$next" in
      )" +
         paths + R"() verb=$next ;;
      help) ;;
      *) break ;;
    esac
  done
  _ecorche_words
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
  if [[ -n $files ]]; then
    local IFS=$'\n'
    COMPREPLY+=($(compgen -f -- "$cur"))
    compopt -o filenames 2>/dev/null
  fi
}
complete -F _ecorche ecorche
)";
}

std::string zsh_completion(const CLI::App& app) {
  std::string cases, paths;
  walk(app, "", [&](const CLI::App& verb, const std::string& path) {
    if (!path.empty()) paths += (paths.empty() ? "" : "|") + quoted(path);
    if (verbs_of(verb).empty()) {
      cases += zsh_case(verb, path);
      return;
    }
    cases += fmt::format("    {})\n      local -a verbs=(", quoted(path));
    for (const CLI::App* each : verbs_of(verb))
      cases +=
          " " + quoted(escape_zsh(each->get_name()) + ":" + escape_zsh(each->get_description()));
    cases += ")\n      _describe verb verbs ;;\n";
  });
  return R"(#compdef ecorche
# Completion of ecorche for zsh: save it as _ecorche in a folder of $fpath.
_ecorche() {
  local verb= next
  local -i i depth=0
  for ((i = 2; i < CURRENT; i++)); do
    next="${verb:+$verb }${words[i]}"
    case "$next" in
      )" +
         paths + R"() verb=$next; depth=i ;;
      *) break ;;
    esac
  done
  if ((depth > 0)); then
    words=("${words[depth]}" "${(@)words[depth + 1,-1]}")
    ((CURRENT -= depth - 1))
  fi
  case "$verb" in
)" + cases +
         R"(  esac
}
_ecorche "$@"
)";
}

std::string man_page(const CLI::App& app) {
  std::string verbs;
  walk(app, "", [&](const CLI::App& verb, const std::string& path) {
    if (verbs_of(verb).empty()) verbs += man_verb(verb, path);
  });
  return ".TH ECORCHE 1 \"\" \"ecorche " ECORCHE_VERSION
         "\" \"User Commands\"\n.SH NAME\necorche \\- bones and muscles inside a human skin, and "
         "the skin moved by them\n"
         ".SH SYNOPSIS\n.B ecorche\n.I verb\n[\\fIoptions\\fR]\n.br\n.B ecorche help\n.I verb\n.SH "
         "DESCRIPTION\n" +
         troff(app.get_description()) +
         "\nData go to standard output, all else to standard error.\n.SH VERBS\n" + verbs +
         kExitStatus;
}

}  // namespace ecorche
