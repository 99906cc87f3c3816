#include "app/pages/carried_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "viewer/camera.h"
#include "viewer/draw_mesh.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr double kPadHeight = 0.05;                                     // m
constexpr double kBedLength = 2.0, kBedWidth = 0.9, kBedHeight = 0.16;  // m
constexpr double kStrapRadius = 0.008, kBarRadius = 0.018;              // m
constexpr int kRodSides = 8;
constexpr float kAzimuth = -1.22f, kElevation = 0.20f;  // rad
constexpr double kGap = 0.25;                           // m between figures
const Vec3f kClothColor(0.47f, 0.60f, 0.72f), kStrapColor(0.22f, 0.28f, 0.36f),
    kBarColor(0.55f, 0.56f, 0.58f), kBedColor(0.86f, 0.87f, 0.84f);

DrawMesh box_mesh(const Vec3& low, const Vec3& high) {
  DrawMesh out;
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, 1}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const std::uint32_t first = std::uint32_t(out.positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        Vec3 p = low, n = Vec3::Zero();
        p[axis] = end ? high[axis] : low[axis];
        n[axis] = end ? 1 : -1;
        if (corner == 1 || corner == 2) p[u] = high[u];
        if (corner >= 2) p[v] = high[v];
        out.positions.push_back(p.cast<float>());
        out.normals.push_back(n.cast<float>());
      }
      const std::uint32_t b = end ? 1 : 3, d = end ? 3 : 1;
      out.triangles.push_back({first, first + b, first + 2});
      out.triangles.push_back({first, first + 2, first + d});
    }
  return out;
}

DrawMesh skin_mesh(const CarryModel& model, const LiftFrame& frame, const CarriedLook& look) {
  DrawMesh out = make_draw_mesh({frame.skin.cast<double>(), model.patient.skin.F});
  out.colors.reserve(frame.pressure.size());
  for (const float pressure : frame.pressure)
    out.colors.push_back(pressure_color(pressure, look.scale));
  return out;
}

// The frame's straps and the bar's rods.
DrawMesh hanger_mesh(const CarryModel& model, const LiftFrame& frame) {
  DrawMesh out;
  for (const Strap& strap : model.sheet->straps)
    for (std::size_t k = 0; k < strap.nodes.size(); ++k)
      add_tube(frame.nodes.row(strap.nodes[k]).transpose(), frame.bar + strap.hook,
               kStrapRadius / 2, kRodSides, out);
  return out;
}

DrawMesh bar_mesh(const CarryModel& model, const LiftFrame& frame) {
  DrawMesh out;
  const Vec3 top = frame.bar + Vec3(0, 0.10, 0);
  for (const Strap& strap : model.sheet->straps)
    add_tube(top, frame.bar + strap.hook, kBarRadius, kRodSides, out);
  add_tube(top, top + Vec3(0, 0.12, 0), kBarRadius, kRodSides, out);
  return out;
}

// Turns what points down towards the side that the camera is on, about the middle of the body.
Mat4f below_transform(const LiftFrame& frame, const Vec3& offset) {
  const Vec3f middle =
      0.5f * (frame.skin.colwise().minCoeff() + frame.skin.colwise().maxCoeff()).transpose();
  Eigen::Affine3f X = Eigen::Affine3f::Identity();
  X.translate(Vec3f(offset.cast<float>()));
  X.rotate(Eigen::AngleAxisf(-float(M_PI) / 2, Vec3f::UnitZ()));
  X.translate(-middle);
  return X.matrix();
}

void add_item(DrawList& list, DrawMesh mesh, const Surface& surface, const Mat4f& X_WM, bool shadow,
              bool closed) {
  DrawItem item;
  item.mesh = int(list.meshes.size());
  item.surface = surface;
  item.X_WM = X_WM;
  item.casts_shadow = shadow;
  item.closed = closed;
  list.meshes.push_back(std::move(mesh));
  list.items.push_back(item);
}

Vec3 bed_middle(const CarryModel& model) {
  const Vec3 low = model.patient.skin.V.colwise().minCoeff(),
             high = model.patient.skin.V.colwise().maxCoeff();
  // The rest pose stands; lying down turns up into -z about the root.
  return Vec3(0, 0,
              rest_positions(model.patient.skeleton)[0].y() +
                  rest_positions(model.patient.skeleton)[0].z() - 0.5 * (low.y() + high.y()));
}

}  // namespace

Vec3f pressure_color(double pressure, double scale) {
  const Vec3f stops[] = {kSkinLook.color, Vec3f(0.98f, 0.87f, 0.45f), Vec3f(0.95f, 0.55f, 0.16f),
                         Vec3f(0.78f, 0.16f, 0.18f), Vec3f(0.36f, 0.05f, 0.34f)};
  constexpr int kLast = 4;
  const double at = kLast * std::clamp(pressure / scale, 0.0, 1.0);
  const int below = std::min(kLast - 1, int(at));
  const float share = float(at - below);
  return (1 - share) * stops[below] + share * stops[below + 1];
}

