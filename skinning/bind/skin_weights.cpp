#include "skinning/bind/skin_weights.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace ecorche::inline v1 {
namespace {

JointWeights four_joint_weights(const WeightRow& row, const FrameTables& tables) {
  WeightRow joints;
  for (Influence w : row) {
    if (w.joint >= tables.first_pair()) continue;
    w.joint = tables.joint_of(w.joint);
    const auto it = std::find_if(joints.begin(), joints.end(),
                                 [&](const Influence& o) { return o.joint == w.joint; });
    if (it == joints.end())
      joints.push_back(w);
    else
      it->weight += w.weight;
  }
  std::stable_sort(joints.begin(), joints.end(),
                   [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  joints.resize(4);
  double sum = 0;
  for (const Influence& w : joints) sum += w.weight;
  JointWeights out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = {joints[k].joint, joints[k].weight / sum};
  return out;
}

// A blend of rows with the blend's weights, for every row of the map. `first` .. `last`: the
// frames or handles that are taken.
std::vector<WeightRow> blend_rows(const Refinement& refinement, const std::vector<WeightRow>& base,
                                  int first, int last) {
  std::vector<WeightRow> rows(refinement.map.rows());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    WeightRow& row = rows[i];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(refinement.map,
                                                                        Eigen::Index(i));
         it; ++it)
      for (const Influence& w : base[it.col()]) {
        if (w.joint < first || w.joint >= last) continue;
        const auto at = std::find_if(row.begin(), row.end(),
                                     [&](const Influence& o) { return o.joint == w.joint; });
        if (at == row.end())
          row.push_back({w.joint, it.value() * w.weight});
        else
          at->weight += it.value() * w.weight;
      }
    std::sort(row.begin(), row.end(),
              [](const Influence& x, const Influence& y) { return x.joint < y.joint; });
    std::erase_if(row, [](const Influence& w) {
      return w.weight < 1e-4;
    });  // the map's small negative entries among them
  });
  return rows;
}

}  // namespace

void thin_weights(std::vector<WeightRow>& rows, double least, int most) {
  for (WeightRow& row : rows) {
    double largest = 0, whole = 0;
    for (const Influence& w : row) {
      largest = std::max(largest, w.weight);
      whole += w.weight;
    }
    double cut = std::min(least, 0.5 * largest);
    if (int(row.size()) > most) {
      std::vector<double> sorted;
      for (const Influence& w : row) sorted.push_back(w.weight);
      std::nth_element(sorted.begin(), sorted.begin() + most, sorted.end(), std::greater<>());
      cut = std::max(cut, sorted[most]);
    }
    double sum = 0;
    for (Influence& w : row) sum += w.weight = std::max(0.0, w.weight - cut);
    std::erase_if(row, [](const Influence& w) { return w.weight <= 0; });
    for (Influence& w : row) w.weight *= whole / sum;
  }
}

std::vector<JointWeights> four_joint_weights(const std::vector<WeightRow>& frames,
                                             const FrameTables& tables) {
  std::vector<JointWeights> out;
  out.reserve(frames.size());
  for (const WeightRow& row : frames) out.push_back(four_joint_weights(row, tables));
  return out;
}

SkinWeights refine_weights(const Refinement& refinement, const SkinWeights& base,
                           const FrameTables& frames, int handle_count) {
  SkinWeights fine{blend_rows(refinement, base.frames, 0, frames.first_pair()), {}};
  for (WeightRow& row : fine.frames) {
    double sum = 0;
    for (const Influence& w : row) sum += w.weight;
    for (Influence& w : row) w.weight /= sum;
  }
  thin_weights(fine.frames, 0.5 * kLeastWeight, kMostJoints);
  std::vector<WeightRow> pairs =
      blend_rows(refinement, base.frames, frames.first_pair(), frames.frame_count());
  thin_weights(pairs, 0.5 * kLeastWeight, kMostPairs);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    fine.frames[i].insert(fine.frames[i].end(), pairs[i].begin(), pairs[i].end());
  if (!base.handles.empty()) {
    fine.handles = blend_rows(refinement, base.handles, 0, handle_count);
    thin_weights(fine.handles, 0.5 * kLeastWeight, kMostHandles);
  }
  return fine;
}

}  // namespace ecorche::inline v1
