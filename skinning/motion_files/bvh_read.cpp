#include "skinning/motion_files/bvh_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMaxDegrees = 1e6;  // beyond this a double has lost the fraction that matters
constexpr double kMaxPosition = 1e9;
constexpr double kMinFrameTime = 1e-4, kMaxFrameTime = 10;

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v' || c == '\0';
}

bool same_word(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (size_t k = 0; k < a.size(); ++k)
    if (std::tolower(static_cast<unsigned char>(a[k])) !=
        std::tolower(static_cast<unsigned char>(b[k])))
      return false;
  return true;
}

// For messages: a token shortened, and printable.
std::string shown(std::string_view token) {
  return printable(token.substr(0, 40)) + (token.size() > 40 ? "..." : "");
}

// Words of the file with their line number. '{' and '}' are words even without spaces around them.
class Words {
 public:
  Words(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  int line() const { return line_; }

  [[noreturn]] void fail(const std::string& what) const { fail_at(line_, what); }
  [[noreturn]] void fail_at(int line, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", file_, line, what));
  }

  // The next word, or empty at the end of the file.
  std::string_view next() {
    skip_blanks(true);
    const size_t begin = at_;
    if (at_ < text_.size() && is_brace(text_[at_])) return text_.substr(at_++, 1);
    while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != '\n' &&
           !is_brace(text_[at_]))
      ++at_;
    return text_.substr(begin, at_ - begin);
  }

  // What is left of the line, up to a brace, without blanks around it.
  std::string_view rest_of_line() {
    skip_blanks(false);
    const size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n' && !is_brace(text_[at_])) ++at_;
    size_t end = at_;
    while (end > begin && is_space(text_[end - 1])) --end;
    return text_.substr(begin, end - begin);
  }

  // The next line that is not blank, or nullopt at the end of the file. `whole` tells whether it
  // ended with a line end.
  std::optional<std::string_view> next_line(bool& whole) {
    skip_blanks(true);
    if (at_ >= text_.size()) return std::nullopt;
    const size_t begin = at_;
    const size_t end = text_.find('\n', at_);
    whole = end != std::string_view::npos;
    at_ = whole ? end : text_.size();
    return text_.substr(begin, at_ - begin);
  }

 private:
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  void skip_blanks(bool over_lines) {
    while (at_ < text_.size() && (is_space(text_[at_]) || (over_lines && text_[at_] == '\n')))
      line_ += text_[at_++] == '\n';
  }

  std::string_view text_;
  std::string file_;
  size_t at_ = 0;
  int line_ = 1;
};

std::optional<double> to_number(std::string_view word) {
  double value = 0;
  return parse_number(word, value) ? std::optional(value) : std::nullopt;
}

double read_number(Words& words, const char* part) {
  const std::string_view word = words.next();
  if (word.empty()) words.fail(fmt::format("{}: the file ends here; it is cut short", part));
  const auto value = to_number(word);
  if (!value)
    words.fail(fmt::format("{}: '{}' is not a finite number; expected digits with a decimal point",
                           part, shown(word)));
  if (std::abs(*value) > kMaxPosition)
    words.fail(fmt::format("{}: {} is beyond {:g}", part, *value, kMaxPosition));
  return *value;
}

// Reads the tree with an explicit stack, so that nesting costs heap, not the call stack.
class HierarchyReader {
 public:
  HierarchyReader(Words& words, BvhMotion& motion) : words_(words), motion_(motion) {}

  void read() {
    if (!same_word(words_.next(), "HIERARCHY"))
      words_.fail("not a BVH file: it does not begin with HIERARCHY");
    while (true) {
      const std::string_view word = words_.next();
      if (word.empty())
        words_.fail(open_.empty() ? "MOTION is missing; the file is cut short"
                                  : "the hierarchy is cut short: a '}' is missing");
      if (open_.empty() && same_word(word, "MOTION")) break;
      if (!open_.empty() && open_.back().end_site)
        end_site_word(word);
      else
        joint_word(word);
    }
    if (motion_.joints.empty()) words_.fail("no ROOT before MOTION");
    if (roots_ > 1)
      motion_.warnings.push_back(
          fmt::format("{}: {} ROOTs; they are read side by side", motion_.name, roots_));
  }

 private:
  struct Open {
    int joint;
    bool end_site;
    bool has_offset;
    bool has_channels;
  };

