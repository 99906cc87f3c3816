#include "viewer/film/film_check.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <system_error>
#include <vector>

namespace ecorche {
namespace {

struct Box {
  std::uint64_t begin = 0, end = 0;  // of what it holds, bytes from the file's beginning
};
using Boxes = std::map<std::string, Box, std::less<>>;  // the first of each type

std::optional<std::uint64_t> read_number(std::ifstream& in, int bytes) {
  std::uint64_t number = 0;
  for (int i = 0; i < bytes; ++i) {
    const int byte = in.get();
    if (byte < 0) return std::nullopt;
    number = number << 8 | std::uint64_t(byte);
  }
  return number;
}

// The boxes side by side in [begin, end); none where they do not fill it.
std::optional<Boxes> read_boxes(std::ifstream& in, Box within) {
  constexpr std::uint64_t head = 8, long_head = 16;
  Boxes boxes;
  for (std::uint64_t at = within.begin; at < within.end;) {
    in.clear();
    in.seekg(std::streamoff(at));
    const auto size = read_number(in, 4);
    std::string type(4, ' ');
    if (!size || !in.read(type.data(), 4)) return std::nullopt;
    const auto whole = *size == 1 ? read_number(in, 8) : size;
    const std::uint64_t least = *size == 1 ? long_head : head;
    if (!whole || *whole < least || *whole > within.end - at) return std::nullopt;
    boxes.try_emplace(type, Box{at + least, at + *whole});
    at += *whole;
  }
  return boxes;
}

// The sizes of a film's samples (box stsz); none where the table is not whole.
std::optional<std::vector<std::uint64_t>> read_sample_sizes(std::ifstream& in, Box table) {
  in.clear();
  in.seekg(std::streamoff(table.begin));
  const auto version = read_number(in, 4), all_alike = read_number(in, 4),
             count = read_number(in, 4);
  constexpr std::uint64_t head = 12;
  if (!version || !count || table.end - table.begin < head) return std::nullopt;
  if (*all_alike > 0)
    return std::vector<std::uint64_t>(*count <= 1u << 24 ? *count : 0, *all_alike);
  if (*count > (table.end - table.begin - head) / 4) return std::nullopt;
  std::vector<std::uint64_t> sizes;
  for (std::uint64_t i = 0; i < *count; ++i) sizes.push_back(read_number(in, 4).value_or(0));
  return sizes;
}

}  // namespace

std::string film_fault(const std::filesystem::path& file, int frames) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) return error.message();
  if (bytes == 0) return "it is empty";
  std::ifstream in(file, std::ios::binary);
  const auto outer = read_boxes(in, {0, bytes});
  if (!outer) return fmt::format("it breaks off after {} bytes", bytes);
  if (!outer->contains("ftyp") || !outer->contains("moov") || !outer->contains("mdat"))
    return "it has no pictures";
  Boxes boxes = *outer;
  for (const char* inner : {"moov", "trak", "mdia", "minf", "stbl"}) {
    const auto box = boxes.find(inner);
    const auto held = box == boxes.end() ? std::nullopt : read_boxes(in, box->second);
    if (!held) return fmt::format("it has no table of its pictures ({})", inner);
    boxes = *held;
  }
  const auto table = boxes.find("stsz");
  const auto sizes = table == boxes.end() ? std::nullopt : read_sample_sizes(in, table->second);
  if (!sizes) return "it has no table of its pictures (stsz)";
  if (sizes->size() != std::size_t(frames))
    return fmt::format("it has {} pictures of {}", sizes->size(), frames);
  const Box data = outer->at("mdat");
  const std::uint64_t needed = std::accumulate(sizes->begin(), sizes->end(), std::uint64_t{0});
  if (needed > data.end - data.begin)
    return fmt::format("{} bytes of its pictures are missing", needed - (data.end - data.begin));
  return {};
}

}  // namespace ecorche
