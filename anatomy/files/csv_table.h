// Tables, ours and other people's: CSV with a header row (RFC 4180 quoting, UTF-8 with or without
// byte order mark, any line ends), lines that start with # are remarks for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

class Table {
 public:
  // Throws InputError that names file and line: unreadable, UTF-16, unclosed quote, a row with
  // another number of cells than the header, two columns of one name; LimitError for what is larger
  // than limits::kTableBytes, kTableColumns.
  explicit Table(const std::filesystem::path& file);
  Table(std::string_view text, std::string name);  // `name` stands for the file in messages

  int rows() const { return int(lines_.size()); }
  const std::vector<std::string>& columns() const { return columns_; }
  bool has_column(std::string_view column) const;

  // The cell's text, without surrounding blanks. Throws InputError when the column is missing.
  std::string text(int row, std::string_view column) const;
  // The cell as a finite number. Throws InputError that names file, line, column and value.
  double number(int row, std::string_view column) const;
  double number_or(int row, std::string_view column, double if_empty) const;

  // "bones.csv:17", for messages about a row.
  std::string where(int row) const;

 private:
  // Cells are places in one text, so that a table takes no more than some times the memory of its
  // file.
  struct Cell {
    std::uint32_t begin = 0, size = 0;
  };

  void parse(std::string_view text);
  std::size_t parse_row(std::string_view text, std::size_t at, char end, int& line,
                        std::vector<Cell>& row);
  void add_row(const std::vector<Cell>& row, int line);
  std::string_view words(const Cell& cell) const {
    return std::string_view(text_).substr(cell.begin, cell.size);
  }
  int column_index(std::string_view column) const;

  std::string name_, text_;
  std::vector<std::string> columns_;
  std::map<std::string, int, std::less<>> index_;  // of columns by name
  std::vector<Cell> cells_;                        // row by row
  std::vector<int> lines_;                         // line of the file each row starts on
};

}  // namespace ecorche::inline v1
