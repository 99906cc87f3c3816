// Prints the figures of registration: on synthetic scans with known truth, and on scanned people in
// ten poses each.
//   registration_figures --synthetic N [--seed S] [--keep DIR]   N scans from seed S on; --keep
//                                            writes each scan and registered skin as PLY files
//   registration_figures --faust DIR [--keep DIR]   DIR/tr_reg_0NN.off and DIR/tr_reg_0NN.vts of
//                                            people 0 to 4, poses 0 to 9 (--people 0,2 --poses 0,3)
//   registration_figures --judge N           judges perturbed and spoilt truth: are the figures
//                                            themselves right?
// Ends with 77 (skipped) where the packages or the scans are not there, with 1 where a figure is
// missed.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/registration/clean_scan.h"
#include "morph/registration/register_scan.h"
#include "tests/morph/synthetic_scans.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kFoundWithin = 0.04;  // m, mean of corresponding points

// What a registration says, in the file's coordinates.
struct Answer {
  bool refused = false;
  std::string reason;  // of refusal, or doubts
  bool doubtful = false;
  double turns = 0;  // deviation from usual ones
  Points posed;
  Points rest;  // the body brought to rest, m
  std::vector<Landmark> joints;
  double seconds = 0;
};

int failures = 0;

void judge(const std::string& what, double value, double bound, const char* unit,
           bool at_least = false) {
  const bool good = at_least ? value >= bound : value <= bound;
  if (!good) ++failures;
  fmt::print("  {:62} {:9.3f}   asked {} {:g} {}{}\n", what, value, at_least ? ">=" : "<=", bound,
             unit, good ? "" : "   MISSED");
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  const std::size_t k = std::min(values.size() - 1, std::size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(k), values.end());
  return values[k];
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

// Options are tried one after another; what follows a flag is its value.
std::optional<std::string> option(const std::vector<std::string>& arguments,
                                  const std::string& name) {
  const auto found = std::find(arguments.begin(), arguments.end(), name);
  if (found == arguments.end()) return std::nullopt;
  if (found + 1 == arguments.end()) throw UsageError(name + " needs a value");
  return *(found + 1);
}

std::vector<int> numbers(const std::string& text) {
  std::vector<int> out;
  std::istringstream in(text);
  for (std::string item; std::getline(in, item, ',');) out.push_back(std::stoi(item));
  return out;
}

// Scan vertices -> surface of the registered skin, in the file's unit.
std::vector<double> distances(const Points& from, const TriMesh& surface, double unit) {
  const NearestSurface tree(surface);
  // 20,000 tell as much as a million.
  const Eigen::Index step = std::max<Eigen::Index>(1, from.rows() / 20000);
  std::vector<double> out;
  int hint = -1;
  for (Eigen::Index i = 0; i < from.rows(); i += step) {
    const SurfacePoint hit = tree.nearest(from.row(i).transpose(), hint);
    hint = hit.triangle;
    out.push_back(unit * hit.distance);
  }
  return out;
}

struct Limb {
  const char* name;
  Side side;
  BodyPart upper, lower;
};
constexpr Limb kLimbs[] = {{"left arm", Side::left, BodyPart::forearm, BodyPart::hand},
                           {"right arm", Side::right, BodyPart::forearm, BodyPart::hand},
                           {"left leg", Side::left, BodyPart::shank, BodyPart::foot},
                           {"right leg", Side::right, BodyPart::shank, BodyPart::foot}};

bool of_limb(const VertexPart& part, const Limb& limb) {
  return part.side == limb.side && (part.part == limb.upper || part.part == limb.lower);
}

class Judge {
 public:
  explicit Judge(const BodyModel& model) : model_(model), parts_(vertex_parts(model.package())) {
    const BodyPackage& package = model.package();
    std::vector<char> inner(std::size_t(package.skin_size), 0);
    for (const Cavity& cavity : package.cavities)
      for (const int q : cavity.quads)
        for (int k = 0; k < 4; ++k) inner[std::size_t(package.quads(q, k))] = 1;
    for (int i = 0; i < package.skin_size; ++i)
      if (!inner[std::size_t(i)]) outer_.push_back(i);
  }

  const BodyPackage& package() const { return model_.package(); }
  const std::vector<VertexPart>& parts() const { return parts_; }

  // Limbs that lie nearer to the other side's truth than to their own, or far from it.
  std::string wrong_limbs(const SyntheticScan& scan, const Points& posed) const {
    std::string out;
    for (const Limb& limb : kLimbs) {
      double own = 0, other = 0;
      int count = 0;
      for (const int i : outer_) {
        if (!of_limb(parts_[std::size_t(i)], limb)) continue;
        const int m = package().mirror[std::size_t(i)];
        own += (posed.row(i) - scan.truth.row(i)).norm();
        other += (posed.row(i) - scan.truth.row(m)).norm();
        ++count;
      }
      if (other < own || scan.unit * own / count > 0.1)
        out += fmt::format("{}{} {}", out.empty() ? "" : ", ", limb.name,
                           other < own ? "swapped" : "lost");
    }
    return out;
  }

  struct Case {
    bool found = false, answered = false, doubtful = false;
    std::string wrong, doubts;
    double correspondence = 0;                 // mean, m
    std::vector<double> to_surface, to_clean;  // m
    std::vector<double> material;              // shown vertices, m
    double joints = 0, worst_joint = 0;        // m
    double seconds = 0;
  };

  Case measure(const SyntheticScan& scan, const Answer& answer) const {
    Case out;
    out.seconds = answer.seconds;
    out.doubtful = answer.doubtful || answer.refused;
    if (answer.refused) {
      out.wrong = "refused: " + answer.reason;
      return out;
    }
    out.answered = true;
    out.doubts = answer.reason;
    double sum = 0;
    for (const int i : outer_) {
      const double d = scan.unit * (answer.posed.row(i) - scan.truth.row(i)).norm();
      sum += d;
      if (scan.shown[std::size_t(i)]) out.material.push_back(d);
    }
    out.correspondence = sum / double(outer_.size());
    out.wrong = wrong_limbs(scan, answer.posed);
    out.found = out.wrong.empty() && out.correspondence < kFoundWithin;
    const TriMesh skin{answer.posed, package().triangles};
    out.to_surface = distances(scan.noisy, skin, scan.unit);
    out.to_clean = distances(scan.clean, skin, scan.unit);
    int count = 0;
    for (const Landmark& truth : scan.joints)
      for (const Landmark& joint : answer.joints) {
        if (joint.name != truth.name) continue;
        const double d = scan.unit * (joint.position - truth.position).norm();
        out.joints += d;
        out.worst_joint = std::max(out.worst_joint, d);
        ++count;
      }
    out.joints = count ? out.joints / count : NAN;
    return out;
  }

  void print_head() const {
    fmt::print("{:>4} {:>5} {:>7} {:>13} {:>13} {:>8} {:>13} {:>6}  {}\n", "seed", "", "corr.",
               "scan->body", "(no noise)", "material", "joints", "s", "scan; mm");
    fmt::print("{:>4} {:>5} {:>7} {:>13} {:>13} {:>8} {:>13}\n", "", "", "mean", "median  p95",
               "median  p95", "median", "mean   max");
  }

  void print(unsigned seed, const SyntheticScan& scan, const Case& c) const {
    fmt::print("{:4} {:>5} ", seed,
               c.found      ? (c.doubtful ? "found?" : "found")
               : c.doubtful ? "no"
                            : "WRONG");
    if (c.answered)
      fmt::print("{:7.1f} {:6.2f} {:6.2f} {:6.2f} {:6.2f} {:8.1f} {:6.1f} {:6.1f} {:6.1f}  ",
                 1e3 * c.correspondence, 1e3 * quantile(c.to_surface, 0.5),
                 1e3 * quantile(c.to_surface, 0.95), 1e3 * quantile(c.to_clean, 0.5),
                 1e3 * quantile(c.to_clean, 0.95), 1e3 * quantile(c.material, 0.5), 1e3 * c.joints,
                 1e3 * c.worst_joint, c.seconds);
    fmt::print("{}{}{}{}\n", scan.name, c.wrong.empty() ? "" : " -- ", c.wrong,
               c.doubts.empty() ? "" : " -- doubtful: " + c.doubts);
    std::fflush(stdout);
  }

  void summary(const std::vector<Case>& cases) const {
    std::vector<double> medians, p95s, material, joints, seconds, clean, clean95;
    int found = 0, silent = 0, needless = 0;
    for (const Case& c : cases) {
      seconds.push_back(c.seconds);
      found += c.found;
      silent += !c.found && !c.doubtful;
      needless += c.found && c.doubtful;
      if (!c.found) continue;
      medians.push_back(1e3 * quantile(c.to_surface, 0.5));
      p95s.push_back(1e3 * quantile(c.to_surface, 0.95));
      clean.push_back(1e3 * quantile(c.to_clean, 0.5));
      clean95.push_back(1e3 * quantile(c.to_clean, 0.95));
      material.push_back(1e3 * quantile(c.material, 0.5));
      joints.push_back(1e3 * c.joints);
    }
    const double n = double(cases.size());
    fmt::print("\n{} synthetic scans\n", cases.size());
    judge("found, %", 100 * found / n, 97, "%", true);
    judge("wrong without a word", silent, 0, "");
    fmt::print("  {:62} {:9}\n", "found, yet called doubtful", needless);
    if (found) {
      const auto worst = [](const std::vector<double>& v) {
        return *std::max_element(v.begin(), v.end());
      };
      judge("scan to surface, median; median of the scans found", quantile(medians, 0.5), 1.5,
            "mm");
      judge("scan to surface, p95; median of the scans found", quantile(p95s, 0.5), 5, "mm");
      judge("the same material point, median; median of the scans found", quantile(material, 0.5),
            8, "mm");
      judge("joints, mean; mean of the scans found", mean(joints), 12, "mm");
      fmt::print(
          "  worst of the scans found: median {:.2f}, p95 {:.2f}, material {:.1f}, joints "
          "{:.1f} mm; without the noise: median {:.2f}, p95 {:.2f} (middle), {:.2f}, {:.2f} "
          "(worst)\n",
          worst(medians), worst(p95s), worst(material), worst(joints), quantile(clean, 0.5),
          quantile(clean95, 0.5), worst(clean), worst(clean95));
    }
    fmt::print("  {:62} {:9.1f}   s, longest {:.1f}\n", "time, mean", mean(seconds),
               *std::max_element(seconds.begin(), seconds.end()));
  }

 private:
  const BodyModel& model_;
  std::vector<VertexPart> parts_;
  std::vector<int> outer_;
};

// unit: metres in one unit of the file, where it is known.
Answer register_file(const RegistrationModel& model, const fs::path& file,
                     std::optional<double> unit) {
  Answer out;
  const auto before = Clock::now();
  try {
    CleanScanOptions options;
    options.unit = unit;
    options.name = file.filename().string();
    const Scan scan = clean_scan(read_mesh_file(file), options);
    const Registration found = register_scan(model, scan);
    const auto to_file = [&](const Vec3& world) -> Vec3 {
      return found.axes.transpose() * (world - found.shift) / found.scale;
    };
    out.rest = found.body.skin.V;
    out.posed.resize(found.posed.rows(), 3);
    for (Eigen::Index i = 0; i < found.posed.rows(); ++i)
      out.posed.row(i) = to_file(found.posed.row(i).transpose()).transpose();
    for (std::size_t j = 0; j < found.pose.joints.size(); ++j)
      out.joints.push_back({found.pose.joints[j], to_file(found.pose.posed[j])});
    out.doubtful = !found.report.doubts.empty();
    out.turns = found.report.turn_deviation;
    for (const std::string& doubt : found.report.doubts)
      out.reason += (out.reason.empty() ? "" : "; ") + doubt;
  } catch (const UnfitError& e) {
    out.refused = true;
    out.reason = e.what();
  }
  out.seconds = std::chrono::duration<double>(Clock::now() - before).count();
  return out;
}

std::vector<char> synthetic(
    const BodyModel& model, int count, unsigned seed, const fs::path& keep,
    const std::function<Answer(const SyntheticScan&, const fs::path&)>& registered) {
  const Judge the_judge(model);
  const SyntheticScans scans(model);
  the_judge.print_head();
  std::vector<Judge::Case> cases;
  const fs::path folder =
      keep.empty() ? fs::temp_directory_path() / fmt::format("ecorche-scans-{}", ::getpid()) : keep;
  fs::create_directories(folder);
  for (unsigned s = seed; s < seed + unsigned(count); ++s) {
    const SyntheticScan scan = scans.make(s);
    const fs::path file = folder / fmt::format("scan{:03}.{}", s, scan.format);
    write_scan(file, scan.mesh, scan.format);
    const Answer answer = registered(scan, file);
    cases.push_back(the_judge.measure(scan, answer));
    the_judge.print(s, scan, cases.back());
    if (keep.empty()) {
      fs::remove(file);
      continue;
    }
    const auto upright = [&](const Points& points) {
      Points out(points.rows(), 3);
      for (Eigen::Index i = 0; i < points.rows(); ++i)
        out.row(i) = scan.unit *
                     (scan.axes.transpose() * (points.row(i).transpose() - scan.shift)).transpose();
      return out;
    };
    const Triangles& F = the_judge.package().triangles;
    write_ply(folder / fmt::format("scan{:03}-upright.ply", s),
              {upright(scan.mesh.V), scan.mesh.F});
    write_ply(folder / fmt::format("scan{:03}-truth.ply", s), {upright(scan.truth), F});
    if (!answer.refused)
      write_ply(folder / fmt::format("scan{:03}-body.ply", s), {upright(answer.posed), F});
  }
  if (keep.empty()) fs::remove(folder);
  the_judge.summary(cases);
  std::vector<char> found;
  for (const Judge::Case& c : cases) found.push_back(c.found);
  return found;
}

// Truth, a little off or thoroughly wrong: every fourth has its legs swapped, every fifth faces
// backwards.
bool has_legs_swapped(unsigned number) { return number % 4 == 3; }
bool faces_backwards(unsigned number) { return number % 5 == 4; }
bool is_spoilt(unsigned number) { return has_legs_swapped(number) || faces_backwards(number); }

Answer spoilt_truth(const BodyPackage& package, const SyntheticScan& scan, unsigned number) {
  std::mt19937 random(number);
  std::normal_distribution<double> normal(0, 0.003);
  Answer out;
  out.posed = scan.truth;
  out.joints = scan.joints;
  for (Eigen::Index i = 0; i < out.posed.rows(); ++i)
    for (int c = 0; c < 3; ++c) out.posed(i, c) += normal(random) / scan.unit;
  if (has_legs_swapped(number)) {
    const std::vector<VertexPart> parts = vertex_parts(package);
    for (Eigen::Index i = 0; i < out.posed.rows(); ++i)
      if (const BodyPart part = parts[std::size_t(i)].part;
          part == BodyPart::shank || part == BodyPart::foot)
        out.posed.row(i) = scan.truth.row(package.mirror[std::size_t(i)]);
  }
  if (faces_backwards(number))
    for (Eigen::Index i = 0; i < out.posed.rows(); ++i)
      out.posed.row(i) = scan.truth.row(package.mirror[std::size_t(i)]);
  return out;
}

// A scan of the set: vertices, and where in it each sample lies.
struct SetScan {
  int person = 0, pose = 0;
  TriMesh mesh;
  double unit = 1;           // metres
  std::vector<int> samples;  // vertex of each
  Answer answer;
  Points mapped_bary;  // #samples x 3
  std::vector<int> mapped_triangle;
};

double enclosed(const TriMesh& mesh) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    sum += a.cross(b).dot(c) / 6;
  }
  return sum;
}

