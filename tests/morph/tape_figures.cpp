// Prints the figures of the shape space on people who were measured: what was asked beside what a
// tape of its own reads on the bodies, what the bodies say of measures not asked, contradictory
// requests, bodies from all of their own measures, the examples paper's sets.
//   tape_figures [--people N] [--sheet FILE.obj]      ends with 77 (skipped) where the packages or
//   ../shared are not there
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <random>
#include <sstream>

#include <Eigen/Cholesky>

#include "anatomy/errors.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/shapes/example_synthesizer.h"
#include "morph/shapes/shape_examples.h"
#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/solve_measures.h"
#include "tests/morph/paper_sets.h"
#include "tests/morph/tape_check.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

const std::vector<std::string> kGiven{"neck_base_girth",    "chest_girth", "waist_girth",
                                      "hip_girth",          "stature",     "crotch_height",
                                      "arm_length_outseam", "weight"};

const char* word(Sex sex) { return sex == Sex::male ? "men" : "women"; }

// The survey's people, the fields that our table knows, in metres and kilograms: #people x
// #measures of the survey.
Eigen::MatrixXd read_survey_people(const TapeMeasure& tape, const Survey& survey,
                                   const std::filesystem::path& file) {
  std::ifstream in(file);
  const auto cells = [](const std::string& line) {
    std::vector<std::string> out;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) {
      cell.erase(std::remove(cell.begin(), cell.end(), '\r'), cell.end());
      std::transform(cell.begin(), cell.end(), cell.begin(),
                     [](unsigned char c) { return std::tolower(c); });
      out.push_back(cell);
    }
    return out;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> header = cells(line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> row = cells(line);
    rows.emplace_back();
    for (int k : survey.measures) {
      const Measure& m = tape.measure(k);
      const std::size_t column =
          std::find(header.begin(), header.end(), m.survey_field) - header.begin();
      const double value = std::stod(row.at(column));
      rows.back().push_back(m.kind == MeasureKind::mass ? 0.1 * value
                                                        : 0.001 * value + m.survey_shift);
    }
  }
  Eigen::MatrixXd out(rows.size(), Eigen::Index(survey.measures.size()));
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index k = 0; k < out.cols(); ++k) out(i, k) = rows[i][k];
  return out;
}

struct Bench {
  const BodyPackage& package;
  const TapeMeasure& tape;
  const TapeCheck& check;
  const ShapeSpace& space;
  const Survey& survey;
  Eigen::MatrixXd people;                  // even rows: fitting half
  std::vector<Eigen::Index> given, other;  // columns

  std::vector<MeasureTarget> targets(Eigen::Index person) const {
    std::vector<MeasureTarget> out;
    for (Eigen::Index c : given) out.push_back({survey.measures[c], people(person, c)});
    return out;
  }
};

int failures = 0;

void judge(const std::string& what, double value, double bound, const char* unit) {
  const bool good = value <= bound;
  if (!good) ++failures;
  fmt::print("  {:62} {:9.3f}   asked <= {:g} {}{}\n", what, value, bound, unit,
             good ? "" : "   MISSED");
}

