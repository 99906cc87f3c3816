#include "morph/dilation/close_raphes.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "morph/dilation/packed_sections.h"
#include "morph/dilation/smooth_along.h"

namespace ecorche::inline v1 {
namespace {

// m, of half the gap: edges that are farther from the middle go that far only. Larger: recti that a
// belly has driven apart get as wide again.
constexpr double kMostClosing = 0.025;
constexpr int kEvenRounds = 4;  // along the strip

// The same muscle of the other side, or -1.
int image_of(std::span<const Muscle> muscles, const Muscle& left) {
  const std::string_view suffix = side_suffix(Side::left);
  if (left.side != Side::left || !left.name.ends_with(suffix)) return -1;
  const std::string name =
      left.name.substr(0, left.name.size() - suffix.size()) + side_suffix(Side::right);
  const auto found = std::ranges::find(muscles, name, &Muscle::name);
  return found == muscles.end() ? -1 : int(found - muscles.begin());
}

// From a section's centre to the edge of its ellipse that is next to the mid-plane.
Vec3 to_middle(const Ellipse& slice, Side side) {
  const bool outwards = (slice.axes(0, 0) > 0) == (side == Side::left);
  return (outwards ? -1 : 1) * slice.radii.x() * slice.axes.col(0);
}

// One edge moves, the other stays, and the section stays in its plane.
void move_edge(Ellipse& slice, Side side, const Vec3& move) {
  const Vec3 arm = to_middle(slice, side), normal = slice.axes.col(2);
  const Vec3 far = slice.center - arm, near = slice.center + arm + move - normal * normal.dot(move);
  const Vec3 width = near - far;
  if (width.norm() < slice.radii.x()) return;
  slice.center = 0.5 * (near + far);
  slice.radii.x() = 0.5 * width.norm();
  slice.axes.col(0) = width.normalized() * (arm.dot(slice.axes.col(0)) > 0 ? 1 : -1);
  slice.axes.col(1) = normal.cross(slice.axes.col(0));
}

void close_raphe(std::span<Ellipse> left, std::span<Ellipse> right) {
  std::vector<Vec3> moves;
  for (std::size_t k = 0; k < left.size(); ++k) {
    const Vec3 gap = right[k].center + to_middle(right[k], Side::right) - left[k].center -
                     to_middle(left[k], Side::left);
    Vec3 move = 0.5 * gap;
    if (move.norm() > kMostClosing) move *= kMostClosing / move.norm();
    moves.push_back(move);
  }
  smooth_along(moves, kEvenRounds);
  for (std::size_t k = 0; k < left.size(); ++k) {
    move_edge(left[k], Side::left, moves[k]);
    move_edge(right[k], Side::right, -moves[k]);
  }
}

}  // namespace

void close_raphes(std::span<const Muscle> muscles, std::span<Ellipse> slices) {
  const std::vector<std::size_t> begins = slice_begins(muscles);
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const int image = image_of(muscles, muscles[m]);
    if (image < 0) continue;
    const std::vector<Strip>&one = muscles[m].strips, &other = muscles[std::size_t(image)].strips;
    std::size_t left = begins[m], right = begins[std::size_t(image)];
    for (std::size_t s = 0; s < std::min(one.size(), other.size()); ++s) {
      const std::size_t count = one[s].slices.size();
      if (one[s].raphe > 0 && other[s].raphe > 0 && count > 2 && count == other[s].slices.size())
        close_raphe(slices.subspan(left, count), slices.subspan(right, count));
      left += count;
      right += other[s].slices.size();
    }
  }
}

}  // namespace ecorche::inline v1
