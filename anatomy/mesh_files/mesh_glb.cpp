#include "anatomy/mesh_files/mesh_glb.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "anatomy/mesh_files/glb_bytes.h"

namespace ecorche::inline v1 {
namespace {

using Json = nlohmann::json;

constexpr int kFloat = 5126, kUint = 5125;                  // component types
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963;  // targets of views

class Builder {
 public:
  Builder() {
    root_["asset"] = {{"version", "2.0"}, {"generator", "ecorche"}};
    root_["scene"] = 0;
    root_["scenes"] = Json::array({{{"nodes", Json::array()}}});
  }

  void add(const MeshPart& part) {
    // A vertex and a place on the texture each.
    std::vector<int> vertex(std::size_t(part.mesh.V.rows()));
    std::vector<Vec2> place(vertex.size(), Vec2::Zero());
    for (std::size_t i = 0; i < vertex.size(); ++i) vertex[i] = int(i);
    std::vector<std::uint32_t> corners(std::size_t(part.mesh.F.size()));
    const bool textured = part.texture.rows() == part.mesh.F.size();
    std::vector<char> placed(vertex.size(), 0);
    std::map<std::pair<int, std::pair<float, float>>, int> more;
    for (Eigen::Index c = 0; c < part.mesh.F.size(); ++c) {
      const int v = part.mesh.F(c / 3, c % 3);
      int at = v;
      if (textured) {
        const Vec2 here(part.texture(c, 0), 1 - part.texture(c, 1));
        if (!placed[std::size_t(v)]) {
          placed[std::size_t(v)] = 1;
          place[std::size_t(v)] = here;
        } else if (place[std::size_t(v)] != here) {
          const auto [found, is_new] =
              more.try_emplace({v, {part.texture(c, 0), part.texture(c, 1)}}, int(vertex.size()));
          if (is_new) {
            vertex.push_back(v);
            place.push_back(here);
          }
          at = found->second;
        }
      }
      corners[std::size_t(c)] = std::uint32_t(at);
    }
    Json attributes;
    attributes["POSITION"] = add_rows(part.mesh.V, vertex, true);
    if (part.normals.rows() == part.mesh.V.rows() &&
        part.normals.rowwise().norm().minCoeff() > 0.99)
      attributes["NORMAL"] = add_rows(part.normals, vertex, false);
    if (part.colours.rows() == part.mesh.V.rows())
      attributes["COLOR_0"] = add_rows(part.colours.cast<double>(), vertex, false);
    if (textured) {
      std::vector<float> values;
      for (const Vec2& one : place) values.insert(values.end(), {float(one.x()), float(one.y())});
      attributes["TEXCOORD_0"] = add_values(values.data(), values.size() * sizeof(float),
                                            place.size(), kFloat, "VEC2", kVertexBuffer);
    }
    const int indices = add_values(corners.data(), corners.size() * sizeof(corners[0]),
                                   corners.size(), kUint, "SCALAR", kIndexBuffer);
    const int number = int(root_["meshes"].size());
    root_["meshes"].push_back(
        {{"primitives", Json::array({{{"attributes", attributes}, {"indices", indices}}})}});
    Json node{{"mesh", number}};
    if (!part.name.empty()) node["name"] = part.name;
    root_["nodes"].push_back(std::move(node));
    root_["scenes"][0]["nodes"].push_back(number);
  }

  std::string bytes() {
    root_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    return glb_bytes(root_.dump(-1, ' ', false, Json::error_handler_t::replace), binary_);
  }

 private:
  int add_rows(const Points& points, const std::vector<int>& rows, bool bounded) {
    std::vector<float> values;
    values.reserve(3 * rows.size());
    for (const int row : rows)
      for (int k = 0; k < 3; ++k) values.push_back(float(points(row, k)));
    const int accessor = add_values(values.data(), values.size() * sizeof(float), rows.size(),
                                    kFloat, "VEC3", kVertexBuffer);
    if (bounded) {
      Json low = Json::array(), high = Json::array();
      for (int k = 0; k < 3; ++k) {
        float least = values[std::size_t(k)], most = least;
        for (std::size_t i = std::size_t(k); i < values.size(); i += 3) {
          least = std::min(least, values[i]);
          most = std::max(most, values[i]);
        }
        low.push_back(least);
        high.push_back(most);
      }
      root_["accessors"][std::size_t(accessor)]["min"] = low;
      root_["accessors"][std::size_t(accessor)]["max"] = high;
    }
    return accessor;
  }

  int add_values(const void* values, std::size_t bytes, std::size_t count, int component,
                 const char* type, int target) {
    const std::size_t start = binary_.size();
    binary_.append(static_cast<const char*>(values), bytes);
    root_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes}, {"target", target}});
    root_["accessors"].push_back({{"bufferView", root_["bufferViews"].size() - 1},
                                  {"componentType", component},
                                  {"count", count},
                                  {"type", type}});
    return int(root_["accessors"].size()) - 1;
  }

  Json root_;
  std::string binary_;
};

}  // namespace

std::string mesh_glb(const MeshFile& file) {
  Builder builder;
  for (const MeshPart& part : file.parts)
    if (part.mesh.F.rows() > 0) builder.add(part);
  return builder.bytes();
}

}  // namespace ecorche::inline v1
