// The people whom body statistics know: drawn from the shape spaces of all grown ages, two fifths
// of them old, as in the statistics paper, whose 130 men had about 50 over 65.
#pragma once

#include <cstdint>
#include <vector>

#include "morph/measures/tape_measure.h"
#include "morph/shapes/body_statistics.h"

namespace ecorche::inline v1 {

inline constexpr int kStatisticPeople = 260;

// Ages 18 to 90 in turn. Person i depends on the seed, the count and i alone. Some seconds.
// `adults`: of read_shape_space; its sex is theirs.
std::vector<StatisticPerson> draw_statistic_people(const BodyPackage& package,
                                                   const TapeMeasure& tape,
                                                   const ShapeSpace& adults, int count,
                                                   std::uint64_t seed);

// Statistics of kStatisticPeople people, kept in the cache (anatomy/files/cache.h).
BodyStatistics read_statistics(const BodyPackage& package, const TapeMeasure& tape,
                               const ShapeSpace& adults);

}  // namespace ecorche::inline v1
