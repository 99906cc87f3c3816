// The glTF text of a crowd and the place of its bytes. Private to the room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace ecorche::inline v1 {

struct CrowdText {
  struct Buffer {
    std::filesystem::path file;
    std::uintmax_t begin = 0, size = 0;
  };
  std::filesystem::path file;
  nlohmann::ordered_json document;
  std::vector<Buffer> buffers;
  std::vector<int> parents;          // #nodes; -1 for roots
  std::map<std::string, int> skins;  // a person's name -> the node of their skin
};

// Throws InputError "FILE: what".
[[noreturn]] void fail(const CrowdText& text, const std::string& what);

// A member that is a whole number not below 0; `otherwise` where it is missing. Throws InputError.
std::size_t whole_number(const CrowdText& text, const nlohmann::ordered_json& object,
                         const char* key, std::size_t otherwise);
std::size_t whole_number(const CrowdText& text, const nlohmann::ordered_json& object,
                         const char* key);

// Bytes of a buffer. Throws InputError for what reaches beyond it.
std::string read_buffer(const CrowdText& text, std::size_t buffer, std::size_t offset,
                        std::size_t size);

}  // namespace ecorche::inline v1
