#include "morph/template/regressor_training.h"

#include "anatomy/queries/signed_distance.h"

namespace ecorche::inline v1 {
namespace {

// The marks that rules name: the package's cubes, and vertices of its skin ("vertex-5162").
std::vector<Landmark> marks_of(const BodyPackage& package, const FitRules& rules,
                               const Points& points) {
  std::vector<Landmark> out = joint_cubes(package, points);
  for (const CubeRule& rule : rules.cubes)
    if (rule.vertex >= 0) out.push_back({rule.cube, points.row(rule.vertex)});
  return out;
}

NamedPoints known_centres(const FitRules& rules, const NamedPoints& all) {
  NamedPoints out;
  for (const CubeRule& cube : rules.cubes) out[cube.joint] = all.at(cube.joint);
  out["pelvis"] = Vec3(0, all.at("hip").y(), all.at("hip").z());
  return out;
}

// The centres of a build of the same stature as `average`. Limbs and head go with their marks. The
// trunk's do not tell: marks of hips and spine go with fat and flesh. Its joints go up and down,
// forward and back with neck and knees, and not sideways.
NamedPoints moved_with_marks(const FitRules& rules, const NamedPoints& average,
                             const std::vector<Landmark>& before,
                             const std::vector<Landmark>& after) {
  NamedPoints shift;
  for (size_t k = 0; k < before.size(); ++k)
    shift[before[k].name] = after[k].position - before[k].position;
  const Vec3 neck = shift.at("joint-neck"), knee = shift.at("joint-l-knee");
  const auto upright = [](const Vec3& v) { return Vec3(0, v.y(), v.z()); };
  NamedPoints out;
  for (const CubeRule& cube : rules.cubes)
    out[cube.joint] = average.at(cube.joint) + shift.at(cube.cube);
  for (const char* name : {"hip", "l5"})
    out[name] = average.at(name) + upright(0.5 * neck + 0.5 * knee);
  out["t12"] = average.at("t12") + upright(0.75 * neck + 0.25 * knee);
  out["pelvis"] = average.at("pelvis") + upright(0.5 * neck + 0.5 * knee);
  out["clavicle"] = average.at("clavicle") + upright(neck);
  out["scapula"] = average.at("scapula") + upright(shift.at("joint-l-shoulder"));
  return out;
}

struct Examples {
  std::vector<CentreExample> centres;
  std::vector<BuildExample> builds;
};

void place_template(const BodyPackage& package, const FitTables& tables, const ShapeSpec& spec,
                    Examples& out) {
  const ShapedBody body = shape_body(package, spec);
  const SkinField skin(capped_skin(package, body.points));
  const PlaceInput input = fit_input(tables, body.body.skin.V, body.stature);
  const Placement placement = place_bones(input, tables.rules, skin);
  const NamedPoints centres =
      known_centres(tables.rules, moved(tables.half, tables.rules, placement).points);
  out.builds.push_back(
      {build_features(input.centres, body.stature), placement.maps, placement.expected});
  out.centres.push_back({body.body.skin.V, centres});
}

}  // namespace

PlaceInput source_input(const BodyPackage& package, const HalfSkeleton& source,
                        const FitRules& rules, const ShapedBody& body) {
  PlaceInput input;
  input.source = &source;
  input.centres =
      guess_centres(rules, marks_of(package, rules, body.points), body.body.sex, body.stature);
  for (const CubeRule& cube : rules.cubes) input.tolerances[cube.joint] = cube.tolerance;
  input.size = body.stature / source.stature;
  for (const LandmarkRule& rule : rules.landmarks)
    input.landmarks.push_back({find_landmark(source, rule), (rule.low + rule.high) / 2,
                               (rule.high - rule.low) / 4, rule.tolerance, 1});
  return input;
}

void train(const BodyPackage& package, const HalfSkeleton& source, const ShapedBody& own,
           FitTables& tables) {
  const FitRules& rules = tables.rules;
  std::vector<CentreExample> examples{{own.body.skin.V, known_centres(rules, tables.half.points)}};
  examples[0].centres["pelvis"] = tables.half.points.at("pelvis");
  ShapeSpec woman_spec;
  woman_spec.sex = Sex::female;
  const ShapedBody woman = shape_body(package, woman_spec);
  const SkinField skin(capped_skin(package, woman.points));
  const Placement placement = place_bones(source_input(package, source, rules, woman), rules, skin);
  examples.push_back(
      {woman.body.skin.V, known_centres(rules, moved(source, rules, placement).points)});

  // Other builds of the two.
  struct Build {
    double muscle, weight;
  };
  for (size_t k = 0; k < 2; ++k) {
    const ShapedBody& average = k == 0 ? own : woman;
    const std::vector<Landmark> marks = marks_of(package, rules, average.points);
    Points still = shape_points(package, average.macros);
    const Eigen::RowVector3d floor = average.points.row(0) - still.row(0);
    for (const Build& build : {Build{0.5, 0.9},
                               {0.5, 0.2},
                               {0.9, 0.5},
                               {0.2, 0.5},
                               {0.9, 0.8},
                               {0.3, 0.8},
                               {0.8, 0.3},
                               {0.3, 0.3},
                               {0.1, 0.9},
                               {0.05, 0.2}}) {
      Macros macros = average.macros;
      macros.muscle = build.muscle;
      macros.weight = build.weight;
      Points points = shape_points(package, macros);
      points.rowwise() += floor;
      examples.push_back(
          {points.topRows(package.skin_size),
           moved_with_marks(rules, examples[k].centres, marks, marks_of(package, rules, points))});
    }
  }

  // Other statures and ages, by what is learned so far.
  tables.regressor = learn_centres(examples, tables.topology.mirror);
  Examples placed;
  for (const Sex sex : {Sex::male, Sex::female})
    for (const double height : {1.5, 1.55, 1.6, 1.65, 1.7, 1.8, 1.9, 2.0}) {
      if (sex == Sex::female && height > 1.85) continue;
      ShapeSpec spec;
      spec.sex = sex;
      spec.height = height;
      place_template(package, tables, spec, placed);
    }
  for (const Sex sex : {Sex::male, Sex::female})
    for (const double age : {15.0, 50.0, 75.0}) {
      ShapeSpec spec;
      spec.sex = sex;
      spec.age = age;
      place_template(package, tables, spec, placed);
    }
  examples.insert(examples.end(), placed.centres.begin(), placed.centres.end());
  tables.regressor = learn_centres(examples, tables.topology.mirror);
  tables.build =
      learn_build(build_features(joint_centres(tables.regressor, own.body.skin.V), own.stature),
                  rules, placed.builds);
}

}  // namespace ecorche::inline v1
