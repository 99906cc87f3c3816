#include "skinning/crowd/crowd_layout.h"

#include <cmath>

namespace ecorche::inline v1 {

CrowdLayout crowd_layout(const CrowdPrototype& prototype) {
  CrowdLayout out;
  const std::size_t joints = prototype.skeleton.joints.size(), skin = prototype.layers[0].vertices;
  out.unit = kMatrixBytes * joints;
  out.frames = out.unit + sizeof(float);
  out.joints = out.frames + kFrameFloats * sizeof(float) * joints;
  out.weights = out.joints + kJointBytes * skin;
  out.size = out.weights + kWeightBytes * skin;
  for (const CrowdPrototype::Layer& layer : prototype.layers) {
    const std::size_t positions = out.size, normals = positions + kPositionBytes * layer.vertices;
    out.layers.push_back({layer.vertices, positions, normals});
    out.size = normals + kNormalBytes * layer.vertices;
  }
  return out;
}

QuantizedWeights quantize_weights(std::span<const std::array<Influence, 4>> influences) {
  QuantizedWeights out;
  for (const std::array<Influence, 4>& four : influences) {
    double sum = 0;
    for (const Influence& influence : four) sum += influence.weight;
    int left = 65535;
    std::array<int, 4> share{};
    std::size_t largest = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      share[k] = int(std::lround(65535 * four[k].weight / sum));
      left -= share[k];
      if (share[k] > share[largest]) largest = k;
    }
    share[largest] += left;
    for (std::size_t k = 0; k < 4; ++k) {
      out.joints.push_back(
          std::uint8_t(share[k] > 0 ? four[k].joint : 0));  // an unused slot must name joint 0
      out.weights.push_back(std::uint16_t(share[k]));
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
