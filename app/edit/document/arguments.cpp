#include "app/edit/document/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/errors.h"
#include "anatomy/files/similar_names.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche {
namespace {

struct UnitWord {
  const char* word;
  ArgumentUnit of;
  double factor;  // of the word in `of`
};
constexpr std::array kUnitWords{UnitWord{"mm", ArgumentUnit::millimetre, 1},
                                UnitWord{"cm", ArgumentUnit::millimetre, 10},
                                UnitWord{"m", ArgumentUnit::millimetre, 1000},
                                UnitWord{"mm", ArgumentUnit::centimetre, 0.1},
                                UnitWord{"cm", ArgumentUnit::centimetre, 1},
                                UnitWord{"m", ArgumentUnit::centimetre, 100},
                                UnitWord{"mm", ArgumentUnit::metre, 0.001},
                                UnitWord{"cm", ArgumentUnit::metre, 0.01},
                                UnitWord{"m", ArgumentUnit::metre, 1},
                                UnitWord{"deg", ArgumentUnit::degree, 1},
                                UnitWord{"rad", ArgumentUnit::degree, 180 / 3.14159265358979323846},
                                UnitWord{"ml", ArgumentUnit::millilitre, 1},
                                UnitWord{"cm3", ArgumentUnit::millilitre, 1},
                                UnitWord{"l", ArgumentUnit::millilitre, 1000},
                                UnitWord{"N", ArgumentUnit::newton, 1},
                                UnitWord{"kN", ArgumentUnit::newton, 1000},
                                UnitWord{"s", ArgumentUnit::second, 1},
                                UnitWord{"ms", ArgumentUnit::second, 0.001}};

[[noreturn]] void fail_argument(const char* key, const std::string& value,
                                const std::string& expected) {
  throw InputError(fmt::format("argument '{}': '{}': expected {}", key, value, expected));
}

// "12", "12mm", "1.2 cm": in `unit`. False where it is none.
bool read_number(std::string_view text, ArgumentUnit unit, double& value) {
  const auto end = text.find_last_of("0123456789.");
  if (end == std::string_view::npos) return false;
  std::string_view word = text.substr(end + 1);
  double factor = 1;
  if (text.ends_with("cm3")) word = "cm3";
  std::string_view digits = text.substr(0, text.size() - word.size());
  if (!word.empty()) {
    const auto known = std::ranges::find_if(
        kUnitWords, [&](const UnitWord& each) { return each.of == unit && word == each.word; });
    if (known == kUnitWords.end()) return false;
    factor = known->factor;
  }
  if (!parse_number(digits, value)) return false;
  value *= factor;
  return true;
}

std::string expected_number(const NumberRange& range) {
  std::string out = "a number";
  if (range.unit != ArgumentUnit::none) out += fmt::format(" of {}", unit_name(range.unit));
  const double most = std::numeric_limits<double>::max();
  if (range.low > -most && range.high < most)
    out += fmt::format(" within {:g} .. {:g}", range.low, range.high);
  return out;
}

double number_of(const char* key, const std::string& text, const NumberRange& range) {
  double value = 0;
  if (!read_number(text, range.unit, value) || value < range.low || value > range.high)
    fail_argument(key, text, expected_number(range));
  return value;
}

std::string vector_text(const Vec3& value) {
  return fmt::format("{},{},{}", value.x() + 0.0, value.y() + 0.0, value.z() + 0.0);
}

}  // namespace

const char* unit_name(ArgumentUnit unit) {
  switch (unit) {
    case ArgumentUnit::millimetre:
      return "mm";
    case ArgumentUnit::centimetre:
      return "cm";
    case ArgumentUnit::metre:
      return "m";
    case ArgumentUnit::degree:
      return "deg";
    case ArgumentUnit::millilitre:
      return "ml";
    case ArgumentUnit::newton:
      return "N";
    case ArgumentUnit::second:
      return "s";
    case ArgumentUnit::none:
      break;
  }
  return "";
}

ArgumentReader::ArgumentReader(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      bare_.push_back(word);
    else if (!named_.emplace(word.substr(0, equals), word.substr(equals + 1)).second)
      throw InputError(fmt::format("argument '{}' is given twice", word.substr(0, equals)));
  }
}

std::optional<std::string> ArgumentReader::take(const char* key, Need need, const char* help) {
  known_.push_back(key);
  if (const auto found = named_.find(key); found != named_.end()) {
    std::string value = std::move(found->second);
    named_.erase(found);
    if (value.empty()) fail_argument(key, value, help);
    return value;
  }
  if (next_ < bare_.size()) return bare_[next_++];
  if (need == Need::required) {
    std::vector<std::string> left;
    for (const auto& [name, value] : named_) left.push_back(name);
    if (const auto near = similar_names(key, left); !near.empty())
      throw InputError(
          fmt::format("argument '{}': '{}': there is none of that name; did you mean {}?",
                      near.front(), named_.at(near.front()), key));
    throw InputError(fmt::format("argument '{}' is missing: {}", key, help));
  }
  return std::nullopt;
}

void ArgumentReader::text(const char* key, const char*, std::string& value, Need need,
                          const char* help) {
  if (auto word = take(key, need, help)) value = std::move(*word);
}

void ArgumentReader::choice(const char* key, std::string& value,
                            std::initializer_list<const char*> words, Need need, const char* help) {
  const auto word = take(key, need, help);
  if (!word) return;
  std::vector<std::string> all(words.begin(), words.end());
  if (std::ranges::find(all, *word) == all.end())
    fail_argument(key, *word,
                  fmt::format("one of {}{}", fmt::join(all, ", "), did_you_mean(*word, all)));
  value = *word;
}

