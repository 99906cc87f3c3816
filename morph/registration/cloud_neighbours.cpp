#include "morph/registration/cloud_neighbours.h"

#include <array>
#include <cmath>
#include <vector>

#include <nanoflann.hpp>

#include "anatomy/compute/parallel_ranges.h"

namespace ecorche::inline v1 {
namespace {

struct CloudAdaptor {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return points.rows(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points(i, axis); }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using CloudTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, CloudAdaptor>,
                                        CloudAdaptor, 3, int>;

}  // namespace

CloudNeighbours nearest_neighbours(const Points& points, int count) {
  constexpr int kLeaf = 16;
  constexpr std::size_t kGrain = 2000;
  const std::size_t n = points.rows();
  CloudNeighbours out{count, std::vector<int>(n * count), std::vector<float>(n * count)};
  if (n == 0) return out;
  const CloudAdaptor adaptor{points};
  const CloudTree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf));
  parallel_for_ranges(n, kGrain, Threads::all, [&](std::size_t first, std::size_t last) {
    std::vector<int> found(count + 1);
    std::vector<double> squared(count + 1);
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t got =
          tree.knnSearch(points.row(i).data(), count + 1, found.data(), squared.data());
      std::size_t k = 0;
      for (std::size_t f = 0; f < got && k < std::size_t(count); ++f) {
        if (found[f] == int(i)) continue;
        out.index[i * count + k] = found[f];
        out.distance[i * count + k++] = float(std::sqrt(squared[f]));
      }
      for (; k < std::size_t(count); ++k) out.index[i * count + k] = int(i);
    }
  });
  return out;
}

}  // namespace ecorche::inline v1