  void joint_word(std::string_view word) {
    if (same_word(word, "ROOT")) {
      if (!open_.empty())
        words_.fail(fmt::format("ROOT inside joint '{}'; expected JOINT or '}}'",
                                motion_.joints[open_.back().joint].name));
      ++roots_;
      open_joint(-1);
    } else if (open_.empty()) {
      words_.fail(fmt::format("'{}' outside of any ROOT; expected ROOT or MOTION", shown(word)));
    } else if (same_word(word, "JOINT")) {
      open_joint(open_.back().joint);
    } else if (same_word(word, "End") || same_word(word, "EndSite")) {
      words_.rest_of_line();
      push(Open{open_.back().joint, true, false, false});
    } else if (same_word(word, "OFFSET")) {
      motion_.joints[open_.back().joint].offset = read_offset();
    } else if (same_word(word, "CHANNELS")) {
      read_channels(motion_.joints[open_.back().joint]);
    } else if (word == "}") {
      if (!open_.back().has_offset)
        motion_.warnings.push_back(fmt::format("{}:{}: joint '{}' has no OFFSET; 0 0 0 is taken",
                                               motion_.name, words_.line(),
                                               motion_.joints[open_.back().joint].name));
      open_.pop_back();
    } else {
      words_.fail(fmt::format(
          "joint '{}': unknown word '{}'; expected OFFSET, CHANNELS, JOINT, End Site or '}}'",
          motion_.joints[open_.back().joint].name, shown(word)));
    }
  }

  void end_site_word(std::string_view word) {
    BvhJoint& joint = motion_.joints[open_.back().joint];
    if (same_word(word, "OFFSET")) {
      joint.end_sites.push_back(read_offset());
    } else if (same_word(word, "CHANNELS")) {
      if (read_number(words_, "CHANNELS of an End Site") != 0)
        words_.fail(fmt::format("End Site of '{}' has channels; only joints may", joint.name));
    } else if (word == "}") {
      open_.pop_back();
    } else {
      words_.fail(fmt::format("End Site of '{}': unknown word '{}'; expected OFFSET or '}}'",
                              joint.name, shown(word)));
    }
  }

  Vec3 read_offset() {
    if (open_.back().has_offset)
      words_.fail(
          fmt::format("joint '{}': a second OFFSET", motion_.joints[open_.back().joint].name));
    open_.back().has_offset = true;
    Vec3 offset;
    for (int k = 0; k < 3; ++k) offset[k] = read_number(words_, "OFFSET");
    return offset;
  }

  void open_joint(int parent) {
    if (motion_.joints.size() >= limits::kMotionJoints)
      words_.fail(fmt::format("more than {} joints", limits::kMotionJoints));
    BvhJoint joint;
    joint.name = unique_name(words_.rest_of_line());
    joint.parent = parent;
    motion_.joints.push_back(std::move(joint));
    push(Open{int(motion_.joints.size()) - 1, false, false, false});
  }

  void push(Open open) {
    const std::string_view brace = words_.next();
    if (brace.empty()) words_.fail("the hierarchy is cut short: a '{' is missing");
    if (brace != "{") words_.fail(fmt::format("'{}' where a '{{' should be", shown(brace)));
    if (open_.size() >= limits::kMotionDepth)
      words_.fail(fmt::format("joints nested deeper than {}", limits::kMotionDepth));
    open_.push_back(open);
  }

  std::string unique_name(std::string_view written) {
    if (written.size() > limits::kNameBytes)
      words_.fail(fmt::format("a joint's name of {} bytes; the limit is {}", written.size(),
                              limits::kNameBytes));
    std::string name(written);
    std::string why;
    if (name.empty()) {
      name = fmt::format("joint_{}", motion_.joints.size());
      why = "has no name";
    } else if (!is_utf8(name)) {
      name = printable(name);
      why = "is not UTF-8";
    }
    if (const int count = ++seen_[name]; count > 1) {
      do
        name = fmt::format("{}#{}",
                           written.empty() ? name : std::string(name.substr(0, name.find('#'))),
                           ++copies_);
      while (seen_.count(name));
      seen_[name] = 1;
      why = "repeats a name";
    }
    if (!why.empty())
      motion_.warnings.push_back(fmt::format("{}:{}: joint {} {}; it is called '{}' here",
                                             motion_.name, words_.line(), motion_.joints.size(),
                                             why, name));
    return name;
  }

  void read_channels(BvhJoint& joint) {
    static constexpr const char* kNames[] = {"Xposition", "Yposition", "Zposition",
                                             "Xrotation", "Yrotation", "Zrotation"};
    if (open_.back().has_channels)
      words_.fail(fmt::format("joint '{}': a second CHANNELS", joint.name));
    open_.back().has_channels = true;
    const double count = read_number(words_, "CHANNELS");
    if (count != std::floor(count) || count < 0 || count > 6)
      words_.fail(fmt::format("joint '{}': {} channels; expected 0 to 6", joint.name, count));
    joint.first_channel = motion_.channels;
    for (int k = 0; k < int(count); ++k) {
      const std::string_view word = words_.next();
      int found = -1;
      for (int c = 0; c < 6; ++c)
        if (same_word(word, kNames[c])) found = c;
      if (found < 0)
        words_.fail(fmt::format(
            "joint '{}': unknown channel '{}'; expected Xposition .. Zrotation ({} of them)",
            joint.name, shown(word), count));
      for (BvhChannel other : joint.channels)
        if (int(other) == found)
          words_.fail(fmt::format("joint '{}': channel '{}' twice", joint.name, kNames[found]));
      joint.channels.push_back(static_cast<BvhChannel>(found));
    }
    motion_.channels += int(count);
  }

