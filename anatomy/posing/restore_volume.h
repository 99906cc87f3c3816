// Restores the rest volume of bellies after another stage has moved sections or changed outlines.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/compute/threads.h"
#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/posing_batch.h"
#include "anatomy/posing/posing_table.h"

namespace ecorche::inline v1 {

// One to four strips of equally many slices, by batch and lane.
struct StripGroup {
  struct Place {
    int batch = 0, lane = 0;
  };
  std::array<Place, kLanes> strips;
  int count = 0;
};
// Memory of restore_volumes(). Its content has no meaning between calls.
using VolumeWorkspace = std::vector<StripGroup>;

// Largest radial scale used to restore a belly's volume (sheets: its square root in thickness): in
// the first pass of a pose, and in later ones. When sections are tilted or compressed from all
// sides, more scaling causes new contact, which needs still more scaling; beyond this bound the
// outlines are made rounder instead (symmetrize_outlines.h).
constexpr double kMostFirstScale = 2, kMostLaterScale = 1.1;

// Scales the strips of which a section has `changed` (#sections; empty: all strips) to their rest
// volumes. The same bytes at any number of threads. Precondition: the table is not empty.
void restore_volumes(const PosingTable& table, std::span<const char> changed, PosedAnatomy& out,
                     VolumeWorkspace& workspace, Threads threads, double most = kMostLaterScale);

// Strips of a batch for which no scale was found, and which are stored unscaled: their outlines
// become more symmetric.
void restore_missed_volumes(const PosingData& data, const PosingBatch& batch,
                            const VolumeScale& found, PosedAnatomy& out);

// Number of strips whose swelling is at its limits, see PosedAnatomy::clamped.
int clamped_strips(const PosedAnatomy& posed);

}  // namespace ecorche::inline v1
