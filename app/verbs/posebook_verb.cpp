#include "app/verbs/posebook_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <system_error>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/geometry/self_intersections.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/options/picture_size.h"
#include "app/pages/pose_sheet.h"
#include "app/progress.h"
#include "skinning/evaluation/pose_figures.h"
#include "skinning/motion/pose_table.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct PoseBookOptions {
  std::vector<fs::path> characters;
  fs::path folder, poses;  // without poses: our own
  std::string methods = "lbs,dqs,deltamush,paper,ecorche";
  std::string cell = "230x270";
  bool pictures = true;
};

// One method's figures. Volumes as relative changes, the larger one of both sides.
struct MethodFigures {
  SkinMethod method = SkinMethod::ecorche;
  std::vector<double> volumes;          // a volume pose of each character in turn
  std::vector<PoseFigures> poses;       // a pose of the book of each character in turn
  std::vector<int> self_intersections;  // likewise
};

std::vector<SkinMethod> read_methods(const std::string& text) {
  std::vector<SkinMethod> out;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) {
    const std::optional<SkinMethod> method = skin_method(name);
    if (!method)
      throw UsageError(
          fmt::format("--methods: '{}' is no way to move a skin; there are lbs, dqs, deltamush, "
                      "paper, anchors and ecorche",
                      name));
    out.push_back(*method);
  }
  return out;
}

double largest(double a, double b) { return std::abs(a) > std::abs(b) ? a : b; }

void add_figures(const Actor& actor, const std::vector<VolumePose>& volumes,
                 const std::vector<NamedPose>& book, const Common& common, MethodFigures& out) {
  const TriMesh& rest = actor.character.body.skin;
  const std::vector<LimbSection> limbs =
      whole_limbs(actor.character.anatomy.skeleton, rest, actor.binding);
  ActorState frame(actor);
  for (const VolumePose& each : volumes) {
    evaluate_skin(actor, each.pose, {}, frame);
    double change =
        each.sections.empty()
            ? measure_pose(rest, *actor.skin.blend, frame.posed.X_WJ, frame.skin).body_volume_change
            : 0;
    for (const LimbSection& limb : limbs)
      if (std::find(each.sections.begin(), each.sections.end(), limb.name) != each.sections.end())
        change = largest(change, section_change(limb, rest, frame.skin));
    out.volumes.push_back(change);
  }
  Points V;
  Progress progress(common, std::string(long_name(actor.method)), int(book.size()));
  for (std::size_t i = 0; i < book.size(); ++i) {
    evaluate_skin(actor, book[i].pose, {}, frame);
    out.poses.push_back(measure_pose(rest, *actor.skin.blend, frame.posed.X_WJ, frame.skin));
    to_points(frame.skin, V);
    out.self_intersections.push_back(count_self_intersections(rest.F, V));
    progress.step();
  }
}

// Of the absolute values.
double median_size(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

template <class Take>
double median(const MethodFigures& figures, const Take& take) {
  std::vector<double> values;
  for (std::size_t i = 0; i < figures.poses.size(); ++i) values.push_back(take(i));
  return median_size(std::move(values));
}

template <class Take>
double worst(const MethodFigures& figures, const Take& take) {
  double out = 0;
  for (std::size_t i = 0; i < figures.poses.size(); ++i) out = largest(out, take(i));
  return out;
}

struct Row {
  std::string name, label;
  double unit = 1;              // the figure is shown in parts of it
  std::vector<double> values;   // a method
  std::optional<double> asked;  // at most
};

// Targets of our own method: volumes within 1 % in every pose, a quarter of the intersecting
// triangles that the better one of linear blend and delta mush has, two thirds of linear blend's
// change of edge lengths, and no flipped triangle outside contact folds.
void set_asked(const std::vector<MethodFigures>& all, std::vector<Row>& rows) {
  for (Row& row : rows) {
    const auto of = [&](SkinMethod method) {
      const auto it = std::find_if(
          all.begin(), all.end(), [&](const MethodFigures& each) { return each.method == method; });
      return it == all.end() ? std::optional<double>() : row.values[it - all.begin()];
    };
    const std::optional<double> linear = of(SkinMethod::linear_blend),
                                mush = of(SkinMethod::delta_mush);
    if (row.name == "body_volume_change_worst") row.asked = 0.01;
    if (row.name == "flipped_outside_worst") row.asked = 0;
    if (row.name == "edge_change_p99_median" && linear) row.asked = *linear * 2 / 3;
    if (row.name == "self_intersections_median" && linear && mush)
      row.asked = std::min(*linear, *mush) / 4;
  }
}

std::vector<Row> rows_of(const std::vector<VolumePose>& volumes,
                         const std::vector<MethodFigures>& all) {
  std::vector<Row> rows;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    rows.push_back({"volume." + volumes[v].name,
                    "|change|: " + volumes[v].label + ", %",
                    0.01,
                    {},
                    volumes[v].asked});
    for (const MethodFigures& each : all) {
      std::vector<double> of_all;
      for (std::size_t k = v; k < each.volumes.size(); k += volumes.size())
        of_all.push_back(each.volumes[k]);
      rows.back().values.push_back(median_size(std::move(of_all)));
    }
  }
  const auto add = [&](const std::string& name, const std::string& label, double unit,
                       const auto& take) {
    Row middle{name + "_median", label + ", median", unit, {}, {}},
        most{name + "_worst", label + ", worst pose", unit, {}, {}};
    for (const MethodFigures& each : all) {
      const auto value = [&](std::size_t i) { return take(each, i); };
      middle.values.push_back(median(each, value));
      most.values.push_back(worst(each, value));
    }
    rows.push_back(std::move(middle));
    rows.push_back(std::move(most));
  };
  add("body_volume_change", "|change of the body's volume|, %", 0.01,
      [](const MethodFigures& m, std::size_t i) {
        return std::abs(m.poses[i].body_volume_change);
      });
  add("self_intersections", "triangles that pass through others", 1,
      [](const MethodFigures& m, std::size_t i) { return double(m.self_intersections[i]); });
  add("flipped", "flipped triangles", 1,
      [](const MethodFigures& m, std::size_t i) { return double(m.poses[i].flipped); });
  add("flipped_outside", "of them outside contact folds", 1,
      [](const MethodFigures& m, std::size_t i) { return double(m.poses[i].flipped_outside); });
  add("edge_change_p99", "|change of edge length|, 99th percentile, %", 0.01,
      [](const MethodFigures& m, std::size_t i) { return m.poses[i].edge_change_p99; });
  set_asked(all, rows);
  return rows;
}

