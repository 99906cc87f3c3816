#include "morph/registration/point_tree.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <vector>

namespace ecorche::inline v1 {
namespace {

struct Cloud {
  std::vector<std::array<float, 6>> rows;

  std::size_t kdtree_get_point_count() const { return rows.size(); }
  float kdtree_get_pt(std::size_t row, std::size_t axis) const { return rows[row][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

std::array<float, 6> place(const Vec3& point, const Vec3& normal, double reach) {
  return {float(point.x()),          float(point.y()),          float(point.z()),
          float(reach * normal.x()), float(reach * normal.y()), float(reach * normal.z())};
}

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 6>;

}  // namespace

struct PointTree::Impl {
  double reach;
  Cloud cloud;
  Tree tree;

  Impl(const SurfacePoints& surface, double reach_of)
      : reach(reach_of), cloud(rows_of(surface, reach_of)), tree(6, cloud, {16}) {
    tree.buildIndex();
  }

  static Cloud rows_of(const SurfacePoints& surface, double reach) {
    Cloud out;
    out.rows.reserve(std::size_t(surface.points.rows()));
    for (Eigen::Index i = 0; i < surface.points.rows(); ++i)
      out.rows.push_back(place(surface.points.row(i), surface.normals.row(i), reach));
    return out;
  }
};

PointTree::PointTree(const SurfacePoints& surface, double reach)
    : impl_(std::make_unique<Impl>(surface, reach)) {}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

NearPoint PointTree::nearest(const Vec3& point, const Vec3& normal) const {
  const auto query = place(point, normal, impl_->reach);
  std::uint32_t index = 0;
  float squared = 0;
  impl_->tree.knnSearch(query.data(), 1, &index, &squared);
  return {int(index), std::sqrt(double(squared))};
}

}  // namespace ecorche::inline v1
