#include "app/pages/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace ecorche {
namespace {

// The page's style sheet; a rule that needs several lines here is one line of the page.
constexpr const char* kStyle =
    "body { font: 16px/1.5 Georgia, serif; max-width: 1100px; margin: 2em auto; padding: 0 1em; "
    "color: #222; background: #faf8f4 }\n"
    "h1, h2 { font-weight: normal } h2 { margin-top: 2em; border-bottom: 1px solid #ccc }\n"
    "table { border-collapse: collapse; font: 14px/1.4 sans-serif; margin: 1em 0 } "
    "th, td { text-align: left; padding: .25em .9em .25em 0; border-bottom: 1px solid #ddd }\n"
    "figure { margin: 1.2em 0 } "
    "img, svg { max-width: 100%; background: #fff; border: 1px solid #ddd } "
    "figcaption { font: italic 14px Georgia, serif; color: #555 }\n"
    "svg text { font: 11px sans-serif } .grid { stroke: #e4e4e4 } "
    ".mark { stroke: #999; stroke-dasharray: 4 3 } .curve { fill: none; stroke-width: 1.6 }\n";

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t left = std::min<size_t>(3, bytes.size() - i);
    unsigned word = bytes[i] << 16;
    if (left > 1) word |= bytes[i + 1] << 8;
    if (left > 2) word |= bytes[i + 2];
    out += kDigits[word >> 18];
    out += kDigits[word >> 12 & 63];
    out += left > 1 ? kDigits[word >> 6 & 63] : '=';
    out += left > 2 ? kDigits[word & 63] : '=';
  }
  return out;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

// Distance of ticks: 1, 2 or 5 times a power of ten, for about `count` ticks.
double tick_step(const Range& range, int count) {
  const double raw = std::max(range.high - range.low, 1e-12) / count;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (double m : {1.0, 2.0, 5.0})
    if (m * power >= raw) return m * power;
  return 10 * power;
}

// Hues of Okabe and Ito's palette, which colour-blind readers tell apart.
constexpr std::array kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                              "#E69F00", "#56B4E9", "#000000", "#888888"};

constexpr double kWidth = 860, kHeight = 345, kLeft = 62, kRight = 190, kTop = 40, kBottom = 42;

struct Frame {
  Range x, y;
  double px(double v) const {
    return kLeft + (v - x.low) / (x.high - x.low) * (kWidth - kLeft - kRight);
  }
  double py(double v) const {
    return kHeight - kBottom - (v - y.low) / (y.high - y.low) * (kHeight - kTop - kBottom);
  }
};

Frame frame_of(const Plot& plot) {
  Frame frame;
  for (double v : plot.x) frame.x.include(v);
  for (const PlotSeries& series : plot.series)
    for (double v : series.y) frame.y.include(v);
  for (Range* range : {&frame.x, &frame.y}) {
    if (!(range->low <= range->high)) *range = {0, 1};
    if (range->high - range->low < 1e-12) range->low -= 0.5, range->high += 0.5;
  }
  const double pad = 0.05 * (frame.y.high - frame.y.low);
  frame.y.low -= pad, frame.y.high += pad;
  return frame;
}

