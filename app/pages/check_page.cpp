#include "app/pages/check_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/files/actor.h"
#include "app/pages/html_page.h"
#include "viewer/camera.h"
#include "viewer/gl/renderer.h"
#include "viewer/scene.h"

namespace ecorche {
namespace {
// overlap, as a share of a muscle's volume, that has the strongest colour
constexpr double kFullColor = 0.10;
constexpr int kWorst = 20;
constexpr const char* kSlitsName = "slits under the fat layer, between muscles or bones";

const char* axis_name(int axis) {
  return axis == 0 ? "flexion" : axis == 1 ? "abduction" : "rotation";
}

std::string pose_name(const AnatomyCheck& check, int pose) {
  return pose < 0 ? "" : check.poses[pose].name;
}

std::string jump_place(const MuscleCheck& muscle, const Anatomy& anatomy) {
  if (muscle.jump_joint < 0) return "";
  return fmt::format("{} {} {:.0f} deg", anatomy.skeleton.joints[muscle.jump_joint].name,
                     axis_name(muscle.jump_axis), kDegreesPerRadian * muscle.jump_angle);
}

std::string slits_text(const AnatomyCheck& check) {
  if (!std::isfinite(check.slits)) return "not known";
  return fmt::format("{:.1f} cm2{}", 1e4 * check.slits,
                     check.slit_muscle.empty() ? "" : " (" + check.slit_muscle + ")");
}

// Muscles in descending order of the figure, without those that have none.
template <typename Figure>
std::vector<int> worst_muscles(const AnatomyCheck& check, Figure figure) {
  std::vector<int> order(check.muscles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return figure(check.muscles[a]) > figure(check.muscles[b]);
  });
  while (!order.empty() &&
         (int(order.size()) > kWorst || !(figure(check.muscles[order.back()]) > 0)))
    order.pop_back();
  return order;
}

template <typename Figure, typename Row>
void add_worst(HtmlPage& page, const AnatomyCheck& check, const std::string& heading,
               const std::vector<std::string>& header, Figure figure, Row row) {
  std::vector<std::vector<std::string>> rows;
  for (int m : worst_muscles(check, figure)) rows.push_back(row(m, check.muscles[m]));
  if (rows.empty()) return;
  page.add_heading(heading);
  page.add_table(header, rows);
}

class Photographer {
 public:
  explicit Photographer(const Actor& actor)
      : actor_(actor),
        model_(make_scene_model(actor.character.anatomy, actor.character.body.skin)) {}

  std::vector<std::uint8_t> take(const Pose& pose, std::span<const float> faults, float skin,
                                 const std::string& view) {
    constexpr int kWidth = 480, kHeight = 640;
    evaluate(actor_, pose, {}, frame_);
    Appearance appearance;
    appearance.muscle_colors = MuscleColors::shortening;
    appearance.looks[0].skin = skin;
    appearance.looks[0].skin_edge = skin > 0 ? 0.4f : 0;
    update_scene(model_, frame_.posed, &frame_.skin, faults, appearance, ++revision_, scene_);
    scene_.list.lighting.follows_camera = true;
    scene_.list.background_top = scene_.list.background_bottom = Vec3f(1, 1, 1);
    Points points;
    to_points(frame_.skin, points);
    const Vec3 low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
    const ViewAngles angles = view_angles(view);
    scene_.list.camera =
        orbit_camera((0.5 * (low + high)).cast<float>(), float(0.5 * (high - low).maxCoeff()),
                     angles.azimuth, angles.elevation, 0.3f, float(kWidth) / kHeight);
    return encode_png(renderer_.render(scene_.list, kWidth, kHeight));
  }