void print_rows(const std::vector<Row>& rows, const std::vector<MethodFigures>& all) {
  fmt::print("{:<58}", "");
  for (const MethodFigures& each : all) fmt::print(" {:>10}", short_name(each.method));
  fmt::print(" {:>10}\n", "asked");
  for (const Row& row : rows) {
    fmt::print("{:<58}", row.label);
    for (const double value : row.values) fmt::print(" {:>10.2f}", value / row.unit);
    fmt::print(" {:>10}\n", row.asked ? fmt::format("{:.2f}", *row.asked / row.unit) : "");
  }
}

void write_table(const fs::path& file, const std::vector<std::string>& names,
                 const std::vector<NamedPose>& book, const std::vector<MethodFigures>& all) {
  std::string out =
      "character,pose,method,self_intersections,flipped,flipped_outside,edge_change_p99,body_"
      "volume_change\n";
  for (std::size_t i = 0; i < names.size() * book.size(); ++i)
    for (const MethodFigures& each : all)
      out += fmt::format("{},{},{},{},{},{},{:.5f},{:.5f}\n", names[i / book.size()],
                         book[i % book.size()].name, short_name(each.method),
                         each.self_intersections[i], each.poses[i].flipped,
                         each.poses[i].flipped_outside, each.poses[i].edge_change_p99,
                         each.poses[i].body_volume_change);
  write_file_atomically(file, out);
}

PoseSheetOptions read_cell(const std::string& text) {
  constexpr int kSmallest = 64, kLargest = 2048;
  PoseSheetOptions sheet;
  if (!read_picture_size(text, sheet.cell_width, sheet.cell_height) ||
      std::min(sheet.cell_width, sheet.cell_height) < kSmallest ||
      std::max(sheet.cell_width, sheet.cell_height) > kLargest)
    throw UsageError(fmt::format(
        "--cell: '{}' is no size; write WIDTHxHEIGHT, {} to {} pixels each, for example 460x540",
        text, kSmallest, kLargest));
  return sheet;
}

void write_sheets(const PoseBookOptions& options, PoseSheetOptions sheet, Actor& actor,
                  const std::vector<SkinMethod>& methods, const std::vector<NamedPose>& book,
                  const Common& common) {
  Renderer renderer;
  SceneOptions scene;
  scene.eyes =
      find_eyes(common.assets, actor.character.body.skin, actor.character.anatomy.skeleton);
  const SceneModel model =
      make_scene_model(actor.character.anatomy, actor.character.body.skin, scene);
  for (const SkinMethod method : methods) {
    choose_skin(common.assets, actor, std::string(short_name(method)));
    const fs::path file = options.folder / fmt::format("{}.png", short_name(method));
    sheet.skin = true;
    write_png(file,
              sheet_of_poses(renderer, actor, model, book, std::string(long_name(method)), sheet));
    note(common, file.string());
    if (method != SkinMethod::ecorche) continue;
    const fs::path under = options.folder / "muscles.png";
    sheet.skin = false;
    write_png(under, sheet_of_poses(renderer, actor, model, book, "muscles and bones", sheet));
    note(common, under.string());
  }
}

