#include "anatomy/mesh_files/gltf_nodes.h"

#include <fmt/format.h>

#include <cmath>

namespace ecorche::inline v1 {
namespace {

using Json = nlohmann::json;

template <int Count>
Eigen::Matrix<double, Count, 1> numbers(const GltfFile& file, std::size_t node, const char* key,
                                        const Eigen::Matrix<double, Count, 1>& otherwise) {
  const Json& item = file.item("nodes", node);
  const auto found = item.find(key);
  if (found == item.end()) return otherwise;
  Eigen::Matrix<double, Count, 1> out;
  if (!found->is_array() || found->size() != std::size_t(Count))
    file.fail(fmt::format("node {}: '{}' is not {} numbers", node, key, Count));
  for (int k = 0; k < Count; ++k) {
    const Json& value = (*found)[std::size_t(k)];
    out[k] = value.is_number() ? value.get<double>() : std::nan("");
    if (!std::isfinite(out[k])) file.fail(fmt::format("node {}: '{}' is not finite", node, key));
  }
  return out;
}

}  // namespace

Affine node_map(const GltfFile& file, std::size_t node) {
  if (!file.item("nodes", node).contains("matrix")) return node_place(file, node).map();
  const auto m = numbers<16>(file, node, "matrix", Eigen::Matrix<double, 16, 1>::Zero());
  Affine out = Affine::Identity();
  for (int k = 0; k < 12; ++k) out.matrix()(k % 3, k / 3) = m[4 * (k / 3) + k % 3];
  return out;
}

NodePlace node_place(const GltfFile& file, std::size_t node) {
  NodePlace out;
  if (file.item("nodes", node).contains("matrix")) {
    const Affine map = node_map(file, node);
    out.translation = map.translation();
    Mat3 axes = map.linear();
    for (int k = 0; k < 3; ++k) {
      out.scale[k] = axes.col(k).norm();
      if (out.scale[k] > 0) axes.col(k) /= out.scale[k];
    }
    if (axes.determinant() < 0) out.scale.x() *= -1, axes.col(0) *= -1;
    out.rotation = Quat(axes).normalized();
    return out;
  }
  out.translation = numbers<3>(file, node, "translation", out.translation);
  out.scale = numbers<3>(file, node, "scale", out.scale);
  const Eigen::Vector4d q = numbers<4>(file, node, "rotation", Eigen::Vector4d(0, 0, 0, 1));
  if (!(q.norm() > 1e-6)) file.fail(fmt::format("node {}: 'rotation' has no length", node));
  out.rotation = Quat(q[3], q[0], q[1], q[2]).normalized();
  return out;
}

GltfTree::GltfTree(const GltfFile& file) : parents_(file.parents()) {
  const std::size_t count = parents_.size();
  std::vector<std::vector<std::size_t>> children(count);
  for (std::size_t n = 0; n < count; ++n)
    if (parents_[n] >= 0)
      children[std::size_t(parents_[n])].push_back(n);
    else
      order_.push_back(n);
  for (std::size_t at = 0; at < order_.size(); ++at)
    order_.insert(order_.end(), children[order_[at]].begin(), children[order_[at]].end());
  world_.resize(count);
  for (const std::size_t n : order_) {
    world_[n] = node_map(file, n);
    if (parents_[n] >= 0) world_[n] = world_[std::size_t(parents_[n])] * world_[n];
  }
  std::vector<char> seen(count, 1);
  if (file.count("scenes") > 0) {
    seen.assign(count, 0);
    const Json& scene = file.item("scenes", file.whole(file.root(), "scene", 0));
    if (const auto roots = scene.find("nodes"); roots != scene.end() && roots->is_array())
      for (const Json& root : *roots)
        if (root.is_number_unsigned() && root.get<std::size_t>() < count)
          seen[root.get<std::size_t>()] = 1;
    for (const std::size_t n : order_)
      if (parents_[n] >= 0 && seen[std::size_t(parents_[n])]) seen[n] = 1;
  }
  for (std::size_t n = 0; n < count; ++n)
    if (seen[n]) in_scene_.push_back(n);
}

}  // namespace ecorche::inline v1
