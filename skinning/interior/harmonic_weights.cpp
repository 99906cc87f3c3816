#include "skinning/interior/harmonic_weights.h"

#include <algorithm>
#include <queue>

namespace ecorche::inline v1 {
namespace {

// Adds up weights of many sources, few at a time.
class Mixer {
 public:
  explicit Mixer(int sources) : sum_(sources, 0.0f) {}

  void add(int source, float weight) {
    float& sum = sum_[source];
    if (sum == 0) touched_.push_back(short(source));
    sum += weight;
  }
  void add(const SourceWeights& of, float factor) {
    for (int k = 0; k < of.count; ++k) add(of.source[k], factor * of.weight[k]);
  }
  // The largest, scaled so that they add up to 1; ready for the next mean.
  SourceWeights take() {
    std::size_t count = touched_.size();
    if (count > SourceWeights::kMost) {
      std::nth_element(touched_.begin(), touched_.begin() + SourceWeights::kMost, touched_.end(),
                       [&](short a, short b) { return sum_[a] > sum_[b]; });
      count = SourceWeights::kMost;
    }
    SourceWeights out;
    float total = 0;
    for (std::size_t k = 0; k < count; ++k) total += sum_[touched_[k]];
    for (std::size_t k = 0; k < count; ++k) {
      const float weight = sum_[touched_[k]] / total;
      if (!(weight > 1e-5f)) continue;
      out.source[out.count] = touched_[k];
      out.weight[out.count++] = weight;
    }
    for (const short s : touched_) sum_[s] = 0;
    touched_.clear();
    return out;
  }

 private:
  std::vector<float> sum_;
  std::vector<short> touched_;
};

}  // namespace

std::vector<SourceWeights> harmonic_weights(const BodyLattice& lattice,
                                            std::span<const SourceWeights> fixed, int sources,
                                            std::span<const SourceWeights> start, int rounds) {
  std::vector<SourceWeights> out(lattice.nodes());
  std::queue<int> front;
  for (int i = 0; i < lattice.nodes(); ++i) {
    if (fixed[i].count > 0) {
      out[i] = fixed[i];
      front.push(i);
    } else if (!start.empty() && start[i].count > 0) {
      out[i] = start[i];
    }
  }
  while (!front.empty()) {  // what has no weights takes those of the nearest source
    const int i = front.front();
    front.pop();
    for (const int other : lattice.links[i])
      if (other >= 0 && out[other].count == 0) {
        out[other] = out[i];
        front.push(other);
      }
  }
  Mixer mixer(sources);
  for (int round = 0; round < rounds; ++round)
    for (int n = 0; n < lattice.nodes(); ++n) {
      const int i = round % 2 == 0 ? n : lattice.nodes() - 1 - n;
      if (fixed[i].count > 0) continue;
      bool any = false;
      for (const int other : lattice.links[i])
        if (other >= 0 && out[other].count > 0) {
          mixer.add(out[other], 1);
          any = true;
        }
      if (any) out[i] = mixer.take();
    }
  return out;
}

SourceWeights largest_weights(std::span<const std::pair<int, double>> weights) {
  int most = 0;
  for (const auto& [source, weight] : weights) most = std::max(most, source);
  Mixer mixer(most + 1);
  for (const auto& [source, weight] : weights) mixer.add(source, float(weight));
  return mixer.take();
}

SourceWeights mix_weights(std::span<const LatticeShare> shares,
                          std::span<const SourceWeights> weights) {
  int most = 0;
  for (const LatticeShare& share : shares)
    for (int k = 0; k < weights[share.node].count; ++k)
      most = std::max(most, int(weights[share.node].source[k]));
  Mixer mixer(most + 1);
  for (const LatticeShare& share : shares) mixer.add(weights[share.node], float(share.weight));
  return mixer.take();
}

}  // namespace ecorche::inline v1
