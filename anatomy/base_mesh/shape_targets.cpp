#include "anatomy/base_mesh/shape_targets.h"

#include <map>
#include <mutex>

#include "anatomy/files/gzip.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {
namespace {

ShapeTarget parse_target(std::string_view text, const std::string& name, int point_count) {
  std::vector<int> indices;
  std::vector<double> offsets;
  TextScan scan(text, name);
  while (scan.next_line()) {
    if (scan.at_line_end() || scan.line().front() == '#') continue;
    indices.push_back(int(scan.whole("point", 0, point_count - 1)));
    for (const char* axis : {"x", "y", "z"}) offsets.push_back(0.1 * scan.number(axis));
    if (!scan.at_line_end()) scan.fail("more than a point and three numbers");
  }
  ShapeTarget target;
  target.offsets = Eigen::Map<const Points>(offsets.data(), Eigen::Index(indices.size()), 3);
  target.indices = std::move(indices);
  return target;
}

}  // namespace

struct ShapeTargets::State {
  PackageReader reader;
  int point_count = 0;
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<const ShapeTarget>>
      read;  // a null pointer remembers that there is none
};

ShapeTargets::ShapeTargets(PackageReader reader, int point_count)
    : state_(std::make_unique<State>()) {
  state_->reader = std::move(reader);
  state_->point_count = point_count;
}
ShapeTargets::~ShapeTargets() = default;

const ShapeTarget* ShapeTargets::find(const std::string& name) const {
  const std::lock_guard lock(state_->mutex);
  const auto known = state_->read.find(name);
  if (known != state_->read.end()) return known->second.get();
  const std::string path = "mpfb2/targets/" + name + ".target.gz";
  std::unique_ptr<const ShapeTarget> target;
  if (const auto bytes = state_->reader(path)) {
    target = std::make_unique<const ShapeTarget>(
        parse_target(gunzip(*bytes, path), path, state_->point_count));
  }
  return (state_->read[name] = std::move(target)).get();
}

}  // namespace ecorche::inline v1
