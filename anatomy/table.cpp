#include "anatomy/table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {

namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

}  // namespace

Table::Table(const std::filesystem::path& file) : name_(file.filename().string()) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file.string()));
  parse(std::string(std::istreambuf_iterator<char>(in), {}));
}

Table::Table(std::string_view text, std::string name) : name_(std::move(name)) { parse(text); }

void Table::parse(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  int line = 1;
  std::size_t at = 0;
  while (at < text.size()) {
    const int first_line = line;
    if (text[at] == '#') {
      at = std::min(text.find('\n', at), text.size() - 1) + 1;
      ++line;
      continue;
    }
    std::vector<std::string> row(1);
    bool quoted = false;
    for (bool ended = false; !ended && at < text.size(); ++at) {
      const char c = text[at];
      line += c == '\n';
      if (quoted) {
        if (c != '"') {
          row.back() += c;
        } else if (at + 1 < text.size() && text[at + 1] == '"') {
          row.back() += text[++at];
        } else {
          quoted = false;
        }
      } else if (c == '"') {
        quoted = true;
      } else if (c == ',') {
        row.emplace_back();
      } else if (c == '\n') {
        ended = true;
      } else {
        row.back() += c;
      }
    }
    if (quoted) throw InputError(fmt::format("{}:{}: a quoted cell does not end", name_, first_line));
    for (std::string& cell : row) cell = trimmed(cell);
    if (row.size() == 1 && row.front().empty()) continue;
    if (columns_.empty()) {
      columns_ = row;
      std::sort(row.begin(), row.end());
      if (const auto twice = std::adjacent_find(row.begin(), row.end()); twice != row.end()) {
        throw InputError(fmt::format("{}:{}: two columns are called '{}'", name_, first_line, *twice));
      }
      continue;
    }
    if (row.size() != columns_.size()) {
      throw InputError(fmt::format("{}:{}: {} cells; the header has {}", name_, first_line, row.size(), columns_.size()));
    }
    cells_.push_back(std::move(row));
    lines_.push_back(first_line);
  }
  if (columns_.empty()) throw InputError(fmt::format("{}: no header row", name_));
}

int Table::column_index(std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  return found == columns_.end() ? -1 : static_cast<int>(found - columns_.begin());
}

bool Table::has_column(std::string_view column) const { return column_index(column) >= 0; }

const std::string& Table::text(int row, std::string_view column) const {
  const int index = column_index(column);
  if (index < 0) throw InputError(fmt::format("{}: no column '{}'", name_, column));
  return cells_.at(static_cast<std::size_t>(row))[static_cast<std::size_t>(index)];
}

double Table::number(int row, std::string_view column) const {
  const std::string& cell = text(row, column);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    throw InputError(fmt::format("{}: column '{}': '{}' is not a number", where(row), column, cell));
  }
  return value;
}

double Table::number_or(int row, std::string_view column, double if_empty) const {
  return text(row, column).empty() ? if_empty : number(row, column);
}

std::string Table::where(int row) const { return fmt::format("{}:{}", name_, lines_.at(static_cast<std::size_t>(row))); }

}  // namespace ecorche
