#include "app/options/option_values.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/similar_names.h"

namespace ecorche {

CLI::Validator between(double low, double high) {
  const std::string range = fmt::format("{} to {}", low, high);
  return CLI::Validator(
      [low, high, range](std::string& text) -> std::string {
        double value = 0;
        const std::string_view digits =
            std::string_view(text).substr(text.starts_with('+') ? 1 : 0);
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size())
          return fmt::format("{} is no number; give one from {}", printable(text), range);
        if (!(value >= low && value <= high))
          return fmt::format("{} is out of range; give a number from {}", printable(text), range);
        return {};
      },
      fmt::format("[{} - {}]", low, high), "between");
}

CLI::Validator one_of(std::vector<std::string> names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ",") + name;
  return CLI::Validator(
      [names, all](std::string& text) -> std::string {
        for (const std::string& name : names)
          if (text == name) return {};
        return fmt::format("{} is none of {}{}", printable(text), all, did_you_mean(text, names));
      },
      "{" + all + "}", "one_of");
}

namespace {

// CLI11 turns ValidationError into its own message; the option's name is in ours already.
CLI::Option* add_quantity(CLI::App& verb, const std::string& name, const std::string& unit,
                          const std::string& help, std::function<void(const std::string&)> read) {
  return verb
      .add_option_function<std::string>(
          name,
          [read = std::move(read)](const std::string& text) {
            try {
              read(text);
            } catch (const UsageError& e) {
              throw CLI::ValidationError(e.what());
            }
          },
          help)
      ->type_name(unit);
}

}  // namespace

CLI::Option* add_length(CLI::App& verb, const std::string& name, double& metres,
                        const LengthRange& possible, const LengthRange& usual,
                        const std::string& help) {
  return add_quantity(verb, name, "LENGTH", help,
                      [&metres, name, possible, usual](const std::string& text) {
                        metres = parse_length(text, name, possible, usual);
                      });
}

CLI::Option* add_mass(CLI::App& verb, const std::string& name, double& kilograms, double low,
                      double high, const std::string& help) {
  return add_quantity(verb, name, "MASS", help,
                      [&kilograms, name, low, high](const std::string& text) {
                        kilograms = parse_mass(text, name, low, high);
                      });
}

}  // namespace ecorche
