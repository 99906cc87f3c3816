#include "anatomy/regrow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/outline.h"
#include "anatomy/posing_lanes.h"
#include "anatomy/round_out.h"

namespace ecorche {
namespace {

constexpr double kVolumeKept = 1e-6;  // share
constexpr double kLeastGrowth = 0.5, kMostGrowth = 2;  // of a belly's radii, after its outlines; sheets: of the root of their thickness

void gather(const PosedAnatomy& posed, int slice, int lane, int row, Scratch& t) {
  const Ellipse& e = posed.slices[static_cast<std::size_t>(slice)];
  const auto put = [lane](Lane3& to, const Vec3& v) { to.x[lane] = v.x(), to.y[lane] = v.y(), to.z[lane] = v.z(); };
  put(t.center[row], e.center);
  put(t.width[row], e.axes.col(0));
  put(t.thickness[row], e.axes.col(1));
  put(t.tangent[row], e.axes.col(2));
  t.a[row][lane] = e.radii.x();
  t.b[row][lane] = e.radii.y();
  t.belly[row][lane] = static_cast<double>(posed.belly[static_cast<std::size_t>(slice)]);
}

void set_areas(const SliceOutline& here, const SliceOutline& next, int lane, PosingAreas& areas) {
  const MixedArea mixed = mixed_area(here, next);
  const LopsidedMoments more = lopsided_moments(here, next);
  areas.own[lane] = outline_area(here);
  areas.ab[lane] = mixed.ab;
  areas.ba[lane] = mixed.ba;
  areas.aa[lane] = mixed.aa;
  areas.bb[lane] = mixed.bb;
  areas.more_a1[lane] = more.a1;
  areas.more_b1[lane] = more.b1;
  areas.more_a0[lane] = more.a0;
  areas.more_b0[lane] = more.b0;
}

bool fits(double missed, double volume) { return std::abs(missed) <= kVolumeKept * std::abs(volume); }

double round_strip(const PosingBatch& batch, int lane, int first, double low, double high, double growth, PosedAnatomy& out) {
  const auto rows = static_cast<std::size_t>(batch.rows);
  const BellyGrowth law{{&out.belly[static_cast<std::size_t>(first)], rows}, batch.lanes.width_swells[lane] > 0, low, high};
  return round_out({&out.slices[static_cast<std::size_t>(first)], rows}, law, growth, batch.lanes.volume[lane] * std::numbers::pi / 3);
}

void regrow_batch(const PosingTable::Data& data, const PosingBatch& batch, std::span<const char> changed, PosedAnatomy& out) {
  std::array<bool, kLanes> touched{};
  const auto first = [&](int lane) { return data.strip[static_cast<std::size_t>(batch.strip[static_cast<std::size_t>(lane)])].slice; };
  for (int lane = 0; lane < batch.strips; ++lane) {
    const auto begin = changed.begin() + first(lane);
    touched[static_cast<std::size_t>(lane)] = std::find(begin, begin + batch.rows, 1) != begin + batch.rows;
  }
  if (std::none_of(touched.begin(), touched.end(), [](bool t) { return t; })) return;

  const auto pressed = [&](int slice) {  // now or earlier
    return out.slices[static_cast<std::size_t>(slice)].outline != data.outlines[static_cast<std::size_t>(slice)];
  };
  Scratch t;
  PosingAreas areas[kMaxStripSlices];
  std::copy_n(&data.areas[static_cast<std::size_t>(batch.row)], batch.rows, areas);
  for (int lane = 0; lane < kLanes; ++lane) {
    const int begin = first(lane);
    for (int k = 0; k < batch.rows; ++k) {
      gather(out, begin + k, lane, k, t);
      const int next = std::min(k + 1, batch.rows - 1);
      if (pressed(begin + k) || pressed(begin + next))
        set_areas(out.slices[static_cast<std::size_t>(begin + k)].outline, out.slices[static_cast<std::size_t>(begin + next)].outline, lane, areas[k]);
    }
  }
  const auto tubes = batch.lanes.width_swells > 0;
  const Lane low = tubes.select(Lane::Constant(kLeastGrowth), Lane::Constant(kLeastGrowth * kLeastGrowth));
  const Lane high = tubes.select(Lane::Constant(kMostGrowth), Lane::Constant(kMostGrowth * kMostGrowth));
  const auto [growth, missed] = find_growth(batch, areas, t, low, high);
  for (int lane = 0; lane < batch.strips; ++lane) {
    if (!touched[static_cast<std::size_t>(lane)]) continue;
    const bool tube = batch.lanes.width_swells[lane] > 0;
    for (int k = 0; k < batch.rows; ++k) {
      Ellipse& e = out.slices[static_cast<std::size_t>(first(lane) + k)];
      const double g = 1 + t.belly[k][lane] * (growth[lane] - 1);
      e.radii = Vec2(tube ? e.radii.x() * g : e.radii.x(), e.radii.y() * g);
    }
    const int strip = data.strip[static_cast<std::size_t>(batch.strip[static_cast<std::size_t>(lane)])].strip;
    const double grown = fits(missed[lane], batch.lanes.volume[lane]) ? growth[lane]
                                                                      : round_strip(batch, lane, first(lane), low[lane], high[lane], growth[lane], out);
    out.swelling[static_cast<std::size_t>(strip)] *= tube ? grown : std::sqrt(grown);
  }
}

}  // namespace

void round_out_missed(const PosingTable::Data& data, const PosingBatch& batch, const LaneGrowth& found, PosedAnatomy& out) {
  for (int lane = 0; lane < batch.strips; ++lane) {
    if (fits(found.missed[lane], batch.lanes.volume[lane])) continue;
    const PosingStrip& strip = data.strip[static_cast<std::size_t>(batch.strip[static_cast<std::size_t>(lane)])];
    const double grown = round_strip(batch, lane, strip.slice, batch.lanes.grow_min[lane], batch.lanes.grow_max[lane], found.growth[lane], out);
    out.swelling[static_cast<std::size_t>(strip.strip)] = batch.lanes.width_swells[lane] > 0 ? grown : std::sqrt(grown);
  }
}

void regrow(const PosingTable::Data& data, std::span<const char> changed, PosedAnatomy& out) {
  for (const PosingBatch& batch : data.batches) regrow_batch(data, batch, changed, out);
}

}  // namespace ecorche