  Words& words_;
  BvhMotion& motion_;
  std::vector<Open> open_;
  std::map<std::string, int> seen_;
  int copies_ = 1;
  int roots_ = 0;
};

// The rate a rounded frame time stands for. A time printed with n decimals is off by at most one in
// the last of them.
double rational_fps(double frame_time, std::string_view written) {
  const size_t point = written.find('.');
  const size_t exponent = written.find_first_of("eE");
  if (point == std::string_view::npos || exponent != std::string_view::npos) return 1 / frame_time;
  // 2e-6 of it lets 23.976, which stands for 24000/1001, through as well.
  const double last_digit =
      std::max(std::pow(10.0, -double(written.size() - point - 1)), 2e-6 * frame_time);
  const double whole = std::round(1 / frame_time);
  if (whole >= 1 && std::abs(1 / whole - frame_time) <= last_digit) return whole;
  for (double base : {24.0, 30.0, 48.0, 60.0, 120.0, 240.0}) {
    const double film = base * 1000 / 1001;
    if (std::abs(1 / film - frame_time) <= last_digit) return film;
  }
  return 1 / frame_time;
}

// `Frames:` and `Frame Time:` with any spacing. Returns the number of frames that the file claims.
double read_motion_header(Words& words, BvhMotion& motion, const BvhReadOptions& options) {
  std::string_view word = words.next();
  if (same_word(word, "Frames"))
    word = words.next();  // "Frames :"
  else if (!same_word(word, "Frames:"))
    words.fail(word.empty() ? "Frames: is missing; the file is cut short"
                            : fmt::format("'{}' where 'Frames:' should be", shown(word)));
  if (word == ":" || same_word(word, "Frames:")) word = words.next();
  const auto claimed = to_number(word);
  if (!claimed || *claimed < 0 || *claimed != std::floor(*claimed))
    words.fail(fmt::format("Frames: '{}'; expected a whole number, 0 or more", shown(word)));

  if (word = words.next(); !same_word(word, "Frame"))
    words.fail(fmt::format("'{}' where 'Frame Time:' should be", shown(word)));
  if (word = words.next(); !same_word(word, "Time:")) {
    if (!same_word(word, "Time") || words.next() != ":") words.fail("'Frame' without 'Time:'");
  }
  const int line = words.line();
  word = words.next();
  if (words.line() != line) word = {};  // the first sample is no time
  const auto time = to_number(word);
  const bool usable = time && *time >= kMinFrameTime && *time <= kMaxFrameTime;
  if (options.fps) {
    motion.fps = *options.fps;
    motion.frame_time = 1 / motion.fps;
  } else if (!usable) {
    words.fail(fmt::format(
        "Frame Time: '{}'; expected {} to {} seconds, or give the rate with --motion-fps",
        shown(word), kMinFrameTime, kMaxFrameTime));
  } else {
    motion.frame_time = *time;
    motion.fps = rational_fps(*time, word);
  }
  return *claimed;
}

// One line into `frame`. Returns how many numbers it holds; stops at the first that is not one.
int read_frame(std::string_view line, const std::vector<bool>& rotation, std::vector<double>& frame,
               std::string& problem) {
  int count = 0;
  size_t at = 0;
  while (true) {
    while (at < line.size() && is_space(line[at])) ++at;
    if (at == line.size()) return count;
    const size_t begin = at;
    while (at < line.size() && !is_space(line[at])) ++at;
    const std::string_view word = line.substr(begin, at - begin);
    const auto value = to_number(word);
    if (count < int(frame.size())) {
      const double limit = rotation[count] ? kMaxDegrees : kMaxPosition;
      if (!value)
        problem = fmt::format("value {}: '{}' is not a finite number", count + 1, shown(word));
      else if (std::abs(*value) > limit)
        problem = fmt::format("value {}: {} is beyond {:g}", count + 1, *value, limit);
      else
        frame[count] = *value;
      if (!problem.empty()) return count;
    }
    ++count;
  }
}