void ArgumentReader::number(const char* key, double& value, const NumberRange& range, Need need,
                            const char* help) {
  if (const auto word = take(key, need, help)) value = number_of(key, *word, range);
}

void ArgumentReader::number(const char* key, std::optional<double>& value, const NumberRange& range,
                            const char* help) {
  if (const auto word = take(key, Need::optional, help)) value = number_of(key, *word, range);
}

void ArgumentReader::whole(const char* key, int& value, int low, int high, Need need,
                           const char* help) {
  const auto word = take(key, need, help);
  if (!word) return;
  long long number = 0;
  if (!parse_whole(*word, number) || number < low || number > high)
    fail_argument(key, *word, fmt::format("a whole number within {} .. {}", low, high));
  value = int(number);
}

void ArgumentReader::vector(const char* key, Vec3& value, ArgumentUnit unit, Need need,
                            const char* help) {
  const auto word = take(key, need, help);
  if (!word) return;
  std::string_view rest = *word;
  for (int k = 0; k < 3; ++k) {
    const auto comma = rest.find(',');
    if ((comma == std::string_view::npos) != (k == 2) ||
        !read_number(rest.substr(0, comma), unit, value[k]))
      fail_argument(key, *word,
                    fmt::format("left,up,front: three numbers{}{}, no blanks between",
                                unit == ArgumentUnit::none ? "" : " of ", unit_name(unit)));
    if (k < 2) rest.remove_prefix(comma + 1);
  }
}

void ArgumentReader::end() const {
  if (!named_.empty()) {
    const auto& [key, value] = *named_.begin();
    throw InputError(fmt::format("argument '{}': '{}': there is none of that name{}; there are {}",
                                 key, value, did_you_mean(key, known_), fmt::join(known_, ", ")));
  }
  if (next_ < bare_.size())
    throw InputError(fmt::format("'{}': one value too many; the arguments are {}", bare_[next_],
                                 fmt::join(known_, ", ")));
}

void ArgumentWriter::add(const char* key, const std::string& value, Need need) {
  values_[key] = value;
  const auto before = before_.find(key);
  if (need == Need::required || before == before_.end() || before->second != value)
    line_ += fmt::format(" {}", quoted(fmt::format("{}={}", key, value)));
}

void ArgumentWriter::text(const char* key, const char*, std::string& value, Need need,
                          const char*) {
  if (!value.empty()) add(key, value, need);
}
void ArgumentWriter::choice(const char* key, std::string& value, std::initializer_list<const char*>,
                            Need need, const char*) {
  if (!value.empty()) add(key, value, need);
}
void ArgumentWriter::number(const char* key, double& value, const NumberRange&, Need need,
                            const char*) {
  add(key, fmt::format("{}", value), need);
}
void ArgumentWriter::number(const char* key, std::optional<double>& value, const NumberRange&,
                            const char*) {
  if (value) add(key, fmt::format("{}", *value), Need::required);
}
void ArgumentWriter::whole(const char* key, int& value, int, int, Need need, const char*) {
  add(key, fmt::format("{}", value), need);
}
void ArgumentWriter::vector(const char* key, Vec3& value, ArgumentUnit, Need need, const char*) {
  add(key, vector_text(value), need);
}

void ArgumentLister::text(const char* key, const char* kind, std::string&, Need need,
                          const char* help) {
  list_.push_back({key, kind, help, ArgumentUnit::none, {}, need == Need::required});
}
void ArgumentLister::choice(const char* key, std::string&, std::initializer_list<const char*> words,
                            Need need, const char* help) {
  list_.push_back({key,
                   "word",
                   help,
                   ArgumentUnit::none,
                   {words.begin(), words.end()},
                   need == Need::required});
}
void ArgumentLister::number(const char* key, double&, const NumberRange& range, Need need,
                            const char* help) {
  list_.push_back({key, "number", help, range.unit, {}, need == Need::required});
}
void ArgumentLister::number(const char* key, std::optional<double>&, const NumberRange& range,
                            const char* help) {
  list_.push_back({key, "number", help, range.unit, {}, false});
}
void ArgumentLister::whole(const char* key, int&, int, int, Need need, const char* help) {
  list_.push_back({key, "whole number", help, ArgumentUnit::none, {}, need == Need::required});
}
void ArgumentLister::vector(const char* key, Vec3&, ArgumentUnit unit, Need need,
                            const char* help) {
  list_.push_back({key, "left,up,front", help, unit, {}, need == Need::required});
}

std::vector<std::string> split_words(std::string_view line) {
  std::vector<std::string> out;
  bool inside = false, begun = false;
  std::string word;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      inside = !inside;
      begun = true;
    } else if (inside && c == '\\' && i + 1 < line.size()) {
      word += line[++i];
    } else if (!inside && (c == ' ' || c == '\t' || c == '\r')) {
      if (begun) out.push_back(std::move(word));
      word.clear();
      begun = false;
    } else if (!inside && c == '#' && !begun) {
      return out;
    } else {
      word += c;
      begun = true;
    }
  }
  if (inside) throw InputError("a quotation that does not end; close it with \"");
  if (begun) out.push_back(std::move(word));
  return out;
}

std::string quoted(const std::string& word) {
  if (word.find_first_of(" \t\"#\\") == std::string::npos && !word.empty()) return word;
  std::string out = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

}  // namespace ecorche
