// Numbers and words out of text files, line by line, with errors that say file and line.
//
// Independent of the locale. Understands LF, CRLF and CR, skips a UTF-8 byte order mark, refuses
// UTF-16.
#pragma once

#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// The text without its byte order mark. Throws InputError that names UTF-16, with or without a
// mark.
std::string_view unmarked_text(std::string_view text, const std::string& name);

// What lines of a text end with: '\r' where it has no '\n' at all, as files from old spreadsheets;
// else '\n', which a '\r' may precede.
char line_end(std::string_view text);

class TextScan {
 public:
  // `name` is what messages call the text. The text must outlive the scan. Throws InputError for
  // UTF-16 text.
  TextScan(std::string_view text, std::string name);
  // With the end of lines told: for a text that bytes follow.
  TextScan(std::string_view text, std::string name, char end);

  // Moves to the next line; false at the end of the text.
  bool next_line();

  std::string_view line() const { return line_; }
  int line_number() const { return number_; }

  // The next word of the line; empty at its end.
  std::string_view word();
  bool at_line_end();

  // The next word as a number; throws InputError when it is missing, not a number, not finite or
  // (whole) out of range.
  double number(std::string_view what);
  long long whole(std::string_view what, long long low, long long high);

  // Throws InputError "name:line: message".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view rest_, line_, tail_;
  std::string name_;
  int number_ = 0;
  char end_ = '\n';
};

// The whole word as a finite number. False when it is anything else.
bool parse_number(std::string_view word, double& value);
bool parse_whole(std::string_view word, long long& value);

}  // namespace ecorche::inline v1