 private:
  const Actor& actor_;
  Renderer renderer_;
  SceneModel model_;
  Scene scene_;
  ActorState frame_{actor_};
  std::uint64_t revision_ = 0;
};

std::vector<float> colors_of(const AnatomyCheck& check, double MuscleCheck::*figure) {
  std::vector<float> colors;
  for (const MuscleCheck& muscle : check.muscles)
    colors.push_back(float(std::min(1.0, muscle.*figure / kFullColor)));
  return colors;
}

template <typename Figure>
int worst_pose(const AnatomyCheck& check, Figure figure) {
  int worst = -1;
  for (int p = 0; p < int(check.poses.size()); ++p)
    if (worst < 0 || figure(check.poses[p]) > figure(check.poses[worst])) worst = p;
  return worst;
}

void add_pictures(HtmlPage& page, const AnatomyCheck& check, const Actor& actor,
                  const std::vector<LimitPose>& poses) {
  Photographer photographer(actor);
  const Pose rest = rest_pose(actor.character.anatomy.skeleton);
  page.add_heading("At rest");
  const std::vector<float> shared = colors_of(check, &MuscleCheck::overlap);
  for (const char* view : {"front", "left", "back"})
    page.add_picture(photographer.take(rest, shared, 0, view),
                     fmt::format("From the {}: the more orange a muscle, the more of it lies "
                                 "within others (a tenth or more: full)",
                                 view));
  if (poses.empty()) return;
  page.add_heading("The worst poses");
  const int outside =
      worst_pose(check, [](const PoseCheck& p) { return double(p.muscle_points_outside); });
  const int overlap = worst_pose(check, [](const PoseCheck& p) { return p.overlap_share; });
  const int parted = worst_pose(check, [](const PoseCheck& p) { return p.daylight; });
  const auto posed_outside = colors_of(check, &MuscleCheck::posed_outside),
             posed_overlap = colors_of(check, &MuscleCheck::posed_overlap);
  for (const char* view : {"oblique", "back"}) {
    page.add_picture(photographer.take(poses[outside].pose, posed_outside, 0.16f, view),
                     fmt::format("{}: most muscle outside the skin ({} points)",
                                 poses[outside].name, check.poses[outside].muscle_points_outside));
    page.add_picture(photographer.take(poses[overlap].pose, posed_overlap, 0, view),
                     fmt::format("{}: most muscle within muscle ({:.1f} %)", poses[overlap].name,
                                 100 * check.poses[overlap].overlap_share));
    page.add_picture(photographer.take(poses[parted].pose, {}, 0, view),
                     fmt::format("{}: most daylight where muscles touched ({:.0f} cm2)",
                                 poses[parted].name, 1e4 * check.poses[parted].daylight));
  }
}

void add_bulges(HtmlPage& page, const Bulges& bulges) {
  page.add_heading("Bulges at full effort");
  std::vector<std::vector<std::string>> rows;
  if (std::isfinite(bulges.arm_relaxed))
    rows.push_back({"upper arm girth, flexed", fmt::format("{:.1f} cm", 100 * bulges.arm_relaxed),
                    fmt::format("{:.1f} cm", 100 * bulges.arm_tensed),
                    "trained men +2 to +4 cm; women +0.8 to +1.5"});
  for (const Thickening& m : bulges.muscles)
    rows.push_back(
        {m.muscle + ", thickness", fmt::format("{:.1f} mm", 1e3 * m.relaxed),
         fmt::format("{:.1f} mm ({:+.0f} %)", 1e3 * m.tense, 100 * (m.tense / m.relaxed - 1)),
         m.published});
  const std::vector<std::string> header{"", "relaxed", "tense", "measured in people"};
  page.add_table(header, rows);
}

void add_muscles(HtmlPage& page, const AnatomyCheck& check, const Anatomy& anatomy) {
  const auto name = [&](int m) { return anatomy.muscles[m].name; };
  const auto share = [](double x) { return fmt::format("{:.1f} %", 100 * x); };
  add_worst(
      page, check, "Muscles that share most with others at rest",
      {"muscle", "of its volume", "most with", "ml"},
      [](const MuscleCheck& m) { return m.overlap; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), share(c.overlap),
                                        c.neighbour < 0 ? "" : name(c.neighbour),
                                        fmt::format("{:.1f}", 1e6 * c.neighbour_volume)};
      });
  add_worst(
      page, check, "Muscles that lie in bones at rest", {"muscle", "of its volume"},
      [](const MuscleCheck& m) { return m.in_bone; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), share(c.in_bone)};
      });
  add_worst(
      page, check, "Muscles that show through what covers them at rest", {"muscle", "cm2"},
      [](const MuscleCheck& m) { return m.shown; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{:.1f}", 1e4 * c.shown)};
      });
  add_worst(
      page, check, "Muscles that leave the skin when posed", {"muscle", "of its points", "pose"},
      [](const MuscleCheck& m) { return m.posed_outside; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), share(c.posed_outside),
                                        pose_name(check, c.outside_pose)};
      });
  add_worst(
      page, check, "Muscles that stick out in a spike when posed",
      {"muscle", "mm beyond its next sections", "pose"},
      [](const MuscleCheck& m) { return m.spike; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{:.0f}", 1e3 * c.spike),
                                        pose_name(check, c.spike_pose)};
      });
  add_worst(
      page, check, "Muscles that are creased when posed",
      {"muscle", "of its edges turn by 45 degrees more", "pose"},
      [](const MuscleCheck& m) { return m.creased; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), share(c.creased),
                                        pose_name(check, c.creased_pose)};
      });
  add_worst(
      page, check, "Muscles with needles when posed", {"muscle", "points that stand off", "pose"},
      [](const MuscleCheck& m) { return double(m.needles); },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{}", c.needles),
                                        pose_name(check, c.needles_pose)};
      });
  const auto add_worst_area = [&](const char* heading, const char* column,
                                  double MuscleCheck::*area, int MuscleCheck::*pose) {
    add_worst(
        page, check, heading, {"muscle", column, "pose"},
        [&](const MuscleCheck& m) { return m.*area; },
        [&](int m, const MuscleCheck& c) {
          return std::vector<std::string>{name(m), fmt::format("{:.0f}", 1e4 * c.*area),
                                          pose_name(check, c.*pose)};
        });
  };
  add_worst_area("Muscles that part from what they touched at rest", "cm2 of daylight",
                 &MuscleCheck::daylight, &MuscleCheck::daylight_pose);
  add_worst_area("Muscles whose outer face sinks into others", "cm2", &MuscleCheck::buried,
                 &MuscleCheck::buried_pose);
  add_worst(
      page, check, "Tendons that kink", {"muscle", "degrees in a centimetre", "pose"},
      [](const MuscleCheck& m) { return m.kink; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m),
                                        fmt::format("{:.0f}", 0.01 * kDegreesPerRadian * c.kink),
                                        pose_name(check, c.kink_pose)};
      });
  add_worst(
      page, check, "Ends that come off their bones when posed", {"muscle", "mm", "pose"},
      [](const MuscleCheck& m) { return m.end_off; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{:.1f}", 1e3 * c.end_off),
                                        pose_name(check, c.end_off_pose)};
      });
  add_worst(
      page, check, "Paths that jump", {"muscle", "mm in a degree", "where"},
      [](const MuscleCheck& m) { return m.jump; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{:.2f}", 1e3 * c.jump),
                                        jump_place(c, anatomy)};
      });
  add_worst(
      page, check, "Bellies that do not keep their volume", {"muscle", "change"},
      [](const MuscleCheck& m) { return m.drift > 1e-6 ? m.drift : 0; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{:.3f} %", 100 * c.drift)};
      });
  add_worst(
      page, check, "Ends far from their bones", {"muscle", "mm"},
      [](const MuscleCheck& m) { return m.end_distance; },
      [&](int m, const MuscleCheck& c) {
        return std::vector<std::string>{name(m), fmt::format("{:.1f}", 1e3 * c.end_distance)};
      });
}

