// Private to the readers of glTF: container, JSON and accessors of one file held in memory, every
// index and length checked. Reads .glb and, told by its first bytes, .gltf.
//
// Buffers lie in the second chunk, in data: URIs, or, where the caller names the folder, in files
// of that folder, by a plain name. Images, materials and animations are never looked at.
// A file takes memory in proportion to its bytes, however often it names the same data: what is
// handed out beyond that counts against limits::kRepeatedElements.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "anatomy/limits.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Where the parts of a .glb lie. Throws InputError "name: reason".
struct GlbParts {
  std::string_view json, binary;  // binary: empty where there is no second chunk
};
GlbParts split_glb(std::string_view bytes, const std::string& name);

// glTF's JSON. Throws InputError for anything but an object, LimitError for what is nested deeper
// than limits::kJsonDepth, which no reader of ours then meets, larger than `limit` bytes or of more
// than `values` values; 0: a quarter of `limit`.
template <class Json>
Json parse_gltf_json(std::string_view text, const std::string& name, std::size_t limit,
                     std::size_t values = 0);

class GltfFile {
 public:
  using Json = nlohmann::json;

  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using WholeRows = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // `bytes` must outlive the file; `name` is what messages call it. `folder`: where the buffers
  // that a .gltf names by files lie; without it they are refused. Throws as split_glb and
  // parse_gltf_json.
  GltfFile(std::string_view bytes, std::string name,
           std::optional<std::filesystem::path> folder = std::nullopt);

  const Json& root() const { return root_; }
  const std::string& name() const { return name_; }
  [[noreturn]] void fail(const std::string& message) const;  // InputError "name: message"

  // Elements of a top-level list; `item` throws InputError where it is not there.
  std::size_t count(const char* list) const;
  const Json& item(const char* list, std::size_t index) const;

  // A member that is a whole number not below 0; `otherwise` where it is missing, InputError where
  // it must not be.
  std::size_t whole(const Json& object, const char* key,
                    std::optional<std::size_t> otherwise = std::nullopt) const;

  // Values of an accessor, sparse ones and those without a buffer (zeros) included; whole numbers
  // marked as normalised become -1 .. 1. InputError that names it for anything out of its buffer,
  // of another shape or not finite; UnfitError where it is compressed.
  Rows rows(std::size_t accessor, std::size_t columns) const;  // #items x columns, 1 .. 4
  // SCALAR .. VEC4 of a whole component type, as they stand: JOINTS_0.
  WholeRows whole_rows(std::size_t accessor, std::size_t columns) const;
  Points points(std::size_t accessor) const;  // VEC3, of any component type
  std::vector<int> corners(std::size_t accessor,
                           std::size_t vertices) const;  // SCALAR, whole numbers below `vertices`
  std::vector<double> scalars(std::size_t accessor) const;  // SCALAR, of any component type
  std::vector<Eigen::Matrix4d> matrices(std::size_t accessor) const;  // MAT4, column by column
  std::string shape_of(std::size_t accessor) const;                   // "SCALAR" .. "MAT4"
  std::size_t size_of(std::size_t accessor) const {
    return whole(item("accessors", accessor), "count");
  }

  // Parents of all nodes, -1 for those that have none. Throws InputError for what is no forest: two
  // parents, a node below itself.
  std::vector<int> parents() const;

  // Throws InputError for a bufferView that reaches beyond its buffer and an accessor beyond its
  // bufferView, whether used or not; those of buffers outside the file are left alone.
  void check_views() const;

  // The bytes of a bufferView: images.
  std::string_view view_bytes(std::size_t view) const;

 private:
  struct Values {  // where an accessor's items lie; no bytes: all are zero
    std::string_view bytes;
    std::size_t count = 0, columns = 0, stride = 0, component = 0, type = 0;
    double scale = 1;
    bool is_zero = false;
  };

  std::string_view buffer_bytes(std::size_t buffer) const;
  Values values(std::size_t accessor, const std::string& shape) const;
  Values items(std::size_t view, std::size_t offset, std::size_t type, std::size_t count,
               std::size_t columns, std::size_t accessor) const;
  double number(const Values& values, std::size_t accessor, std::size_t row,
                std::size_t column) const;
  template <class T>
  void copy(std::size_t accessor, const Values& values, T* out) const;
  std::vector<std::size_t> sparse_rows(std::size_t accessor, const Values& items) const;
  void count_elements(std::size_t more) const;

  std::string name_;
  std::optional<std::filesystem::path> folder_;
  GlbParts parts_;
  mutable std::map<std::size_t, std::string> buffers_;  // those of data: URIs and of files
  Json root_;
  mutable std::size_t allowed_ = 0;  // more once a buffer is read from its file
  mutable std::size_t handed_out_ = 0;
};

// --- implementation of the template ----------------------------------------------------

namespace gltf_detail {
void check_text(std::string_view text, const std::string& name, std::size_t limit,
                std::size_t most_values);
[[noreturn]] void refuse(const std::string& name, const std::string& message);
}  // namespace gltf_detail

template <class Json>
Json parse_gltf_json(std::string_view text, const std::string& name, std::size_t limit,
                     std::size_t values) {
  gltf_detail::check_text(text, name, limit, values == 0 ? limit / 4 : values);
  try {
    Json out = Json::parse(text);
    if (!out.is_object()) gltf_detail::refuse(name, "the JSON is no object");
    return out;
  } catch (const nlohmann::json::exception& e) {
    gltf_detail::refuse(name, e.what());
  }
}

}  // namespace ecorche::inline v1