// Missed targets of our own method, as text.
std::vector<std::string> missed_targets(const std::vector<Row>& rows,
                                        const std::vector<MethodFigures>& all) {
  std::vector<std::string> out;
  for (std::size_t m = 0; m < all.size(); ++m)
    for (const Row& row : rows)
      if (all[m].method == SkinMethod::ecorche && row.asked && row.values[m] > *row.asked)
        out.push_back(fmt::format("{}: {:.2f}; at most {:.2f} was asked", row.label,
                                  row.values[m] / row.unit, *row.asked / row.unit));
  return out;
}

int run_posebook(const PoseBookOptions& options, const Common& common, Report& report) {
  if (!options.pictures && options.cell != PoseBookOptions{}.cell)
    throw UsageError("--cell: there are no sheets with --no-pictures; leave one of them out");
  const std::vector<SkinMethod> methods = read_methods(options.methods);
  const PoseSheetOptions sheet = read_cell(options.cell);
  check_outputs(common, {}, options.characters);
  make_output_folder(options.folder);
  std::vector<MethodFigures> all(methods.size());
  std::vector<std::string> names;
  std::vector<VolumePose> volumes;
  std::vector<NamedPose> book;
  int at_rest = 0;
  for (const fs::path& file : options.characters) {
    Character character = open_character(file, common, report);
    book = read_pose_table(
        options.poses.empty() ? common.assets.tables / "poses" / "poses.csv" : options.poses,
        character.anatomy.skeleton);
    Actor actor = make_actor(common.assets, std::move(character), report);
    const Skeleton& skeleton = actor.character.anatomy.skeleton;
    volumes = volume_poses(skeleton);
    names.push_back(file.stem().string());
    at_rest = std::max(at_rest, count_self_intersections(actor.character.body.skin.F,
                                                         actor.character.body.skin.V));
    {
      const StageTimer timer(report, "figures");
      for (std::size_t m = 0; m < methods.size(); ++m) {
        choose_skin(common.assets, actor, std::string(short_name(methods[m])));
        all[m].method = methods[m];
        add_figures(actor, volumes, book, common, all[m]);
      }
    }
    if (options.pictures && names.size() == 1)
      write_sheets(options, sheet, actor, methods, book, common);
  }
  write_table(options.folder / "figures.csv", names, book, all);
  const std::vector<Row> rows = rows_of(volumes, all);
  report.set("posebook.characters", int(names.size()));
  report.set("posebook.poses", int(book.size()));
  report.set("posebook.self_intersections_at_rest", at_rest);
  for (const Row& row : rows)
    for (std::size_t m = 0; m < all.size(); ++m)
      report.set(fmt::format("posebook.{}.{}", short_name(all[m].method), row.name), row.values[m]);
  print_rows(rows, all);
  note(common,
       fmt::format("{} poses of {} characters; at most {} triangles pass through others at rest; "
                   "every pose is in {}",
                   book.size(), names.size(), at_rest, (options.folder / "figures.csv").string()));
  const std::vector<std::string> missed = missed_targets(rows, all);
  for (const std::string& target : missed) {
    note(common, "missed: " + target);
    report.append_text("missed", target);
  }
  return missed.empty() ? 0 : 8;
}

}  // namespace

void add_posebook_verb(VerbRegistry& registry) {
  auto options = std::make_shared<PoseBookOptions>();
  CLI::App* verb =
      add_verb(registry, registry.app, "posebook",
               "Hard poses by every way to move a skin: a sheet each, and a table of figures",
               "ecorche posebook anna-anatomy.glb ben-anatomy.glb -o poses",
               [options](const Common& common, Report& report) {
                 return run_posebook(*options, common, report);
               });
  verb->add_option(
          "characters", options->characters,
          "Characters written by `ecorche fit`; the sheets show the first, the figures are of all")
      ->required();
  verb->add_option("-o,--output", options->folder,
                   "Folder for METHOD.png, muscles.png and figures.csv")
      ->required();
  verb->add_option("--poses", options->poses,
                   "Table of poses (docs/posebook.md) instead of our own");
  verb->add_option("--methods", options->methods, "Which ways to move a skin")
      ->capture_default_str();
  verb->add_option("--cell", options->cell,
                   "Size of one pose on the sheets, WIDTHxHEIGHT in pixels")
      ->capture_default_str();
  verb->add_flag("!--no-pictures", options->pictures, "Figures only");
}

}  // namespace ecorche
