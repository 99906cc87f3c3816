#include "skinning/motion_files/acclaim_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kAcclaimRate = 120;  // of CMU's library, frames a second
constexpr double kInch = 0.0254;
constexpr double kFarthestPart = 1e9;  // file units, and units of angles

std::string lower_case(std::string_view word) {
  std::string out(word);
  std::ranges::transform(out, out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

std::string acclaim_shown(std::string_view word) { return printable(word.substr(0, 60)); }

// Commas and brackets are blanks, a # begins a remark.
std::string plain_text(std::string_view text) {
  std::string out(text);
  bool remark = false;
  for (char& c : out) {
    if (c == '\n' || c == '\r') remark = false;
    if (c == '#') remark = true;
    if (remark || c == ',' || c == '(' || c == ')') c = ' ';
  }
  return out;
}

Mat3 turn_about(char axis, double angle) {
  return Eigen::AngleAxisd(angle, Vec3::Unit(std::toupper(static_cast<unsigned char>(axis)) - 'X'))
      .toRotationMatrix();
}

double bounded_number(TextScan& scan, const std::string& what) {
  const double value = scan.number(what);
  if (!(std::abs(value) <= kFarthestPart))
    scan.fail(fmt::format("{}: {:g} is beyond {:g}", what, value, kFarthestPart));
  return value;
}

class SkeletonReader {
 public:
  SkeletonReader(std::string_view text, const std::string& name)
      : text_(plain_text(text)), scan_(text_, name) {
    out_.name = name;
    out_.bones.push_back({.name = "root", .channels = "xyzXYZ"});
    places_["root"] = 0;
  }

  AcclaimSkeleton read() {
    while (scan_.next_line()) {
      std::string word = lower_case(scan_.word());
      if (word.empty()) continue;
      if (word[0] == ':')
        section_ = word;
      else if (section_ == ":units")
        unit_line(word);
      else if (section_ == ":root")
        root_line(word);
      else if (section_ == ":bonedata")
        bone_line(word);
      else if (section_ == ":hierarchy")
        hierarchy_line(word);
      else if (section_.empty())
        scan_.fail(
            fmt::format("'{}' before any ':' section; is this an .asf?", acclaim_shown(word)));
    }
    if (open_) scan_.fail(fmt::format("bone '{}' is cut short: 'end' is missing", bone_.name));
    if (out_.bones.size() < 2) scan_.fail("no bones; expected a section :bonedata");
    finish();
    return std::move(out_);
  }

 private:
  void unit_line(const std::string& word) {
    if (word == "length") {
      out_.length = bounded_number(scan_, "length of :units");
      if (!(out_.length > 1e-9)) scan_.fail(fmt::format(":units length {}", out_.length));
    } else if (word == "angle") {
      const std::string kind = lower_case(scan_.word());
      if (kind != "deg" && kind != "rad")
        scan_.fail(fmt::format(":units angle '{}'; expected deg or rad", acclaim_shown(kind)));
      out_.angle = kind == "deg" ? kDegree : 1;
    }
  }

  Vec3 read_vector(const std::string& what) {
    Vec3 out;
    for (int k = 0; k < 3; ++k) out[k] = bounded_number(scan_, what);
    return out;
  }

  // "XYZ" in any case and order.
  std::string read_order(const std::string& what) {
    std::string order(scan_.word());
    std::ranges::transform(order, order.begin(),
                           [](unsigned char c) { return char(std::toupper(c)); });
    std::string sorted = order;
    std::ranges::sort(sorted);
    if (sorted != "XYZ")
      scan_.fail(
          fmt::format("{}: '{}'; expected an order of X, Y and Z", what, acclaim_shown(order)));
    return order;
  }

  // Of `dof` and `order`: "rx" or "TX" each; one letter a channel.
  std::string read_channels(const std::string& what) {
    std::string out;
    while (!scan_.at_line_end()) {
      const std::string word = lower_case(scan_.word());
      const bool named = word.size() == 2 && (word[0] == 't' || word[0] == 'r') && word[1] >= 'x' &&
                         word[1] <= 'z';
      if (word == "l")
        scan_.fail(what +
                   ": 'l', a bone that changes its length, is not read; export the motion "
                   "with bones of constant length");
      if (!named)
        scan_.fail(fmt::format("{}: '{}'; expected tx ty tz rx ry rz", what, acclaim_shown(word)));
      const char letter =
          word[0] == 't' ? word[1] : char(std::toupper(static_cast<unsigned char>(word[1])));
      if (out.find(letter) != std::string::npos)
        scan_.fail(fmt::format("{}: '{}' twice", what, word));
      out += letter;
    }
    return out;
  }

  void root_line(const std::string& word) {
    if (word == "order") {
      out_.bones[0].channels = read_channels("order of :root");
    } else if (word == "axis") {
      root_order_ = read_order("axis of :root");
    } else if (word == "position") {
      out_.position = read_vector("position of :root");
    } else if (word == "orientation") {
      root_turn_ = read_vector("orientation of :root");
    }
  }

  void bone_line(const std::string& word) {
    if (word == "begin") {
      if (open_) scan_.fail(fmt::format("'begin' inside bone '{}'; expected 'end'", bone_.name));
      open_ = true;
      bone_ = {};
      direction_.setZero();
      length_ = 0;
      turn_.setZero();
      order_ = "XYZ";
    } else if (!open_) {
      scan_.fail(fmt::format("'{}' outside of any bone; expected 'begin'", acclaim_shown(word)));
    } else if (word == "end") {
      close_bone();
    } else if (word == "name") {
      const std::string_view name = scan_.word();
      if (name.empty() || name.size() > limits::kNameBytes)
        scan_.fail("a bone's name is missing or too long");
      bone_.name = printable(name);
    } else if (word == "direction") {
      direction_ = read_vector("direction of bone '" + bone_.name + "'");
    } else if (word == "length") {
      length_ = bounded_number(scan_, "length of bone '" + bone_.name + "'");
    } else if (word == "axis") {
      turn_ = read_vector("axis of bone '" + bone_.name + "'");
      if (!scan_.at_line_end()) order_ = read_order("axis of bone '" + bone_.name + "'");
    } else if (word == "dof") {
      bone_.channels = read_channels("dof of bone '" + bone_.name + "'");
    }
  }

  void close_bone() {
    open_ = false;
    if (bone_.name.empty()) scan_.fail("a bone without a name");
    if (out_.bones.size() > limits::kMotionJoints)
      throw LimitError(fmt::format("{}: more than {} bones", out_.name, limits::kMotionJoints));
    if (!places_.try_emplace(bone_.name, int(out_.bones.size())).second)
      scan_.fail(fmt::format("bone '{}' twice", bone_.name));
    const double norm = direction_.norm();
    if (length_ != 0 && !(norm > 1e-9))
      scan_.fail(
          fmt::format("bone '{}' has a length of {}, but no direction", bone_.name, length_));
    bone_.along = length_ == 0 ? Vec3::Zero() : Vec3(length_ / norm * direction_);
    turns_.emplace_back(order_, turn_);
    out_.bones.push_back(std::move(bone_));
    bone_ = {};
  }

  void hierarchy_line(const std::string& word) {
    if (word == "begin" || word == "end") return;
    std::string_view line = scan_.line();  // names keep their case
    const std::size_t first = line.find_first_not_of(" \t");
    const std::string parent = printable(line.substr(first, word.size()));
    const int above = place_of(parent);
    while (!scan_.at_line_end()) {
      const std::string child = printable(scan_.word());
      const int bone = place_of(child);
      if (bone == 0 || !parents_.try_emplace(bone, above).second)
        scan_.fail(fmt::format("bone '{}' has a second parent, '{}'", child, parent));
    }
  }

  int place_of(const std::string& name) const {
    const auto found = places_.find(name);
    if (found == places_.end())
      scan_.fail(fmt::format(":hierarchy names bone '{}', which :bonedata does not have",
                             acclaim_shown(name)));
    return found->second;
  }

  // Axes, which wait for the unit of angles, and an order in which parents come first.
  void finish() {
    const auto axes = [&](const std::string& order, const Vec3& turn) {
      Mat3 R = Mat3::Identity();
      for (const char axis : order) R = turn_about(axis, turn[axis - 'X'] * out_.angle) * R;
      return R;
    };
    out_.bones[0].axis = axes(root_order_, root_turn_);
    for (std::size_t b = 1; b < out_.bones.size(); ++b)
      out_.bones[b].axis = axes(turns_[b - 1].first, turns_[b - 1].second);
    std::vector<std::vector<int>> children(out_.bones.size());
    for (const auto& [bone, parent] : parents_) children[std::size_t(parent)].push_back(bone);
    std::vector<AcclaimBone> sorted;
    std::vector<std::pair<int, int>> waiting{{0, -1}};
    while (!waiting.empty()) {
      const auto [bone, parent] = waiting.back();
      waiting.pop_back();
      out_.bones[std::size_t(bone)].parent = parent;
      const auto& below = children[std::size_t(bone)];
      for (auto child = below.rbegin(); child != below.rend(); ++child)
        waiting.emplace_back(*child, int(sorted.size()));
      sorted.push_back(std::move(out_.bones[std::size_t(bone)]));
    }
    if (sorted.size() != out_.bones.size())
      scan_.fail(fmt::format("{} of {} bones do not hang on the root; complete :hierarchy",
                             out_.bones.size() - sorted.size(), out_.bones.size() - 1));
    out_.bones = std::move(sorted);
  }

  std::string text_;
  TextScan scan_;
  AcclaimSkeleton out_;
  std::string section_, root_order_ = "XYZ", order_;
  Vec3 root_turn_ = Vec3::Zero(), direction_, turn_;
  double length_ = 0;
  bool open_ = false;
  AcclaimBone bone_;
  std::vector<std::pair<std::string, Vec3>> turns_;  // of the bones without the root
  std::map<std::string, int> places_;
  std::map<int, int> parents_;
};

class MotionReader {
 public:
  MotionReader(std::string_view text, const std::string& name, const AcclaimSkeleton& skeleton)
      : text_(plain_text(text)), scan_(text_, name), skeleton_(skeleton), angle_(skeleton.angle) {
    out_.name = name;
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) places_[skeleton.bones[b].name] = b;
    values_.resize(skeleton.bones.size());
    for (std::size_t b = 0; b < values_.size(); ++b)
      values_[b].assign(skeleton.bones[b].channels.size(), 0.0);
    seen_.assign(values_.size(), 0);
  }

  MotionClip read(const std::optional<double>& fps) {
    add_joints();
    while (scan_.next_line()) {
      const std::string_view word = scan_.word();
      if (word.empty()) continue;
      if (word[0] == ':')
        head_line(lower_case(word));
      else if (std::isdigit(static_cast<unsigned char>(word[0])))
        begin_frame(word);
      else
        bone_line(printable(word));
    }
    if (frame_ > 0) close_frame();
    out_.fps = fps.value_or(rate_.value_or(kAcclaimRate));
    if (!fps && !rate_ && out_.frame_count > 0)
      out_.warnings.push_back(
          fmt::format("{}: it does not say its rate; {:g} frames a second are taken, --motion-fps "
                      "gives another",
                      out_.name, kAcclaimRate));
    if (leaps_ > 0)
      out_.warnings.push_back(fmt::format(
          "{}: the numbers of its frames leap {} times: frames are missing", out_.name, leaps_));
    out_.metres_per_unit = kInch / skeleton_.length;
    return std::move(out_);
  }

 private:
  void head_line(const std::string& word) {
    if (word == ":degrees") angle_ = kDegree;
    if (word == ":radians") angle_ = 1;
    if (word == ":fully-specified") fully_ = true;
    if (word == ":samples-per-second") {
      rate_ = scan_.number("rate");
      if (!(*rate_ >= 0.1 && *rate_ <= 10000))
        scan_.fail(fmt::format(":samples-per-second {:g}; expected 0.1 to 10000", *rate_));
    }
  }

  void begin_frame(std::string_view word) {
    long long number = 0;
    if (!parse_whole(word, number) || !scan_.at_line_end())
      scan_.fail(fmt::format("'{}': expected the number of a frame alone", acclaim_shown(word)));
    if (frame_ > 0) close_frame();
    if (frame_ > 0 && number != frame_ + 1) ++leaps_;
    if (number < 1 || number > limits::kMotionFrames)
      scan_.fail(fmt::format("frame {}; expected 1 to {}", number, limits::kMotionFrames));
    frame_ = number;
    frame_line_ = scan_.line_number();
    std::ranges::fill(seen_, 0);
  }

  void bone_line(const std::string& name) {
    const auto found = places_.find(name);
    if (frame_ == 0) scan_.fail(fmt::format("'{}' before the first frame", acclaim_shown(name)));
    if (found == places_.end())
      scan_.fail(
          fmt::format("frame {}: the skeleton {} has no bone '{}'; name the one that belongs "
                      "to this motion with --skeleton",
                      frame_, skeleton_.name, acclaim_shown(name)));
    const std::size_t b = found->second;
    if (seen_[b]) scan_.fail(fmt::format("frame {}: bone '{}' twice", frame_, name));
    seen_[b] = 1;
    for (double& value : values_[b])
      value = bounded_number(scan_, fmt::format("frame {}: bone '{}'", frame_, name));
    if (!scan_.at_line_end())
      scan_.fail(fmt::format("frame {}: bone '{}' has more than {} values", frame_, name,
                             values_[b].size()));
  }

  void close_frame() {
    for (std::size_t b = 0; fully_ && b < seen_.size(); ++b)
      if (!seen_[b] && !values_[b].empty())
        throw InputError(
            fmt::format("{}:{}: frame {}: bone '{}' is missing, although the file is "
                        ":FULLY-SPECIFIED",
                        out_.name, frame_line_, frame_, skeleton_.bones[b].name));
    if (++out_.frame_count > limits::kMotionFrames)
      throw LimitError(fmt::format("{}: more than {} frames", out_.name, limits::kMotionFrames));
    for (std::size_t b = 0; b < values_.size(); ++b) {
      const AcclaimBone& bone = skeleton_.bones[b];
      if (bone.channels.empty()) continue;
      Mat3 turn = Mat3::Identity();
      Vec3 shift = Vec3::Zero();
      for (std::size_t k = 0; k < bone.channels.size(); ++k) {
        const char channel = bone.channels[k];
        if (channel >= 'x')
          shift[channel - 'x'] = values_[b][k];
        else
          turn = turn_about(channel, values_[b][k] * angle_) * turn;
      }
      const bool root = b == 0;
      out_.rotations.push_back(root ? Mat3(turn * bone.axis)
                                    : Mat3(bone.axis * turn * bone.axis.transpose()));
      if (out_.joints[b].translation_track >= 0)
        out_.translations.push_back(out_.joints[b].offset + (root ? shift : bone.axis * shift));
    }
  }

  void add_joints() {
    for (const AcclaimBone& bone : skeleton_.bones) {
      ClipJoint joint;
      joint.name = bone.name;
      joint.parent = bone.parent;
      joint.offset =
          bone.parent < 0 ? skeleton_.position : skeleton_.bones[std::size_t(bone.parent)].along;
      if (!bone.channels.empty()) joint.rotation_track = out_.rotation_tracks++;
      if (bone.channels.find_first_of("xyz") != std::string::npos)
        joint.translation_track = out_.translation_tracks++;
      out_.joints.push_back(std::move(joint));
    }
    std::vector<char> ends(out_.joints.size(), 1);
    for (const ClipJoint& joint : out_.joints)
      if (joint.parent >= 0) ends[std::size_t(joint.parent)] = 0;
    for (std::size_t b = 0; b < ends.size(); ++b)
      if (ends[b]) out_.joints[b].end_sites.push_back(skeleton_.bones[b].along);
  }

  std::string text_;
  TextScan scan_;
  const AcclaimSkeleton& skeleton_;
  MotionClip out_;
  double angle_;  // rad
  bool fully_ = false;
  std::optional<double> rate_;
  long long frame_ = 0;
  int frame_line_ = 0, leaps_ = 0;
  std::vector<std::vector<double>> values_;  // of each bone, kept from frame to frame
  std::vector<char> seen_;
  std::map<std::string, std::size_t> places_;
};

}  // namespace

AcclaimSkeleton parse_asf(std::string_view text, const std::string& name) {
  return SkeletonReader(text, name).read();
}

MotionClip parse_amc(std::string_view text, const std::string& name,
                     const AcclaimSkeleton& skeleton, const std::optional<double>& fps) {
  return MotionReader(text, name, skeleton).read(fps);
}

}  // namespace ecorche::inline v1
