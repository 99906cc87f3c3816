#include "skinning/bake/bake_influences.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "anatomy/geometry/vertex_rings.h"
#include "skinning/bake/bake_weights.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;

constexpr std::size_t kMostCandidates = 12;  // bones that weights of a vertex are solved for
constexpr int kBatchBakeInfluences = 16;     // helpers added before weights are solved again
constexpr double kHelperReach = 0.25;   // m; vertices farther from a helper get no weight for it
constexpr double kHelperSpread = 0.10;  // m; falloff by which helpers are ranked as candidates

class RigSolver {
 public:
  RigSolver(const BakeScene& scene, std::vector<BakeFrame>& samples)
      : scene_(scene), samples_(samples), rings_(vertex_neighbours(scene.skin)) {
    rig_.influences.assign(scene.start.begin(), scene.start.end());
  }

  BakeRig run() {
    solve_weights(std::vector<char>(scene_.start.size(), 1));
    add_helpers();
    return std::move(rig_);
  }

 private:
  // Candidate bones of a vertex: joints with a given weight for it or its neighbours, those next to
  // them in the tree, and helpers nearby.
  std::vector<int> candidates(std::size_t vertex) const {
    std::vector<double> share(scene_.joints(), 0);
    const auto add = [&](std::size_t i, double scale) {
      for (const Influence& influence : scene_.start[i])
        share[influence.joint] += scale * influence.weight;
    };
    add(vertex, 1);
    for (const int i : rings_[vertex]) add(std::size_t(i), 0.5 / double(rings_[vertex].size()));
    std::vector<double> spread = share;
    for (std::size_t j = 1; j < share.size(); ++j) {
      const std::size_t parent = scene_.skeleton.joints[j].parent;
      spread[parent] += 0.1 * share[j];
      spread[j] += 0.1 * share[parent];
    }
    double sum = 0;
    for (const double s : spread) sum += s;
    for (const BakeHelper& helper : rig_.helpers) {
      const double distance = (scene_.place(vertex) - helper.rest).norm();
      spread.push_back(
          distance < kHelperReach ? 2 * sum * std::exp(-std::pow(distance / kHelperSpread, 2)) : 0);
    }
    std::vector<int> order;
    for (std::size_t j = 0; j < spread.size(); ++j)
      if (spread[j] > 0) order.push_back(int(j));
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return spread[a] > spread[b]; });
    if (order.size() > kMostCandidates) order.resize(kMostCandidates);
    return order;
  }

  std::array<Influence, 4> solve_vertex(std::size_t vertex) const {
    const BakeOptions& options = scene_.options;
    const std::vector<int> bones = candidates(vertex);
    const Index n = Index(bones.size()), row = Index(vertex);
    const Vec3 X = scene_.place(vertex), N = scene_.normals.row(row);
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n), D(6, n);
    for (const BakeFrame& frame : samples_) {
      const Vec3 wanted = frame.exact.row(row).transpose().cast<double>(),
                 facing = frame.normals.row(row).transpose().cast<double>();
      for (Index k = 0; k < n; ++k) {
        const Transform& T = frame.bones[bones[k]];
        D.col(k).head<3>() = T * X - wanted;
        D.col(k).tail<3>() = options.normal_arm * (T.linear() * N - facing);
      }
      G.noalias() += D.transpose() * D;
    }
    Eigen::VectorXd given = Eigen::VectorXd::Zero(n);
    for (const Influence& influence : scene_.start[vertex])
      for (Index k = 0; k < n; ++k)
        if (bones[k] == influence.joint) given[k] += influence.weight;
    const Eigen::VectorXd w = simplex_weights(
        G, given, double(samples_.size()) * options.keep_weights * options.keep_weights, 4);
    std::array<Influence, 4> out{};
    std::size_t at = 0;
    for (Index k = 0; k < n; ++k)
      if (w[k] > 0) out[at++] = {bones[k], w[k]};
    std::stable_sort(out.begin(), out.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    return out;
  }

  void solve_weights(const std::vector<char>& which) {
    tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t i) {
      if (which[i]) rig_.influences[i] = solve_vertex(i);
    });
  }

  void place_helpers() {
    const std::vector<std::vector<int>> skinned =
        vertices_of_helpers(rig_.influences, scene_.joints(), rig_.helpers.size());
    tbb::parallel_for(std::size_t{0}, samples_.size(), [&](std::size_t f) {
      samples_[f].bones.resize(scene_.joints() + rig_.helpers.size(), Transform::Identity());
      pose_helpers(scene_.skin.V, rig_.patches, skinned, rig_.influences, samples_[f]);
    });
  }

  // Mask of the vertices within reach of a helper from `first` on.
  std::vector<char> reached(std::size_t first) const {
    std::vector<char> out(scene_.start.size(), 0);
    for (std::size_t i = 0; i < out.size(); ++i)
      for (std::size_t h = first; h < rig_.helpers.size(); ++h)
        if ((scene_.place(i) - rig_.helpers[h].rest).norm() < kHelperReach) out[i] = 1;
    return out;
  }

  // Errors by vertex (fourth-power mean over the samples), smoothed over neighbours, #V, m; and the
  // largest error.
  std::pair<Eigen::VectorXd, double> errors_of_influences() const {
    Eigen::VectorXd sum(scene_.skin.V.rows()), most(scene_.skin.V.rows());
    tbb::parallel_for(Index{0}, sum.size(), [&](Index i) {
      sum[i] = most[i] = 0;
      for (const BakeFrame& frame : samples_) {
        const Vec3 played = blended(rig_.influences[i], frame.bones) * scene_.place(std::size_t(i));
        const double d = (played - frame.exact.row(i).transpose().cast<double>()).norm();
        sum[i] += d * d * d * d / double(samples_.size());
        most[i] = std::max(most[i], d);
      }
      sum[i] = std::sqrt(std::sqrt(sum[i]));
    });
    for (int round = 0; round < 2; ++round) {
      const Eigen::VectorXd before = sum;
      for (Index i = 0; i < sum.size(); ++i)
        for (const int k : rings_[i]) sum[i] += (before[k] - before[i]) / double(rings_[i].size());
    }
    return {sum, most.maxCoeff()};
  }

  void add_helpers() {
    const BakeOptions& options = scene_.options;
    while (int(rig_.helpers.size()) < options.helpers) {
      const auto [errors, most] = errors_of_influences();
      if (most < options.helper_error) break;
      const std::size_t first = rig_.helpers.size();
      const int room = options.helpers - int(first);
      for (HelperPatch& patch : choose_helpers(scene_.skin.V, errors, 0.05 * options.helper_error,
                                               std::min(kBatchBakeInfluences, room))) {
        const auto& weights = scene_.start[patch.center];
        const auto heaviest = std::max_element(
            weights.begin(), weights.end(),
            [](const Influence& a, const Influence& b) { return a.weight < b.weight; });
        rig_.helpers.push_back({heaviest->joint, scene_.skin.V.row(patch.center)});
        rig_.patches.push_back(std::move(patch));
      }
      if (rig_.helpers.size() == first) break;
      place_helpers();
      solve_weights(reached(first));
      place_helpers();
    }
    if (rig_.helpers.empty()) return;
    solve_weights(reached(0));
    place_helpers();
  }

  const BakeScene& scene_;
  std::vector<BakeFrame>& samples_;
  const std::vector<std::vector<int>> rings_;
  BakeRig rig_;
};

}  // namespace

BakeRig solve_rig(const BakeScene& scene, std::vector<BakeFrame>& samples) {
  return RigSolver(scene, samples).run();
}

}  // namespace ecorche::inline v1
