#include "morph/shapes/statistic_people.h"

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <string>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/byte_stream.h"
#include "anatomy/files/cache.h"
#include "morph/measures/body_volume.h"
#include "morph/shapes/shape_age.h"
#include "morph/shapes/shape_space_cache.h"

namespace ecorche::inline v1 {
namespace {

// Three fifths are 18 to 62, two fifths 66 to 90.
constexpr std::array kAges{18.0, 22.0, 27.0, 32.0, 38.0, 44.0, 50.0, 56.0,
                           62.0, 66.0, 70.0, 74.0, 79.0, 84.0, 90.0};

std::string statistics_bytes(const BodyStatistics& s) {
  const std::int64_t sizes[] = {s.people, s.mean.rows(), s.deviation.size(), s.M.rows(),
                                s.back.cols()};
  std::string out;
  put_bytes(out, sizes, std::size(sizes));
  const auto put = [&out](const auto& matrix) {
    put_bytes(out, matrix.data(), std::size_t(matrix.size()));
  };
  put(s.mean), put(s.components), put(s.deviation), put(s.explained), put(s.M), put(s.back);
  put(s.attribute_mean), put(s.attribute_deviation), put(s.attribute_error);
  return sealed(std::move(out));
}

BodyStatistics statistics_from(std::string_view bytes, Sex sex, Eigen::Index skin) {
  bytes = unsealed(bytes);
  std::int64_t sizes[5];
  take_bytes(bytes, sizes, std::size(sizes));
  constexpr std::int64_t kMost = 1000;
  if (sizes[1] != skin || sizes[2] < 1 || sizes[2] > kMost || sizes[3] < 1 || sizes[3] > kMost ||
      sizes[4] < 2 || sizes[4] > kMost)
    throw InputError("statistics cache: of another body");
  BodyStatistics s;
  s.sex = sex;
  s.people = int(sizes[0]);
  s.mean.resize(skin, 3);
  s.components.resize(3 * skin, sizes[2]);
  s.deviation.resize(sizes[2]);
  s.explained.resize(sizes[2]);
  s.M.resize(sizes[3], BodyStatistics::kAttributes + 1);
  s.back.resize(BodyStatistics::kAttributes, sizes[4]);
  for (Eigen::VectorXd* v : {&s.attribute_mean, &s.attribute_deviation, &s.attribute_error})
    v->resize(BodyStatistics::kAttributes);
  const auto take = [&bytes](auto& matrix) {
    take_bytes(bytes, matrix.data(), std::size_t(matrix.size()));
  };
  take(s.mean), take(s.components), take(s.deviation), take(s.explained), take(s.M), take(s.back);
  take(s.attribute_mean), take(s.attribute_deviation), take(s.attribute_error);
  return s;
}

}  // namespace

std::vector<StatisticPerson> draw_statistic_people(const BodyPackage& package,
                                                   const TapeMeasure& tape,
                                                   const ShapeSpace& adults, int count,
                                                   std::uint64_t seed) {
  std::vector<StatisticPerson> out(count);
  const int ages = int(kAges.size());
  for (int a = 0; a < std::min(ages, count); ++a) {
    ShapeSpace space = adults;
    move_to_age(package, tape, kAges[a], space);
    for (int i = a; i < count; i += ages) {
      std::seed_seq mixed{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(i)};
      std::mt19937_64 random(mixed);
      std::normal_distribution<double> normal;
      Eigen::VectorXd z(space.basis.cols());
      for (double& x : z) x = normal(random);
      StatisticPerson& person = out[i];
      person.skin = space_points(space, z);
      person.skin.col(1).array() -= person.skin.col(1).minCoeff();
      person.age = kAges[a];
      person.mass = kBodyDensity * skin_volume(package, person.skin);
      person.stature = stature(package, person.skin);
    }
  }
  return out;
}

BodyStatistics read_statistics(const BodyPackage& package, const TapeMeasure& tape,
                               const ShapeSpace& adults) {
  const std::string name = fmt::format(
      "{}-{}.statistics", shape_space_key(package.tables, adults.sex), kStatisticPeople);
  if (const std::optional<std::string> bytes = read_cached(name)) {
    try {
      return statistics_from(*bytes, adults.sex, package.skin_size);
    } catch (const InputError&) {
      // damaged: made anew and overwritten below
    }
  }
  constexpr std::uint64_t kSeed = 2020;
  const BodyStatistics out = learn_statistics(
      adults.sex, draw_statistic_people(package, tape, adults, kStatisticPeople, kSeed));
  write_cached(name, statistics_bytes(out));
  return out;
}

}  // namespace ecorche::inline v1
