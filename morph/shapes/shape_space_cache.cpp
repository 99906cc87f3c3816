#include "morph/shapes/shape_space_cache.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/byte_stream.h"
#include "anatomy/files/cache.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/package_archive.h"
#include "shape_space_code.h"  // generated: kShapeSpaceCode

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

// Numbers as they lie in memory (the cache stays on the machine that wrote it), a hash at the end.
std::string space_bytes(const ShapeSpace& space) {
  const std::int64_t sizes[] = {
      space.sex == Sex::male ? 1 : 0, space.mean.rows(),    space.basis.cols(), space.components,
      space.example_components,       space.law_mean.size()};
  std::string out;
  put_bytes(out, sizes, std::size(sizes));
  put_bytes(out, space.mean.data(), std::size_t(space.mean.size()));
  put_bytes(out, space.spread.data(), std::size_t(space.spread.size()));
  put_bytes(out, space.law_mean.data(), std::size_t(space.law_mean.size()));
  put_bytes(out, space.law_covariance.data(), std::size_t(space.law_covariance.size()));
  put_bytes(out, space.heavier.data(), std::size_t(space.heavier.size()));
  put_bytes(out, space.basis.data(), std::size_t(space.basis.size()));
  return sealed(std::move(out));
}

ShapeSpace space_from(std::string_view bytes, Eigen::Index skin) {
  bytes = unsealed(bytes);
  std::int64_t sizes[6];
  take_bytes(bytes, sizes, std::size(sizes));
  if (sizes[1] != skin || sizes[2] < 1 || sizes[2] > 10000 || sizes[5] < 0 || sizes[5] > 10000)
    throw InputError("shape space cache: of another body");
  ShapeSpace out;
  out.sex = sizes[0] == 1 ? Sex::male : Sex::female;
  out.mean.resize(sizes[1], 3);
  out.spread.resize(sizes[2]);
  out.basis.resize(3 * sizes[1], sizes[2]);
  out.components = int(sizes[3]);
  out.example_components = int(sizes[4]);
  take_bytes(bytes, out.mean.data(), std::size_t(out.mean.size()));
  take_bytes(bytes, out.spread.data(), std::size_t(out.spread.size()));
  out.law_mean.resize(sizes[5]);
  out.law_covariance.resize(sizes[5], sizes[5]);
  take_bytes(bytes, out.law_mean.data(), std::size_t(out.law_mean.size()));
  take_bytes(bytes, out.law_covariance.data(), std::size_t(out.law_covariance.size()));
  out.heavier.resize(sizes[5]);
  take_bytes(bytes, out.heavier.data(), std::size_t(out.heavier.size()));
  take_bytes(bytes, out.basis.data(), std::size_t(out.basis.size()));
  return out;
}

}  // namespace

std::string shape_space_key(const fs::path& tables, Sex sex) {
  std::string all = std::string(kShapeSpaceCode) + (sex == Sex::male ? " male" : " female") +
                    read_input_file(tables / "packages.txt");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(tables / "body")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files)
    all += '\n' + file.filename().string() + '\n' + read_input_file(file);
  return sha256(all);
}

ShapeSpace read_shape_space(const BodyPackage& package, const TapeMeasure& tape, Sex sex) {
  const std::string name = shape_space_key(package.tables, sex) + ".space";
  if (const std::optional<std::string> bytes = read_cached(name)) {
    try {
      return space_from(*bytes, package.skin_size);
    } catch (const InputError&) {
      // damaged: built anew and overwritten below
    }
  }
  ShapeSpace out = build_shape_space(package, tape, sex);
  write_cached(name, space_bytes(out));
  return out;
}

}  // namespace ecorche::inline v1