// Asked against measured, and unasked against least squares, on people whose rows the survey's
// statistics were not made from.
void feasible(const Bench& b, int count) {
  const Eigen::Index half = b.people.rows() / 2, n = std::min<Eigen::Index>(count, half),
                     G = Eigen::Index(b.given.size()), O = b.other.size();
  Eigen::MatrixXd X(half, G + 1), Y(half, O);  // least squares on the fitting half
  for (Eigen::Index i = 0; i < half; ++i) {
    for (Eigen::Index j = 0; j < G; ++j) X(i, j) = b.people(2 * i, b.given[j]);
    X(i, G) = 1;
    for (Eigen::Index j = 0; j < O; ++j) Y(i, j) = b.people(2 * i, b.other[j]);
  }
  const Eigen::MatrixXd W = (X.transpose() * X).ldlt().solve(X.transpose() * Y);
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(O), ours = offset, theirs = offset;
  double sum = 0, worst = 0, milliseconds = 0;
  int lengths = 0, outside = 0, alarms = 0;
  std::vector<double> miss(b.given.size(), 0.0);
  for (const int part : {0, 1}) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index person = 2 * i + part;
      const std::vector<MeasureTarget> asked = b.targets(person);
      const auto before = std::chrono::steady_clock::now();
      const SolvedBody body = solve_measures(b.tape, b.space, asked);
      if (part == 1)
        milliseconds +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before)
                .count() /
            double(n);
      Eigen::VectorXd read(O), said(O);
      for (Eigen::Index j = 0; j < O; ++j) {
        const auto c = b.other[j];
        read[j] = b.tape.take(b.survey.measures[c], body.points);
        said[j] = b.people(person, c);
      }
      if (part == 0) {
        offset += (read - said) / double(n);
        continue;
      }
      Eigen::VectorXd x(G + 1);
      for (Eigen::Index j = 0; j < G; ++j) x[j] = b.people(person, b.given[j]);
      x[G] = 1;
      ours += (read - offset - said).cwiseAbs() / double(n);
      theirs += (W.transpose() * x - said).cwiseAbs() / double(n);
      if (!body.conflicts.empty()) {
        ++alarms;
        continue;
      }
      for (std::size_t j = 0; j < asked.size(); ++j) {
        const Measure& m = b.tape.measure(asked[j].measure);
        const double off = std::abs(b.check.take(m, body.points) - asked[j].value);
        miss[j] = std::max(miss[j], off);
        if (off > m.tolerance) ++outside;
        if (m.kind == MeasureKind::mass) continue;
        sum += off, worst = std::max(worst, off), ++lengths;
      }
    }
  }
  fmt::print("\n{} {}: eight measures asked, read by another tape\n", n, word(b.space.sex));
  judge("mean miss of an asked length", 1e3 * sum / lengths, 1, "mm");
  judge("measures outside what ISO 20685 allows", outside, 0, "");
  judge("feasible sets refused, %", 100.0 * alarms / double(n), 1, "%");
  for (std::size_t j = 0; j < miss.size(); ++j) {
    const Measure& m = b.tape.measure(b.survey.measures[b.given[j]]);
    judge("  largest miss of " + m.id, (m.kind == MeasureKind::mass ? 1 : 1e3) * miss[j],
          (m.kind == MeasureKind::mass ? 1 : 1e3) * m.tolerance,
          m.kind == MeasureKind::mass ? "kg" : "mm");
  }
  judge(fmt::format("{} unasked measures: {:.2f} mm, least squares {:.2f} mm; ratio", O,
                    1e3 * ours.mean(), 1e3 * theirs.mean()),
        ours.mean() / theirs.mean(), 1.1, "");
  fmt::print("  {:62} {:9.1f}   ms, wall\n", "mean time of a body", milliseconds);
}

// One of a person's measures moved four deviations to the other side of the mean.
void contradictory(const Bench& b, int count) {
  std::mt19937 random(5);
  int flagged = 0, right = 0;
  for (int set = 0; set < count; ++set) {
    std::vector<MeasureTarget> asked =
        b.targets(2 * (Eigen::Index(random()) % (b.people.rows() / 2)) + 1);
    const std::size_t bad = random() % asked.size();
    const Eigen::Index c = b.given[bad];
    asked[bad].value =
        b.survey.mean[c] + (asked[bad].value > b.survey.mean[c] ? -4 : 4) * b.survey.sd[c];
    const std::vector<Conflict> conflicts = find_conflicts(b.space, asked);
    if (!conflicts.empty()) ++flagged;
    if (std::any_of(conflicts.begin(), conflicts.end(), [&](const Conflict& found) {
          return found.blamed == int(bad) || std::find(found.others.begin(), found.others.end(),
                                                       int(bad)) != found.others.end();
        }))
      ++right;
  }
  fmt::print("\n{} contradictory sets of {}\n", count, word(b.space.sex));
  judge("not flagged", count - flagged, 0, "");
  judge("flagged without the measure that was moved", flagged - right, 0, "");
}

