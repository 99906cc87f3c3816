#include "anatomy/posing/restore_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/posing/posing_batch.h"
#include "anatomy/posing/posing_data.h"
#include "anatomy/posing/section_areas.h"
#include "anatomy/posing/symmetrize_outlines.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kGrain = 8;    // groups of strips of a task
constexpr double kLeastScale = 0.5;  // radial

// An Ellipse is stored as it lies in workspace: center, width, thickness, tangent, radii, outline.
static_assert(sizeof(Ellipse) == 14 * sizeof(double) + sizeof(SliceOutline));

// Four places of four quantities each to four lanes.
inline std::array<Double4, 4> across_restore_volume(const std::array<const double*, kLanes>& from) {
  Eigen::Matrix4d m;
  for (int lane = 0; lane < kLanes; ++lane) m.col(lane) = Eigen::Vector4d::Map(from[lane]);
  m.transposeInPlace();
  return {m.col(0).array(), m.col(1).array(), m.col(2).array(), m.col(3).array()};
}

// The row's sections of four strips that begin at these slices.
void gather(const PosedAnatomy& posed, const std::array<int, kLanes>& first, int row,
            BatchWorkspace& t) {
  std::array<const double*, kLanes> begin, middle;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t slice = first[lane] + row;
    const Ellipse& e = posed.slices[slice];
    begin[lane] = e.center.data();
    middle[lane] = e.axes.data() + 1;
    const int to = lane;
    t.thickness[row].z[to] = e.axes(2, 1);
    t.a[row][to] = e.radii.x();
    t.b[row][to] = e.radii.y();
    t.belly[row][to] = double(posed.belly[slice]);
  }
  const auto one = across_restore_volume(begin), two = across_restore_volume(middle);
  t.center[row] = {one[0], one[1], one[2]};
  t.width[row] = {one[3], two[0], two[1]};
  t.thickness[row].x = two[2], t.thickness[row].y = two[3];
}

// The areas of all rows' outlines; of the last, its own.
void gather_areas(const PosedAnatomy& posed, const std::array<int, kLanes>& first, int rows,
                  PosingAreas* areas) {
  const auto set = [&](int row, LaneOutlines& to) {
    std::array<const SliceOutline*, kLanes> from;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      from[lane] = &posed.slices[first[lane] + row].outline;
    to.set(from);
  };
  std::array<LaneOutlines, 2> outlines;  // of even and of odd rows
  set(0, outlines[0]);
  for (int k = 0; k + 1 < rows; ++k) {
    LaneOutlines &here = outlines[k % 2], &next = outlines[(k + 1) % 2];
    set(k + 1, next);
    areas[k] = areas_between(here, next);
    areas[k + 1].own = next.own;
  }
}

std::span<Ellipse> sections(const PosingBatch& batch, int first, PosedAnatomy& posed) {
  return {&posed.slices[first], std::size_t(batch.rows)};
}

BellyScaling law_of(const PosingBatch& batch, int lane, int first, double low, double high,
                    const PosedAnatomy& posed) {
  return {{&posed.belly[first], std::size_t(batch.rows)},
          batch.lanes.width_swells[lane] > 0,
          low,
          high};
}

double volume(const PosingBatch& batch, int lane) {
  return batch.lanes.volume[lane] * std::numbers::pi / 3;
}

// As a factor of the radii.
double swelling(const BellyScaling& law, double scale) {
  return law.tube ? scale : std::sqrt(scale);
}

void restore_strips(const PosingData& data, const StripGroup& group, double most,
                    PosedAnatomy& out) {
  PosingBatch four;
  four.rows = data.batches[group.strips[0].batch].rows;
  four.strips = group.count;
  std::array<int, kLanes> first{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const StripGroup::Place& from = group.strips[lane < std::size_t(group.count) ? lane : 0];
    const PosingBatch& batch = data.batches[from.batch];
    const Eigen::Index to = lane;
    four.strip[lane] = batch.strip[from.lane];
    four.lanes.volume[to] = batch.lanes.volume[from.lane];
    four.lanes.width_swells[to] = batch.lanes.width_swells[from.lane];
    first[lane] = data.strip[four.strip[lane]].slice;
  }
  BatchWorkspace t;
  PosingAreas areas[kMaxStripSlices];
  for (int k = 0; k < four.rows; ++k) gather(out, first, k, t);
  gather_areas(out, first, four.rows, areas);
  const auto tubes = four.lanes.width_swells > 0;
  const Double4 low =
      tubes.select(Double4::Constant(kLeastScale), Double4::Constant(kLeastScale * kLeastScale));
  const Double4 high = tubes.select(Double4::Constant(most), Double4::Constant(most * most));
  const VolumeScale found = find_volume_scale(four, areas, t, low, high);
  for (int lane = 0; lane < four.strips; ++lane) {
    const int begin = first[lane];
    const BellyScaling law = law_of(four, lane, begin, low[lane], high[lane], out);
    const std::span<Ellipse> strip = sections(four, begin, out);
    double scale = found.scale[lane];
    if (found.found[lane])
      scale_belly(strip, law, scale);
    else
      scale = symmetrize_outlines(strip, law, volume(four, lane));
    out.swelling[data.strip[four.strip[lane]].strip] *= swelling(law, scale);
  }
}

}  // namespace

void restore_missed_volumes(const PosingData& data, const PosingBatch& batch,
                            const VolumeScale& found, PosedAnatomy& out) {
  for (int lane = 0; lane < batch.strips; ++lane) {
    if (found.found[lane]) continue;
    const PosingStrip& strip = data.strip[batch.strip[lane]];
    const BellyScaling law = law_of(batch, lane, strip.slice, batch.lanes.scale_min[lane],
                                    batch.lanes.scale_max[lane], out);
    out.swelling[strip.strip] = swelling(
        law, symmetrize_outlines(sections(batch, strip.slice, out), law, volume(batch, lane)));
  }
}

void restore_volumes(const PosingTable& table, std::span<const char> changed, PosedAnatomy& out,
                     VolumeWorkspace& workspace, Threads threads, double most) {
  const PosingData& data = *table.data;
  workspace.clear();
  workspace.reserve(2 * data.batches.size());
  for (std::size_t b = 0; b < data.batches.size(); ++b) {  // by slices
    const PosingBatch& batch = data.batches[b];
    for (int lane = 0; lane < batch.strips; ++lane) {
      const int begin = data.strip[batch.strip[lane]].slice;
      if (!changed.empty() && !std::memchr(&changed[begin], 1, std::size_t(batch.rows))) continue;
      const bool goes_on = !workspace.empty() && workspace.back().count < kLanes &&
                           data.batches[workspace.back().strips[0].batch].rows == batch.rows;
      if (!goes_on) workspace.emplace_back();
      StripGroup& group = workspace.back();
      group.strips[group.count++] = {int(b), lane};
    }
  }
  parallel_for_ranges(workspace.size(), kGrain, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) restore_strips(data, workspace[i], most, out);
  });
}

int clamped_strips(const PosedAnatomy& posed) {
  int count = 0;
  for (const double swelling : posed.swelling)
    count += swelling < kLeastSwelling + 1e-9 || swelling > kMostSwelling - 1e-9;
  return count;
}

}  // namespace ecorche::inline v1
