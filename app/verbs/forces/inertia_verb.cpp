#include "app/verbs/forces/inertia_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <nlohmann/json.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/csv_table.h"
#include "app/files/body_inertia.h"
#include "app/files/open_character.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct InertiaOptions {
  fs::path character;
  std::vector<fs::path> outputs;
};

// Shares of the mass as de Leva (1996) has them; head and neck are one segment there.
std::vector<double> published_shares(const Assets& assets, Sex sex, const SegmentInertia& found) {
  const Table table(assets.tables / "segments.csv");
  const std::string column = sex == Sex::female ? "mass_female" : "mass_male";
  std::vector<double> out;
  for (const BodySegment& segment : found.segments) {
    out.push_back(std::nan(""));
    for (int row = 0; row < table.rows(); ++row) {
      const std::string name = table.text(row, "segment");
      if (segment.name == name || segment.name == name + "_l" || segment.name == name + "_r")
        out.back() = table.number(row, column);
    }
  }
  return out;
}

// Radii of gyration about the joint's axes, m.
Vec3 gyration(const BodySegment& segment) {
  return (segment.inertia.diagonal() / segment.mass).cwiseSqrt();
}

void print_table(const SegmentInertia& found, const std::vector<double>& published,
                 const Skeleton& skeleton) {
  fmt::print("{:14}{:>9}{:>8}{:>9}{:>8}   {:>24}   {:>20}  {}\n", "segment", "kg", "%", "de Leva",
             "litre", "centre x y z, mm", "gyration, mm", "joint");
  for (std::size_t k = 0; k < found.segments.size(); ++k) {
    const BodySegment& s = found.segments[k];
    const Vec3 c = 1e3 * s.center, g = 1e3 * gyration(s);
    // the head's figure is that of head and neck
    const std::string theirs =
        std::isnan(published[k]) ? "" : fmt::format("{:.2f}", 100 * published[k]);
    fmt::print(
        "{:14}{:9.3f}{:8.2f}{:>9}{:8.3f}   {:8.1f}{:8.1f}{:8.1f}   {:6.1f}{:7.1f}{:7.1f}  {}\n",
        s.name, s.mass, 100 * s.mass / found.mass, theirs, 1e3 * found.volumes[k], c.x(), c.y(),
        c.z(), g.x(), g.y(), g.z(), skeleton.joints[s.joint].name);
  }
  fmt::print(
      "{:14}{:9.3f}   tissues {:.2f} kg: bone {:.1f}, muscle {:.1f}, fat {:.1f}, lungs {:.1f}, "
      "organs and the rest {:.1f}\n",
      "body", found.mass, found.tissue_mass, found.bone_mass, found.muscle_mass, found.fat_mass,
      found.lung_mass,
      found.tissue_mass - found.bone_mass - found.muscle_mass - found.fat_mass - found.lung_mass);
}

std::string to_csv(const SegmentInertia& found, const Skeleton& skeleton) {
  std::string out =
      "segment,joint,mass_kg,volume_l,center_x_m,center_y_m,center_z_m,ixx_kgm2,iyy_kgm2,izz_kgm2,"
      "ixy_kgm2,ixz_kgm2,iyz_kgm2\n";
  for (std::size_t k = 0; k < found.segments.size(); ++k) {
    const BodySegment& s = found.segments[k];
    const Mat3& I = s.inertia;
    out += fmt::format(
        "{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n",
        s.name, skeleton.joints[s.joint].name, s.mass, 1e3 * found.volumes[k], s.center.x(),
        s.center.y(), s.center.z(), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  }
  return out;
}

std::string to_json(const SegmentInertia& found, const Skeleton& skeleton) {
  nlohmann::ordered_json out;
  out["mass"] = found.mass;
  out["tissues"] = {{"mass", found.tissue_mass},
                    {"bone", found.bone_mass},
                    {"muscle", found.muscle_mass},
                    {"fat", found.fat_mass},
                    {"lungs", found.lung_mass}};
  for (std::size_t k = 0; k < found.segments.size(); ++k) {
    const BodySegment& s = found.segments[k];
    nlohmann::ordered_json one;
    one["name"] = s.name;
    one["joint"] = skeleton.joints[s.joint].name;
    one["mass"] = s.mass;
    one["volume"] = found.volumes[k];
    one["center"] = {s.center.x(), s.center.y(), s.center.z()};
    for (int row = 0; row < 3; ++row)
      one["inertia"].push_back({s.inertia(row, 0), s.inertia(row, 1), s.inertia(row, 2)});
    out["segments"].push_back(std::move(one));
  }
  return out.dump(2) + "\n";
}

int run_inertia(const InertiaOptions& options, const Common& common, Report& report) {
  for (const fs::path& output : options.outputs) require_ending(output, {".csv", ".json"});
  check_outputs(common, options.outputs, {options.character});
  const Character character = open_character(options.character, common, report);
  const Skeleton& skeleton = character.anatomy.skeleton;
  const SegmentInertia found = weigh_character(common.assets, character, report);
  for (const BodySegment& segment : found.segments)
    report.set("inertia.mass_share." + segment.name, segment.mass / found.mass);
  for (const fs::path& output : options.outputs) {
    write_file_atomically(
        output, output.extension() == ".csv" ? to_csv(found, skeleton) : to_json(found, skeleton));
    note(common, fmt::format("{}: {} segments, {:.1f} kg", output.string(), found.segments.size(),
                             found.mass));
  }
  if (!common.quiet)
    print_table(found, published_shares(common.assets, character.body.sex, found), skeleton);
  return 0;
}

}  // namespace

void add_inertia_verb(VerbRegistry& registry) {
  auto options = std::make_shared<InertiaOptions>();
  CLI::App* verb =
      add_verb(registry, registry.app, "inertia",
               "Mass, centre of mass and inertia of a character's segments, from its tissues",
               "ecorche inertia anna-anatomy.glb -o anna-inertia.csv",
               [options](const Common& common, Report& report) {
                 return run_inertia(*options, common, report);
               });
  verb->add_option("character", options->character,
                   "Character written by `ecorche fit`, or CROWD.glb#NAME")
      ->required();
  verb->add_option("-o,--output", options->outputs,
                   "Table to write; may be given several times: .csv, .json")
      ->allow_extra_args(false);
}

}  // namespace ecorche
