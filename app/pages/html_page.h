// A self-contained HTML page: text, tables, pictures (PNG, embedded) and line plots (SVG). All
// text is escaped.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ecorche {

struct PlotSeries {
  std::string name;
  std::vector<double> y;  // same length as Plot::x; NaN leaves a gap
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<double> x;
  std::vector<PlotSeries> series;
  std::vector<std::pair<double, std::string>>
      marks;  // x position and word: events such as the take-off
};

class HtmlPage {
 public:
  explicit HtmlPage(std::string title) : title_(std::move(title)) {}

  void add_heading(const std::string& text);
  void add_paragraph(const std::string& text);
  void add_table(std::span<const std::string> header,
                 std::span<const std::vector<std::string>> rows);
  void add_picture(std::span<const unsigned char> png, const std::string& caption);
  void add_plot(const Plot& plot);

  std::string to_string() const;

 private:
  std::string title_, body_;
};

}  // namespace ecorche
