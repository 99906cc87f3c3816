#include "anatomy/mesh_files/glb_bytes.h"

#include <cstdint>
#include <cstring>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

std::string word(std::size_t value) {
  if (value > 0xFFFFFFFFu) throw LimitError("a .glb file holds at most 4 GB");
  const auto number = std::uint32_t(value);
  std::string out(4, '\0');
  std::memcpy(out.data(), &number, 4);
  return out;
}

}  // namespace

std::string glb_bytes(std::string_view json, std::string_view binary) {
  const std::string text = std::string(json) + std::string((4 - json.size() % 4) % 4, ' ');
  const std::size_t padding = (4 - binary.size() % 4) % 4;
  std::string out = "glTF" + word(2) + word(28 + text.size() + binary.size() + padding) +
                    word(text.size()) + "JSON" + text + word(binary.size() + padding) +
                    std::string("BIN\0", 4);
  out += binary;
  out.append(padding, '\0');
  return out;
}

}  // namespace ecorche::inline v1
