#include "morph/shapes/body.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

// A named state of one slider and how much of it there is.
struct State {
  std::string name;
  double weight = 0;
};
using States = std::vector<State>;

void append_if_any(States& states, const char* name, double weight) {
  if (weight > 1e-9) states.push_back({name, weight});
}

// Sliders with three states: half the way up is all middle.
States three_states(double v, const char* low, const char* middle, const char* high) {
  States out;
  append_if_any(out, low, std::max(0.0, 1 - 2 * v));
  append_if_any(out, middle, 1 - std::abs(2 * v - 1));
  append_if_any(out, high, std::max(0.0, 2 * v - 1));
  return out;
}

// Sliders whose middle is the absence of a target.
States two_ended(double v, const char* low, const char* high) {
  States out;
  append_if_any(out, low, std::max(0.0, 1 - 2 * v));
  append_if_any(out, high, std::max(0.0, 2 * v - 1));
  return out;
}

States age_states(double v) {
  constexpr double kChild = 0.1875, kYoung = 0.5;
  States out;
  if (v < kChild) {
    append_if_any(out, "baby", 1 - v / kChild);
    append_if_any(out, "child", v / kChild);
  } else if (v < kYoung) {
    append_if_any(out, "child", (kYoung - v) / (kYoung - kChild));
    append_if_any(out, "young", (v - kChild) / (kYoung - kChild));
  } else {
    append_if_any(out, "young", (1 - v) / (1 - kYoung));
    append_if_any(out, "old", (v - kYoung) / (1 - kYoung));
  }
  return out;
}

// All combinations of one state of each axis: names joined by dashes, weights multiplied.
States combine(const std::vector<States>& axes) {
  States out{{"", 1}};
  for (const auto& axis : axes) {
    States longer;
    for (const auto& head : out) {
      for (const auto& state : axis)
        longer.push_back({head.name.empty() ? state.name : head.name + "-" + state.name,
                          head.weight * state.weight});
    }
    out = std::move(longer);
  }
  return out;
}

void check_sliders(const Macros& m) {
  for (double v : {m.male, m.age, m.muscle, m.weight, m.height, m.proportions, m.cup, m.firmness}) {
    if (!(v >= 0 && v <= 1))
      throw std::invalid_argument(fmt::format("shape slider {} is not in 0 .. 1", v));
  }
  if (!(m.origin.minCoeff() >= 0 && m.origin.sum() > 0))
    throw std::invalid_argument("shares of origin must be positive");
}

// Every target of a shape with its weight. A combination the package has no file for adds nothing.
States shape_targets(const Macros& m) {
  States gender, origin;
  append_if_any(gender, "female", 1 - m.male);
  append_if_any(gender, "male", m.male);
  const Vec3 shares = m.origin / m.origin.sum();
  append_if_any(origin, "african", shares[0]);
  append_if_any(origin, "asian", shares[1]);
  append_if_any(origin, "caucasian", shares[2]);
  const States age = age_states(m.age);
  const States muscle = three_states(m.muscle, "minmuscle", "averagemuscle", "maxmuscle");
  const States weight = three_states(m.weight, "minweight", "averageweight", "maxweight");

  States out;
  const auto add = [&out](const char* prefix, const States& states) {
    for (const auto& state : states) out.push_back({prefix + state.name, state.weight});
  };
  add("macrodetails/", combine({origin, gender, age}));
  add("macrodetails/universal-", combine({gender, age, muscle, weight}));
  add("macrodetails/height/",
      combine({gender, age, muscle, weight, two_ended(m.height, "minheight", "maxheight")}));
  add("macrodetails/proportions/",
      combine({gender, age, muscle, weight,
               two_ended(m.proportions, "uncommonproportions", "idealproportions")}));
  if (m.male < 1) {
    add("breast/",
        combine({{{"female", 1 - m.male}},
                 age,
                 muscle,
                 weight,
                 three_states(m.cup, "mincup", "averagecup", "maxcup"),
                 three_states(m.firmness, "minfirmness", "averagefirmness", "maxfirmness")}));
  }
  return out;
}

