#include "app/pages/stage_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "anatomy/muscles/action_line.h"
#include "app/pages/actor_film.h"
#include "app/pages/legend.h"
#include "skinning/motion/sample_motion.h"
#include "viewer/camera.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr float kLetters = 15;           // pixels
constexpr int kTitleStagePictures = 30;  // pixels above and below a row of pictures

void paste(const Image& part, int x, int y, Image& whole) {
  for (int row = 0; row < part.height; ++row)
    std::copy_n(part.pixel(0, row), 4 * std::size_t(part.width), whole.pixel(x, y + row));
}

PosedAnatomy at_rest(const Anatomy& anatomy) {
  PosedAnatomy posed;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), posed.X_WJ);
  posed.slices = rest_slices(anatomy);
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) posed.lengths.push_back(strip.rest_length);
  posed.swelling.assign(posed.lengths.size(), 1);
  return posed;
}

SceneModel model_of(const Anatomy& anatomy, const TriMesh& skin, std::span<const Eyeball> eyes) {
  SceneOptions options;
  options.surface.rows_between = 1;
  options.eyes.assign(eyes.begin(), eyes.end());
  return make_scene_model(anatomy, skin, options);
}

// The background is white after the renderer's tone curve.
void light_studio(DrawList& list) {
  light_from_camera(0.55f, list.lighting);
  list.background_top = list.background_bottom = Vec3f(1.2f, 1.2f, 1.2f);
}

// Parallel projection, so that one scale holds for the whole picture.
Camera flat_camera(const Vec3f& center, const std::string& view, float metres_high) {
  const ViewAngles angles = view_angles(view);
  Camera camera = orbit_camera(center, metres_high, angles.azimuth, angles.elevation, 0.3f);
  camera.ortho_height = metres_high;
  return camera;
}

struct Extent {
  Vec3f center = Vec3f::Zero();
  float height = 1, width = 1;  // m; width: the larger one of both horizontal ones
};

Extent extent_of(const Points& V) {
  const Vec3 low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
  return {(0.5 * (low + high)).cast<float>(), float(high.y() - low.y()),
          float(std::max(high.x() - low.x(), high.z() - low.z()))};
}

// The label without its parentheses, since there is little room.
std::string short_label(const std::string& label) {
  const size_t open = label.find(" ("), close = label.find(')', open);
  return open == std::string::npos || close == std::string::npos
             ? label
             : label.substr(0, open) + label.substr(close + 1);
}

// The visible area of a muscle in one picture.
struct Seen {
  std::string label;
  int pixels = 0;
  double x = 0, y = 0;  // sums over its pixels, then a pixel of it
};

// The `count` muscles with most pixels on the given half of the picture, from top to bottom.
std::vector<Seen> largest_muscles(const std::vector<std::uint32_t>& parts, const Anatomy& anatomy,
                                  int width, int x_begin, int x_end, size_t count) {
  std::map<std::string, Seen> by_label;
  const int height = int(parts.size()) / width;
  const auto each_pixel = [&](const auto& act) {
    for (int y = 0; y < height; ++y)
      for (int x = x_begin; x < x_end; ++x) {
        const Part part = part_of(parts[y * width + x]);
        if (part.kind == Part::Kind::muscle) act(anatomy.muscles[part.index].label, x, y);
      }
  };
  each_pixel([&](const std::string& label, int x, int y) {
    Seen& seen = by_label[label];
    seen.label = label;
    ++seen.pixels, seen.x += x, seen.y += y;
  });
  std::map<std::string, Seen> nearest;  // the pixel next to the middle of what is seen
  each_pixel([&](const std::string& label, int x, int y) {
    const Seen& all = by_label[label];
    const auto off = [&](double px, double py) {
      return std::hypot(px - all.x / all.pixels, py - all.y / all.pixels);
    };
    const auto found = nearest.find(label);
    if (found == nearest.end() || off(x, y) < off(found->second.x, found->second.y))
      nearest[label] = {label, all.pixels, double(x), double(y)};
  });
  std::vector<Seen> chosen;
  for (const auto& [label, seen] : nearest) chosen.push_back(seen);
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const Seen& a, const Seen& b) { return a.pixels > b.pixels; });
  chosen.resize(std::min(chosen.size(), count));
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const Seen& a, const Seen& b) { return a.y < b.y; });
  return chosen;
}