void read_frames(Words& words, BvhMotion& motion, double claimed) {
  std::vector<bool> rotation(motion.channels);
  for (const BvhJoint& joint : motion.joints)
    for (size_t k = 0; k < joint.channels.size(); ++k)
      rotation[joint.first_channel + k] = joint.channels[k] >= BvhChannel::x_rotation;

  std::vector<double> frame(motion.channels);
  bool whole = true;
  while (const auto line = words.next_line(whole)) {
    if (motion.channels == 0) words.fail("numbers after MOTION, but no joint has a channel");
    std::string problem;
    const int count = read_frame(*line, rotation, frame, problem);
    if (count < motion.channels && !whole) {  // the file ends inside this line
      motion.warnings.push_back(
          fmt::format("{}:{}: the last frame has {} of {} values and is left out", motion.name,
                      words.line(), count, motion.channels));
      break;
    }
    if (!problem.empty()) words.fail(fmt::format("frame {}: {}", motion.frames, problem));
    if (count != motion.channels) {
      const int here = words.line();
      const bool last = !words.next_line(whole).has_value();
      if (!last || count > motion.channels)
        words.fail_at(here, fmt::format("frame {}: {} values for {} channels", motion.frames, count,
                                        motion.channels));
      motion.warnings.push_back(
          fmt::format("{}: the last frame has {} of {} values and is left out", motion.name, count,
                      motion.channels));
      break;
    }
    if (++motion.frames > limits::kMotionFrames)
      words.fail(fmt::format("more than {} frames", limits::kMotionFrames));
    motion.samples.insert(motion.samples.end(), frame.begin(), frame.end());
  }
  if (motion.frames != claimed)
    motion.warnings.push_back(fmt::format("{}: Frames: says {:.0f}, the file holds {}", motion.name,
                                          claimed, motion.frames));
}
Mat3 axis_rotation(BvhChannel channel, double degrees) {
  const int axis = int(channel) - int(BvhChannel::x_rotation);
  return Eigen::AngleAxisd(degrees / kDegreesPerRadian, Vec3::Unit(axis)).toRotationMatrix();
}

}  // namespace

BvhMotion parse_bvh(std::string_view text, const std::string& name, const BvhReadOptions& options) {
  if (options.fps && !(*options.fps >= 1 / kMaxFrameTime && *options.fps <= 1 / kMinFrameTime))
    throw UsageError(fmt::format("{} frames a second; expected {} to {}", *options.fps,
                                 1 / kMaxFrameTime, 1 / kMinFrameTime));
  BvhMotion motion;
  motion.name = name;
  if (text.empty()) throw InputError(name + ": empty file");
  text = unmarked_text(text, name);
  std::string turned;
  if (line_end(text) == '\r') {  // of old programs
    turned = text;
    std::replace(turned.begin(), turned.end(), '\r', '\n');
    text = turned;
  }
  Words words(text, name);
  HierarchyReader(words, motion).read();
  const double claimed = read_motion_header(words, motion, options);
  read_frames(words, motion, claimed);
  return motion;
}

BvhMotion read_bvh(const std::filesystem::path& file, const BvhReadOptions& options) {
  return parse_bvh(read_input_file(file, limits::kMotionBytes), printable(file.filename().string()),
                   options);
}

MotionClip clip_from_bvh(const BvhMotion& motion) {
  MotionClip out;
  out.name = motion.name;
  out.fps = motion.fps;
  out.frame_count = motion.frames;
  out.warnings = motion.warnings;
  for (const BvhJoint& joint : motion.joints) {
    ClipJoint& own = out.joints.emplace_back();
    own.name = joint.name;
    own.parent = joint.parent;
    own.offset = joint.offset;
    own.end_sites = joint.end_sites;
    bool rotates = false, translates = false;
    for (const BvhChannel channel : joint.channels)
      (channel < BvhChannel::x_rotation ? translates : rotates) = true;
    if (rotates) own.rotation_track = out.rotation_tracks++;
    if (translates) own.translation_track = out.translation_tracks++;
  }
  out.rotations.reserve(std::size_t(motion.frames) * out.rotation_tracks);
  out.translations.reserve(std::size_t(motion.frames) * out.translation_tracks);
  for (int frame = 0; frame < motion.frames; ++frame)
    for (std::size_t j = 0; j < motion.joints.size(); ++j) {
      const BvhJoint& joint = motion.joints[j];
      Vec3 position = joint.offset;
      Mat3 rotation = Mat3::Identity();
      const double* row =
          motion.samples.data() + std::size_t(frame) * motion.channels + joint.first_channel;
      for (std::size_t k = 0; k < joint.channels.size(); ++k) {
        if (joint.channels[k] < BvhChannel::x_rotation)
          position[int(joint.channels[k])] = row[k];
        else
          rotation = rotation * axis_rotation(joint.channels[k], row[k]);
      }
      if (out.joints[j].rotation_track >= 0) out.rotations.push_back(rotation);
      if (out.joints[j].translation_track >= 0) out.translations.push_back(position);
    }
  return out;
}

}  // namespace ecorche::inline v1
