// The arguments of actions, described once: the same description reads them from a script, writes
// them as a line of one, and lists them with units and help.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

// Of numbers in actions and scripts; a script may say another unit of the same kind behind the
// number.
enum class ArgumentUnit { none, millimetre, centimetre, metre, degree, millilitre, newton, second };
const char* unit_name(ArgumentUnit unit);  // "mm"; "" for none

enum class Need { required, optional };

struct NumberRange {
  ArgumentUnit unit = ArgumentUnit::none;
  double low = -std::numeric_limits<double>::max(), high = std::numeric_limits<double>::max();
};

// What an action does with each of its arguments, in their order.
class Arguments {
 public:
  Arguments() = default;
  virtual ~Arguments() = default;
  Arguments(const Arguments&) = delete;
  Arguments& operator=(const Arguments&) = delete;

  // `kind`: "muscle", "point", "joint", "file", "words", ...
  virtual void text(const char* key, const char* kind, std::string& value, Need need,
                    const char* help) = 0;
  virtual void choice(const char* key, std::string& value, std::initializer_list<const char*> words,
                      Need need, const char* help) = 0;
  virtual void number(const char* key, double& value, const NumberRange& range, Need need,
                      const char* help) = 0;
  // Stays as it is where it is left out.
  virtual void number(const char* key, std::optional<double>& value, const NumberRange& range,
                      const char* help) = 0;
  virtual void whole(const char* key, int& value, int low, int high, Need need,
                     const char* help) = 0;
  // To the left, up, to the front.
  virtual void vector(const char* key, Vec3& value, ArgumentUnit unit, Need need,
                      const char* help) = 0;
};

// Words of a line: `key=value`, or values alone, which fill what is not named in the order of the
// arguments. Every call throws InputError that names argument, value, and what is expected.
class ArgumentReader : public Arguments {
 public:
  explicit ArgumentReader(const std::vector<std::string>& words);
  void text(const char* key, const char* kind, std::string& value, Need need,
            const char* help) override;
  void choice(const char* key, std::string& value, std::initializer_list<const char*> words,
              Need need, const char* help) override;
  void number(const char* key, double& value, const NumberRange& range, Need need,
              const char* help) override;
  void number(const char* key, std::optional<double>& value, const NumberRange& range,
              const char* help) override;
  void whole(const char* key, int& value, int low, int high, Need need, const char* help) override;
  void vector(const char* key, Vec3& value, ArgumentUnit unit, Need need,
              const char* help) override;
  // Throws InputError for words that no argument has taken.
  void end() const;

 private:
  std::optional<std::string> take(const char* key, Need need, const char* help);

  std::map<std::string, std::string> named_;
  std::vector<std::string> bare_;
  std::size_t next_ = 0;  // of bare_
  std::vector<std::string> known_;
};

// `key=value` of all arguments that are required or not as `before` has them.
class ArgumentWriter : public Arguments {
 public:
  // `before`: what a fresh action writes; empty: all is written
  explicit ArgumentWriter(std::map<std::string, std::string> before = {})
      : before_(std::move(before)) {}
  void text(const char* key, const char* kind, std::string& value, Need need,
            const char* help) override;
  void choice(const char* key, std::string& value, std::initializer_list<const char*> words,
              Need need, const char* help) override;
  void number(const char* key, double& value, const NumberRange& range, Need need,
              const char* help) override;
  void number(const char* key, std::optional<double>& value, const NumberRange& range,
              const char* help) override;
  void whole(const char* key, int& value, int low, int high, Need need, const char* help) override;
  void vector(const char* key, Vec3& value, ArgumentUnit unit, Need need,
              const char* help) override;

  const std::map<std::string, std::string>& values() const { return values_; }
  const std::string& line() const { return line_; }  // " key=value key=value"

 private:
  void add(const char* key, const std::string& value, Need need);

  std::map<std::string, std::string> before_, values_;
  std::string line_;
};

struct ArgumentInfo {
  std::string key, kind, help;
  ArgumentUnit unit = ArgumentUnit::none;
  std::vector<std::string> words;  // to choose from
  bool required = false;
};

class ArgumentLister : public Arguments {
 public:
  void text(const char* key, const char* kind, std::string& value, Need need,
            const char* help) override;
  void choice(const char* key, std::string& value, std::initializer_list<const char*> words,
              Need need, const char* help) override;
  void number(const char* key, double& value, const NumberRange& range, Need need,
              const char* help) override;
  void number(const char* key, std::optional<double>& value, const NumberRange& range,
              const char* help) override;
  void whole(const char* key, int& value, int low, int high, Need need, const char* help) override;
  void vector(const char* key, Vec3& value, ArgumentUnit unit, Need need,
              const char* help) override;
  const std::vector<ArgumentInfo>& list() const { return list_; }

 private:
  std::vector<ArgumentInfo> list_;
};

// Words of a script's line, blanks between them; "..." holds some together, # starts a remark.
// Throws InputError for a quotation that does not end.
std::vector<std::string> split_words(std::string_view line);
std::string quoted(const std::string& word);  // as split_words() takes it back

}  // namespace ecorche
