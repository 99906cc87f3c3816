#include "anatomy/muscles/strip_kinks.h"

#include <algorithm>
#include <cstddef>

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

// The point of a line of centres at a length. `lengths`: #slices.
Vec3 point_at(std::span<const Ellipse> slices, const std::vector<double>& lengths, double length) {
  const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, length);
  const auto k = std::size_t(after - lengths.begin());
  const double t = (length - lengths[k - 1]) / std::max(lengths[k] - lengths[k - 1], 1e-9);
  return slices[k - 1].center + t * (slices[k].center - slices[k - 1].center);
}

}  // namespace

std::vector<Vec3> off_chords(const Strip& strip, std::span<const Ellipse> slices, double reach) {
  std::vector<double> lengths(slices.size(), 0.0);
  std::vector<Vec3> out(slices.size(), Vec3::Zero());
  for (std::size_t k = 0; k < slices.size(); ++k)
    lengths[k] = strip.slices[k].s * strip.rest_length;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    if (lengths[k] - reach < lengths.front() || lengths[k] + reach > lengths.back()) continue;
    const Vec3 from = point_at(slices, lengths, lengths[k] - reach),
               to = point_at(slices, lengths, lengths[k] + reach);
    const Vec3 along = (to - from).stableNormalized(), off = slices[k].center - from;
    out[k] = off - along * along.dot(off);
  }
  return out;
}

std::vector<double> kinks_beyond(const Strip& strip, std::span<const Ellipse> slices,
                                 const Strip& reference) {
  const double scale = strip.rest_length / std::max(reference.rest_length, 1e-6);
  const std::vector<Vec3> is = off_chords(strip, slices, kKinkReach),
                          was = off_chords(reference, rest_slices(reference), kKinkReach / scale);
  std::vector<double> out(is.size(), 0.0);
  for (std::size_t k = 0; k < is.size(); ++k) out[k] = is[k].norm() - scale * was[k].norm();
  return out;
}

}  // namespace ecorche::inline v1
