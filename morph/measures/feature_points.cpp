#include "morph/measures/feature_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

// One piece of a horizontal section.
struct Piece {
  std::vector<Vec3> points;
  double left = -std::numeric_limits<double>::infinity(),
         right = std::numeric_limits<double>::infinity();  // largest and least x

  void add(const Vec3& p) {
    points.push_back(p);
    left = std::max(left, p.x());
    right = std::min(right, p.x());
  }
};

class Sections {
 public:
  explicit Sections(const TriMesh& skin)
      : skin_(skin), floor_(skin.V.col(1).minCoeff()), top_(skin.V.col(1).maxCoeff()) {
    middle_ = 0.5 * (skin.V.col(0).minCoeff() + skin.V.col(0).maxCoeff());
  }
  double stature() const { return top_ - floor_; }
  double middle() const { return middle_; }

  // Pieces that hang together over the triangles that the level cuts.
  std::vector<Piece> at(double height) const {
    const double y = floor_ + height;
    std::map<std::pair<int, int>, int> node_of;
    std::vector<Vec3> points;
    std::vector<int> leader;
    const auto root = [&leader](int i) {
      while (leader[i] != i) i = leader[i];
      return i;
    };
    for (Eigen::Index f = 0; f < skin_.F.rows(); ++f) {
      int first = -1;
      for (int e = 0; e < 3; ++e) {
        int a = skin_.F(f, e), b = skin_.F(f, (e + 1) % 3);
        if ((skin_.V(a, 1) < y) == (skin_.V(b, 1) < y)) continue;
        if (a > b) std::swap(a, b);
        const auto [found, fresh] = node_of.try_emplace({a, b}, int(points.size()));
        if (fresh) {
          const double t = (y - skin_.V(a, 1)) / (skin_.V(b, 1) - skin_.V(a, 1));
          points.push_back((1 - t) * skin_.V.row(a).transpose() + t * skin_.V.row(b).transpose());
          leader.push_back(found->second);
        }
        if (first < 0)
          first = found->second;
        else
          leader[root(found->second)] = root(first);
      }
    }
    std::map<int, Piece> pieces;
    for (std::size_t i = 0; i < points.size(); ++i) pieces[root(int(i))].add(points[i]);
    std::vector<Piece> out;
    for (auto& [_, piece] : pieces) out.push_back(std::move(piece));
    return out;
  }

  // The piece that lies across the middle plane and is widest; null where only limbs are cut.
  const Piece* trunk(const std::vector<Piece>& pieces) const {
    const Piece* best = nullptr;
    for (const Piece& p : pieces)
      if (p.left > middle_ && p.right < middle_ &&
          (best == nullptr || p.left - p.right > best->left - best->right))
        best = &p;
    return best;
  }

 private:
  const TriMesh& skin_;
  double floor_, top_, middle_ = 0;
};

// Perimeter of the convex hull of points of one level.
double hull_girth(std::vector<Vec3> points) {
  if (points.size() < 3) return 0;
  std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
    return std::make_pair(a.x(), a.z()) < std::make_pair(b.x(), b.z());
  });
  const auto turn = [](const Vec3& o, const Vec3& a, const Vec3& b) {
    return (a.x() - o.x()) * (b.z() - o.z()) - (a.z() - o.z()) * (b.x() - o.x());
  };
  double girth = 0;
  for (const bool upper : {false, true}) {
    std::vector<Vec3> chain;
    for (const Vec3& p : points) {
      while (chain.size() >= 2 &&
             (upper ? -1 : 1) * turn(chain[chain.size() - 2], chain.back(), p) <= 0)
        chain.pop_back();
      chain.push_back(p);
    }
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) girth += (chain[i + 1] - chain[i]).norm();
  }
  return girth;
}

// The level between two heights whose girth is largest or smallest.
FeatureGirth extreme(const Sections& sections, double low, double high, double step, bool largest) {
  FeatureGirth best;
  for (double h = low; h <= high; h += step) {
    const std::vector<Piece> pieces = sections.at(h);
    const Piece* trunk = sections.trunk(pieces);
    if (trunk == nullptr) continue;
    const double girth = hull_girth(trunk->points);
    if (best.girth == 0 || (largest ? girth > best.girth : girth < best.girth)) best = {h, girth};
  }
  return best;
}

}  // namespace

BodyFeatures find_features(const TriMesh& skin, double step) {
  constexpr double kShoulders = 0.862, kLowestArmpit = 0.6, kLowestCrotch = 0.3,
                   kHighestCrotch = 0.6;  // of the stature
  constexpr double kLeastBelow = 0.05;    // of the stature, from the bust down to the waist
  // of the stature: lower down, legs that stand apart count as hip
  constexpr double kAboveCrotch = 0.03;
  const Sections sections(skin);
  BodyFeatures out;
  out.stature = sections.stature();
  double armpit = 0;
  for (double h = kShoulders * out.stature; h > kLowestArmpit * out.stature && armpit == 0;
       h -= step) {
    const std::vector<Piece> pieces = sections.at(h);
    const Piece* trunk = sections.trunk(pieces);
    if (trunk == nullptr) continue;
    const auto beside = [&](bool left) {
      return std::any_of(pieces.begin(), pieces.end(), [&](const Piece& p) {
        return left ? p.right > trunk->left : p.left < trunk->right;
      });
    };
    if (!beside(true) || !beside(false)) continue;
    armpit = h;
    const auto by_x = [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); };
    out.armpit_left = *std::max_element(trunk->points.begin(), trunk->points.end(), by_x);
    out.armpit_right = *std::min_element(trunk->points.begin(), trunk->points.end(), by_x);
  }
  if (armpit == 0)
    throw UnfitError(
        "no armpits found: the skin must stand with its arms away from the trunk, +Y up and facing "
        "+Z");
  for (double h = kLowestCrotch * out.stature;
       h < kHighestCrotch * out.stature && out.crotch_height == 0; h += step)
    if (sections.trunk(sections.at(h)) != nullptr) out.crotch_height = h;
  if (out.crotch_height <= kLowestCrotch * out.stature + step)
    throw UnfitError("no crotch found: the legs must be apart");
  // The waist lies between the crotch and the armpits; where it is decides how far the other two
  // may be looked for.
  const double third = (armpit - out.crotch_height) / 3;
  out.waist = extreme(sections, out.crotch_height + third, armpit - third, step, false);
  out.bust =
      extreme(sections, std::max(out.waist.height, armpit - third - kLeastBelow * out.stature),
              armpit, step, true);
  out.hip = extreme(sections, out.crotch_height + kAboveCrotch * out.stature, out.waist.height,
                    step, true);
  return out;
}

}  // namespace ecorche::inline v1
