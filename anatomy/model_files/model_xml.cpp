#include "anatomy/model_files/model_xml.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1::model_xml {
namespace {

// How deep elements nest, told by counting tags: the parser recurses, so that this must be known
// before it starts.
int element_depth(std::string_view text) {
  int depth = 0, deepest = 0;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at + 1)) {
    if (text.substr(at).starts_with("<!--")) {
      at = text.find("-->", at);
      if (at == std::string_view::npos) break;
      continue;
    }
    if (at + 1 >= text.size() || text[at + 1] == '!' || text[at + 1] == '?') continue;
    const std::size_t end = text.find('>', at);
    if (end == std::string_view::npos) break;
    if (text[at + 1] == '/')
      --depth;
    else if (text[end - 1] != '/')
      deepest = std::max(deepest, ++depth);
  }
  return deepest;
}

}  // namespace

void load(pugi::xml_document& document, std::string_view text, const std::string& name) {
  if (const int depth = element_depth(text); depth > limits::kXmlDepth)
    throw LimitError(fmt::format("{}: elements nested {} deep; at most {} are read", name, depth,
                                 limits::kXmlDepth));
  const auto result = document.load_buffer(text.data(), text.size());
  if (!result)
    throw InputError(fmt::format("{}: byte {}: {}; is the file complete XML?", name, result.offset,
                                 result.description()));
}

std::vector<double> numbers(std::string_view text, const std::string& where, std::size_t most) {
  std::vector<double> values;
  std::size_t at = 0;
  while (true) {
    at = text.find_first_not_of(" \t\r\n", at);
    if (at == std::string_view::npos) return values;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    std::string_view word = text.substr(at, end - at);
    double value = 0;
    if (!parse_number(word, value))
      throw InputError(fmt::format("{}: '{}' is not a finite number", where,
                                   printable(std::string(word.substr(0, 40)))));
    if (values.size() >= most)
      throw InputError(fmt::format("{}: more than {} numbers", where, most));
    values.push_back(value);
    at = end;
  }
}

double number(std::string_view text, const std::string& where) {
  const auto v = numbers(text, where, 2);
  if (v.size() != 1) throw InputError(fmt::format("{}: one number expected", where));
  return v[0];
}

Vec3 vector3(std::string_view text, const std::string& where) {
  const auto v = numbers(text, where, 4);
  if (v.size() != 3) throw InputError(fmt::format("{}: three numbers expected", where));
  return {v[0], v[1], v[2]};
}

std::string inside(const std::string& from, const std::string& path, const std::string& where) {
  const std::filesystem::path raw(path);
  const std::string normal =
      (std::filesystem::path(from).parent_path() / raw).lexically_normal().generic_string();
  if (raw.is_absolute() || normal == ".." || normal.starts_with("../") || normal.starts_with("/") ||
      path.find('\0') != std::string::npos)
    throw InputError(
        fmt::format("{}: '{}' leaves the model's folder; name the folder that holds all its files "
                    "with --folder",
                    where, printable(path)));
  return normal;
}

Mat3 body_xyz(const Vec3& a) {
  return (Eigen::AngleAxisd(a.x(), Vec3::UnitX()) * Eigen::AngleAxisd(a.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(a.z(), Vec3::UnitZ()))
      .toRotationMatrix();
}

}  // namespace ecorche::inline v1::model_xml
