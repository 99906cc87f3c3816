#include "app/pages/tape_pictures.h"

#include <algorithm>
#include <cmath>

#include "anatomy/geometry/mesh_measures.h"
#include "viewer/camera.h"
#include "viewer/draw_mesh.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr float kLettersTapePictures = 13, kLeading = 17;  // pixels
constexpr float kTitleTapePictures = 28;                   // pixels above the figures

struct Panel {
  const char* title;
  const char* view;
  bool (*shows)(MeasureKind kind);
  Vec3f color;
};

const Panel kPanels[] = {
    {"girths", "front", [](MeasureKind kind) { return kind == MeasureKind::girth; },
     Vec3f(0.90f, 0.35f, 0.10f)},
    {"lengths, breadths, depths", "back",
     [](MeasureKind kind) {
       return kind == MeasureKind::path || kind == MeasureKind::distance ||
              kind == MeasureKind::breadth || kind == MeasureKind::depth;
     },
     Vec3f(0.45f, 0.20f, 0.65f)},
    {"heights", "left",
     [](MeasureKind kind) { return kind == MeasureKind::height || kind == MeasureKind::ahead; },
     Vec3f(0.10f, 0.40f, 0.70f)}};

// A line as a thin tube of six sides.
void add_line(const std::vector<Vec3>& line, double radius, DrawMesh& out) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) add_tube(line[i], line[i + 1], radius, 6, out);
}

// Draws the name of a tape with a line to its outermost point on that side of the picture.
struct Name {
  std::string text;
  float x = 0, y = 0;
};

void write_column(std::vector<Name> names, float x, Align align, float low, float high,
                  Image& whole) {
  std::stable_sort(names.begin(), names.end(),
                   [](const Name& a, const Name& b) { return a.y < b.y; });
  std::vector<float> lines;
  for (const Name& name : names)
    lines.push_back(std::max(name.y, lines.empty() ? low : lines.back() + kLeading));
  for (std::size_t i = lines.size(); i-- > 0;)
    lines[i] = std::min(lines[i], i + 1 < lines.size() ? lines[i + 1] - kLeading : high);
  const float gap = align == Align::left ? -4 : 4;
  for (std::size_t i = 0; i < names.size(); ++i) {
    draw_line(whole, x + gap, lines[i] - 4, names[i].x, names[i].y, 1, Vec3f(0.4f, 0.4f, 0.4f),
              0.7f);
    draw_text(whole, names[i].text, x, lines[i], {.size = kLettersTapePictures, .align = align});
  }
}

Image picture(Renderer& renderer, const TapeMeasure& tape, const TriMesh& skin,
              const DrawMesh& body, const Panel& panel, int width, int height) {
  DrawList list;
  list.lighting.follows_camera = true;
  list.lighting.ambient_strength = 0.55f;
  list.background_top = list.background_bottom = Vec3f(1.2f, 1.2f, 1.2f);
  list.meshes = {body, {}};
  const Vec3 low = skin.V.colwise().minCoeff(), top = skin.V.colwise().maxCoeff(),
             middle = 0.5 * (low + top);
  const ViewAngles angles = view_angles(panel.view);
  const double high = 1.12 * (top.y() - low.y()), scale = height / high;
  list.camera =
      orbit_camera(middle.cast<float>(), float(high), angles.azimuth, angles.elevation, 0.3f);
  list.camera.ortho_height = float(high);
  const Vec3 right(std::cos(angles.azimuth), 0, -std::sin(angles.azimuth));
  std::vector<Name>
      sides[2];  // left and right of the picture, so that lines to names do not cross the figure
  TapeTrace trace;
  for (int k = 0; k < tape.count(); ++k) {
    if (!panel.shows(tape.measure(k).kind)) continue;
    tape.take(k, skin.V, nullptr, &trace);
    Name name{tape.measure(k).id, 0, 0};
    double furthest = -1;
    for (const auto& line : trace) {
      add_line(line, 0.003, list.meshes[1]);
      for (const Vec3& p : line) {
        const double across = (p - middle).dot(right);
        if (std::abs(across) <= furthest) continue;
        furthest = std::abs(across);
        name.x = float(0.5 * width + scale * across),
        name.y = float(0.5 * height - scale * (p.y() - middle.y()));
      }
    }
    const float off = name.x - 0.5f * float(width);
    const bool at_left = std::abs(off) < 20 ? sides[0].size() < sides[1].size() : off < 0;
    if (!trace.empty()) sides[at_left ? 0 : 1].push_back(name);
  }
  DrawItem skin_item, tapes;
  skin_item.surface.color = Vec3f(0.86f, 0.74f, 0.66f);
  skin_item.closed = true;
  tapes.mesh = 1;
  tapes.surface.color = panel.color;
  list.items = {skin_item, tapes};
  Image out = renderer.render(list, width, height);
  write_column(sides[0], 6, Align::left, kTitleTapePictures + kLeading, float(height) - 8, out);
  write_column(sides[1], float(width) - 6, Align::right, kTitleTapePictures + kLeading,
               float(height) - 8, out);
  draw_text(out, panel.title, 0.5f * float(width), 20, {.size = 16, .align = Align::center});
  return out;
}

}  // namespace

Image sheet_of_tapes(Renderer& renderer, const TapeMeasure& tape, const TriMesh& skin,
                     int cell_width, int cell_height) {
  const DrawMesh body = make_draw_mesh(skin);
  Image whole = make_image(cell_width * int(std::size(kPanels)), cell_height);
  for (std::size_t i = 0; i < std::size(kPanels); ++i) {
    const Image part = picture(renderer, tape, skin, body, kPanels[i], cell_width, cell_height);
    for (int row = 0; row < cell_height; ++row)
      std::copy_n(part.pixel(0, row), 4 * std::size_t(cell_width),
                  whole.pixel(int(i) * cell_width, row));
  }
  return whole;
}

}  // namespace ecorche
