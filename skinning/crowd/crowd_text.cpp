#include "skinning/crowd/crowd_text.h"

#include <fmt/format.h>

#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {

void fail(const CrowdText& text, const std::string& what) {
  throw InputError(fmt::format("{}: {}", printable(text.file.string()), printable(what)));
}

std::size_t whole_number(const CrowdText& text, const nlohmann::ordered_json& object,
                         const char* key, std::size_t otherwise) {
  if (!object.contains(key)) return otherwise;
  if (!object.at(key).is_number_unsigned())
    fail(text, fmt::format("'{}' is not a whole number", key));
  return object.at(key).get<std::size_t>();
}

std::size_t whole_number(const CrowdText& text, const nlohmann::ordered_json& object,
                         const char* key) {
  if (!object.contains(key)) fail(text, fmt::format("'{}' is missing", key));
  return whole_number(text, object, key, 0);
}

std::string read_buffer(const CrowdText& text, std::size_t buffer, std::size_t offset,
                        std::size_t size) {
  if (buffer >= text.buffers.size()) fail(text, fmt::format("there is no buffer {}", buffer));
  const CrowdText::Buffer& from = text.buffers[buffer];
  if (offset > from.size || size > from.size - offset)
    fail(text, fmt::format("{} bytes at {} reach beyond {}", size, offset, from.file.string()));
  std::string out(size, '\0');
  std::ifstream in(from.file, std::ios::binary);
  in.seekg(std::streamoff(from.begin + offset));
  if (!in.read(out.data(), std::streamsize(size)))
    fail(text, fmt::format("{} could not be read", from.file.string()));
  return out;
}

}  // namespace ecorche::inline v1
