#include "skinning/motion_files/npy_read.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMostHeader = 65536;

// What stands behind 'key': in the header's dictionary, from its first character that is no blank.
std::string_view value_of(std::string_view header, std::string_view key, const std::string& name) {
  const std::size_t at = header.find(fmt::format("'{}'", key));
  const std::size_t colon = at == std::string_view::npos ? at : header.find(':', at);
  const std::size_t begin =
      colon == std::string_view::npos ? colon : header.find_first_not_of(" ", colon + 1);
  if (begin == std::string_view::npos)
    throw InputError(fmt::format("{}: no '{}' in its head; not an array of NumPy", name, key));
  return header.substr(begin);
}

std::vector<std::size_t> shape_of(std::string_view header, const std::string& name,
                                  std::size_t most) {
  std::string_view text = value_of(header, "shape", name);
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos)
    throw InputError(name + ": malformed shape");
  text = text.substr(1, end - 1);
  std::vector<std::size_t> out;
  double count = 1;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, comma);
    while (word.starts_with(' ')) word.remove_prefix(1);
    text.remove_prefix(std::min(text.size(), comma + 1));
    if (word.empty() && text.empty()) break;
    long long size = 0;
    if (!parse_whole(word, size) || size < 0 || out.size() == 4)
      throw InputError(fmt::format("{}: malformed shape '{}'", name, printable(std::string(word))));
    out.push_back(std::size_t(size));
    count *= double(size);
  }
  if (count > double(most))
    throw LimitError(fmt::format("{}: {:.0f} numbers; the limit is {}", name, count, most));
  return out;
}

template <class T>
void take_values(std::string_view data, std::vector<double>& out) {
  for (std::size_t k = 0; k < out.size(); ++k) {
    T value;
    std::memcpy(&value, data.data() + k * sizeof(T), sizeof(T));
    out[k] = double(value);
  }
}

}  // namespace

NumberArray parse_npy(std::string_view bytes, const std::string& name, std::size_t most) {
  if (!bytes.starts_with(kMagic) || bytes.size() < 12)
    throw InputError(name + ": not an array of NumPy, or cut short");
  const auto byte = [&](std::size_t k) { return std::size_t(std::uint8_t(bytes[k])); };
  const std::size_t version = byte(6);
  if (version < 1 || version > 3)
    throw InputError(
        fmt::format("{}: version {} of NumPy's format; 1 to 3 are read", name, version));
  std::size_t size = byte(8) | byte(9) << 8, begin = 10;
  if (version > 1) size |= byte(10) << 16 | byte(11) << 24, begin = 12;
  if (size > kMostHeader || bytes.size() < begin + size)
    throw InputError(name + ": cut short within its head");
  const std::string_view header = bytes.substr(begin, size), data = bytes.substr(begin + size);

  std::string_view type = value_of(header, "descr", name);
  const std::size_t quote = type.find('\'', 1);
  type = type.starts_with('\'') && quote != std::string_view::npos ? type.substr(1, quote - 1)
                                                                   : std::string_view("structured");
  const bool known = type == "<f4" || type == "<f8" || type == "<i4" || type == "<i8";
  if (!known)
    throw InputError(
        fmt::format("{}: numbers of type '{}'; <f4, <f8, <i4 and <i8 are read: save it "
                    "with .astype('<f8')",
                    name, printable(std::string(type))));
  NumberArray out;
  out.shape = shape_of(header, name, most);
  if (!value_of(header, "fortran_order", name).starts_with("False") && out.shape.size() > 1)
    throw InputError(name +
                     ": stored by columns (fortran_order); save it with numpy.ascontiguousarray");
  std::size_t count = 1;
  for (const std::size_t n : out.shape) count *= n;
  const std::size_t width = type.back() == '4' ? 4 : 8;
  if (data.size() < count * width)
    throw InputError(
        fmt::format("{}: cut short: {} bytes of {} numbers", name, data.size(), count));
  out.values.resize(count);
  if (type == "<f4") take_values<float>(data, out.values);
  if (type == "<f8") take_values<double>(data, out.values);
  if (type == "<i4") take_values<std::int32_t>(data, out.values);
  if (type == "<i8") take_values<std::int64_t>(data, out.values);
  for (std::size_t k = 0; k < count; ++k)
    if (!std::isfinite(out.values[k]))
      throw InputError(fmt::format("{}: row {}: a number that is not finite", name,
                                   k / (count / std::max<std::size_t>(1, out.rows())) + 1));
  return out;
}

}  // namespace ecorche::inline v1