// Where a rising function meets a value, given a bracket: false position with the Illinois rule.
double solve_rising(const std::function<double(double)>& f, double low, double f_low, double high,
                    double f_high, double value, double tolerance) {
  double x = low;
  f_low -= value;
  f_high -= value;
  for (int round = 0, stuck = 0; round < 60; ++round) {
    x = std::abs(f_high - f_low) > 1e-12 ? low - f_low * (high - low) / (f_high - f_low)
                                         : 0.5 * (low + high);
    const double y = f(x) - value;
    if (std::abs(y) < tolerance) break;
    if (y < 0) {
      low = x, f_low = y;
      if (stuck == -1) f_high *= 0.5;
      stuck = -1;
    } else {
      high = x, f_high = y;
      if (stuck == 1) f_low *= 0.5;
      stuck = 1;
    }
  }
  return x;
}

// Sets the height slider so that the stature is met. Throws UnfitError that states the range.
void solve_height(const BodyPackage& package, double wanted, Macros& macros) {
  const auto stature_at = [&](double slider) {
    macros.height = slider;
    return stature(package, shape_points(package, macros));
  };
  const double middle = stature_at(0.5);
  if (std::abs(wanted - middle) < 1e-5) return;
  const bool taller = wanted > middle;
  const double end = stature_at(taller ? 1 : 0);
  if (taller ? wanted > end : wanted < end) {
    throw UnfitError(
        fmt::format("height {:.3f} m: shapes of this sex and age reach {:.3f} m .. {:.3f} m; "
                    "choose a height in that range",
                    wanted, taller ? stature_at(0) : end, taller ? end : stature_at(1)));
  }
  macros.height = taller ? solve_rising(stature_at, 0.5, middle, 1, end, wanted, 1e-5)
                         : solve_rising(stature_at, 0, end, 0.5, middle, wanted, 1e-5);
}

void check_spec(const ShapeSpec& spec) {
  const auto check = [](const char* what, double value, double low, double high, const char* unit) {
    if (!(value >= low && value <= high))
      throw UnfitError(
          fmt::format("{} {}{}: expected {} .. {}{}", what, value, unit, low, high, unit));
  };
  check("age", spec.age, 1, 110, " years");
  check("height", spec.height.value_or(1.7), 0.3, 3, " m");
}

}  // namespace

Points shape_points(const BodyPackage& package, const Macros& macros) {
  check_sliders(macros);
  Points points = package.points;
  for (const auto& [name, weight] : shape_targets(macros)) {
    const ShapeTarget* target = package.targets->find(name);
    if (target == nullptr) continue;
    for (std::size_t k = 0; k < target->indices.size(); ++k) {
      points.row(target->indices[k]) += weight * target->offsets.row(k);
    }
  }
  return points;
}

double age_slider(double years) {
  const double slider = years < 25 ? 0.5 * (years - 1) / 24 : 0.5 + 0.5 * (years - 25) / 65;
  return std::clamp(slider, 0.0, 1.0);
}

ShapedBody shape_body(const BodyPackage& package, const ShapeSpec& spec) {
  check_spec(spec);
  ShapedBody out;
  Macros& macros = out.macros;
  macros.male = spec.sex == Sex::male ? 1 : 0;
  macros.age = age_slider(spec.age);
  if (spec.height) solve_height(package, *spec.height, macros);
  out.points = shape_points(package, macros);
  out.points.col(1).array() -= out.points.col(1).head(package.skin_size).minCoeff();
  out.stature = stature(package, out.points);
  out.volume = skin_volume(package, out.points);
  out.mass = kBodyDensity * out.volume;
  out.body.skin = skin_mesh(package, out.points);
  out.body.sex = spec.sex;
  out.body.age = spec.age;
  out.body.mass = out.mass;
  return out;
}

}  // namespace ecorche::inline v1
