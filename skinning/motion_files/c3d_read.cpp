#include "skinning/motion_files/c3d_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kBlock = 512;     // bytes
constexpr unsigned char kMagic = 0x50;  // the second byte
enum class Processor { intel = 84, dec = 85, mips = 86 };

// Numbers at places of the file, as a processor wrote them.
class C3dBytes {
 public:
  C3dBytes(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  void set_processor(Processor processor) { processor_ = processor; }
  std::size_t size() const { return bytes_.size(); }

  unsigned byte(std::size_t at) const {
    if (at >= bytes_.size())
      fail(fmt::format("it ends after {} bytes, amid what its head promises", bytes_.size()));
    return std::uint8_t(bytes_[at]);
  }
  int word(std::size_t at) const { return int(std::int16_t(unsigned_word(at))); }
  unsigned unsigned_word(std::size_t at) const {
    const unsigned a = byte(at), b = byte(at + 1);
    return processor_ == Processor::mips ? a << 8 | b : b << 8 | a;
  }
  // A DEC's float has its halves the other way round, and an exponent that counts two more.
  double real(std::size_t at) const {
    std::array<std::uint32_t, 4> b{};
    for (std::size_t k = 0; k < 4; ++k) b[k] = byte(at + k);
    if (processor_ == Processor::mips) b = {b[3], b[2], b[1], b[0]};
    if (processor_ == Processor::dec) b = {b[2], b[3], b[0], b[1]};
    const std::uint32_t bits = b[3] << 24 | b[2] << 16 | b[1] << 8 | b[0];
    const double value = double(std::bit_cast<float>(bits));
    return processor_ == Processor::dec ? value / 4 : value;
  }
  std::string_view text(std::size_t at, std::size_t length) const {
    if (length > 0) byte(at + length - 1);
    return bytes_.substr(std::min(at, bytes_.size()), length);
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", name_, message));
  }

 private:
  std::string_view bytes_;
  const std::string& name_;
  Processor processor_ = Processor::intel;
};

struct C3dParameter {
  int type = 0;  // -1 characters, 1 bytes, 2 words, 4 floats
  std::vector<std::size_t> sizes;
  std::size_t data = 0, count = 1;  // place in the file, elements
};

class C3dReader {
 public:
  C3dReader(std::string_view bytes, const std::string& name) : file_(bytes, name) {
    out_.name = name;
  }

  MarkerTake read(const std::optional<double>& fps) {
    if (file_.size() < 2 * kBlock || file_.byte(1) != kMagic)
      file_.fail("it does not begin as a C3D file does");
    read_parameters();
    read_head(fps);
    read_labels();
    read_frames();
    const double metres = metres_of_unit(unit_);
    if (metres > 0)
      for (Points& places : out_.frames) places *= metres;
    else if (!unit_.empty())
      out_.warnings.push_back(fmt::format("{}: its unit '{}' is not known; taken as metres",
                                          out_.name, printable(unit_)));
    finish_take(unit_, out_);
    return std::move(out_);
  }

 private:
  void read_parameters() {
    const std::size_t begin = (file_.byte(0) - 1) * kBlock;
    if (file_.byte(0) < 2) file_.fail("its parameters lie nowhere");
    const unsigned processor = file_.byte(begin + 3);
    if (processor < 84 || processor > 86)
      file_.fail(fmt::format("parameters: processor {}; there are 84 (Intel), 85 (DEC), 86 (MIPS)",
                             processor));
    file_.set_processor(Processor(processor));
    std::map<int, std::string> groups;
    std::map<std::string, C3dParameter> waiting;  // "ID:NAME", whose group may come later
    for (std::size_t at = begin + 4; at + 4 <= file_.size();) {
      const int length = int(std::int8_t(file_.byte(at))),
                id = int(std::int8_t(file_.byte(at + 1)));
      if (length == 0 || id == 0) break;
      const std::size_t letters = std::size_t(std::abs(length)), next = at + 2 + letters;
      std::string name = printable(file_.text(at + 2, letters));
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
      const int step = file_.word(next);
      if (step < 0)
        file_.fail(fmt::format("parameter '{}': the next one lies {} bytes away", name, step));
      if (id < 0)
        groups[-id] = name;
      else
        waiting[fmt::format("{}:{}", id, name)] = read_parameter(next + 2, name);
      if (step == 0) break;
      at = next + std::size_t(step);
    }
    for (const auto& [key, parameter] : waiting) {
      const std::size_t colon = key.find(':');
      const auto group = groups.find(std::stoi(key.substr(0, colon)));
      if (group != groups.end()) parameters_[group->second + key.substr(colon)] = parameter;
    }
  }

