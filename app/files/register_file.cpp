#include "app/files/register_file.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "anatomy/base_mesh/skin_import.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/mesh_files/mesh_glb.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/mesh_files/scene_import.h"
#include "app/files/registration_hints.h"
#include "app/options/option_values.h"
#include "morph/registration/clean_scan.h"

namespace ecorche {
namespace {

// A mesh beyond so many vertices is moved by way of the base mesh alone.
constexpr Eigen::Index kMostOwn = 400000;

std::string upper_case(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
  return text;
}

RegistrationOptions hints_of(const RegisterFileOptions& options, const RegistrationModel& model) {
  RegistrationOptions out;
  if (options.stature > 0) out.stature = options.stature;
  if (!options.landmarks.empty())
    out.landmarks = read_scan_landmarks(options.landmarks, registration_landmarks(model));
  const std::string pose = upper_case(options.pose);
  if (pose == "A" || pose == "T")
    out.pose = pose == "A" ? "a" : "t";
  else if (pose.ends_with(".BVH"))
    out.joints = read_posed_joints(options.pose);
  else if (!pose.empty())
    throw UsageError(
        fmt::format("--pose {}: expected A, T, or a .bvh file whose first frame stands in the scan",
                    printable(options.pose)));
  out.watch = options.watch;
  return out;
}

// The file's meshes, and as a scene of which they can be given back.
struct OpenedFile {
  MeshFile meshes;
  std::string scene;  // .glb; empty for a cloud
};

OpenedFile open_meshes(const std::filesystem::path& file) {
  const std::string name = printable(file.string());
  std::string bytes = read_input_file(file);
  OpenedFile out;
  const bool foreign = scene_format(bytes).has_value();
  if (foreign) bytes = import_scene(bytes, name);
  if (bytes.starts_with("glTF")) {
    out.meshes = parse_mesh(bytes, name, {.clouds = true, .node_pose = true});
    out.scene = std::move(bytes);
    return out;
  }
  out.meshes = read_mesh_file(file, {.clouds = true});
  const auto faces = [](const MeshPart& part) { return part.mesh.F.rows() > 0; };
  const auto small = [](const MeshPart& part) { return part.mesh.V.rows() <= kMostOwn; };
  if (std::ranges::any_of(out.meshes.parts, faces) && std::ranges::all_of(out.meshes.parts, small))
    out.scene = mesh_glb(out.meshes);
  return out;
}

// What `make` gives; where it cannot, the message begins with the file.
template <class Make>
auto with_name(const std::string& name, const Make& make) {
  try {
    return make();
  } catch (const UnfitError& e) {
    const std::string text = e.what();
    throw UnfitError(text.starts_with(name) ? text : name + ": " + text);
  }
}

}  // namespace

RegisteredFile register_file(const std::filesystem::path& file, const RegistrationModel& model,
                             const RegisterFileOptions& options, const Common& common,
                             Report& report) {
  RegisteredFile out;
  const std::string name = printable(file.string());
  RegistrationOptions how = hints_of(options, model);
  {
    const StageTimer timer(report, "clean");
    OpenedFile opened = open_meshes(file);
    CleanScanOptions clean;
    if (!options.unit.empty()) clean.unit = metres_in(options.unit);
    if (options.stature > 0) clean.stature = options.stature;
    clean.name = name;
    if (!opened.scene.empty()) {
      Stranger stranger = make_stranger(std::move(opened.scene), name);
      if (how.joints.empty()) how.joints = stranger.joints;
      out.stranger = std::make_shared<const Stranger>(std::move(stranger));
    }
    out.scan = with_name(name, [&] { return clean_scan(opened.meshes, clean); });
  }
  for (const std::string& text : out.scan.notes) {
    note(common, text);
    report.append_text("scan.notes", text);
  }
  {
    const StageTimer timer(report, "register");
    out.registration = with_name(name, [&] { return register_scan(model, out.scan, how); });
  }
  out.registration.body.name = printable(file.stem().string());
  return out;
}

bool is_base_skin(const std::filesystem::path& file, const BodyPackage& package) {
  const std::string bytes = read_input_file(file);
  if (scene_format(bytes)) return false;
  return has_base_skin(read_mesh_file(file, {.clouds = true}), package);
}

void add_registration_options(CLI::App& verb, RegisterFileOptions& options) {
  verb.add_option("--landmarks", options.landmarks,
                  "Known points of the skin (.json): {\"acromion_l\": [x, y, z], ...}, in the "
                  "scan's coordinates; any of data/body/landmarks.csv with _l or _r");
  verb.add_option("--pose", options.pose,
                  "How the scan stands: A, T, or a .bvh file whose first frame stands in it, in "
                  "its coordinates; found out when left out");
  add_length(verb, "--stature", options.stature, {0.5, 2.6}, {1.2, 2.3},
             "The person's, where it is known: 1.68, 168cm, 5ft6. It sets the size of a scan whose "
             "unit is not known");
}

}  // namespace ecorche