// Draws names in a column at x, at least one line apart, with lines to their muscles.
void write_names(const std::vector<Seen>& muscles, float x, bool at_right, int offset_x, int height,
                 Image& whole) {
  constexpr float leading = 1.5f * kLetters;
  std::vector<float> lines;
  for (const Seen& seen : muscles)
    lines.push_back(std::max(float(seen.y), lines.empty() ? leading : lines.back() + leading));
  for (size_t i = lines.size(); i-- > 0;)
    lines[i] =
        std::min(lines[i], i + 1 < lines.size() ? lines[i + 1] - leading : float(height) - leading);
  const Vec3f quiet(0.35f, 0.35f, 0.36f);
  for (size_t i = 0; i < muscles.size(); ++i) {
    const float px = float(offset_x + muscles[i].x), py = float(muscles[i].y);
    draw_line(whole, at_right ? x - 6 : x + 6, lines[i] - 5, px, py, 1.1f, quiet, 0.85f);
    fill_field(whole, px - 2, py - 2, 4, 4, quiet);
    draw_text(whole, short_label(muscles[i].label), x, lines[i],
              {.size = kLetters, .align = at_right ? Align::left : Align::right});
  }
}

}  // namespace

Image sheet_of_stages(Renderer& renderer, const TriMesh& skin, std::span<const Eyeball> eyes,
                      std::span<const Stage> stages, std::span<const std::string> views,
                      int cell_width, int cell_height) {
  const Extent extent = extent_of(skin.V);
  const float high =
      1.04f * std::max(extent.height, extent.width * float(cell_height) / float(cell_width));
  Image whole = make_image(cell_width * int(stages.size()),
                           kTitleStagePictures + cell_height * int(views.size()));
  for (size_t i = 0; i < stages.size(); ++i) {
    const SceneModel model = model_of(*stages[i].anatomy, skin, eyes);
    Appearance appearance;
    appearance.looks = {stages[i].look};
    Scene scene;
    update_scene(model, at_rest(*stages[i].anatomy), nullptr, {}, appearance, 1, scene);
    light_studio(scene.list);
    const int x = int(i) * cell_width;
    for (size_t v = 0; v < views.size(); ++v) {
      scene.list.camera = flat_camera(extent.center, views[v], high);
      paste(renderer.render(scene.list, cell_width, cell_height), x,
            kTitleStagePictures + int(v) * cell_height, whole);
    }
    draw_text(whole, stages[i].title, float(x) + 0.5f * float(cell_width), 21,
              {.size = kLetters, .align = Align::center});
  }
  for (size_t v = 0; v < views.size(); ++v)
    draw_text(whole, views[v], 8, float(kTitleStagePictures + 16 + int(v) * cell_height),
              {.size = kLetters, .opacity = 0.7f});
  draw_scale_bar(whole, 10, float(whole.height) - 12, kLetters, float(cell_height) / high, 0.2f);
  return whole;
}

