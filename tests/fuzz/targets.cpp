#include "tests/fuzz/targets.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/character.h"
#include "anatomy/contact/muscle_model.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/mesh_files/scene_import.h"
#include "anatomy/mesh_files/stl_io.h"
#include "anatomy/model_files/mjcf_reader.h"
#include "anatomy/model_files/model_xml.h"
#include "anatomy/model_files/musculoskeletal_model.h"
#include "anatomy/model_files/osim_reader.h"
#include "skinning/bind/bind.h"
#include "skinning/bind/painted_weights.h"
#include "skinning/character/evaluate.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/files/character_read.h"
#include "skinning/motion/activation_read.h"
#include "skinning/motion/pose_book.h"
#include "skinning/motion_files/acclaim_read.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/c3d_read.h"
#include "skinning/motion_files/deepmimic_read.h"
#include "skinning/motion_files/opensim_read.h"
#include "skinning/motion_files/trc_read.h"
#include "skinning/retarget/joint_map_file.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/plain_skeleton.h"

namespace ecorche::test {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

void check(const TriMesh& mesh) {
  require(mesh.V.allFinite(), "a vertex that is not finite was let through");
  require(mesh.F.size() == 0 || (mesh.F.minCoeff() >= 0 && mesh.F.maxCoeff() < mesh.V.rows()),
          "a triangle out of range was let through");
}

void check(const MotionClip& clip) {
  require(clip.rotations.size() == std::size_t(clip.frame_count) * clip.rotation_tracks &&
              clip.translations.size() == std::size_t(clip.frame_count) * clip.translation_tracks,
          "samples are missing");
  for (const Mat3& turn : clip.rotations)
    require(turn.allFinite() && turn.isUnitary(1e-3), "a turn that is none was let through");
  for (const Vec3& way : clip.translations)
    require(way.allFinite(), "a place that is not finite was let through");
  for (std::size_t j = 0; j < clip.joints.size(); ++j)
    require(clip.joints[j].parent < int(j) && is_utf8(clip.joints[j].name), "a joint is none");
}

// Each reader of motions alone, and with what it makes of the skeleton in the same bytes.
void motion(std::string_view bytes) {
  const auto attempt = [](auto read) {
    try {
      read();
    } catch (const Error& error) {
      require(is_utf8(error.what()), "a message that is not UTF-8");
    }
  };
  attempt([&] { check(parse_amc(bytes, "input.amc", parse_asf(bytes, "input.asf"), {})); });
  static const AcclaimSkeleton arm = parse_asf(
      ":bonedata\nbegin\nname upper\ndirection 1 0 0\nlength 2\ndof rx ry "
      "rz\nend\nbegin\nname lower\ndof rz\nend\n:hierarchy\nroot upper\nupper lower\n",
      "arm.asf");
  attempt([&] { check(parse_amc(bytes, "input.amc", arm, {})); });
  attempt([&] {
    check(parse_deepmimic(bytes, "input.txt", parse_deepmimic_character(bytes, "input.txt"), {}));
  });
  static const DeepMimicCharacter bones{
      "bones", {{"a", -1, Vec3::Zero(), -1, -1, {}}, {"b", 0, Vec3(0, 1, 0), -1, -1, {}}}, {7, 4}};
  attempt([&] { check(parse_deepmimic(bytes, "input.txt", bones, {})); });
  check(clip_from_coordinates(parse_coordinates(bytes, "input.mot"), {}));
}

void markers(std::string_view bytes) {
  const MarkerTake take =
      is_c3d(bytes) ? parse_c3d(bytes, "input.c3d", {}) : parse_trc(bytes, "input.trc", {});
  require(std::isfinite(take.fps) && take.fps > 0 && !take.frames.empty(), "a take is none");
  for (const std::string& name : take.markers) require(is_utf8(name), "a name that is not UTF-8");
  for (const Points& places : take.frames) {
    require(places.rows() == Eigen::Index(take.markers.size()), "places are missing");
    for (const auto& p : places.rowwise())
      require(p.allFinite() || p.array().isNaN().all(), "half a place was let through");
  }
}

void bvh(std::string_view bytes) {
  const BvhMotion motion = parse_bvh(bytes, "input.bvh");
  require(motion.samples.size() == std::size_t(motion.frames) * std::size_t(motion.channels),
          "samples are missing");
  require(std::all_of(motion.samples.begin(), motion.samples.end(),
                      [](double v) { return std::isfinite(v); }),
          "a sample that is not finite was let through");
  for (std::size_t j = 0; j < motion.joints.size(); ++j)
    require(motion.joints[j].parent < int(j) && is_utf8(motion.joints[j].name), "a joint is none");
  if (motion.joints.size() > 200 || motion.frames > 20) return;
  static const Skeleton ours = plain_skeleton();
  RetargetReport report;
  const Motion moved = retarget(clip_from_bvh(motion), ours, {}, report);
  for (const Pose& pose : moved.frames)
    require(pose.root.allFinite(), "a pose that is not finite came out");
}

void mesh(std::string_view bytes) {
  if (scene_format(bytes)) return;
  for (const MeshPart& part : parse_mesh(bytes, "input.mesh").parts) {
    check(part.mesh);
    require(is_utf8(part.name), "a name that is not UTF-8 was let through");
  }
}

// Scans: clouds are let through, and colours and the like have a row for each vertex or none. FBX
// and COLLADA would start a program for each; what it gives is glTF, which is tried here.
void cloud(std::string_view bytes) {
  if (scene_format(bytes)) return;
  for (const MeshPart& part : parse_mesh(bytes, "input.mesh", {true, true}).parts) {
    check(part.mesh);
    const Eigen::Index vertices = part.mesh.V.rows();
    for (const Eigen::Index rows :
         {part.normals.rows(), part.colours.rows(), part.confidence.rows()})
      require(rows == 0 || rows == vertices, "values of a part of the vertices were let through");
    require(part.texture.rows() == 0 || part.texture.rows() == part.mesh.F.size(),
            "texture coordinates of a part of the corners were let through");
    require(part.normals.allFinite() && part.colours.allFinite() && part.texture.allFinite() &&
                part.confidence.allFinite(),
            "a value of a vertex that is not finite was let through");
    require(std::ranges::all_of(part.face_materials,
                                [&](int m) { return m < int(part.materials.size()); }),
            "a material out of range was let through");
  }
}

void body(std::string_view bytes) { check(parse_body(std::string(bytes), "input.glb").skin); }

void character(std::string_view bytes) {
  const Character read = parse_character(std::string(bytes), "input.glb");
  const Anatomy& anatomy = read.anatomy;
  check(read.body.skin);
  if (slice_count(anatomy) > 2000 || read.body.skin.V.rows() > 5000) return;
  const CharacterModel model = compile_character(read);
  CharacterState state(model);
  Pose pose = rest_pose(anatomy.skeleton);
  for (std::size_t j = 1; j < pose.rotations.size(); ++j)
    pose.rotations[j] = Quat(Eigen::AngleAxisd(0.7, anatomy.skeleton.joints[j].axes.col(0)));
  const SkinFrame& skin = evaluate_skin(model, pose, {}, state);
  for (const float v : skin.positions) require(std::abs(v) < 1000, "the skin was flung away");
}

// Crowds are read by parts from their files.
void crowd(std::string_view bytes) {
  static const std::filesystem::path folder = [] {
    const std::filesystem::path place =
        std::filesystem::temp_directory_path() / fmt::format("ecorche_fuzz_{}", ::getpid());
    std::filesystem::create_directories(place);
    return place;
  }();
  const std::filesystem::path file =
      folder / (bytes.starts_with("glTF") ? "crowd.glb" : "crowd.gltf");
  std::ofstream(file, std::ios::binary) << bytes;
  std::ofstream(folder / "person.bin", std::ios::binary) << std::string(4096, '\1');
  if (!is_crowd(file)) return;
  const Crowd people = open_crowd(file);
  for (const std::string& name : people.people) {
    const CrowdPerson person = read_crowd_person(people, name);
    check(person.body.skin);
    require(!person.skeleton.joints.empty(), "a person without joints");
  }
}

void table(std::string_view bytes) {
  const Table rows(bytes, "input.csv");
  for (int row = 0; row < std::min(rows.rows(), 1000); ++row)
    for (const std::string& column : rows.columns()) {
      require(is_utf8(rows.text(row, column)), "a cell that is not UTF-8 was let through");
      try {
        require(std::isfinite(rows.number_or(row, column, 0)),
                "a number that is not finite was let through");
      } catch (const InputError&) {
      }
    }
}

void poses(std::string_view bytes) {
  static const Skeleton ours = plain_skeleton();
  for (const NamedPose& pose : pose_book(Table(bytes, "input.csv"), "input.csv", ours))
    for (const Quat& turn : pose.pose.rotations)
      require(std::abs(turn.norm() - 1) < 1e-3, "a pose turns by what is no turn");
}

void weights(std::string_view bytes) {
  static const Arm arm = make_arm();
  const PaintedWeights painted =
      painted_weights(Table(bytes, "input.csv"), "input.csv", arm.anatomy, int(arm.skin.V.rows()));
  for (const auto& weights : painted.weights) {
    double sum = 0;
    for (const Influence& w : weights) sum += w.weight;
    require(std::abs(sum - 1) < 1e-6, "weights that do not add up were let through");
  }
}

void activation(std::string_view bytes) {
  static const Anatomy anatomy = make_arm().anatomy;
  for (const char* name : {"input.csv", "input.sto"}) try {
      for (const ActivationCurve& curve : parse_activations(bytes, name, anatomy).curves)
        for (const double value : curve.values)
          require(value >= 0 && value <= 1, "an activation beyond 0 .. 1 was let through");
    } catch (const Error&) {
    }
}

void osim(std::string_view bytes) { check_model(parse_osim(std::string(bytes), "input.osim")); }

void mjcf(std::string_view bytes) {
  const std::string text(bytes);
  check_model(parse_mjcf_model({[&](const std::string& path) {
                                 if (path != "input.xml" && path != "again.xml")
                                   throw InputError(printable(path) + ": not there");
                                 return text;
                               }},
                               "input.xml"));
}

void stl(std::string_view bytes) { check(parse_stl(bytes, "input.stl")); }

void map(std::string_view bytes) {
  require(!parse_joint_map(bytes, "input.map").empty(), "an empty map was let through");
}

// Our errors are what a reader may answer.
std::function<void(std::string_view)> refusing(void (*target)(std::string_view)) {
  return [target](std::string_view bytes) {
    try {
      target(bytes);
    } catch (const Error& error) {
      require(is_utf8(error.what()), "a message that is not UTF-8");
    }
  };
}

}  // namespace

const std::map<std::string, std::function<void(std::string_view)>>& fuzz_targets() {
  static const std::map<std::string, std::function<void(std::string_view)>> all{
      {"activation", refusing(activation)},
      {"body", refusing(body)},
      {"bvh", refusing(bvh)},
      {"character", refusing(character)},
      {"cloud", refusing(cloud)},
      {"crowd", refusing(crowd)},
      {"map", refusing(map)},
      {"markers", refusing(markers)},
      {"mesh", refusing(mesh)},
      {"mjcf", refusing(mjcf)},
      {"motion", refusing(motion)},
      {"osim", refusing(osim)},
      {"poses", refusing(poses)},
      {"stl", refusing(stl)},
      {"table", refusing(table)},
      {"weights", refusing(weights)}};
  return all;
}

}  // namespace ecorche::test
