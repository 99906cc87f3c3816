#include "anatomy/files/csv_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {

Table::Table(const std::filesystem::path& file) : name_(printable(file.filename().string())) {
  parse(read_input_file(file, limits::kTableBytes));
}

Table::Table(std::string_view text, std::string name) : name_(std::move(name)) {
  if (text.size() > limits::kTableBytes)
    throw LimitError(
        fmt::format("{}: {} bytes; the limit is {}", name_, text.size(), limits::kTableBytes));
  parse(text);
}

// The cells of the row that begins at `at`, their text appended to ours; where the next one begins.
std::size_t Table::parse_row(std::string_view text, std::size_t at, char end, int& line,
                             std::vector<Cell>& row) {
  const int first_line = line;
  row.assign(1, {std::uint32_t(text_.size()), 0});
  bool quoted = false;
  const auto close = [&] {  // without surrounding blanks
    Cell& cell = row.back();
    const std::string_view all = std::string_view(text_).substr(cell.begin), blank = " \t\r";
    const auto first = all.find_first_not_of(blank);
    if (first == std::string_view::npos) return;
    cell.size = std::uint32_t(all.find_last_not_of(blank) + 1 - first);
    cell.begin += std::uint32_t(first);
  };
  for (bool ended = false; !ended && at < text.size(); ++at) {
    const char c = text[at];
    line += c == end;
    if (quoted && c == '"' && at + 1 < text.size() && text[at + 1] == '"') {
      text_ += text[++at];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      close();
      row.push_back({std::uint32_t(text_.size()), 0});
    } else if (!quoted && c == end) {
      ended = true;
    } else {
      text_ += c;
    }
  }
  if (quoted) throw InputError(fmt::format("{}:{}: a quoted cell does not end", name_, first_line));
  close();
  return at;
}

void Table::add_row(const std::vector<Cell>& row, int line) {
  if (row.size() == 1 && row.front().size == 0) return;
  if (columns_.empty()) {
    if (row.size() > limits::kTableColumns)
      throw LimitError(fmt::format("{}:{}: {} columns; the limit is {}", name_, line, row.size(),
                                   limits::kTableColumns));
    for (const Cell& cell : row) {
      columns_.push_back(printable(words(cell)));
      if (!index_.emplace(columns_.back(), int(index_.size())).second)
        throw InputError(fmt::format("{}:{}: two columns are called '{}'", name_, line,
                                     columns_.back().substr(0, 80)));
    }
    return;
  }
  if (row.size() != columns_.size())
    throw InputError(fmt::format("{}:{}: {} cells; the header has {}", name_, line, row.size(),
                                 columns_.size()));
  cells_.insert(cells_.end(), row.begin(), row.end());
  lines_.push_back(line);
}

void Table::parse(std::string_view text) {
  text = unmarked_text(text, name_);
  const char end = line_end(text);
  int line = 1;
  std::vector<Cell> row;
  for (std::size_t at = 0; at < text.size();) {
    const int first_line = line;
    if (text[at] == '#') {
      at = std::min(text.find(end, at), text.size() - 1) + 1;
      ++line;
      continue;
    }
    at = parse_row(text, at, end, line, row);
    add_row(row, first_line);
  }
  if (columns_.empty()) throw InputError(fmt::format("{}: no header row", name_));
}

int Table::column_index(std::string_view column) const {
  const auto found = index_.find(column);
  return found == index_.end() ? -1 : found->second;
}

bool Table::has_column(std::string_view column) const { return column_index(column) >= 0; }

std::string Table::text(int row, std::string_view column) const {
  const int index = column_index(column);
  if (index < 0)
    throw InputError(
        fmt::format("{}: no column '{}'; it has {}", name_, column,
                    printable(fmt::format("{}", fmt::join(columns_, ", ")).substr(0, 200))));
  const std::string_view found =
      words(cells_.at(std::size_t(row) * columns_.size() + std::size_t(index)));
  return is_utf8(found) ? std::string(found) : printable(found);
}

double Table::number(int row, std::string_view column) const {
  const std::string cell = text(row, column);
  double value = 0;
  if (!parse_number(cell, value))
    throw InputError(fmt::format("{}: column '{}': '{}' is not a number", where(row), column,
                                 cell.substr(0, 80)));
  return value;
}

double Table::number_or(int row, std::string_view column, double if_empty) const {
  return text(row, column).empty() ? if_empty : number(row, column);
}

std::string Table::where(int row) const { return fmt::format("{}:{}", name_, lines_.at(row)); }

}  // namespace ecorche::inline v1
