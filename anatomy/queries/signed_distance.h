// Signed distance to a closed skin, its gradient, and the winding number: where a point lies with
// respect to the body.
//
// Distances come from a bounding volume tree over the triangles; their sign from the angle-weighted
// pseudonormal at the nearest feature (Baerentzen & Aanaes 2005, 10.1109/TVCG.2005.49). The winding
// number (tree of dipoles, Barill et al. 2018, 10.1145/3197517.3201337) does not depend on that and
// serves as the judge of inside and outside.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct SkinPoint {
  double distance = 0;            // metres, negative inside
  Vec3 point = Vec3::Zero();      // nearest point of the skin
  Vec3 gradient = Vec3::UnitY();  // of the distance, unit length; outwards
  int triangle = -1;
};

// Queries are const and may run in several threads.
class SkinField {
 public:
  // Precondition: a closed, consistently wound mesh (outward normals), at least one triangle;
  // vertices without triangles are fine. Throws std::invalid_argument otherwise.
  explicit SkinField(const TriMesh& skin);

  // `seed`: a triangle thought to be near (an earlier answer), or -1. It changes the time, not the
  // answer.
  SkinPoint nearest(const Vec3& p, int seed = -1) const;
  double distance(const Vec3& p, int seed = -1) const { return nearest(p, seed).distance; }

  // The same, but what seems outside is so only where the winding number says it, too: where folds
  // of the skin (lips, a chin on the neck) cross, the nearest triangle may face either way.
  SkinPoint nearest_judged(const Vec3& p, int seed = -1) const;

  // 1 inside a simple closed skin, 0 outside; to about 0.01.
  double winding_number(const Vec3& p) const;

 private:
  struct Node {
    Vec3 low, high;
    int begin = 0, end = 0;  // triangles order_[begin, end)
    int right = -1;  // index of the second child, the first follows its parent; -1 for leaves
    Vec3 center = Vec3::Zero();  // area-weighted, of the dipole
    Vec3 area = Vec3::Zero();    // sum of area vectors
    double radius = 0;           // of the ball about `center` around all triangles
  };

  int build(int begin, int end, const std::vector<Vec3>& centroids);
  void closest_in_triangle(int f, const Vec3& p, double& best, SkinPoint& out, int& feature) const;
  Vec3 feature_normal(int f, int feature) const;

  Points V_;
  Triangles F_;             // in tree order
  std::vector<int> order_;  // tree order -> the caller's triangle
  std::vector<int> place_;  // the caller's triangle -> tree order
  std::vector<Node> nodes_;
  std::vector<Vec3> vertex_normals_;
  std::vector<Vec3> edge_normals_;  // 3 a triangle: opposite of corner 0, 1, 2
};

}  // namespace ecorche::inline v1
