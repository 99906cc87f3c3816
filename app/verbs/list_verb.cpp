#include "app/verbs/list_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "anatomy/errors.h"
#include "app/files/open_character.h"
#include "app/options/option_values.h"
#include "morph/measures/tape_measure.h"
#include "morph/shapes/sizes.h"
#include "morph/template/template.h"
#include "morph/template/template_cache.h"
#include "skinning/motion/limit_poses.h"
#include "skinning/motion/pose_book.h"
#include "skinning/motion_files/read_motion.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct ListOptions {
  std::string what;
  fs::path character;
  bool names = false, json = false;
};

// Rows of text; the first column is the name. As text, only the first `shown` columns.
struct Listing {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::size_t shown = 9;
};

const char* word(Sex sex) { return sex == Sex::female ? "female" : "male"; }

// "-5 .. 140" for each of the three axes that turns at all.
std::string ranges_of(const Joint& joint) {
  constexpr const char* kAxes[] = {"flexion", "abduction", "rotation"};
  constexpr double kStill = 1;  // degrees
  std::string out;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = kDegreesPerRadian * joint.min[axis],
                 high = kDegreesPerRadian * joint.max[axis];
    if (high - low > kStill)
      out += fmt::format("{}{} {:.0f} .. {:.0f}", out.empty() ? "" : ", ", kAxes[axis], low, high);
  }
  return out;
}

Listing list_muscles(const Assets&, const Anatomy& anatomy) {
  Listing out{{"muscle", "label", "group", "layer", "strips", "origin", "insertion"}, {}, 5};
  for (const Muscle& m : anatomy.muscles)
    out.rows.push_back({m.name, m.label, m.group, m.layer, std::to_string(m.strips.size()),
                        m.origin, m.insertion});
  return out;
}

Listing list_joints(const Assets&, const Anatomy& anatomy) {
  Listing out{{"joint", "parent", "degrees"}, {}};
  for (const Joint& joint : anatomy.skeleton.joints)
    out.rows.push_back({joint.name,
                        joint.parent < 0 ? "" : anatomy.skeleton.joints[joint.parent].name,
                        ranges_of(joint)});
  return out;
}

Listing list_bones(const Assets&, const Anatomy& anatomy) {
  Listing out{{"bone", "joint"}, {}};
  for (const Bone& bone : anatomy.bones)
    out.rows.push_back({bone.name, anatomy.skeleton.joints[bone.joint].name});
  return out;
}

Listing list_measures(const Assets& assets) {
  const BodyPackage package = read_body_package(assets);
  Listing out{{"measure", "name", "standard", "remark"}, {}};
  const MeasureTable table = read_measure_table(package, package.tables / "body");
  for (const Measure& m : table.measures) out.rows.push_back({m.id, m.name, m.standard, m.note});
  for (const MeasureName& other : table.other_names)
    out.rows.push_back({other.name, "the same as " + table.measures[other.measure].id, "", ""});
  return out;
}

Listing list_landmarks(const Assets& assets) {
  const BodyPackage package = read_body_package(assets);
  Listing out{{"landmark", "where"}, {}};
  for (const SkinLandmark& each : read_measure_table(package, package.tables / "body").landmarks)
    out.rows.push_back({each.id, each.rule});
  return out;
}

Listing list_sizes(const Assets& assets) {
  const auto range = [](const std::array<double, 2>& r) {
    return fmt::format("{:.0f} .. {:.0f}", 100 * r[0], 100 * r[1]);
  };
  Listing out{{"size", "sex", "stature cm", "chest or bust", "waist", "hip"}, {}};
  for (const StandardSize& size : read_sizes(assets.tables / "body"))
    out.rows.push_back({size.name, word(size.sex), fmt::format("{:.0f}", 100 * size.stature),
                        range(size.chest), range(size.waist), range(size.hip)});
  return out;
}

Listing list_poses(const Assets& assets, const Anatomy& anatomy) {
  Listing out{{"pose", "what", "of"}, {}};
  for (const NamedPose& pose :
       read_pose_book(assets.tables / "poses" / "poses.csv", anatomy.skeleton))
    out.rows.push_back({pose.name, pose.label, "posebook"});
  for (const LimitPose& pose : standard_limit_poses(assets.tables, anatomy.skeleton))
    out.rows.push_back({pose.name, "joints at their limits", "check"});
  return out;
}

