// The report of a run: timings, counts and quality figures under stable names (docs/report.md),
// written as JSON.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ecorche {

// Dotted names make objects: set("timings_ms.fit", 12.5) gives {"timings_ms": {"fit": 12.5}}. Order
// of first use is kept. Numbers that are not finite are written as null, so that a missing figure
// cannot pass for a good one.
class Report {
 public:
  Report();
  ~Report();
  Report(Report&&) noexcept;
  Report& operator=(Report&&) noexcept;

  void set(std::string_view name, double value);
  void set(std::string_view name, int value);
  void set(std::string_view name, const std::string& value);
  void set(std::string_view name, const char* value) { set(name, std::string(value)); }
  void set_flag(std::string_view name, bool value);
  void set_list(std::string_view name, const std::vector<double>& values);
  void append_text(std::string_view name, const std::string& value);  // to a list of strings
  double number(std::string_view name) const;                         // NaN where absent

  std::string to_json() const;
  std::string to_text() const;                          // a line a figure: "timings_ms.fit 12.5"
  void write(const std::filesystem::path& file) const;  // throws OutputError

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Writes the elapsed wall time to timings_ms.<name> when it goes out of scope.
class StageTimer {
 public:
  StageTimer(Report& report, std::string name)
      : report_(report), name_(std::move(name)), start_(std::chrono::steady_clock::now()) {}
  ~StageTimer() { report_.set("timings_ms." + name_, milliseconds()); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  Report& report_;
  std::string name_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace ecorche
