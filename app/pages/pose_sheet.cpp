#include "app/pages/pose_sheet.h"

#include <algorithm>

#include "viewer/camera.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr int kTitle = 34, kLabel = 22;  // pixels

// Parallel camera that just has all points in view.
Camera camera_on(const SkinFrame& skin, const std::string& view, float aspect) {
  const ViewAngles angles = view_angles(view);
  const Vec3f forward(-std::sin(angles.azimuth) * std::cos(angles.elevation),
                      -std::sin(angles.elevation),
                      -std::cos(angles.azimuth) * std::cos(angles.elevation));
  const Vec3f right = forward.cross(Vec3f::UnitY()).normalized(), up = right.cross(forward);
  Eigen::AlignedBox3f box, seen;
  for (std::size_t i = 0; i + 3 < skin.positions.size(); i += 4) {
    const Vec3f p(skin.positions[i], skin.positions[i + 1], skin.positions[i + 2]);
    box.extend(p);
    seen.extend(Vec3f(p.dot(right), p.dot(up), 0));
  }
  const float high = 1.05f * std::max(seen.sizes().y(), seen.sizes().x() / aspect);
  const Vec3f middle =
      right * seen.center().x() + up * seen.center().y() + forward * forward.dot(box.center());
  Camera camera = orbit_camera(middle, high, angles.azimuth, angles.elevation, 0.3f);
  camera.ortho_height = high;
  return camera;
}

}  // namespace

Image sheet_of_poses(Renderer& renderer, const Actor& actor, const SceneModel& model,
                     std::span<const NamedPose> poses, const std::string& title,
                     const PoseSheetOptions& options) {
  const int columns = std::min(options.columns, int(poses.size())), w = options.cell_width,
            h = options.cell_height;
  const int rows = (int(poses.size()) + columns - 1) / columns;
  Image whole = make_image(columns * w, kTitle + rows * (h + kLabel));
  Appearance appearance;
  Look& look = appearance.looks[0];
  if (options.skin)
    look.muscles = look.bones = 0;
  else
    look.skin = 0;
  ActorState frame(actor);
  Scene scene;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    evaluate(actor, poses[i].pose, {}, frame);
    update_scene(model, frame.posed, &frame.skin, {}, appearance, i + 1, scene);
    light_from_camera(0.5f, scene.list.lighting);
    scene.list.background_top = scene.list.background_bottom = Vec3f(1.2f, 1.2f, 1.2f);
    scene.list.camera = camera_on(frame.skin, poses[i].view, float(w) / float(h));
    const Image cell = renderer.render(scene.list, w, h);
    const int x = int(i) % columns * w, y = kTitle + int(i) / columns * (h + kLabel);
    for (int row = 0; row < h; ++row)
      std::copy_n(cell.pixel(0, row), 4 * std::size_t(w), whole.pixel(x, y + row));
    draw_text(whole, poses[i].label, float(x) + 0.5f * float(w), float(y + h + 15),
              {.size = 13, .align = Align::center});
  }
  draw_text(whole, title, 10, 24, {.size = 20});
  return whole;
}

}  // namespace ecorche
