// Private to the writers of .glb files: builds the one buffer, the accessors over it, and the parts
// that these files share.
#pragma once

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "anatomy/base_mesh/skin_texture.h"
#include "anatomy/base_mesh/tissue_look.h"
#include "anatomy/skeleton.h"
#include "skinning/binding.h"

namespace ecorche::inline v1::gltf {

// glTF's base colour of a tissue: in proportion to light, opaque.
std::array<double, 4> base_color(const TissueLook& look);

// A colour that the material's base colour is multiplied by, 8 bits each, the last one opacity.
using Tint = std::array<std::uint8_t, 4>;

class GlbBuilder {
 public:
  GlbBuilder();

  tinygltf::Model& model() { return model_; }
  const tinygltf::Model& model() const { return model_; }
  tinygltf::Scene& scene() { return model_.scenes[0]; }

  int add_node(tinygltf::Node node, int parent = -1);

  template <class T>
  int add_accessor(const std::vector<T>& values, int component_type, int type, int components,
                   int target, bool bounds = false) {
    const size_t start = align();
    auto& bytes = model_.buffers[0].data;
    const auto* data = reinterpret_cast<const unsigned char*>(values.data());
    bytes.insert(bytes.end(), data, data + values.size() * sizeof(T));

    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = start;
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    model_.bufferViews.push_back(view);

    tinygltf::Accessor accessor;
    accessor.bufferView = int(model_.bufferViews.size()) - 1;
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = values.size() / components;
    if (bounds) {
      accessor.minValues.assign(components, std::numeric_limits<double>::infinity());
      accessor.maxValues.assign(components, -std::numeric_limits<double>::infinity());
      for (size_t i = 0; i < values.size(); ++i) {
        accessor.minValues[i % components] =
            std::min(accessor.minValues[i % components], double(values[i]));
        accessor.maxValues[i % components] =
            std::max(accessor.maxValues[i % components], double(values[i]));
      }
    }
    model_.accessors.push_back(accessor);
    return int(model_.accessors.size()) - 1;
  }

  int add_vectors(const Points& points, bool bounds);

  int add_scalars(const std::vector<float>& values, bool bounds, int target);

  // Normalised 16-bit integers for -1 .. 1.
  int add_normalized_shorts(const std::vector<std::int16_t>& values, int type, int components);

  // TEXCOORD_0 with its origin in the lower left; glTF has it in the upper left.
  int add_texture_coordinates(const TexturePoints& places);

  int add_tints(const std::vector<Tint>& tints);

  // The material of a tissue, made on first use. `brighter`: a factor of its colour, for tints that
  // only darken.
  int material(const TissueLook& look, float brighter = 1);

  int add_indices(const Triangles& F);

  // A primitive with POSITION and NORMAL; further attributes and indices are the caller's.
  tinygltf::Primitive surface(const Points& V, const Points& normals, int indices, int material);

  // Returns its index.
  int add_mesh(const std::string& name, std::vector<tinygltf::Primitive> primitives);

  // A mesh with normals; the caller may add attributes to the returned primitive.
  tinygltf::Primitive& add_mesh(const std::string& name, const TriMesh& mesh, int material);

  void add_influences(tinygltf::Primitive& primitive,
                      std::span<const std::array<Influence, 4>> influences);

  static Points unit_normals(const TriMesh& mesh);

  // Stores JSON that is inserted only when the file is written. Strips have nearly all of a
  // character's numbers, and one by one as tinygltf::Value they cost several times as much as the
  // rest of the file. Returns a placeholder for an object of extras by the name "strips".
  // Placeholders must be used in the order of these calls.
  tinygltf::Value keep_text(std::string json);

  // The whole file. False when it cannot be written.
  bool write(std::ostream& out);

 private:
  size_t align();

  tinygltf::Model model_;
  std::vector<std::string> texts_;
};

// Joint nodes in skeleton order, so that node index = joint index, and the glTF skin 0 over them.
// Call it first.
void add_joints(GlbBuilder& glb, const Skeleton& skeleton);

void add_channel(tinygltf::Animation& animation, int node, const char* path, int times, int values);

enum class RotationKeys { floats, shorts };  // shorts: as quantized_rotations.h has them

// An animation of the joints, a key a frame, or one key for constant joints. Returns the accessor
// of its times.
int add_motion(GlbBuilder& glb, const Skeleton& skeleton, const Motion& motion,
               const std::string& name, RotationKeys keys = RotationKeys::floats);

}  // namespace ecorche::inline v1::gltf
