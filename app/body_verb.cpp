// ecorche body new: a body of a wanted sex, age, height and mass.
#include <fmt/format.h>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/package.h"
#include "app/verb.h"
#include "morph/body.h"
#include "skinning/character_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string sex;
  double age = 25, height = 0, mass = 0, muscle = -1;
  fs::path output;
};

int run_new(const NewOptions& options, const Common& common, Report& report) {
  if (options.output.extension() != ".glb") throw UsageError(options.output.string() + ": a body is written as .glb");
  check_output(options.output);
  BodySpec spec;
  spec.sex = options.sex == "female" ? Sex::female : Sex::male;
  spec.age = options.age;
  if (options.height > 0) spec.height = options.height;
  if (options.mass > 0) spec.mass = options.mass;
  if (options.muscle >= 0) spec.muscle = options.muscle;
  spec.name = options.output.stem().string();

  const BodyPackage package = read_body_package(find_packages());
  const StageTimer timer(report, "body");
  const ShapedBody shaped = shape_body(package, spec);
  write_body(options.output, shaped.body);
  report.set("body.stature", shaped.stature);
  report.set("body.mass", shaped.mass);
  report.set("body.volume", shaped.volume);
  report.set("skin_vertices", static_cast<int>(shaped.body.skin.V.rows()));
  note(common, fmt::format("{}: {}, {:.0f} years, {:.3f} m, {:.1f} kg", options.output.string(), options.sex, spec.age, shaped.stature, shaped.mass));
  return 0;
}

}  // namespace

void add_body_verb(VerbRegistry& registry) {
  CLI::App* body = registry.app.add_subcommand("body", "Bodies: skins with a known topology");
  body->require_subcommand(1);
  auto options = std::make_shared<NewOptions>();
  CLI::App* verb = add_verb(registry, *body, "new", "Make a body of a wanted sex, age, height and mass",
                            "ecorche body new --sex female --age 30 --height 1.68 --mass 60 -o anna.glb",
                            [options](const Common& common, Report& report) { return run_new(*options, common, report); });
  verb->add_option("--sex", options->sex, "male or female")->required()->check(CLI::IsMember({"male", "female"}));
  verb->add_option("--age", options->age, "Years")->check(CLI::Range(1.0, 90.0))->capture_default_str();
  verb->add_option("--height", options->height, "Stature in metres; the average when left out")->check(CLI::Range(0.5, 2.6));
  verb->add_option("--mass", options->mass, "Kilograms; follows from an average build when left out")->check(CLI::Range(2.0, 400.0));
  verb->add_option("--muscle", options->muscle, "Muscularity from 0 to 1; follows from the mass when left out")->check(CLI::Range(0.0, 1.0));
  verb->add_option("-o,--output", options->output, "Body file to write (.glb)")->required();
}

}  // namespace ecorche
