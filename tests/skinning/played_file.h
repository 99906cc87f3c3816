// What a player of glTF makes of a file: nodes, morph targets, skins. Knows the format alone.
#pragma once

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "anatomy/types.h"

namespace ecorche::test {

class PlayedFile {
 public:
  explicit PlayedFile(const std::filesystem::path& file) {
    std::string error, warning;
    const bool ok = tinygltf::TinyGLTF().LoadBinaryFromFile(&model_, &error, &warning, file);
    EXPECT_TRUE(ok) << error;
    parents_.assign(model_.nodes.size(), -1);
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      for (const int child : model_.nodes[n].children) parents_[child] = int(n);
  }

  const tinygltf::Model& model() const { return model_; }

  int node(const std::string& name) const {
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      if (model_.nodes[n].name == name) return int(n);
    throw std::runtime_error(name);
  }

  // Everything at a key of the animation `motion`; channels of one key stay at it.
  void play(std::size_t frame) {
    for (const tinygltf::Animation& animation : model_.animations) {
      if (animation.name != "motion") continue;
      for (const tinygltf::AnimationChannel& channel : animation.channels) {
        const tinygltf::AnimationSampler& sampler = animation.samplers[channel.sampler];
        const std::size_t keys = model_.accessors[sampler.input].count,
                          key = std::min(frame, keys - 1);
        const std::vector<double> all = numbers(sampler.output);
        const std::size_t size = all.size() / keys;
        const std::vector<double> values(all.begin() + std::ptrdiff_t(key * size),
                                         all.begin() + std::ptrdiff_t((key + 1) * size));
        tinygltf::Node& node = model_.nodes[channel.target_node];
        if (channel.target_path == "rotation") node.rotation = values;
        if (channel.target_path == "translation") node.translation = values;
        if (channel.target_path == "weights") node.weights = values;
      }
    }
  }

  // The vertices of a node's mesh in the world.
  Points world(const std::string& name) const {
    const int n = node(name);
    const tinygltf::Node& own = model_.nodes[n];
    const tinygltf::Primitive& p = model_.meshes[own.mesh].primitives.at(0);
    std::vector<double> places = numbers(p.attributes.at("POSITION"));
    for (std::size_t m = 0; m < own.weights.size(); ++m) {
      const std::vector<double> offsets = numbers(p.targets.at(m).at("POSITION"));
      for (std::size_t k = 0; k < places.size(); ++k) places[k] += own.weights[m] * offsets[k];
    }
    Points out = Eigen::Map<const Points>(places.data(), Eigen::Index(places.size() / 3), 3);
    if (own.skin < 0) {
      const Affine there = frame(n);
      for (Eigen::Index i = 0; i < out.rows(); ++i) out.row(i) = there * Vec3(out.row(i));
      return out;
    }
    const std::vector<Affine> joints = joint_matrices(model_.skins[own.skin]);
    const std::vector<double> which = numbers(p.attributes.at("JOINTS_0")),
                              weights = numbers(p.attributes.at("WEIGHTS_0"));
    for (Eigen::Index i = 0; i < out.rows(); ++i) {
      Vec3 sum = Vec3::Zero();
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t at = 4 * std::size_t(i) + k;
        if (weights[at] != 0)
          sum += weights[at] * (joints.at(std::size_t(which[at])) * Vec3(out.row(i)));
      }
      out.row(i) = sum;
    }
    return out;
  }

  // All numbers of an accessor, normalised ones as they count.
  std::vector<double> numbers(int accessor) const {
    const tinygltf::Accessor& a = model_.accessors.at(std::size_t(accessor));
    const tinygltf::BufferView& view = model_.bufferViews.at(std::size_t(a.bufferView));
    const std::size_t components =
                          std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(a.type))),
                      size = std::size_t(
                          tinygltf::GetComponentSizeInBytes(std::uint32_t(a.componentType))),
                      stride = view.byteStride ? view.byteStride : components * size;
    std::vector<double> out;
    for (std::size_t i = 0; i < a.count; ++i)
      for (std::size_t k = 0; k < components; ++k)
        out.push_back(number(a, &model_.buffers[view.buffer].data.at(
                                    view.byteOffset + a.byteOffset + i * stride + k * size)));
    return out;
  }

 private:
  static double number(const tinygltf::Accessor& a, const unsigned char* from) {
    const auto read = [&](auto value) {
      std::memcpy(&value, from, sizeof value);
      return value;
    };
    switch (a.componentType) {
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return double(read(float{}));
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return a.normalized ? std::max(read(std::int16_t{}) / 32767.0, -1.0) : read(std::int16_t{});
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return read(std::uint16_t{});
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return read(std::uint32_t{});
      default:
        throw std::runtime_error("a component type that the test does not know");
    }
  }

  Affine frame(int n) const {
    const tinygltf::Node& node = model_.nodes[n];
    Affine own = Affine::Identity();
    if (!node.translation.empty())
      own.translate(Vec3(node.translation[0], node.translation[1], node.translation[2]));
    if (!node.rotation.empty())
      own.rotate(Quat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])
                     .normalized());
    return parents_[n] < 0 ? own : frame(parents_[n]) * own;
  }

  std::vector<Affine> joint_matrices(const tinygltf::Skin& skin) const {
    const std::vector<double> binds = numbers(skin.inverseBindMatrices);
    std::vector<Affine> out;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      Affine bind;
      bind.matrix() = Eigen::Map<const Eigen::Matrix4d>(&binds[16 * j]);
      out.push_back(frame(skin.joints[j]) * bind);
    }
    return out;
  }

  tinygltf::Model model_;
  std::vector<int> parents_;
};

}  // namespace ecorche::test
