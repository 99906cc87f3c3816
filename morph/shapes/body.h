// The body package's own shapes: skins by its sliders, their stature and volume.
//
// Lengths in metres, masses in kilograms, ages in years. A made body stands with its soles on y =
// 0, in the base mesh's A-pose, with the base mesh's vertices and triangles.
#pragma once

#include <optional>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "morph/measures/body_volume.h"

namespace ecorche::inline v1 {

// The package's shape sliders, each in [0, 1]; one half is the average. The recipe is that of
// MakeHuman and its Blender add-on.
struct Macros {
  double male = 1;   // 0 female
  double age = 0.5;  // 0 baby, 0.1875 child of ten, 0.5 young, 1 old
  double muscle = 0.5;
  double weight = 0.5;
  double height = 0.5;
  double proportions = 0.5;  // 1 "ideal"
  double cup = 0.5;          // breast size, of females
  double firmness = 0.5;
  Vec3 origin = Vec3(0, 0, 1);  // African, Asian, Caucasian shares; scaled to sum 1
};

// All points of the package in that shape. #P x 3, metres, not yet put on the floor.
// Throws std::invalid_argument for sliders outside [0, 1], InputError for damaged targets.
Points shape_points(const BodyPackage& package, const Macros& macros);

// The package's age slider for a person's age: 1 year .. 90 years. Ages outside are brought to the
// nearer end.
double age_slider(double years);

// A body of the package's own average build: what the template stands in and its regressors are
// trained on. People are made by body_model.h.
struct ShapeSpec {
  Sex sex = Sex::male;
  double age = 25;
  std::optional<double> height{};  // the package's average for sex and age when left out
};

struct ShapedBody {
  Body body;
  // #P x 3, all points of the package in this shape, on the floor: what rigs are placed by
  Points points;
  Macros macros;  // that give it
  double stature = 0;
  double volume = 0;
  double mass = 0;
};

// Height is met to 0.1 mm. Throws UnfitError that states the reachable range when the package's
// shapes cannot.
ShapedBody shape_body(const BodyPackage& package, const ShapeSpec& spec);

}  // namespace ecorche::inline v1