// Bodies from all of their own measures: drawn from the space, and held-out shapes of the package.
void come_back(const Bench& b, int count) {
  const Eigen::MatrixXd held_out =
      shape_examples(b.package, b.space.sex, ShapeSpaceOptions{}.examples + count).rightCols(count);
  for (const bool drawn : {true, false}) {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    std::vector<double> distances;
    for (int i = 0; i < count; ++i) {
      Eigen::VectorXd z(b.space.basis.cols());
      for (double& x : z) x = normal(random);
      const Points own =
          drawn ? space_points(b.space, z)
                : Points(Eigen::Map<const Points>(held_out.col(i).data(), b.package.skin_size, 3));
      std::vector<MeasureTarget> asked;
      for (int k = 0; k < b.tape.count(); ++k) asked.push_back({k, b.tape.take(k, own)});
      SolveOptions any;
      any.allow_unusual = true;
      Points back = solve_measures(b.tape, b.space, asked, any).points;
      back.rowwise() += (own - back).colwise().mean();
      const SkinField surface(TriMesh{own, b.package.triangles});
      double distance = 0;
      for (Eigen::Index v = 0; v < back.rows(); ++v)
        distance += std::abs(surface.distance(back.row(v))) / double(back.rows());
      distances.push_back(1e3 * distance);
    }
    std::sort(distances.begin(), distances.end());
    double mean = 0;
    for (double d : distances) mean += d / count;
    fmt::print("\n{} {} from all {} of their own measures, {}\n", count, word(b.space.sex),
               b.tape.count(),
               drawn ? "drawn from the space" : "shapes of the package that were no examples");
    judge("mean over them of the mean distance of the surfaces", mean, 2, "mm");
    judge("largest of them", distances.back(), 2, "mm");
    fmt::print(
        "  {:62} {:9.1f}   %\n", "share within 2 mm",
        100.0 *
            double(std::upper_bound(distances.begin(), distances.end(), 2.0) - distances.begin()) /
            count);
  }
}

// The examples paper's own sets, made whatever people measure; onto the sheet from left to right.
void paper(const Bench& b, std::ofstream* sheet, int row, int& sheet_vertices) {
  fmt::print(
      "\nThe examples paper's sets, {}: asked and read by another tape, cm (* the space calls the "
      "set contradictory)\n  ",
      word(b.space.sex));
  for (const char* id : kPaperMeasures) fmt::print("{:>15}", std::string(id).substr(0, 14));
  fmt::print("\n");
  double worst = 0;
  const auto& sets = paper_sets(b.space.sex);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    std::vector<MeasureTarget> asked;
    for (std::size_t j = 0; j < sets[s].size(); ++j)
      asked.push_back({b.tape.table().at(kPaperMeasures[j]), 0.01 * sets[s][j]});
    SolveOptions any;
    any.allow_unusual = true;
    const SolvedBody body = solve_measures(b.tape, b.space, asked, any);
    fmt::print("{}{}", char('a' + s), find_conflicts(b.space, asked).empty() ? ' ' : '*');
    for (const MeasureTarget& target : asked) {
      const Measure& m = b.tape.measure(target.measure);
      const double read = b.check.take(m, body.points);
      worst = std::max(worst, std::abs(read - target.value) / m.tolerance);
      fmt::print("{:>15}", fmt::format("{:.0f} {:.1f}", 100 * target.value, 100 * read));
    }
    fmt::print("\n");
    if (sheet == nullptr) continue;
    for (int v = 0; v < b.package.skin_size; ++v)
      *sheet << fmt::format("v {:.4f} {:.4f} {:.4f}\n", body.points(v, 0) + 1.2 * double(s),
                            body.points(v, 1) - 2.2 * row, body.points(v, 2));
    for (Eigen::Index q = 0; q < b.package.quads.rows(); ++q)
      *sheet << fmt::format("f {} {} {} {}\n", sheet_vertices + b.package.quads(q, 0) + 1,
                            sheet_vertices + b.package.quads(q, 1) + 1,
                            sheet_vertices + b.package.quads(q, 2) + 1,
                            sheet_vertices + b.package.quads(q, 3) + 1);
    sheet_vertices += b.package.skin_size;
  }
  judge("largest miss, in tolerances of ISO 20685", worst, 1, "");
}

