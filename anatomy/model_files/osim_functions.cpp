#include "anatomy/model_files/osim_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/model_files/model_xml.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::array kNames{"Constant",
                            "LinearFunction",
                            "PolynomialFunction",
                            "MultiplierFunction",
                            "PiecewiseLinearFunction",
                            "PiecewiseConstantFunction",
                            "SimmSpline",
                            "NaturalCubicSpline",
                            "GCVSpline",
                            "Sine"};

struct Samples {
  std::vector<double> x, y;
};

Samples samples(pugi::xml_node node, const std::string& where) {
  Samples s{model_xml::numbers(node.child_value("x"), where + ": x"),
            model_xml::numbers(node.child_value("y"), where + ": y")};
  if (s.x.empty() || s.x.size() != s.y.size())
    throw InputError(
        fmt::format("{}: {} x and {} y; as many of both expected", where, s.x.size(), s.y.size()));
  for (size_t i = 1; i < s.x.size(); ++i)
    if (!(s.x[i] > s.x[i - 1]))
      throw InputError(fmt::format("{}: x does not rise after {}", where, s.x[i - 1]));
  return s;
}

size_t interval(const Samples& s, double x) {
  const auto above = std::upper_bound(s.x.begin(), s.x.end(), x);
  return std::size_t(std::clamp<long>(above - s.x.begin() - 1, 0, long(s.x.size()) - 2));
}

// Second-order coefficients c of the cubic pieces; ends from the cubic through the nearest four
// points.
std::vector<double> spline_curvatures(const Samples& s) {
  const size_t n = s.x.size();
  std::vector<double> b(n), c(n), d(n);
  for (size_t i = 0; i + 1 < n; ++i) d[i] = s.x[i + 1] - s.x[i];
  const auto slope = [&](size_t i) { return (s.y[i + 1] - s.y[i]) / d[i]; };
  for (size_t i = 1; i + 1 < n; ++i) {
    b[i] = 2 * (d[i - 1] + d[i]);
    c[i] = slope(i) - slope(i - 1);
  }
  b[0] = -d[0];
  b[n - 1] = -d[n - 2];
  if (n > 3) {
    c[0] = c[2] / (s.x[3] - s.x[1]) - c[1] / (s.x[2] - s.x[0]);
    c[0] *= d[0] * d[0] / (s.x[3] - s.x[0]);
    c[n - 1] = c[n - 2] / (s.x[n - 1] - s.x[n - 3]) - c[n - 3] / (s.x[n - 2] - s.x[n - 4]);
    c[n - 1] *= -d[n - 2] * d[n - 2] / (s.x[n - 1] - s.x[n - 4]);
  }
  for (size_t i = 1; i < n; ++i) {
    const double t = d[i - 1] / b[i - 1];
    b[i] -= t * d[i - 1];
    c[i] -= t * c[i - 1];
  }
  c[n - 1] /= b[n - 1];
  for (size_t i = n - 1; i-- > 0;) c[i] = (c[i] - d[i] * c[i + 1]) / b[i];
  return c;
}

double spline(const Samples& s, double x) {
  const size_t n = s.x.size();
  if (n == 1) return s.y[0];
  if (n == 2) return s.y[0] + (s.y[1] - s.y[0]) / (s.x[1] - s.x[0]) * (x - s.x[0]);
  const std::vector<double> c = spline_curvatures(s);
  const size_t i = interval(s, x);
  const double h = s.x[i + 1] - s.x[i];
  const double b = (s.y[i + 1] - s.y[i]) / h - h * (c[i + 1] + 2 * c[i]), d = (c[i + 1] - c[i]) / h;
  // Beyond its ends a spline goes on straight.
  const double inside = std::clamp(x, s.x.front(), s.x.back()), t = inside - s.x[i];
  return s.y[i] + t * (b + t * (3 * c[i] + t * d)) +
         (x - inside) * (b + t * (6 * c[i] + 3 * t * d));
}

double polyline_osim_functions(const Samples& s, double x) {
  if (s.x.size() == 1) return s.y[0];
  const size_t i = interval(s, x);
  return s.y[i] + (s.y[i + 1] - s.y[i]) / (s.x[i + 1] - s.x[i]) * (x - s.x[i]);
}

double evaluate(pugi::xml_node node, double x, const std::string& where, int depth) {
  if (depth > limits::kModelDepth) throw LimitError(where + ": functions nested too deep");
  const std::string_view kind = node.name();
  const auto coefficients = [&] {
    return model_xml::numbers(node.child_value("coefficients"), where + ": coefficients", 64);
  };
  const auto value = [&](const char* name, double otherwise) {
    return node.child(name)
               ? model_xml::number(node.child_value(name), fmt::format("{}: {}", where, name))
               : otherwise;
  };
  if (kind == "Constant") return value("value", 0);
  if (kind == "LinearFunction") {
    const auto c = coefficients();
    if (c.size() != 2) throw InputError(where + ": LinearFunction: two coefficients expected");
    return c[0] * x + c[1];
  }
  if (kind == "PolynomialFunction") {
    double sum = 0;
    for (double c : coefficients()) sum = sum * x + c;
    return sum;
  }
  if (kind == "MultiplierFunction") {
    const pugi::xml_node inner = find_osim_function(node.child("function"));
    if (!inner) throw InputError(where + ": MultiplierFunction without a function");
    return value("scale", 1) * evaluate(inner, x, where, depth + 1);
  }
  if (kind == "PiecewiseLinearFunction") return polyline_osim_functions(samples(node, where), x);
  if (kind == "PiecewiseConstantFunction") {
    const Samples s = samples(node, where);
    return s.y[std::max<long>(0, std::upper_bound(s.x.begin(), s.x.end(), x) - s.x.begin() - 1)];
  }
  if (kind == "Sine")
    return value("amplitude", 1) * std::sin(value("omega", 1) * x + value("phase", 0)) +
           value("offset", 0);
  if (kind == "SimmSpline" || kind == "NaturalCubicSpline" || kind == "GCVSpline")
    return spline(samples(node, where), x);
  throw InputError(fmt::format("{}: function '{}' is not understood", where, kind));
}

}  // namespace

double osim_function(pugi::xml_node function, double x, const std::string& where) {
  const double y = evaluate(function, x, where, 0);
  if (!std::isfinite(y))
    throw InputError(fmt::format("{}: the function has no finite value at {}", where, x));
  return y;
}

pugi::xml_node find_osim_function(pugi::xml_node property) {
  const auto is_one = [](pugi::xml_node n) {
    return std::any_of(kNames.begin(), kNames.end(),
                       [&](const char* k) { return std::string_view(n.name()) == k; });
  };
  if (is_one(property)) return property;
  for (pugi::xml_node child : property.children())
    if (is_one(child)) return child;
  for (pugi::xml_node child : property.children())
    if (std::string_view(child.name()) == "function")
      for (pugi::xml_node inner : child.children())
        if (is_one(inner)) return inner;
  return {};
}

}  // namespace ecorche::inline v1
