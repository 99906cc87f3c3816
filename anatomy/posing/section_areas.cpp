#include "anatomy/posing/section_areas.h"

#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

// By direction: its coordinates, and their products with those of the next, each over what its sum
// is to be over.
struct Turns {
  std::array<double, kOutlinePoints> x, y, xx, yy;
  std::array<double, kOutlinePoints> both;  // half of xy + yx
};

const Turns& turns() {
  static const Turns out = [] {
    Turns all;
    const auto& d = outline_directions();
    const double whole = kOutlinePoints * std::sin(2 * std::numbers::pi / kOutlinePoints);
    for (std::size_t i = 0; i < d.size(); ++i) {
      const Vec2 here = d[i], next = d[(i + 1) % d.size()];
      all.x[i] = here.x() / (2 * kOutlinePoints), all.y[i] = here.y() / (2 * kOutlinePoints);
      all.xx[i] = here.x() * next.x() / whole, all.yy[i] = here.y() * next.y() / whole;
      all.both[i] = 0.5 * (here.x() * next.y() + here.y() * next.x()) / whole;
    }
    return all;
  }();
  return out;
}

}  // namespace

void LaneOutlines::set(const std::array<const SliceOutline*, kLanes>& outlines) {
  for (std::size_t i = 0; i < at.size(); i += 4) {
    Eigen::Matrix4d four;
    for (int lane = 0; lane < kLanes; ++lane)
      four.col(lane) = Eigen::Vector4f::Map(outlines[lane]->data() + i).cast<double>();
    four.transposeInPlace();
    for (int k = 0; k < 4; ++k) at[i + k] = four.col(k).array();
  }
  Double4 before = at.back() * at.front(), all = Double4::Zero();
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Double4 after = at[i] * at[(i + 1) % at.size()];
    fan[i] = before + after;
    all += after;
    before = after;
  }
  own = all / kOutlinePoints;
}

PosingAreas areas_between(const LaneOutlines& first, const LaneOutlines& second) {
  const Turns& t = turns();
  const Double4 zero = Double4::Zero();
  Double4 mean = zero, turned = zero;  // half of the sum and of the difference of ab and ba
  Double4 aa = zero, bb = zero, a1 = zero, b1 = zero, a0 = zero, b0 = zero;
  for (std::size_t i = 0; i < kOutlinePoints; ++i) {
    const std::size_t next = (i + 1) % kOutlinePoints;
    const Double4 fg = first.at[i] * second.at[next], gf = second.at[i] * first.at[next],
                  less = fg - gf;
    mean += fg + gf;
    turned += t.both[i] * less;
    aa += t.xx[i] * less;
    bb += t.yy[i] * less;
    const Double4 of_first = first.fan[i] * second.at[i], of_second = second.fan[i] * first.at[i];
    a1 += t.x[i] * of_first;
    b1 += t.y[i] * of_first;
    a0 += t.x[i] * of_second;
    b0 += t.y[i] * of_second;
  }
  mean /= 2 * kOutlinePoints;
  return {first.own, mean + turned, mean - turned, aa, bb, a1, b1, a0, b0};
}

}  // namespace ecorche::inline v1