// The examples paper's table 3, with our examples: each made from the others by its measures.
void synthesizer(const Bench& b, int count) {
  const ExampleSynthesizer learned = learn_synthesizer(b.package, b.tape, b.space.sex, count);
  fmt::print(
      "\nBodies by examples alone, {} {} left out in turn: {} components of the joints, {} of the "
      "displacements (cm)\n",
      count, word(b.space.sex), learned.joint.networks.size(),
      learned.displacement.networks.size());
  fmt::print("  {:24}{:>14}{:>14}{:>10}\n", "", "correlation", "mean diff.", "mean");
  for (const LeftOut& row : cross_validate(b.package, b.tape, b.space.sex, learned))
    fmt::print("  {:24}{:14.3f}{:14.3f}{:10.2f}\n", row.measure, row.correlation,
               100 * row.mean_difference, 100 * row.mean);
}

int run(int count, const std::string& sheet_file) {
  const std::filesystem::path survey_folder =
      std::filesystem::path(ECORCHE_SHARED_DIR) / "testdata" / "anthropometry" / "ansur2";
  if (!std::filesystem::exists(survey_folder)) {
    fmt::print("skipped: {} is not there\n", survey_folder.string());
    return 77;
  }
  std::optional<BodyPackage> package;
  try {
    package = read_body_package(test_assets());
  } catch (const InputError& e) {
    fmt::print("skipped: {}\n", e.what());
    return 77;
  }
  const auto folder = test_assets().tables / "body";
  const TapeMeasure tape(*package, read_measure_table(*package, folder));
  const TapeCheck check(*package, tape.table());
  std::optional<std::ofstream> sheet;
  if (!sheet_file.empty()) sheet.emplace(sheet_file);
  int row = 0, sheet_vertices = 0;
  for (const Sex sex : {Sex::male, Sex::female}) {
    const ShapeSpace space = read_shape_space(*package, tape, sex);
    const Survey survey = read_survey(tape.table(), sex, folder);
    Bench b{*package, tape, check, space, survey, {}, {}, {}};
    b.people =
        read_survey_people(tape, survey,
                           survey_folder / (sex == Sex::male ? "ANSUR_II_MALE_Public.csv"
                                                             : "ANSUR_II_FEMALE_Public.csv"));
    for (std::size_t c = 0; c < survey.measures.size(); ++c)
      (std::find(kGiven.begin(), kGiven.end(), tape.measure(survey.measures[c]).id) != kGiven.end()
           ? b.given
           : b.other)
          .push_back(c);
    fmt::print("\n{}: space of {} directions, {} give 99 % of the variance\n", word(sex),
               space.basis.cols(), space.components);
    feasible(b, count);
    contradictory(b, 100);
    come_back(b, std::clamp(count / 20, 5, 60));
    synthesizer(b, count >= 500 ? 200 : 60);
    paper(b, sheet ? &*sheet : nullptr, row++, sheet_vertices);
  }
  fmt::print("\n{}\n",
             failures == 0 ? "all figures reached" : fmt::format("{} figures missed", failures));
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace ecorche

int main(int argc, char** argv) {
  int count = 500;
  std::string sheet;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::string(argv[i]) == "--people") count = std::stoi(argv[i + 1]);
    if (std::string(argv[i]) == "--sheet") sheet = argv[i + 1];
  }
  return ecorche::run(count, sheet);
}