Listing list_motions(const Assets& assets) {
  Listing out{{"motion", "file", "frames", "fps", "seconds"}, {}};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(assets.tables / "motions"))
    if (entry.path().extension() == ".bvh") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const MotionClip motion = read_motion(file);
    out.rows.push_back({file.stem().string(), file.string(), std::to_string(motion.frame_count),
                        fmt::format("{:.4g}", motion.fps),
                        fmt::format("{:.1f}", motion.frame_count / motion.fps)});
  }
  return out;
}

const std::map<std::string, std::function<Listing(const Assets&, const Anatomy&)>>&
anatomy_lists() {
  static const std::map<std::string, std::function<Listing(const Assets&, const Anatomy&)>> all{
      {"muscles", list_muscles},
      {"joints", list_joints},
      {"bones", list_bones},
      {"poses", list_poses}};
  return all;
}

const std::map<std::string, std::function<Listing(const Assets&)>>& table_lists() {
  static const std::map<std::string, std::function<Listing(const Assets&)>> all{
      {"measures", list_measures},
      {"landmarks", list_landmarks},
      {"sizes", list_sizes},
      {"motions", list_motions}};
  return all;
}

void print(const Listing& list, const ListOptions& options) {
  if (options.json) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const auto& row : list.rows) {
      nlohmann::ordered_json each;
      for (std::size_t c = 0; c < row.size(); ++c) each[list.columns[c]] = row[c];
      out.push_back(std::move(each));
    }
    fmt::print("{}\n", out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return;
  }
  std::vector<std::size_t> width(list.columns.size());
  const auto line = [&](const std::vector<std::string>& cells, bool measure) {
    std::string out;
    const std::size_t count = std::min(cells.size(), list.shown);
    for (std::size_t c = 0; c < count; ++c) {
      if (measure)
        width[c] = std::max(width[c], cells[c].size());
      else
        out += c + 1 == count ? cells[c] : fmt::format("{:<{}}", cells[c], width[c] + 2);
    }
    while (!out.empty() && out.back() == ' ') out.pop_back();
    return out;
  };
  if (options.names) {
    for (const auto& row : list.rows) fmt::print("{}\n", row[0]);
    return;
  }
  line(list.columns, true);
  for (const auto& row : list.rows) line(row, true);
  fmt::print("{}\n", line(list.columns, false));
  for (const auto& row : list.rows) fmt::print("{}\n", line(row, false));
}

int run_list(const ListOptions& options, const Common& common, Report& report) {
  const auto table = table_lists().find(options.what);
  if (table != table_lists().end()) {
    if (!options.character.empty())
      throw UsageError(fmt::format("list {}: these are the same for every character; leave {} out",
                                   options.what, options.character.string()));
    print(table->second(common.assets), options);
    return 0;
  }
  const Anatomy anatomy = options.character.empty()
                              ? read_template(common.assets).anatomy
                              : open_character(options.character, common, report).anatomy;
  print(anatomy_lists().at(options.what)(common.assets, anatomy), options);
  return 0;
}

}  // namespace

void add_list_verb(VerbRegistry& registry) {
  auto options = std::make_shared<ListOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "list",
      "Name the muscles, joints, bones, measures, skin landmarks, sizes, poses or motions that "
      "there are",
      "ecorche list muscles\n  ecorche list joints anna-anatomy.glb --names",
      [options](const Common& common, Report& report) {
        return run_list(*options, common, report);
      });
  std::vector<std::string> whats;
  for (const auto& [name, list] : anatomy_lists()) whats.push_back(name);
  for (const auto& [name, list] : table_lists()) whats.push_back(name);
  std::sort(whats.begin(), whats.end());
  verb->add_option("what", options->what, "What to name")->required()->check(one_of(whats));
  verb->add_option("character", options->character,
                   "Of this character (muscles, joints, bones, poses); the template when left out");
  CLI::Option* names = verb->add_flag("--names", options->names, "The names alone, one a line");
  verb->add_flag("--json", options->json, "As JSON")->excludes(names);
}

}  // namespace ecorche