Image plate_of_muscles(Renderer& renderer, const Anatomy& anatomy, const TriMesh& skin,
                       std::span<const Eyeball> eyes, int height) {
  constexpr int names = 275;  // pixels for a column of names
  constexpr size_t a_side = 16;
  const Extent extent = extent_of(skin.V);
  const float high = 1.04f * extent.height;
  const int width = int(1.04f * extent.width / high * float(height)), panel = width + 2 * names;
  const SceneModel model = model_of(anatomy, skin, eyes);
  Appearance appearance;
  appearance.looks[0].skin = 0;
  Scene scene;
  update_scene(model, at_rest(anatomy), nullptr, {}, appearance, 1, scene);
  light_studio(scene.list);
  Image whole = make_image(2 * panel, height);
  const std::string views[] = {"front", "back"};
  for (int v = 0; v < 2; ++v) {
    scene.list.camera = flat_camera(extent.center, views[v], high);
    const int x = v * panel + names;
    paste(renderer.render(scene.list, width, height), x, 0, whole);
    // Each half of the figure shows the same muscles: every other name goes to the other side.
    const std::vector<std::uint32_t> parts = renderer.parts();
    const auto left = largest_muscles(parts, anatomy, width, 0, width / 2, 2 * a_side),
               right = largest_muscles(parts, anatomy, width, width / 2, width, 2 * a_side);
    std::vector<Seen> at_left, at_right;
    for (size_t i = 0; i < left.size(); i += 2) at_left.push_back(left[i]);
    for (const Seen& seen : right)
      if (std::none_of(at_left.begin(), at_left.end(),
                       [&](const Seen& other) { return other.label == seen.label; }))
        at_right.push_back(seen);
    write_names(at_left, float(x - 8), false, x, height, whole);
    write_names(at_right, float(x + width + 8), true, x, height, whole);
  }
  draw_scale_bar(whole, 12, float(height) - 12, kLetters, float(height) / high, 0.2f);
  return whole;
}

Image sheet_of_moments(Renderer& renderer, const Actor& actor, std::span<const Eyeball> eyes,
                       const Motion& motion, std::span<const double> seconds,
                       const MomentsOptions& options) {
  const SceneModel model = model_of(actor.character.anatomy, actor.character.body.skin, eyes);
  const int rows = (options.skin ? 1 : 0) + (options.flayed ? 1 : 0), w = options.cell_width,
            h = options.cell_height;
  const int head = (options.flayed ? 2 : 1) * kTitleStagePictures;
  Image whole = make_image(w * int(seconds.size()), head + rows * h + kTitleStagePictures);
  const float high = 1.42f * extent_of(actor.character.body.skin.V).height;
  ActorState frame(actor);
  Pose pose;
  Scene scene;
  std::vector<float> activity;
  std::uint64_t revision = 0;
  for (size_t i = 0; i < seconds.size(); ++i) {
    pose_at(motion, seconds[i], pose);
    evaluate(actor, pose, {}, frame);
    muscle_shortening(model, frame.posed, activity);
    Eigen::AlignedBox3f box;
    for (size_t k = 0; k + 3 < frame.skin.positions.size(); k += 4)
      box.extend(
          Vec3f(frame.skin.positions[k], frame.skin.positions[k + 1], frame.skin.positions[k + 2]));
    int row = 0;
    for (const bool flayed : {false, true}) {
      if (flayed ? !options.flayed : !options.skin) continue;
      Appearance appearance;
      appearance.looks[0].skin = flayed ? 0.0f : 1.0f;
      appearance.looks[0].muscles = appearance.looks[0].bones = flayed ? 1.0f : 0.0f;
      update_scene(model, frame.posed, &frame.skin, activity, appearance, ++revision, scene);
      light_studio(scene.list);
      scene.list.camera = flat_camera(box.center(), "-72,3", high);
      paste(renderer.render(scene.list, w, h), int(i) * w, head + row++ * h, whole);
    }
    draw_text(whole, fmt::format("{:.2f} s", seconds[i]), (float(i) + 0.5f) * float(w),
              float(whole.height) - 9, {.size = kLetters, .align = Align::center});
  }
  if (options.flayed) draw_muscle_legend(whole, 10, 8, kLetters, MuscleColors::flesh);
  draw_scale_bar(whole, float(whole.width) - 120, kTitleStagePictures, kLetters, float(h) / high,
                 0.5f);
  return whole;
}

}  // namespace ecorche
