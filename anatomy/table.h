// Our own tables: CSV with a header row (RFC 4180 quoting, UTF-8), lines that start with # are remarks for people.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche {

class Table {
 public:
  // Throws InputError that names file and line: unreadable, unclosed quote, a row with another number of cells than the
  // header, two columns of one name.
  explicit Table(const std::filesystem::path& file);
  Table(std::string_view text, std::string name);  // `name` stands for the file in messages

  int rows() const { return static_cast<int>(cells_.size()); }
  bool has_column(std::string_view column) const;

  // The cell's text, without surrounding blanks. Throws InputError when the column is missing.
  const std::string& text(int row, std::string_view column) const;
  // The cell as a finite number. Throws InputError that names file, line, column and value.
  double number(int row, std::string_view column) const;
  double number_or(int row, std::string_view column, double if_empty) const;

  // "bones.csv:17", for messages about a row.
  std::string where(int row) const;

 private:
  void parse(std::string_view text);
  int column_index(std::string_view column) const;

  std::string name_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> cells_;
  std::vector<int> lines_;  // line of the file each row starts on
};

}  // namespace ecorche