void add_bones(HtmlPage& page, const AnatomyCheck& check, const Anatomy& anatomy) {
  std::vector<int> order;
  for (std::size_t b = 0; b < check.bones.size(); ++b)
    if (check.bones[b].posed_outside > 0) order.push_back(int(b));
  if (order.empty()) return;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return check.bones[a].posed_depth > check.bones[b].posed_depth;
  });
  if (order.size() > kWorst) order.resize(kWorst);
  std::vector<std::vector<std::string>> rows;
  for (int b : order) {
    const BoneCheck& bone = check.bones[b];
    rows.push_back({anatomy.bones[b].name, fmt::format("{:.1f}", 1e3 * bone.posed_depth),
                    pose_name(check, bone.depth_pose), std::to_string(bone.posed_outside),
                    pose_name(check, bone.outside_pose)});
  }
  page.add_heading("Bones that leave the skin when posed");
  const std::vector<std::string> header{"bone", "mm", "pose", "points", "pose"};
  page.add_table(header, rows);
}

}  // namespace

std::string check_table(const std::vector<Target>& targets) {
  std::string out =
      fmt::format("{:<64} {:>13}  {:>16}  {}\n", "figure", "asked", "measured", "met");
  for (const Target& target : targets)
    out += fmt::format("{:<64} {:>13}  {:>16}  {}\n", target.what, target.asked, target.measured,
                       target.met ? "yes" : "NO");
  return out;
}