std::string axes_svg(const Plot& plot, const Frame& frame) {
  std::string svg;
  const double sx = tick_step(frame.x, 8), sy = tick_step(frame.y, 6);
  for (double v = std::ceil(frame.x.low / sx) * sx; v <= frame.x.high + 1e-9 * sx; v += sx)
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' class='grid'/><text x='{0:.1f}' y='{3}' "
        "text-anchor='middle'>{4:.4g}</text>",
        frame.px(v), kTop, kHeight - kBottom, kHeight - kBottom + 16,
        std::abs(v) < 1e-9 * sx ? 0 : v);
  for (double v = std::ceil(frame.y.low / sy) * sy; v <= frame.y.high + 1e-9 * sy; v += sy)
    svg += fmt::format(
        "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' class='grid'/><text x='{3}' y='{4:.1f}' "
        "text-anchor='end'>{5:.4g}</text>",
        kLeft, kWidth - kRight, frame.py(v), kLeft - 6, frame.py(v) + 4,
        std::abs(v) < 1e-9 * sy ? 0 : v);
  // Labels of marks are above the plot, in several rows where they would overlap.
  constexpr double kLetter = 6.5, kRow = 12;  // px
  double end = -1e9;
  int row = 0;
  for (const auto& [at, word] : plot.marks) {
    const double x = frame.px(at);
    row = x < end ? (row + 1) % 3 : 0;
    end = std::max(x < end ? end : 0, x + kLetter * double(word.size()) + 6);
    const double y = kTop - 4 - kRow * (2 - row);
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1:.1f}' y2='{2}' class='mark'/><text x='{3:.1f}' "
        "y='{4:.1f}'>{5}</text>",
        x, y - 9, kHeight - kBottom, x + 3, y, escape(word));
  }
  svg += fmt::format("<text x='{}' y='{}' text-anchor='middle'>{}</text>",
                     (kLeft + kWidth - kRight) / 2, kHeight - 6, escape(plot.x_label));
  svg +=
      fmt::format("<text transform='translate(14 {}) rotate(-90)' text-anchor='middle'>{}</text>",
                  (kTop + kHeight - kBottom) / 2, escape(plot.y_label));
  return svg;
}

std::string curve_svg(const Plot& plot, const PlotSeries& series, const Frame& frame,
                      const char* colour) {
  std::string path;
  bool pen_down = false;
  for (size_t i = 0; i < std::min(plot.x.size(), series.y.size()); ++i) {
    if (!std::isfinite(series.y[i])) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", frame.px(plot.x[i]),
                        frame.py(series.y[i]));
    pen_down = true;
  }
  return fmt::format("<path d='{}' stroke='{}' class='curve'/>", path, colour);
}

}  // namespace

void HtmlPage::add_heading(const std::string& text) { body_ += "<h2>" + escape(text) + "</h2>\n"; }

void HtmlPage::add_paragraph(const std::string& text) { body_ += "<p>" + escape(text) + "</p>\n"; }

void HtmlPage::add_table(std::span<const std::string> header,
                         std::span<const std::vector<std::string>> rows) {
  body_ += "<table><tr>";
  for (const std::string& cell : header) body_ += "<th>" + escape(cell) + "</th>";
  body_ += "</tr>\n";
  for (const auto& row : rows) {
    body_ += "<tr>";
    for (const std::string& cell : row) body_ += "<td>" + escape(cell) + "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

void HtmlPage::add_picture(std::span<const unsigned char> png, const std::string& caption) {
  body_ += "<figure><img alt=\"" + escape(caption) + "\" src=\"data:image/png;base64," +
           base64(png) + "\"><figcaption>" + escape(caption) + "</figcaption></figure>\n";
}

void HtmlPage::add_plot(const Plot& plot) {
  const Frame frame = frame_of(plot);
  body_ += fmt::format("<figure><svg viewBox='0 0 {} {}' role='img'>", kWidth, kHeight);
  body_ += axes_svg(plot, frame);
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const char* colour = kColours[i % kColours.size()];
    body_ += curve_svg(plot, plot.series[i], frame, colour);
    body_ += fmt::format("<text x='{}' y='{}' fill='{}'>{}</text>", kWidth - kRight + 10,
                         kTop + 14 + 18 * int(i), colour, escape(plot.series[i].name));
  }
  body_ += "</svg><figcaption>" + escape(plot.title) + "</figcaption></figure>\n";
}

std::string HtmlPage::to_string() const {
  return "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width\">\n<title>" +
         escape(title_) + "</title>\n<style>\n" + kStyle + "</style>\n<h1>" + escape(title_) +
         "</h1>\n" + body_ + "</html>\n";
}

}  // namespace ecorche
