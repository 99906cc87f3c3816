#include "anatomy/mesh_files/head_islands.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace ecorche::inline v1 {
namespace {

// Of the figure's largest extent. Eyes are 0.02, those of dolls 0.05, a row of teeth 0.04, a shoe
// 0.13: below, dolls' eyes become body, which bends them; above, shoes become eyes.
constexpr double kLargest = 0.08;
constexpr double kUpright = 0.7;  // of its largest extent, an upright figure's along up
constexpr double kFar = 0.5;      // of its largest extent, further from the head than a head goes

// The middle of the islands that are the head's, as most of those in doubt tell it; of as many at
// either end, the smallest.
Vec3 head_place(std::span<const HeadIsland> islands, const std::vector<char>& may,
                const Eigen::AlignedBox3d& figure) {
  Eigen::Index axis = 0;
  figure.sizes().maxCoeff(&axis);
  struct End {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    double smallest = 1e300;
  };
  std::array<End, 2> ends;
  End known;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (!may[i]) continue;
    const Vec3 middle = islands[i].box.center();
    End& end = islands[i].on_head ? known : ends[middle[axis] > figure.center()[axis] ? 1 : 0];
    end.sum += middle;
    ++end.count;
    end.smallest = std::min(end.smallest, islands[i].box.sizes().maxCoeff());
  }
  if (known.count > 0) return known.sum / known.count;
  const bool second = ends[0].count != ends[1].count ? ends[1].count > ends[0].count
                                                     : ends[1].smallest < ends[0].smallest;
  const End& head = ends[second ? 1 : 0];
  return head.count > 0 ? Vec3(head.sum / head.count) : Vec3(figure.center());
}

}  // namespace

std::vector<char> lies_in_head(std::span<const HeadIsland> islands,
                               const Eigen::AlignedBox3d& figure, const std::optional<Vec3>& up) {
  const double size = figure.sizes().maxCoeff();
  std::vector<char> may(islands.size(), 1);
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const bool small =
        islands[i].kind == PartKind::hair || islands[i].box.sizes().maxCoeff() <= kLargest * size;
    may[i] = islands[i].on_head.value_or(small) ? 1 : 0;
  }
  const Vec3 ups = up ? up->cwiseAbs() : Vec3(Vec3::Zero());
  const bool upright = up && ups.dot(figure.sizes()) >= kUpright * size;
  const Vec3 head = head_place(islands, may, figure);
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (!may[i] || islands[i].on_head) continue;
    const Vec3 from_middle = islands[i].box.center() - figure.center();
    const double top = upright ? up->dot(from_middle) + 0.5 * ups.dot(islands[i].box.sizes()) : 0;
    const bool near = upright ? top > 0 : (islands[i].box.center() - head).norm() <= kFar * size;
    may[i] = near ? 1 : 0;
  }
  return may;
}

}  // namespace ecorche::inline v1
