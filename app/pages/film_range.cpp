#include "app/pages/film_range.h"

#include <fmt/format.h>

#include <charconv>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

// Takes a positive whole number off the front of `text`; nothing if there is none.
std::optional<int> take_number(std::string_view& text) {
  int number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || number < 1) return std::nullopt;
  text.remove_prefix(std::size_t(end - text.data()));
  return number;
}

bool take(char letter, std::string_view& text) {
  if (!text.starts_with(letter)) return false;
  text.remove_prefix(1);
  return true;
}

double duration(const Motion& motion) { return double(motion.frames.size() - 1) / motion.fps; }

}  // namespace

FrameRange read_frame_range(const std::string& text, const std::string& where) {
  std::string_view left = text;
  FrameRange range;
  const auto first = take_number(left);
  bool good = first.has_value();
  if (good) range.first = *first, range.last = first;
  if (good && take('-', left)) range.last = take_number(left);
  if (good && take('x', left)) {
    const auto step = take_number(left);
    good = step.has_value();
    range.step = step.value_or(1);
  }
  if (!good || !left.empty())
    throw UsageError(
        fmt::format("{}: '{}' is no range of frames; write FIRST-LAST, counted from 1, with xSTEP "
                    "behind it to leave frames out: 1-240x2",
                    where, text));
  if (range.last && *range.last < range.first)
    throw UsageError(fmt::format("{}: '{}' ends before it begins", where, text));
  return range;
}

std::vector<double> moments_of(const FrameRange& range, const Motion& motion) {
  const int count = motion.frames.size();
  if (range.first > count || range.last.value_or(count) > count)
    throw UsageError(fmt::format("--frames: the motion has frames 1 to {}, not {}", count,
                                 range.last.value_or(range.first)));
  std::vector<double> moments;
  for (int frame = range.first; frame <= range.last.value_or(count); frame += range.step)
    moments.push_back((frame - 1) / motion.fps);
  return moments;
}

Span span_within(const std::optional<double>& from, const std::optional<double>& to,
                 const Motion& motion) {
  constexpr double kRounding = 1e-6;  // s
  const Span span{from.value_or(0), to.value_or(duration(motion))};
  for (const double moment : {span.begin, span.end})
    if (!(moment >= 0) || !(moment <= duration(motion) + kRounding))
      throw UsageError(
          fmt::format("{:g} s: the motion lasts from 0 to {:.3f} s", moment, duration(motion)));
  if (!(span.begin <= span.end))
    throw UsageError(fmt::format("--from {:g} --to {:g}: the film would end before it begins",
                                 span.begin, span.end));
  return span;
}

}  // namespace ecorche