  C3dParameter read_parameter(std::size_t at, const std::string& name) const {
    C3dParameter out;
    out.type = int(std::int8_t(file_.byte(at)));
    if (out.type != -1 && out.type != 1 && out.type != 2 && out.type != 4)
      file_.fail(fmt::format("parameter '{}': type {}; there are -1, 1, 2 and 4", name, out.type));
    const unsigned dimensions = file_.byte(at + 1);
    if (dimensions > 7)
      file_.fail(
          fmt::format("parameter '{}': {} dimensions; there are 7 at most", name, dimensions));
    for (unsigned k = 0; k < dimensions; ++k) {
      out.sizes.push_back(file_.byte(at + 2 + k));
      out.count *= out.sizes.back();
      if (out.count > file_.size())
        file_.fail(fmt::format("parameter '{}': it is larger than the file", name));
    }
    out.data = at + 2 + dimensions;
    const std::size_t bytes = out.count * std::size_t(std::abs(out.type));
    if (bytes > 0) file_.byte(out.data + bytes - 1);
    return out;
  }

  const C3dParameter* find(const std::string& key) const {
    const auto found = parameters_.find(key);
    return found == parameters_.end() ? nullptr : &found->second;
  }

  // Words count as unsigned: counts above 32,767 are written so.
  std::optional<double> number(const std::string& key, std::size_t index = 0) const {
    const C3dParameter* p = find(key);
    if (!p || index >= p->count || p->type == -1) return std::nullopt;
    if (p->type == 4) return file_.real(p->data + 4 * index);
    return p->type == 2 ? file_.unsigned_word(p->data + 2 * index) : file_.byte(p->data + index);
  }

  std::vector<std::string> texts(const std::string& key) const {
    std::vector<std::string> out;
    const C3dParameter* p = find(key);
    if (!p || p->type != -1 || p->sizes.empty() || p->sizes[0] == 0) return out;
    const std::size_t length = p->sizes[0];
    for (std::size_t k = 0; k < p->count / length; ++k) {
      std::string_view text = file_.text(p->data + k * length, length);
      text = text.substr(0, text.find('\0'));
      const std::size_t end = text.find_last_not_of(" \t");
      const std::size_t begin = text.find_first_not_of(" \t");
      out.push_back(end == std::string_view::npos ? std::string()
                                                  : printable(text.substr(begin, end - begin + 1)));
    }
    return out;
  }

  void read_head(const std::optional<double>& fps) {
    points_ = std::size_t(number("POINT:USED").value_or(file_.unsigned_word(2)));
    if (points_ > kMostMarkers)
      throw LimitError(fmt::format("{}: more than {} markers", out_.name, kMostMarkers));
    if (points_ == 0) throw UnfitError(out_.name + ": it holds no markers");
    analog_ = file_.unsigned_word(4);
    scale_ = number("POINT:SCALE").value_or(file_.real(12));
    if (!std::isfinite(scale_) || scale_ == 0 || std::abs(scale_) > 1e6)
      file_.fail(fmt::format("POINT:SCALE: {:g} is no scale", scale_));
    const double block = number("POINT:DATA_START").value_or(file_.unsigned_word(16));
    begin_ = std::size_t(block >= 2 && block < 65536 ? block : file_.unsigned_word(16)) * kBlock;
    if (begin_ < 2 * kBlock || begin_ - kBlock >= file_.size())
      file_.fail(fmt::format("POINT:DATA_START: block {:g} is not in the file", block));
    begin_ -= kBlock;
    const double rate = fps.value_or(number("POINT:RATE").value_or(file_.real(20)));
    if (!std::isfinite(rate) || !(rate > 0) || rate > 1e5)
      file_.fail(fmt::format("POINT:RATE: {:g} is no rate; --motion-fps sets it", rate));
    out_.fps = rate;
    const double first = file_.unsigned_word(6), last = file_.unsigned_word(8);
    count_frames(first, last);
    out_.start = std::max(0.0, first - 1) / rate;
    const std::vector<std::string> units = texts("POINT:UNITS");
    unit_ = units.empty() ? std::string("mm") : units[0];
  }

