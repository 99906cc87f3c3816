// Bellies at their rest volumes again after sections or their outlines have been moved. For
// pose_anatomy and what comes after it.
#pragma once

#include <span>
#include <vector>

#include "anatomy/posing/posing_batch.h"
#include "anatomy/posing/posing_table.h"

namespace ecorche {

// One to four strips of equally many slices, by batch and lane.
struct GrowingStrips {
  struct Place {
    int batch = 0, lane = 0;
  };
  std::array<Place, kLanes> strips;
  int count = 0;
};
using RegrowMemory = std::vector<GrowingStrips>;

// How much a belly's radii may grow (sheets: the root of their thickness) after its outlines. Where
// sections lean or are pressed on all sides it would have to grow far more for the same volume, be
// pressed the more for it, and so on: it grows rounder instead. A pose does so once, so that there
// is no going on.
constexpr double kMostGrowthOnce = 2, kMostGrowthAgain = 1.1;

// Strips of which a section has `changed` (#sections) swell or shrink until they have their rest
// volumes. The same bytes at any number of threads.
void regrow(const PosingTable::Data& data, std::span<const char> changed, PosedAnatomy& out,
            RegrowMemory& memory, Threads threads, double most = kMostGrowthAgain);

// Muscles whose sections have been moved or pressed since they were posed part once more, and have
// their rest volumes again. `held` (#sections): what else than muscles keeps their outlines from
// growing, 0 .. 1. `parting`: deep only after all in the same memory, and of the same pose.
struct PartMemory {
  ContactMemory contact;
  RegrowMemory growing;
};
void part_again(const PosingTable::Data& data, std::span<const ContactSpokes> held, Parting parting,
                PosedAnatomy& out, PartMemory& memory, Threads threads);

// Strips of a batch for which no growth was found, stored as they are without: their outlines
// become more even (round_out).
void round_out_missed(const PosingTable::Data& data, const PosingBatch& batch,
                      const LaneGrowth& found, PosedAnatomy& out);

}  // namespace ecorche