TriMesh read_off(const fs::path& file) {
  std::ifstream in(file);
  std::string word;
  Eigen::Index vertices = 0, faces = 0, edges = 0;
  in >> word >> vertices >> faces >> edges;
  if (!in || word != "OFF") throw InputError(file.string() + ": no OFF file");
  TriMesh out;
  out.V.resize(vertices, 3);
  out.F.resize(faces, 3);
  for (Eigen::Index i = 0; i < vertices; ++i) in >> out.V(i, 0) >> out.V(i, 1) >> out.V(i, 2);
  for (Eigen::Index f = 0, corners = 0; f < faces; ++f)
    in >> corners >> out.F(f, 0) >> out.F(f, 1) >> out.F(f, 2);
  if (!in) throw InputError(file.string() + ": ends too early");
  return out;
}

// Metres in a unit of the set: of one scan of a person, where it is known, else of the first; the
// person's other scans by their volume.
double known_unit(int person, int pose) {
  if (person == 0 && pose == 0) return 1.7753;
  if (person == 2 && pose == 5) return 1.6919;
  if (pose == 0 && person != 2) return person == 3 ? 1.78 : 1.65;
  return 0;
}

Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, w = p - a;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), wu = w.dot(u), wv = w.dot(v);
  const double d = uu * vv - uv * uv;
  if (d <= 0) return Vec3(1, 0, 0);
  const double s = (vv * wu - uv * wv) / d, t = (uu * wv - uv * wu) / d;
  return Vec3(1 - s - t, s, t);
}

