#include "app/studio/handles/give_way.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

namespace ecorche {
namespace {

constexpr float kReach = 0.08f, kDecay = 0.04f;  // m, from the muscle's surface
constexpr float kWhole = 0.012f;                 // m, from it: goes as far as the muscle
constexpr float kBlend = 0.012f;                 // m, between neighbouring sections
constexpr float kMost = 0.04f;                   // m
constexpr std::size_t kMostRows = 63;            // those behind count as one
constexpr std::uint64_t kOwnRevisions = std::uint64_t{1} << 62;

// A section in the numbers that a vertex needs.
struct Rim {
  Vec3f center, across, through;  // width's and thickness' directions over their radii
  float mean = 0;                 // radius along the muscle, which goes on

  explicit Rim(const Ellipse& e)
      : center(e.center.cast<float>()),
        across(e.axes.col(0).cast<float>() / std::max(float(e.radii.x()), 1e-4f)),
        through(e.axes.col(1).cast<float>() / std::max(float(e.radii.y()), 1e-4f)),
        width(std::max(float(e.radii.x()), 1e-4f)),
        thickness(std::max(float(e.radii.y()), 1e-4f)) {
    mean = std::max(0.5f * (width + thickness), 1e-4f);
  }
  // From the centre to the edge in a direction.
  float edge(const Vec3f& direction) const {
    const float a = across.dot(direction), b = through.dot(direction);
    const float x = a * width, y = b * thickness;
    const float along = std::max(1 - x * x - y * y, 0.0f);
    return 1 / std::sqrt(a * a + b * b + along / (mean * mean));
  }

 private:
  float width, thickness;
};

struct Step {
  Rim was, is;
};

std::vector<Step> steps_of(const std::vector<MovedSection>& sections) {
  std::vector<Step> out;
  for (const MovedSection& s : sections) out.push_back({Rim(s.was), Rim(s.is)});
  return out;
}

constexpr float kFar = 2 * (kReach + kMost) * (kReach + kMost);  // m^2, from all sections

// Sections in a row, and the box beyond which none of them moves anything.
struct Row {
  std::size_t begin = 0, end = 0;
  Eigen::AlignedBox3f box{};
};

// A new row begins where sections lie far apart: at the next strip, or on the other side.
std::vector<Row> rows_of(const std::vector<Step>& steps) {
  constexpr float apart = 0.08f;  // m
  std::vector<Row> out;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Vec3f& at = steps[k].was.center;
    if (k == 0 || (at - steps[k - 1].was.center).norm() > apart) out.push_back({k, k, {}});
    out.back().box.extend(at);
    out.back().end = k + 1;
  }
  const Vec3f reach = Vec3f::Constant(std::sqrt(kFar));
  for (Row& row : out) row.box = Eigen::AlignedBox3f(row.box.min() - reach, row.box.max() + reach);
  return out;
}

Vec3f way_of(std::span<const Step> steps, const Vec3f& place) {
  constexpr float reached = 7 * kBlend * kBlend;  // beyond it a section has no share
  float nearest = kFar;
  for (const Step& s : steps) nearest = std::min(nearest, (place - s.was.center).squaredNorm());
  if (nearest >= kFar) return Vec3f::Zero();
  Vec3f sum = Vec3f::Zero();
  float weights = 0;
  for (const Step& s : steps) {
    const Vec3f from = place - s.was.center;
    const float square = from.squaredNorm();
    if (square > nearest + reached) continue;
    const float blend = std::exp((nearest - square) / (kBlend * kBlend));
    const float distance = std::max(std::sqrt(square), 1e-5f);
    const Vec3f out = from / distance;
    const float edge = s.was.edge(out), gap = std::max(distance - edge - kWhole, 0.0f);
    weights += blend;
    if (gap > kReach) continue;
    const float step = (s.is.center - s.was.center).dot(out) + s.is.edge(out) - edge;
    sum += blend * (1 - gap / kReach) * std::exp(-gap / kDecay) * step * out;
  }
  sum /= weights;
  const float length = sum.norm();
  return length > kMost ? Vec3f(sum * (kMost / length)) : sum;
}

}  // namespace

Vec3f given_way(const std::vector<MovedSection>& sections, const Vec3f& place) {
  return way_of(steps_of(sections), place);
}

void GivingWay::move(const std::vector<MovedSection>& sections, DrawMesh& mesh) {
  static std::uint64_t revisions = 0;
  const bool own = mesh.revision == revision_;
  if (own)
    for (const auto& [v, place] : kept_) mesh.positions[v] = place;
  const bool moved_before = own && !kept_.empty();
  kept_.clear();
  if (sections.empty() && !moved_before) return;
  const std::vector<Step> steps = steps_of(sections);
  const std::vector<Row> rows = rows_of(steps);
  std::vector<Step> near;
  std::uint64_t near_rows = 0, all = 0;  // of `near`, by bits
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    all = 0;
    for (std::size_t r = 0; r < rows.size(); ++r)
      if (rows[r].box.contains(mesh.positions[v]))
        all |= std::uint64_t{1} << std::min(r, kMostRows);
    if (all == 0) continue;
    if (all != near_rows) {
      near.clear();
      for (std::size_t r = 0; r < rows.size(); ++r)
        if (all >> std::min(r, kMostRows) & 1)
          near.insert(near.end(), steps.begin() + long(rows[r].begin),
                      steps.begin() + long(rows[r].end));
      near_rows = all;
    }
    const Vec3f step = way_of(near, mesh.positions[v]);
    if (step.squaredNorm() < 1e-10f) continue;
    kept_.emplace_back(std::uint32_t(v), mesh.positions[v]);
    mesh.positions[v] += step;
  }
  if (kept_.empty() && !moved_before) return;
  revision_ = kOwnRevisions + ++revisions;
  mesh.revision = revision_;
}

}  // namespace ecorche
