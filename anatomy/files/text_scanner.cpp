#include "anatomy/files/text_scanner.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

// What a message may show of a word from a file: short, and printable whatever the file holds.
std::string shown(std::string_view word) {
  std::string out;
  for (char c : word.substr(0, 40)) out += (c >= 0x20 && c < 0x7f) ? c : '?';
  return word.size() > 40 ? out + "..." : out;
}

}  // namespace

bool parse_number(std::string_view word, double& value) {
  word = without_plus(word);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return false;
  // from_chars leaves the value alone; a denormal may count as zero
  if (error == std::errc::result_out_of_range) {
    const auto e = word.find_first_of("eE");
    if (e == std::string_view::npos || e + 1 >= word.size() || word[e + 1] != '-') return false;
    value = 0;
    return true;
  }
  return error == std::errc() && std::isfinite(value);
}

bool parse_whole(std::string_view word, long long& value) {
  word = without_plus(word);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && !word.empty() && end == word.data() + word.size();
}

std::string_view unmarked_text(std::string_view text, const std::string& name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const bool marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
  const auto half = [text](std::size_t unit) {
    return (text[2 * unit] == '\0') - (text[2 * unit + 1] == '\0');
  };  // which of its bytes is 0
  const bool wide = text.size() > 3 && half(0) != 0 && half(0) == half(1);
  if (marked || wide) throw InputError(name + ": the text is UTF-16; save it as UTF-8");
  return text;
}

char line_end(std::string_view text) {
  return text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos
             ? '\r'
             : '\n';
}

TextScan::TextScan(std::string_view text, std::string name)
    : rest_(unmarked_text(text, name)), name_(std::move(name)), end_(line_end(rest_)) {}

TextScan::TextScan(std::string_view text, std::string name, char end)
    : rest_(text), name_(std::move(name)), end_(end) {}

bool TextScan::next_line() {
  if (rest_.empty()) return false;
  const auto end = rest_.find(end_);
  line_ = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  tail_ = line_;
  ++number_;
  return true;
}

std::string_view TextScan::word() {
  std::size_t begin = 0;
  while (begin < tail_.size() && is_space(tail_[begin])) ++begin;
  std::size_t end = begin;
  while (end < tail_.size() && !is_space(tail_[end])) ++end;
  const auto found = tail_.substr(begin, end - begin);
  tail_.remove_prefix(end);
  return found;
}

bool TextScan::at_line_end() {
  std::size_t begin = 0;
  while (begin < tail_.size() && is_space(tail_[begin])) ++begin;
  return begin == tail_.size();
}

double TextScan::number(std::string_view what) {
  const auto found = word();
  double value = 0;
  if (found.empty()) fail(fmt::format("{} is missing", what));
  if (!parse_number(found, value))
    fail(fmt::format("{} '{}' is not a finite number", what, shown(found)));
  return value;
}

long long TextScan::whole(std::string_view what, long long low, long long high) {
  const auto found = word();
  long long value = 0;
  if (found.empty()) fail(fmt::format("{} is missing", what));
  if (!parse_whole(found, value))
    fail(fmt::format("{} '{}' is not a whole number", what, shown(found)));
  if (value < low || value > high)
    fail(fmt::format("{} {} is not in {} .. {}", what, value, low, high));
  return value;
}

void TextScan::fail(const std::string& message) const {
  throw InputError(fmt::format("{}:{}: {}", name_, number_, message));
}

}  // namespace ecorche::inline v1