void faust(const BodyModel& model, const fs::path& folder, const std::vector<int>& people,
           const std::vector<int>& poses, const fs::path& keep,
           const std::function<Answer(const fs::path&, double)>& registered) {
  const Judge the_judge(model);
  const Triangles& F = the_judge.package().triangles;
  if (!keep.empty()) fs::create_directories(keep);
  std::vector<SetScan> scans;
  fmt::print("{:>8} {:>15} {:>6} {:>6}  mm\n", "", "scan->body", "turns", "s");
  fmt::print("{:>8} {:>8} {:>6}\n", "scan", "median", "p95");
  std::vector<double> all, seconds;
  double worst_median = 0, worst_p95 = 0;
  int refused = 0, doubtful = 0;
  for (const int person : people) {
    double volume = 0;  // m^3
    for (int pose = 0; pose < 10; ++pose)
      if (const double unit = known_unit(person, pose))
        volume = std::pow(unit, 3) *
                 enclosed(read_off(folder / fmt::format("tr_reg_{:03}.off", 10 * person + pose)));
    for (const int pose : poses) {
      SetScan scan;
      scan.person = person;
      scan.pose = pose;
      const fs::path file = folder / fmt::format("tr_reg_{:03}.off", 10 * person + pose);
      scan.mesh = read_off(file);
      scan.unit = std::cbrt(volume / enclosed(scan.mesh));
      std::ifstream samples(folder / fmt::format("tr_reg_{:03}.vts", 10 * person + pose));
      for (int v = 0; samples >> v;) scan.samples.push_back(v - 1);
      scan.answer = registered(file, scan.unit);
      seconds.push_back(scan.answer.seconds);
      doubtful += scan.answer.doubtful;
      if (scan.answer.refused) {
        ++refused;
        fmt::print("{:>5}/{:<2} refused: {}\n", person, pose, scan.answer.reason);
        continue;
      }
      const TriMesh skin{scan.answer.posed, F};
      const std::vector<double> d = distances(scan.mesh.V, skin, scan.unit);
      all.insert(all.end(), d.begin(), d.end());
      worst_median = std::max(worst_median, quantile(d, 0.5));
      worst_p95 = std::max(worst_p95, quantile(d, 0.95));
      fmt::print("{:>5}/{:<2} {:8.2f} {:6.2f} {:6.2f} {:6.1f}  {}\n", person, pose,
                 1e3 * quantile(d, 0.5), 1e3 * quantile(d, 0.95), scan.answer.turns,
                 scan.answer.seconds, scan.answer.reason);
      std::fflush(stdout);
      if (!keep.empty()) {
        const auto name = [&](const char* what) {
          return keep / fmt::format("person{}-pose{}-{}.ply", person, pose, what);
        };
        write_ply(name("scan"), {Points(scan.unit * scan.mesh.V), scan.mesh.F});
        write_ply(name("body"), {Points(scan.unit * scan.answer.posed), F});
        write_ply(name("rest"), {scan.answer.rest, F});
      }
      const NearestSurface tree(skin);
      scan.mapped_bary.resize(Eigen::Index(scan.samples.size()), 3);
      for (std::size_t k = 0; k < scan.samples.size(); ++k) {
        const SurfacePoint hit = tree.nearest(scan.mesh.V.row(scan.samples[k]).transpose());
        const auto corner = [&](int c) -> Vec3 {
          return scan.answer.posed.row(F(hit.triangle, c)).transpose();
        };
        scan.mapped_triangle.push_back(hit.triangle);
        scan.mapped_bary.row(Eigen::Index(k)) =
            barycentric(hit.point, corner(0), corner(1), corner(2)).transpose();
      }
      scans.push_back(std::move(scan));
    }
  }
  // From each scan to each other by way of the skin.
  std::vector<double> within, between;
  using PartKey = std::pair<BodyPart, Side>;
  std::map<BodyPart, std::vector<double>> within_parts;
  std::map<const SetScan*, std::map<PartKey, std::vector<double>>> scan_parts;
  for (const SetScan& a : scans)
    for (const SetScan& b : scans) {
      if (&a == &b) continue;
      double sum = 0;
      for (std::size_t k = 0; k < a.samples.size(); ++k) {
        Vec3 p = Vec3::Zero();
        for (int c = 0; c < 3; ++c)
          p += a.mapped_bary(Eigen::Index(k), c) *
               b.answer.posed.row(F(a.mapped_triangle[k], c)).transpose();
        const double off = b.unit * (p - b.mesh.V.row(b.samples[k]).transpose()).norm();
        sum += off;
        if (a.person != b.person) continue;
        const VertexPart& part = the_judge.parts()[std::size_t(F(a.mapped_triangle[k], 0))];
        within_parts[part.part].push_back(1e3 * off);
        scan_parts[&a][{part.part, part.side}].push_back(1e3 * off);
      }
      (a.person == b.person ? within : between).push_back(1e3 * sum / double(a.samples.size()));
    }
  constexpr const char* kParts[] = {"head", "neck",  "trunk", "upper arm", "forearm",
                                    "hand", "thigh", "shank", "foot"};
  fmt::print("\n{:>8}  parts that come to other places than in the person's other poses, mm\n",
             "scan");
  for (const auto& scan : scans) {
    std::string line;
    for (const auto& [key, off] : scan_parts[&scan])
      if (mean(off) > 30)
        line += fmt::format("  {}{} {:.0f}",
                            key.second == Side::left    ? "left "
                            : key.second == Side::right ? "right "
                                                        : "",
                            kParts[int(key.first)], mean(off));
    fmt::print("{:>5}/{:<2}{}\n", scan.person, scan.pose, line);
  }
  // A sample's limb by the vote of all scans; a scan whose limb says otherwise has it swapped.
  int swapped = 0;
  const std::size_t samples = scans.empty() ? 0 : scans[0].samples.size();
  const auto limb_of = [&](const SetScan& scan, std::size_t k) {
    const VertexPart& part = the_judge.parts()[std::size_t(F(scan.mapped_triangle[k], 0))];
    for (int limb = 0; limb < 4; ++limb)
      if (of_limb(part, kLimbs[limb])) return limb;
    return 4;
  };
  std::vector<int> voted(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    std::array<int, 5> votes{};
    for (const SetScan& scan : scans) ++votes[std::size_t(limb_of(scan, k))];
    voted[k] = int(std::max_element(votes.begin(), votes.end()) - votes.begin());
  }
  for (const SetScan& scan : scans)
    for (int limb = 0; limb < 4; ++limb) {
      int all_of = 0, own = 0;
      for (std::size_t k = 0; k < samples; ++k)
        if (voted[k] == limb) ++all_of, own += limb_of(scan, k) == limb;
      if (own >= 0.7 * all_of) continue;
      ++swapped;
      fmt::print("  {}/{}: {} is elsewhere\n", scan.person, scan.pose, kLimbs[limb].name);
    }
  fmt::print("\n{} scans of {} people\n", scans.size() + std::size_t(refused), people.size());
  judge("refused", refused, 0, "");
  judge("scan to surface, median of all points", 1e3 * quantile(all, 0.5), 2, "mm");
  judge("scan to surface, p95 of all points", 1e3 * quantile(all, 0.95), 6, "mm");
  judge("scan to surface, median, worst scan", 1e3 * worst_median, 2, "mm");
  judge("scan to surface, p95, worst scan", 1e3 * worst_p95, 6, "mm");
  if (!within.empty()) {
    judge("correspondence between poses of a person, mean", mean(within), 15, "mm");
    fmt::print("  {:62} {:9.3f}   mm\n", "  worst pair",
               *std::max_element(within.begin(), within.end()));
  }
  for (const auto& [part, off] : within_parts)
    fmt::print("  {:62} {:9.3f}   mm, {:.1f} % of the points\n",
               fmt::format("  {}", kParts[int(part)]), mean(off),
               100 * double(off.size()) / double(within.size() * scans[0].samples.size()));
  if (!between.empty()) {
    judge("correspondence between people, mean", mean(between), 25, "mm");
    fmt::print("  {:62} {:9.3f}   mm\n", "  worst pair",
               *std::max_element(between.begin(), between.end()));
  }
  judge("limbs swapped or lost", swapped, 0, "");
  fmt::print("  {:62} {:9}\n  {:62} {:9.1f}   s\n", "called doubtful", doubtful, "time, mean",
             mean(seconds));
}

