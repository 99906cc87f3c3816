#include "skinning/crowd/crowd_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/crowd/crowd_layout.h"
#include "skinning/crowd/crowd_text.h"
#include "skinning/files/quantized_rotations.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kShortCrowdMotion = 5122, kFloatCrowdMotion = 5126;

// An animation under way: keys and the accessors over them, behind the bytes that are there
// already.
struct Keys {
  Json& document;
  std::size_t begin = 0;  // of `bytes` in the only buffer
  std::string bytes;
  Json channels = Json::array(), samplers = Json::array();

  template <class T>
  std::size_t add(const std::vector<T>& values, std::size_t components, int component,
                  const char* type, bool normalized) {
    document["bufferViews"].push_back({{"buffer", 0},
                                       {"byteOffset", begin + bytes.size()},
                                       {"byteLength", values.size() * sizeof(T)}});
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    Json accessor{{"bufferView", document["bufferViews"].size() - 1},
                  {"componentType", component},
                  {"count", values.size() / components},
                  {"type", type}};
    if (normalized) accessor["normalized"] = true;
    document["accessors"].push_back(std::move(accessor));
    return document["accessors"].size() - 1;
  }

  std::size_t add_times(const std::vector<float>& seconds) {
    const std::size_t out = add(seconds, 1, kFloatCrowdMotion, "SCALAR", false);
    document["accessors"][out]["min"] = Json::array({seconds.front()});
    document["accessors"][out]["max"] = Json::array({seconds.back()});
    return out;
  }

  void add_channel(const Json& node, const char* path, std::size_t times, std::size_t values) {
    channels.push_back(
        {{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers.push_back({{"input", times}, {"output", values}});
  }
};

// A person's own key times, or those of the one before who has the same.
struct Times {
  std::vector<float> seconds;
  std::size_t accessor = 0;
};

void set_times(const Motion& motion, double begin, Keys& keys, Times& last) {
  std::vector<float> seconds;
  for (std::size_t f = 0; f < motion.frames.size(); ++f)
    seconds.push_back(float(begin + double(f) / motion.fps));
  if (seconds == last.seconds) return;
  last.accessor = keys.add_times(seconds);
  last.seconds = std::move(seconds);
}

// `joints`: nodes of the person's skeleton, whose parent has the unit.
void add_motion(const Motion& motion, const Json& joints, double unit, std::size_t times,
                Keys& keys) {
  std::vector<float> roots;
  for (const Pose& pose : motion.frames)
    for (Eigen::Index k = 0; k < 3; ++k)
      roots.push_back(float((pose.root[k] - kCrowdMiddle[k]) / unit));
  keys.add_channel(joints[0], "translation", times,
                   keys.add(roots, 3, kFloatCrowdMotion, "VEC3", false));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::vector<Quat> turns = continuous_rotations(motion, j);
    std::vector<std::int16_t> values;
    bool turned = false;
    for (const Quat& turn : turns)
      for (const std::int16_t part : quantize(turn)) values.push_back(part);
    for (std::size_t i = 0; i < values.size() && !turned; ++i)
      turned = values[i] != (i % 4 == 3 ? 32767 : 0);
    if (turned)
      keys.add_channel(joints[j], "rotation", times,
                       keys.add(values, 4, kShortCrowdMotion, "VEC4", true));
  }
}

// One buffer in place of several.
std::size_t join_buffers(const CrowdText& text, Json& document) {
  std::vector<std::size_t> begins;
  std::size_t size = 0;
  for (const Json& buffer : document.at("buffers")) {
    begins.push_back(size);
    size += (whole_number(text, buffer, "byteLength") + 3) / 4 * 4;
  }
  for (Json& view : document.at("bufferViews")) {
    const std::size_t buffer = whole_number(text, view, "buffer");
    if (buffer >= begins.size())
      throw InputError(fmt::format("{}: there is no buffer {}", text.file.string(), buffer));
    view["byteOffset"] = begins[buffer] + whole_number(text, view, "byteOffset", 0);
    view["buffer"] = 0;
  }
  return size;
}

void write_word(std::ostream& out, std::size_t value) {
  const std::uint32_t word = value;
  out.write(reinterpret_cast<const char*>(&word), sizeof word);
}

// The buffers as they are, one after the other, a piece at a time.
void copy_buffers(const CrowdText& text, std::ostream& out) {
  constexpr std::size_t kPiece = std::size_t{1} << 24;
  for (std::size_t b = 0; b < text.buffers.size(); ++b) {
    const std::size_t size = whole_number(text, text.document.at("buffers")[b], "byteLength");
    for (std::size_t at = 0; at < size; at += kPiece)
      out << read_buffer(text, b, at, std::min(kPiece, size - at));
    for (std::size_t at = size; at % 4 != 0; ++at) out.put('\0');
  }
}

}  // namespace

void write_crowd_motion(const fs::path& file, const Crowd& crowd, const CrowdMotionOptions& options,
                        const std::function<Motion(const CrowdPerson&)>& move) try {
  const CrowdText& text = *crowd.text;
  AtomicFile out(file);
  Json document = text.document;
  if (document.contains("animations"))
    for (const Json& known : document["animations"])
      if (known.value("name", std::string()) == options.name)
        throw UsageError(
            fmt::format("{}: has a motion '{}' already", text.file.string(), options.name));
  Keys keys{document, join_buffers(text, document), {}};
  Times times;
  double begin = 0;
  for (const std::string& name : crowd.people) {
    const CrowdPerson person = read_crowd_person(crowd, name);
    const Motion motion = move(person);
    if (motion.frames.empty() ||
        std::any_of(motion.frames.begin(), motion.frames.end(), [&](const Pose& pose) {
          return pose.rotations.size() != person.skeleton.joints.size();
        }))
      throw std::invalid_argument("write_crowd_motion: the motion belongs to another skeleton");
    set_times(motion, begin, keys, times);
    const Json& skin =
        document["skins"][whole_number(text, document["nodes"][text.skins.at(name)], "skin")];
    const Json& middle = document["nodes"][text.parents[skin["joints"][0].get<std::size_t>()]];
    const double unit = middle.contains("scale") ? middle["scale"].at(0).get<double>() : 1.0;
    if (!(unit > 0 && unit < 100))
      throw InputError(fmt::format("{}: {}: a unit of {} m", text.file.string(), name, unit));
    add_motion(motion, skin["joints"], unit, times.accessor, keys);
    begin += options.stagger;
  }
  document["animations"].push_back({{"name", options.name},
                                    {"channels", std::move(keys.channels)},
                                    {"samplers", std::move(keys.samplers)}});
  const std::size_t binary = keys.begin + keys.bytes.size();
  document["buffers"] = Json::array({{{"byteLength", binary}}});
  std::string words = document.dump();
  words.resize((words.size() + 3) / 4 * 4, ' ');
  if (28 + words.size() + binary > UINT32_MAX)
    throw LimitError(
        fmt::format("{}: more than the 4 GiB of a .glb; move fewer people", file.string()));
  std::ostream& stream = out.stream();
  stream << "glTF";
  for (const std::size_t word : {std::size_t{2}, 28 + words.size() + binary, words.size()})
    write_word(stream, word);
  stream << "JSON" << words;
  write_word(stream, binary);
  stream.write("BIN\0", 4);
  copy_buffers(text, stream);
  stream << keys.bytes;
  if (!stream) out.fail();
  out.commit();
} catch (const nlohmann::json::exception& e) {
  throw InputError(fmt::format("{}: a damaged crowd: {}", crowd.text->file.string(), e.what()));
}

}  // namespace ecorche::inline v1