std::string slits_row(const AnatomyCheck& check) {
  return fmt::format("{:<64} {:>13}  {:>16}\n", kSlitsName, "", slits_text(check));
}

std::string check_csv(const AnatomyCheck& check, const Anatomy& anatomy) {
  std::string out =
      "muscle,group,layer,volume_ml,outside_share,overlap_share,neighbour,neighbour_ml,bone_share,"
      "needles_at_rest,raised_at_rest,needle_at_rest_mm,kink_at_rest_mm,slits_cm2,shown_cm2,"
      "posed_outside_share,outside_pose,posed_overlap_share,overlap_pose,"
      "posed_bone_share,volume_drift,path_jump_mm,path_jump_at,end_distance_mm,"
      "creased_share,creased_pose,needles,needles_pose,daylight_cm2,daylight_pose,buried_cm2,"
      "buried_pose,stretch,"
      "stretch_pose,tendon_kink_deg_cm,tendon_kink_pose,end_off_mm,end_off_pose\n";
  for (std::size_t i = 0; i < check.muscles.size(); ++i) {
    const MuscleCheck& m = check.muscles[i];
    const Muscle& muscle = anatomy.muscles[i];
    out += fmt::format(
        "{},{},{},{:.2f},{:.5f},{:.5f},{},{:.3f},{:.5f},{},{},{:.1f},{:.1f},{:.2f},{:.2f},{:.5f},{}"
        ",{:.5f}"
        ",{},{:."
        "5f},{:.2e},"
        "{:.3f},{},{:.2f},{:.5f},{},{},{},{:.1f},{},{:.1f},{},{:.2f},{},{:.1f},{},{:.1f},{}\n",
        muscle.name, muscle.group, muscle.layer, 1e6 * m.volume,
        m.points > 0 ? double(m.points_outside) / m.points : 0.0, m.overlap,
        m.neighbour < 0 ? "" : anatomy.muscles[m.neighbour].name, 1e6 * m.neighbour_volume,
        m.in_bone, m.tear.needles, m.tear.raised, 1e3 * m.tear.needle, 1e3 * m.tear.kink,
        1e4 * m.slits, 1e4 * m.shown, m.posed_outside, pose_name(check, m.outside_pose),
        m.posed_overlap, pose_name(check, m.overlap_pose), m.posed_in_bone, m.drift, 1e3 * m.jump,
        jump_place(m, anatomy), 1e3 * m.end_distance, m.creased, pose_name(check, m.creased_pose),
        m.needles, pose_name(check, m.needles_pose), 1e4 * m.daylight,
        pose_name(check, m.daylight_pose), 1e4 * m.buried, pose_name(check, m.buried_pose),
        m.stretch, pose_name(check, m.stretch_pose), 0.01 * kDegreesPerRadian * m.kink,
        pose_name(check, m.kink_pose), 1e3 * m.end_off, pose_name(check, m.end_off_pose));
  }
  return out;
}

std::string check_page(const AnatomyCheck& check, const std::vector<Target>& targets,
                       const Bulges& bulges, const Actor& actor,
                       const std::vector<LimitPose>& poses, const CheckPageOptions& options) {
  HtmlPage page(options.title);
  page.add_heading("Asked and measured");
  std::vector<std::vector<std::string>> rows;
  for (const Target& target : targets)
    rows.push_back({target.what, target.asked, target.measured, target.met ? "met" : "not met"});
  rows.push_back({kSlitsName, "", slits_text(check), ""});
  const std::vector<std::string> header{"figure", "asked", "measured", ""};
  page.add_table(header, rows);
  add_bulges(page, bulges);
  if (options.pictures) add_pictures(page, check, actor, poses);
  if (!check.poses.empty()) {
    page.add_heading("Poses at the joints' limits");
    rows.clear();
    for (const PoseCheck& pose : check.poses)
      rows.push_back({pose.name, std::to_string(pose.muscle_points_outside),
                      std::to_string(pose.bone_points_outside),
                      fmt::format("{:.2f} %", 100 * pose.overlap_share),
                      fmt::format("{:.2f} %", 100 * pose.bone_share)});
    const std::vector<std::string> columns{"pose", "muscle points outside", "bone points outside",
                                           "muscle within muscle", "muscle within bone"};
    page.add_table(columns, rows);
  }
  add_bones(page, check, actor.character.anatomy);
  add_muscles(page, check, actor.character.anatomy);
  return page.to_string();
}

}  // namespace ecorche