int run(const std::vector<std::string>& arguments) {
  const auto keep = option(arguments, "--keep");
  const fs::path folder = keep ? fs::path(*keep) : fs::path();
  const BodyModel model(test_assets());
  const unsigned seed = unsigned(std::stoi(option(arguments, "--seed").value_or("1")));
  if (const auto count = option(arguments, "--judge")) {
    const std::vector<char> found =
        synthetic(model, std::stoi(*count), seed, folder,
                  [&, number = 0u](const SyntheticScan& scan, const fs::path&) mutable {
                    return spoilt_truth(model.package(), scan, number++);
                  });
    int wrong = 0;
    for (std::size_t k = 0; k < found.size(); ++k)
      wrong += bool(found[k]) == is_spoilt(unsigned(k));
    fmt::print("{} judged wrongly\n", wrong);
    return wrong > 0;
  }
  const RegistrationModel registration = make_registration_model(test_assets());
  if (const auto count = option(arguments, "--synthetic")) {
    synthetic(model, std::stoi(*count), seed, folder,
              [&](const SyntheticScan&, const fs::path& file) {
                return register_file(registration, file, std::nullopt);
              });
    return failures > 0;
  }
  if (const auto scans = option(arguments, "--faust")) {
    if (!fs::exists(fs::path(*scans) / "tr_reg_000.off")) {
      fmt::print("skipped: no tr_reg_000.off in {}\n", *scans);
      return 77;
    }
    faust(
        model, *scans, numbers(option(arguments, "--people").value_or("0,1,2,3,4")),
        numbers(option(arguments, "--poses").value_or("0,1,2,3,4,5,6,7,8,9")), folder,
        [&](const fs::path& file, double unit) { return register_file(registration, file, unit); });
    return failures > 0;
  }
  fmt::print(stderr, "usage: registration_figures --synthetic N | --faust DIR | --judge N\n");
  return 2;
}

}  // namespace
}  // namespace ecorche

int main(int argc, char** argv) {
  try {
    return ecorche::run({argv + 1, argv + argc});
  } catch (const ecorche::InputError& e) {
    fmt::print("skipped: {}\n", e.what());
    return 77;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
}
