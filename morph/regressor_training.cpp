#include "morph/regressor_training.h"

#include "morph/skin_field.h"

namespace ecorche {
namespace {

NamedPoints known_centres(const FitRules& rules, const NamedPoints& all) {
  NamedPoints out;
  for (const CubeRule& cube : rules.cubes) out[cube.joint] = all.at(cube.joint);
  out["pelvis"] = all.at("pelvis");
  return out;
}

// The centres of a build of the same stature as `average`: each goes with its mark.
NamedPoints moved_with_marks(const FitRules& rules, const NamedPoints& average, const std::vector<Landmark>& before,
                             const std::vector<Landmark>& after) {
  NamedPoints shift;
  for (size_t k = 0; k < before.size(); ++k) shift[before[k].name] = after[k].position - before[k].position;
  NamedPoints out;
  for (const CubeRule& cube : rules.cubes) out[cube.joint] = average.at(cube.joint) + shift.at(cube.cube);
  const Vec3 hip = shift.at("joint-l-upper-leg");
  out["pelvis"] = average.at("pelvis") + Vec3(0, hip.y(), hip.z());
  return out;
}

CentreExample placed_by_template(const BodyPackage& package, const FitTables& tables, const BodySpec& spec) {
  const ShapedBody body = shape_body(package, spec);
  const SkinField skin(capped_skin(package, body.points));
  const Placement placement = place_bones(fit_input(tables, body.body.skin.V, body.stature), tables.rules, skin);
  return {body.body.skin.V, known_centres(tables.rules, moved(tables.half, tables.rules, placement).points)};
}

}  // namespace

PlaceInput source_input(const BodyPackage& package, const HalfSkeleton& source, const FitRules& rules, const ShapedBody& body) {
  PlaceInput input;
  input.source = &source;
  input.centres = guess_centres(rules, joint_cubes(package, body.points), body.body.sex, body.stature);
  for (const CubeRule& cube : rules.cubes) input.tolerances[cube.joint] = cube.tolerance;
  input.size = body.stature / source.stature;
  for (const LandmarkRule& rule : rules.landmarks)
    input.landmarks.push_back({find_landmark(source, rule), (rule.low + rule.high) / 2, (rule.high - rule.low) / 4, rule.tolerance, 1});
  return input;
}

CentreRegressor train_regressor(const BodyPackage& package, const HalfSkeleton& source, const ShapedBody& own, const FitTables& tables) {
  const FitRules& rules = tables.rules;
  std::vector<CentreExample> examples{{own.body.skin.V, known_centres(rules, tables.half.points)}};
  BodySpec woman_spec;
  woman_spec.sex = Sex::female;
  const ShapedBody woman = shape_body(package, woman_spec);
  const SkinField skin(capped_skin(package, woman.points));
  const Placement placement = place_bones(source_input(package, source, rules, woman), rules, skin);
  examples.push_back({woman.body.skin.V, known_centres(rules, moved(source, rules, placement).points)});

  // Other builds of the two.
  struct Build {
    double muscle, weight;
  };
  for (size_t k = 0; k < 2; ++k) {
    const ShapedBody& average = k == 0 ? own : woman;
    const std::vector<Landmark> marks = joint_cubes(package, average.points);
    Points still = shape_points(package, average.macros);
    const Eigen::RowVector3d floor = average.points.row(0) - still.row(0);
    for (const Build& build : {Build{0.5, 0.9}, {0.5, 0.2}, {0.9, 0.5}, {0.2, 0.5}, {0.9, 0.8}, {0.3, 0.8}, {0.8, 0.3}, {0.3, 0.3}}) {
      Macros macros = average.macros;
      macros.muscle = build.muscle;
      macros.weight = build.weight;
      Points points = shape_points(package, macros);
      points.rowwise() += floor;
      examples.push_back({points.topRows(package.skin_size), moved_with_marks(rules, examples[k].centres, marks, joint_cubes(package, points))});
    }
  }

  // Other statures and ages, by what is learned so far.
  FitTables learning = tables;
  learning.regressor = learn_centres(examples, tables.topology.mirror);
  for (const Sex sex : {Sex::male, Sex::female})
    for (const double height : {1.5, 1.6, 1.8, 2.0}) {
      if (sex == Sex::female && height > 1.9) continue;
      BodySpec spec;
      spec.sex = sex;
      spec.height = height;
      examples.push_back(placed_by_template(package, learning, spec));
    }
  for (const Sex sex : {Sex::male, Sex::female}) {
    BodySpec spec;
    spec.sex = sex;
    spec.age = 70;
    examples.push_back(placed_by_template(package, learning, spec));
  }
  return learn_centres(examples, tables.topology.mirror);
}

}  // namespace ecorche
