#include "morph/shapes/shape_examples.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {
namespace {

// Evenly spread numbers in 0 .. 1: the i-th of Halton's sequence in a prime base (Halton 1960).
double halton(int i, int base) {
  double value = 0, share = 1;
  for (int n = i; n > 0; n /= base) {
    share /= base;
    value += share * (n % base);
  }
  return value;
}

constexpr double kYoungestShapeExamples = 18, kOldestShapeExamples = 90;  // years

}  // namespace

Macros example_macros(Sex sex, int i) {
  static constexpr std::array<int, 9> bases{2, 3, 5, 7, 11, 13, 17, 19, 23};
  const auto u = [i](std::size_t axis) { return halton(i + 1, bases[axis]); };
  Macros m;
  m.male = sex == Sex::male ? 1 : 0;
  m.age =
      age_slider(kYoungestShapeExamples + (kOldestShapeExamples - kYoungestShapeExamples) * u(0) *
                                              u(0));  // more young than old, as in the survey
  m.weight = u(1);
  m.muscle = u(2);
  m.height = u(3);
  m.proportions = u(4);
  m.cup = u(5);
  m.firmness = u(6);
  m.origin = Vec3(u(7), u(8), 0.2 + u(0));
  return m;
}

Eigen::MatrixXd shape_examples(const BodyPackage& package, Sex sex, int count) {
  const Eigen::Index n = package.skin_size;
  Eigen::MatrixXd out(3 * n, count);
  for (int i = 0; i < count; ++i) {
    Points skin = shape_points(package, example_macros(sex, i)).topRows(n);
    skin.col(1).array() -= skin.col(1).minCoeff();
    out.col(i) = Eigen::Map<const Eigen::VectorXd>(skin.data(), 3 * n);
  }
  make_symmetric(package, out);
  return out;
}

Eigen::MatrixXd local_shapes(const BodyPackage& package, Sex sex,
                             const std::filesystem::path& folder) {
  const Table table(folder / "local_shapes.csv");
  const Eigen::Index n = package.skin_size;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * n, table.rows());
  int columns = 0;
  for (int row = 0; row < table.rows(); ++row) {
    const std::string& only = table.text(row, "sex");
    if (!only.empty() && only != (sex == Sex::male ? "male" : "female")) continue;
    const double sd = table.number(row, "sd");
    const auto add = [&](std::string name, double amount) {
      const auto star = name.find('*');
      for (const char* side : {"l-", "r-"}) {
        std::string path = name;
        if (star != std::string::npos) path.replace(star, 1, side);
        const ShapeTarget* target = package.targets->find(path);
        if (target == nullptr)
          throw InputError(
              fmt::format("{}: the body package has no target '{}'", table.where(row), path));
        for (std::size_t k = 0; k < target->indices.size(); ++k)
          if (target->indices[k] < n)
            out.block<3, 1>(3 * target->indices[k], columns) +=
                amount * target->offsets.row(k).transpose();
        if (star == std::string::npos) break;
      }
    };
    add(table.text(row, "high"), 0.5 * sd);
    add(table.text(row, "low"), -0.5 * sd);
    ++columns;
  }
  out.conservativeResize(Eigen::NoChange, columns);
  make_symmetric(package, out);
  return out;
}

void make_symmetric(const BodyPackage& package, Eigen::MatrixXd& columns) {
  const Eigen::MatrixXd before = columns;
  for (int v = 0; v < package.skin_size; ++v) {
    const int w = package.mirror[v];
    columns.row(3 * v) = 0.5 * (before.row(3 * v) - before.row(3 * w));
    for (int axis = 1; axis < 3; ++axis)
      columns.row(3 * v + axis) = 0.5 * (before.row(3 * v + axis) + before.row(3 * w + axis));
  }
}

}  // namespace ecorche::inline v1
