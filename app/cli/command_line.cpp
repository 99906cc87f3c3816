#include "app/cli/command_line.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/files/input_file.h"
#include "anatomy/files/similar_names.h"

namespace ecorche {
namespace {

const CLI::App* find_verb(const CLI::App& app, const std::string& name) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (verb->get_name() == name) return verb;
  return nullptr;
}

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> out;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    out.push_back(verb->get_name());
  return out;
}

// "-o" and "--output" of every option, and "--help".
std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> out;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_snames()) out.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
  }
  return out;
}

bool looks_like_number(const std::string& word) {
  return word.size() > 1 && (std::isdigit(static_cast<unsigned char>(word[1])) || word[1] == '.');
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !looks_like_number(word);
}

// "ecorche body new"
std::string command_of(const std::vector<const CLI::App*>& verbs) {
  std::string out = "ecorche";
  for (const CLI::App* verb : verbs) out += " " + verb->get_name();
  return out;
}

const CLI::Option* find_option(const CLI::App& verb, const std::string& word) {
  return verb.get_option_no_throw(word.substr(0, word.find('=')));
}

// -qv: every letter a flag of its own, or the first an option and the rest its value (-ofile).
bool is_known(const CLI::App& verb, const std::string& word) {
  if (word[1] == '-') return find_option(verb, word) != nullptr;
  for (std::size_t i = 1; i < word.size(); ++i) {
    const CLI::Option* option = verb.get_option_no_throw(std::string{'-', word[i]});
    if (!option) return false;
    if (option->get_items_expected_max() > 0) return true;
  }
  return true;
}

// Values that follow an option in words of their own.
std::size_t values_of(const CLI::Option& option, const std::string& word) {
  const bool joined = word[1] == '-' ? word.find('=') != std::string::npos : word.size() > 2;
  return joined ? 0 : std::size_t(std::max(0, option.get_items_expected_min()));
}

std::string unknown_option(const std::vector<const CLI::App*>& verbs, const CLI::App& verb,
                           const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  return fmt::format("{} has no option {}{}\nRun `{} --help` for its options.", command_of(verbs),
                     printable(name), did_you_mean(name, option_names(verb)), command_of(verbs));
}

std::string list(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

}  // namespace

std::vector<std::string> read_command_line(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty()) return words;
  if (words[0] == "-V") words[0] = "--version";
  if (words[0] == "help") {
    words.erase(words.begin());
    words.push_back("--help");
  }
  return words;
}

std::vector<const CLI::App*> named_verbs(const CLI::App& app,
                                         const std::vector<std::string>& words) {
  std::vector<const CLI::App*> out;
  const CLI::App* at = &app;
  for (const std::string& word : words) {
    const CLI::App* verb = is_option(word) ? nullptr : find_verb(*at, word);
    if (!verb) break;
    out.push_back(verb);
    at = verb;
  }
  return out;
}

std::optional<std::string> unknown_word(const CLI::App& app,
                                        const std::vector<std::string>& words) {
  const std::vector<const CLI::App*> verbs = named_verbs(app, words);
  const CLI::App& verb = verbs.empty() ? app : *verbs.back();
  const bool group = !verb_names(verb).empty();
  for (std::size_t i = verbs.size(); i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") break;
    if (!is_option(word)) {
      if (!group) continue;
      return fmt::format("{} is no verb of {}{}\nThere are: {}.", printable(word),
                         command_of(verbs), did_you_mean(word, verb_names(verb)),
                         list(verb_names(verb)));
    }
    if (!is_known(verb, word)) {
      if (group && verbs.empty() && word != "-v" && word != "-q")
        return unknown_option(verbs, verb, word);
      if (group)
        return fmt::format("{} belongs to a verb; name the verb first. There are: {}.",
                           printable(word), list(verb_names(verb)));
      return unknown_option(verbs, verb, word);
    }
    if (const CLI::Option* option = find_option(verb, word[1] == '-' ? word : word.substr(0, 2)))
      i += values_of(*option, word);
  }
  return std::nullopt;
}

std::string describe_parse_error(const CLI::App& app, const std::vector<std::string>& words,
                                 const CLI::ParseError& error) {
  const std::vector<const CLI::App*> verbs = named_verbs(app, words);
  const CLI::App& verb = verbs.empty() ? app : *verbs.back();
  if (const std::vector<std::string> below = verb_names(verb);
      !below.empty() && words.size() == verbs.size())
    return fmt::format("{}: name one of its verbs: {}.\nRun `{} --help` for what they do.",
                       command_of(verbs), list(below), command_of(verbs));
  return fmt::format("{}\nRun `{} --help` for its options.", error.what(), command_of(verbs));
}

}  // namespace ecorche