void draw_pressure_legend(Image& image, float x, float y, float size, double scale) {
  constexpr int kSteps = 96;
  const float width = kPressureLegendWidth * size, bar = 0.55f * size, top = y + 1.5f * size;
  draw_text(image, "pressure on the skin, kPa", x, y + size, {.size = size});
  for (int i = 0; i < kSteps; ++i)
    fill_field(image, x + width * float(i) / kSteps, top, width / kSteps + 0.5f, bar,
               pressure_color(scale * (i + 0.5) / kSteps, scale));
  const float baseline = top + bar + 1.05f * size;
  for (const double mark : {0.0, 4.3, 9.3, scale / 1e3}) {
    const float at = x + width * float(mark * 1e3 / scale);
    if (mark > 0 && mark < scale / 1e3)
      draw_line(image, at, top, at, top + bar, 1, Vec3f(0.1f, 0.1f, 0.1f));
    draw_text(image, fmt::format("{:g}", mark), at, baseline,
              {.size = 0.85f * size, .align = Align::center});
  }
}

void carried_scene(const CarryModel& model, const LiftFrame& frame, const CarriedLook& look,
                   std::uint64_t revision, DrawList& list) {
  list.meshes.clear();
  list.items.clear();
  const Mat4f here = Mat4f::Identity();
  Surface skin;
  skin.color = Vec3f(1, 1, 1);
  skin.roughness = 0.7f;
  add_item(list, skin_mesh(model, frame, look), skin, here, true, true);
  DrawMesh below = list.meshes[0];
  add_item(list, std::move(below), skin, below_transform(frame, look.from_below), false, true);
  if (model.sheet) {
    Surface cloth;
    cloth.color = kClothColor;
    cloth.opacity = 0.72f;
    cloth.roughness = 0.9f;
    add_item(list, make_draw_mesh({frame.nodes, model.sheet->mesh.F}), cloth, here, true, false);
    Surface strap;
    strap.color = kStrapColor;
    add_item(list, hanger_mesh(model, frame), strap, here, true, false);
    Surface bar;
    bar.color = kBarColor;
    bar.roughness = 0.35f;
    add_item(list, bar_mesh(model, frame), bar, here, true, false);
  }
  if (look.mattress && model.mattress.present) {
    const Vec3 middle = bed_middle(model);
    Surface bed;
    bed.color = kBedColor;
    bed.roughness = 0.95f;
    const double top = model.mattress.height - 0.004;
    add_item(list,
             box_mesh(middle + Vec3(-kBedWidth / 2, top - kBedHeight, -kBedLength / 2),
                      middle + Vec3(kBedWidth / 2, top, kBedLength / 2)),
             bed, here, true, true);
  }
  for (const Pad& pad : model.pads) {
    Surface foam;
    foam.color = kBedColor;
    foam.roughness = 0.95f;
    add_item(list,
             box_mesh(Vec3(-pad.half_width, -kPadHeight, -pad.half_length),
                      Vec3(pad.half_width, -0.004, pad.half_length)),
             foam, pad.X_WP.matrix().cast<float>(), true, true);
  }
  for (DrawMesh& mesh : list.meshes) mesh.key = 0, mesh.revision = revision;
  list.lighting.follows_camera = true;
  list.lighting.key_direction = Vec3f(0.35f, -0.75f, -0.6f);
  list.lighting.ambient_strength = 0.55f;
  list.background_top = list.background_bottom = Vec3f(0.97f, 0.97f, 0.96f);
}

Vec3 beside_the_feet(const std::vector<LiftFrame>& frames) {
  float feet = -1e9f, low = 1e9f, high = -1e9f;
  for (const LiftFrame& frame : frames) {
    feet = std::max(feet, frame.skin.col(2).maxCoeff());
    low = std::min(low, frame.skin.col(1).minCoeff());
    high = std::max(high, frame.skin.col(1).maxCoeff());
  }
  const double half =
      0.5 * (frames.front().skin.col(2).maxCoeff() - frames.front().skin.col(2).minCoeff());
  return {0, 0.5 * double(low + high), double(feet) + kGap + half};
}

Camera carried_camera(const CarryModel& model, const std::vector<LiftFrame>& frames,
                      const CarriedLook& look, float aspect) {
  std::vector<Vec3f> points;
  for (const LiftFrame& frame : frames) {
    for (Eigen::Index i = 0; i < frame.skin.rows(); i += 16) {
      points.push_back(frame.skin.row(i).transpose());
      points.push_back(
          (below_transform(frame, look.from_below) * frame.skin.row(i).transpose().homogeneous())
              .head<3>());
    }
    if (model.sheet) points.push_back((frame.bar + Vec3(0, 0.25, 0)).cast<float>());
  }
  if (look.mattress && model.mattress.present)
    for (const int end : {-1, 1})
      points.push_back(
          (bed_middle(model) + Vec3(0, model.mattress.height - kBedHeight, 0.5 * end * kBedLength))
              .cast<float>());
  for (const Pad& pad : model.pads)
    for (const int x : {-1, 1})
      for (const int z : {-1, 1})
        points.push_back(
            (pad.X_WP * Vec3(x * pad.half_width, 0, z * pad.half_length)).cast<float>());
  Eigen::AlignedBox3f box;
  for (const Vec3f& p : points) box.extend(p);
  const ViewAngles angles{kAzimuth, kElevation};
  const Vec3f away = away_from(angles);
  Camera camera;
  camera.fov_y = 0.30f;
  camera.target = box.center();
  camera.eye = camera.target +
               away * distance_to_see(points, camera.target, away, camera.fov_y, aspect, 0.05f);
  camera.up = upward_from(angles);
  return camera;
}

}  // namespace ecorche