  // Sixteen bits do not count long takes: TRIAL has two words for each end.
  void count_frames(double first, double last) {
    const auto field = [&](const char* key) -> std::optional<double> {
      const std::optional<double> low = number(key), high = number(key, 1);
      return low && high ? std::optional(*low + 65536 * *high) : std::nullopt;
    };
    double stated = last - first + 1;
    if (const auto frames = number("POINT:FRAMES"); frames && std::isfinite(*frames))
      stated = std::max(stated, *frames);
    const auto from = field("TRIAL:ACTUAL_START_FIELD"), to = field("TRIAL:ACTUAL_END_FIELD");
    if (from && to && *to >= *from) stated = *to - *from + 1;
    const std::size_t bytes = (4 * points_ + analog_) * (scale_ < 0 ? 4 : 2),
                      held = (file_.size() - begin_) / bytes;
    if (stated > double(held)) {
      out_.warnings.push_back(
          fmt::format("{}: its head says {:.0f} frames, it holds {}", out_.name, stated, held));
      stated = double(held);
    }
    if (!(stated >= 1)) throw UnfitError(out_.name + ": it holds no frame of markers");
    if (stated > limits::kMotionFrames)
      throw LimitError(fmt::format("{}: more than {} frames", out_.name, limits::kMotionFrames));
    frames_ = std::size_t(stated);
  }

  // POINT:LABELS holds 255 at most; the others are in LABELS2 and so on.
  void read_labels() {
    std::vector<std::string> labels;
    for (int k = 1; k <= 99 && labels.size() < points_; ++k) {
      const std::vector<std::string> more =
          texts(k == 1 ? std::string("POINT:LABELS") : fmt::format("POINT:LABELS{}", k));
      if (more.empty()) break;
      labels.insert(labels.end(), more.begin(), more.end());
    }
    std::map<std::string, int> times;
    for (std::size_t m = 0; m < points_; ++m) {
      std::string name =
          m < labels.size() && !labels[m].empty() ? labels[m] : fmt::format("unnamed {}", m + 1);
      if (times[name]++ > 0) name += fmt::format(" ({})", m + 1);
      out_.markers.push_back(std::move(name));
    }
  }

  void read_frames() {
    const bool floats = scale_ < 0;
    const std::size_t size = floats ? 4 : 2, row = (4 * points_ + analog_) * size;
    for (std::size_t f = 0; f < frames_; ++f) {
      Points& places = out_.frames.emplace_back(Eigen::Index(points_), 3);
      for (std::size_t m = 0; m < points_; ++m) {
        const std::size_t at = begin_ + f * row + 4 * size * m;
        const auto value = [&](std::size_t k) {
          return floats ? file_.real(at + size * k) : double(file_.word(at + size * k));
        };
        const double residual = value(3);
        bool seen = residual >= 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const double place = (floats ? 1 : scale_) * value(k);
          places(Eigen::Index(m), Eigen::Index(k)) = place;
          seen = seen && std::isfinite(place) && std::abs(place) < 1e7;
        }
        if (!seen)
          places.row(Eigen::Index(m)).setConstant(std::numeric_limits<double>::quiet_NaN());
      }
    }
  }

  C3dBytes file_;
  MarkerTake out_;
  std::map<std::string, C3dParameter> parameters_;  // "POINT:RATE"
  std::size_t points_ = 0, analog_ = 0, begin_ = 0, frames_ = 0;
  double scale_ = -1;
  std::string unit_;
};

}  // namespace

bool is_c3d(std::string_view bytes) {
  return bytes.size() >= 2 && std::uint8_t(bytes[0]) >= 2 && std::uint8_t(bytes[1]) == kMagic;
}

MarkerTake parse_c3d(std::string_view bytes, const std::string& name,
                     const std::optional<double>& fps) {
  return C3dReader(bytes, name).read(fps);
}

}  // namespace ecorche::inline v1
