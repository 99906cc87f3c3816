#include "skinning/dynamics/compare_ground.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr double kComparedEnds = 0.05;  // s
constexpr double kContactForce = 0.05;  // of the weight: a foot stands
constexpr double kSameContact = 0.1;    // s: landings further apart are of other steps
constexpr double kStep = 0.15;          // s; what is shorter is no step
constexpr double kBears = 0.4;          // of the weight, somewhere in a step
constexpr double kMissing = 0.1;        // of a step's impulse: plates measure no more of it, ...
constexpr double kBoth = 0.6;           // ... and of both feet's no more of theirs

struct Pair {
  Vec3 estimated, measured;  // forwards, up, sideways; over the weight
};

GroundDifference difference_of(const std::vector<Pair>& pairs) {
  GroundDifference out;
  if (pairs.empty()) return out;
  const double n = double(pairs.size());
  Vec3 squares = Vec3::Zero();
  double a = 0, b = 0, ab = 0, aa = 0, bb = 0;
  for (const Pair& pair : pairs) {
    squares += (pair.estimated - pair.measured).cwiseAbs2();
    a += pair.estimated.y() / n, b += pair.measured.y() / n;
    out.peak = std::max(out.peak, pair.estimated.y());
    out.measured_peak = std::max(out.measured_peak, pair.measured.y());
  }
  for (const Pair& pair : pairs) {
    const double x = pair.estimated.y() - a, y = pair.measured.y() - b;
    ab += x * y, aa += x * x, bb += y * y;
  }
  if (aa > 0 && bb > 0) out.correlation = ab / std::sqrt(aa * bb);
  out.forward_rms = std::sqrt(squares.x() / n);
  out.vertical_rms = std::sqrt(squares.y() / n);
  out.sideways_rms = std::sqrt(squares.z() / n);
  return out;
}

// Frames, with parts, at which a force rises or falls through the threshold.
std::vector<double> crossings(const std::vector<double>& force, bool rising) {
  std::vector<double> out;
  for (std::size_t f = 1; f < force.size(); ++f) {
    const double before = force[f - 1] - kContactForce, now = force[f] - kContactForce;
    if ((before < 0) == rising && (now >= 0) == rising && (before < 0) != (now < 0))
      out.push_back(double(f) - now / (now - before));
  }
  return out;
}

// Vertical forces over the weight, by foot: estimated, measured.
using Verticals = std::array<std::array<std::vector<double>, 2>, 2>;

// Frames in which a foot stands beside the plates. Where both feet's sum is measured all the same,
// the contact was taken for the other foot's. Counts steps.
std::vector<char> frames_beside(const Verticals& vertical, std::size_t foot, double fps,
                                int& steps) {
  const auto& [estimated, measured] = vertical[foot];
  const auto& other = vertical[1 - foot];
  std::vector<char> out(estimated.size(), 0);
  for (std::size_t begin = 0; begin < estimated.size(); ++begin) {
    std::size_t end = begin;
    double most = 0, sum = 0, seen = 0, other_sum = 0, other_seen = 0;
    for (; end < estimated.size() && estimated[end] > kContactForce; ++end)
      most = std::max(most, estimated[end]), sum += estimated[end], seen += measured[end],
      other_sum += other[0][end], other_seen += other[1][end];
    if (double(end - begin) >= kStep * fps && most > kBears && seen < kMissing * sum &&
        seen + other_seen < kBoth * (sum + other_sum)) {
      std::fill(out.begin() + std::ptrdiff_t(begin), out.begin() + std::ptrdiff_t(end), char(1));
      ++steps;
    }
    begin = end;
  }
  return out;
}

struct Times {
  double sum = 0, off = 0;
  int count = 0;
};

void add_times(const std::vector<double>& estimated, const std::vector<double>& measured,
               double fps, Times& out) {
  for (const double time : measured) {
    double best = kSameContact * fps;
    bool found = false;
    for (const double other : estimated)
      if (std::abs(other - time) < std::abs(best)) best = other - time, found = true;
    if (!found) continue;
    out.sum += best / fps;
    out.off += std::abs(best) / fps;
    ++out.count;
  }
}

}  // namespace

GroundComparison compare_ground(const MotionDynamics& dynamics,
                                const std::vector<std::array<FootForce, 2>>& measured) {
  GroundComparison out;
  const std::size_t n = dynamics.frames.size(),
                    ends = std::min(n / 3, std::size_t(std::ceil(kComparedEnds * dynamics.fps)));
  Verticals vertical;
  for (std::size_t f = ends; f + ends < n; ++f)
    for (std::size_t foot = 0; foot < 2; ++foot) {
      vertical[foot][0].push_back(dynamics.frames[f].estimated[foot].force.y() / dynamics.weight);
      vertical[foot][1].push_back(measured[f][foot].force.y() / dynamics.weight);
    }
  std::array<std::vector<char>, 2> beside;
  for (std::size_t foot = 0; foot < 2; ++foot)
    beside[foot] = frames_beside(vertical, foot, dynamics.fps, out.beside);
  std::array<std::vector<Pair>, 3> pairs;  // left, right, both
  for (std::size_t f = ends; f + ends < n; ++f) {
    Vec3 forwards = dynamics.frames[f].loads.X_WJ[0].linear().col(2);
    forwards.y() = 0;
    forwards.normalize();
    Mat3 R;
    R << forwards.transpose(), Vec3::UnitY().transpose(), forwards.cross(Vec3::UnitY()).transpose();
    R /= dynamics.weight;
    Pair both{Vec3::Zero(), Vec3::Zero()};
    for (std::size_t foot = 0; foot < 2; ++foot) {
      const Pair pair{R * dynamics.frames[f].estimated[foot].force, R * measured[f][foot].force};
      if (!beside[foot][f - ends]) pairs[foot].push_back(pair);
      both.estimated += pair.estimated, both.measured += pair.measured;
    }
    if (!beside[0][f - ends] && !beside[1][f - ends]) pairs[2].push_back(both);
  }
  for (const Pair& pair : pairs[2])
    out.measured_mean += pair.measured.y() / double(pairs[2].size());
  for (std::size_t k = 0; k < 3; ++k)
    out.compared[k] = double(pairs[k].size()) / double(std::max(std::size_t(1), n - 2 * ends));
  out.feet = {difference_of(pairs[0]), difference_of(pairs[1])};
  out.both = difference_of(pairs[2]);
  Times landing, leaving;
  for (const auto& foot : vertical) {
    add_times(crossings(foot[0], true), crossings(foot[1], true), dynamics.fps, landing);
    add_times(crossings(foot[0], false), crossings(foot[1], false), dynamics.fps, leaving);
  }
  out.contacts = std::min(landing.count, leaving.count);
  if (landing.count > 0)
    out.landing = landing.sum / landing.count, out.landing_off = landing.off / landing.count;
  if (leaving.count > 0)
    out.leaving = leaving.sum / leaving.count, out.leaving_off = leaving.off / leaving.count;
  return out;
}

}  // namespace ecorche::inline v1
