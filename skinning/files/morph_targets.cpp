#include "skinning/files/morph_targets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>

#include "skinning/morphs/join_shapes.h"

namespace ecorche::inline v1::gltf {
namespace {

using tinygltf::Value;

bool fits(const MeshShapes& shapes, Eigen::Index vertices, std::size_t frames) {
  return shapes.shapes.rows() == 3 * vertices && shapes.curves.rows() == Eigen::Index(frames) &&
         shapes.curves.cols() == shapes.shapes.cols();
}

// One accessor a column, all of them in one view.
std::vector<int> add_columns(GlbBuilder& glb, const Eigen::MatrixXf& columns) {
  std::vector<int> out;
  const std::vector<float> all(columns.data(), columns.data() + columns.size());
  const int whole = glb.add_accessor(all, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3,
                                     TINYGLTF_TARGET_ARRAY_BUFFER);
  tinygltf::Model& model = glb.model();
  const tinygltf::Accessor first = model.accessors[whole];
  model.bufferViews[first.bufferView].byteStride = 3 * sizeof(float);
  model.accessors.pop_back();  // it only brought the view
  for (Eigen::Index m = 0; m < columns.cols(); ++m) {
    const Eigen::Map<const Eigen::Matrix3Xf> offsets(columns.col(m).data(), 3, columns.rows() / 3);
    const Eigen::Vector3d low = offsets.rowwise().minCoeff().cast<double>(),
                          high = offsets.rowwise().maxCoeff().cast<double>();
    tinygltf::Accessor accessor = first;
    accessor.byteOffset = std::size_t(m) * std::size_t(columns.rows()) * sizeof(float);
    accessor.count = std::size_t(columns.rows() / 3);
    accessor.minValues.assign(low.data(), low.data() + 3);
    accessor.maxValues.assign(high.data(), high.data() + 3);
    model.accessors.push_back(std::move(accessor));
    out.push_back(int(model.accessors.size()) - 1);
  }
  return out;
}

void add_targets(GlbBuilder& glb, int node, const MeshShapes& shapes) {
  const std::vector<int> places = add_columns(glb, shapes.shapes);
  std::vector<int> normals;
  if (shapes.normals.cols() == shapes.shapes.cols()) normals = add_columns(glb, shapes.normals);
  tinygltf::Mesh& mesh = glb.model().meshes[glb.model().nodes[node].mesh];
  for (tinygltf::Primitive& primitive : mesh.primitives) {
    const tinygltf::Accessor& rest = glb.model().accessors[primitive.attributes.at("POSITION")];
    if (3 * rest.count != std::size_t(shapes.shapes.rows()))
      throw std::invalid_argument("the shapes belong to another mesh");
    for (std::size_t m = 0; m < places.size(); ++m) {
      std::map<std::string, int> target{{"POSITION", places[m]}};
      if (!normals.empty()) target["NORMAL"] = normals[m];
      primitive.targets.push_back(std::move(target));
    }
  }
  mesh.weights.assign(places.size(), 0);
}

void add_curves(GlbBuilder& glb, int node, const MeshShapes& shapes, int times) {
  std::vector<std::int16_t> weights;
  for (Eigen::Index f = 0; f < shapes.curves.rows(); ++f)
    for (Eigen::Index m = 0; m < shapes.curves.cols(); ++m)
      weights.push_back(
          std::int16_t(std::lround(32767 * std::clamp(shapes.curves(f, m), 0.0f, 1.0f))));
  add_channel(glb.model().animations.back(), node, "weights", times,
              glb.add_normalized_shorts(weights, TINYGLTF_TYPE_SCALAR, 1));
}

}  // namespace

void check_shapes(const Character& character, const Motion* motion, const ClipShapes* shapes) {
  if (!shapes) return;
  if (!motion) throw std::invalid_argument("shapes without their motion cannot be written");
  const std::size_t frames = motion->frames.size();
  if (shapes->muscles.size() != character.anatomy.muscles.size())
    throw std::invalid_argument("the shapes belong to another anatomy");
  if (!character.own && !fits(shapes->skin, character.body.skin.V.rows(), frames))
    throw std::invalid_argument("the shapes belong to another skin or motion");
  for (const MeshShapes& mesh : shapes->muscles)
    if (!fits(mesh, mesh.shapes.rows() / 3, frames))
      throw std::invalid_argument("the shapes belong to another motion");
}

MeshShapes seamed_shapes(const MeshShapes& skin, const SkinTexture& texture) {
  return texture.empty() ? skin : shape_rows(skin, texture.vertex);
}

void add_morphs(GlbBuilder& glb, const MorphedNodes& nodes, int times) {
  for (const auto& [node, shapes] : nodes) {
    if (shapes.shapes.cols() == 0) continue;
    add_targets(glb, node, shapes);
    add_curves(glb, node, shapes, times);
  }
}

Value shapes_notes(const GlbBuilder& glb, const MorphedNodes& nodes) {
  struct Sum {
    int count = 0;
    double most = 0, square = 0, places = 0;
  };
  std::map<std::string, Sum> sums;
  for (const auto& [node, shapes] : nodes) {
    Sum& sum = sums[glb.model().nodes[node].name == "skin" ? "skin" : "muscles"];
    const double places = double(shapes.shapes.rows() / 3) * double(shapes.curves.rows());
    sum.count += int(shapes.shapes.cols());
    sum.most = std::max(sum.most, shapes.max_error);
    sum.square += places * shapes.rms_error * shapes.rms_error;
    sum.places += places;
  }
  Object out{{"unit", text("m")}};
  for (const auto& [name, sum] : sums)
    out[name] = Value(Object{{"shapes", Value(sum.count)},
                             {"rms", number(std::sqrt(sum.square / std::max(1.0, sum.places)))},
                             {"max", number(sum.most)}});
  return Value(std::move(out));
}

}  // namespace ecorche::inline v1::gltf
