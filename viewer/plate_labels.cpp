#include "viewer/plate_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "viewer/camera.h"
#include "viewer/lettering.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

constexpr int kColumns = 480;          // of the picture in which parts are looked for
constexpr float kOpaque = 0.98f;       // surfaces below are glass
constexpr float kLargest = 0.027f;     // of the picture's height, a letter's size
constexpr float kLeading = 1.35f;      // of a letter's size, from one name to the next
constexpr float kEdge = 0.015f;        // of the picture's width, free beside the names
constexpr float kLineWidth = 0.0011f;  // of the picture's height
constexpr int kFewPixels = 6;          // a part of fewer is not seen

// Parts of a small picture, by a depth buffer.
class PartBuffer {
 public:
  PartBuffer(const DrawList& list, float aspect)
      : width_(kColumns),
        height_(std::clamp(int(std::lround(kColumns / aspect)), 1, 4 * kColumns)),
        parts_(std::size_t(width_ * height_), 0),
        depths_(parts_.size(), std::numeric_limits<float>::infinity()) {
    const Mat4f clip_from_world = projection_matrix(list.camera, aspect) * view_matrix(list.camera);
    for (const DrawItem& item : list.items)
      if (item.surface.opacity >= kOpaque) draw(list, item, clip_from_world);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  std::uint32_t part(int x, int y) const { return parts_[std::size_t(y * width_ + x)]; }

 private:
  struct Corner {
    float x, y, depth;
    Vec3f world;
  };

  void draw(const DrawList& list, const DrawItem& item, const Mat4f& clip_from_world) {
    const DrawMesh& mesh = list.meshes[std::size_t(item.mesh)];
    std::vector<Corner> corners(mesh.positions.size());
    std::vector<char> before(mesh.positions.size(), 0);
    for (std::size_t v = 0; v < corners.size(); ++v) {
      const Vec4f world = item.X_WM * mesh.positions[v].homogeneous();
      const Vec4f clip = clip_from_world * world;
      before[v] = clip.w() > 1e-6f;
      corners[v] = {0.5f * float(width_) * (1 + clip.x() / clip.w()),
                    0.5f * float(height_) * (1 - clip.y() / clip.w()), clip.z() / clip.w(),
                    world.head<3>()};
    }
    const std::optional<Vec4f> cut = item.cut_face ? std::nullopt : list.cut;
    const float eye = cut ? cut->head<3>().dot(list.camera.eye) - cut->w() : 0;
    for (const Triangle32& t : mesh.triangles) {
      if (!before[t[0]] || !before[t[1]] || !before[t[2]]) continue;
      fill(corners[t[0]], corners[t[1]], corners[t[2]],
           mesh.parts.empty() ? item.part : mesh.parts[t[0]], cut, eye);
    }
  }

  void fill(const Corner& a, const Corner& b, const Corner& c, std::uint32_t part,
            const std::optional<Vec4f>& cut, float eye) {
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (std::abs(area) < 1e-9f) return;
    const int left = std::max(int(std::floor(std::min({a.x, b.x, c.x}))), 0);
    const int right = std::min(int(std::ceil(std::max({a.x, b.x, c.x}))), width_ - 1);
    const int top = std::max(int(std::floor(std::min({a.y, b.y, c.y}))), 0);
    const int bottom = std::min(int(std::ceil(std::max({a.y, b.y, c.y}))), height_ - 1);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const float px = float(x) + 0.5f, py = float(y) + 0.5f;
        const float u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
        const float v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
        const float w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const float depth = u * a.depth + v * b.depth + w * c.depth;
        const std::size_t at = std::size_t(y * width_ + x);
        if (depth >= depths_[at]) continue;
        if (cut) {
          const Vec3f world = u * a.world + v * b.world + w * c.world;
          if ((cut->head<3>().dot(world) - cut->w()) * eye > 0) continue;
        }
        depths_[at] = depth;
        parts_[at] = part;
      }
  }

  int width_, height_;
  std::vector<std::uint32_t> parts_;
  std::vector<float> depths_;
};

// Pixels from the edge of what is seen of the part that each pixel shows: chamfer distances.
std::vector<int> edge_distances(const PartBuffer& buffer) {
  const int width = buffer.width(), height = buffer.height();
  std::vector<int> out(std::size_t(width * height), 0);
  const auto pass = [&](int x, int y, int dx, int dy) {
    const int nx = x + dx, ny = y + dy;
    const bool same =
        nx >= 0 && ny >= 0 && nx < width && ny < height && buffer.part(nx, ny) == buffer.part(x, y);
    const int there = same ? out[std::size_t(ny * width + nx)] : 0;
    return there + (dx != 0 && dy != 0 ? 4 : 3);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out[std::size_t(y * width + x)] =
          std::min({pass(x, y, -1, 0), pass(x, y, 0, -1), pass(x, y, -1, -1), pass(x, y, 1, -1)});
  for (int y = height - 1; y >= 0; --y)
    for (int x = width - 1; x >= 0; --x) {
      int& here = out[std::size_t(y * width + x)];
      here =
          std::min({here, pass(x, y, 1, 0), pass(x, y, 0, 1), pass(x, y, 1, 1), pass(x, y, -1, 1)});
    }
  return out;
}

// Names of one edge, from above to below, so that none lies over another.
void spread(std::vector<PlateLabel>& labels, std::vector<float>& rows, float gap, float top,
            float bottom) {
  std::ranges::sort(labels, {}, &PlateLabel::y);
  rows.clear();
  for (const PlateLabel& label : labels)
    rows.push_back(std::max(label.y, rows.empty() ? top : rows.back() + gap));
  float limit = bottom;
  for (std::size_t k = rows.size(); k-- > 0; limit = rows[k] - gap)
    rows[k] = std::min(rows[k], limit);
}

Vec3f ink_on(const Image& picture, int x, int y) {
  const std::uint8_t* p =
      picture.pixel(std::clamp(x, 0, picture.width - 1), std::clamp(y, 0, picture.height - 1));
  const bool dark = !picture.transparent && 2 * p[0] + 5 * p[1] + p[2] < 8 * 100;
  return dark ? Vec3f(0.95f, 0.95f, 0.93f) : Vec3f(0.10f, 0.10f, 0.11f);
}

struct Pen {
  Vec3f ink;
  float width;  // of lines, pixels

  // around letters and lines, which lie over light and dark
  Vec3f halo() const { return ink.x() > 0.5f ? Vec3f(0.1f, 0.1f, 0.1f) : Vec3f(1, 1, 1); }
};

void write_name(Image& picture, const std::string& text, float x, float y, TextStyle style,
                const Pen& pen) {
  const float around = 0.08f * style.size;
  style.color = pen.halo();
  style.opacity = 0.35f;
  for (const float dx : {-around, 0.0f, around})
    for (const float dy : {-around, 0.0f, around})
      if (dx != 0 || dy != 0) draw_text(picture, text, x + dx, y + dy, style);
  style.color = pen.ink;
  style.opacity = 1;
  draw_text(picture, text, x, y, style);
}

// From a name by a bend to its part.
void draw_leader(Image& picture, const Eigen::Vector2f& from, const Eigen::Vector2f& bend,
                 const Eigen::Vector2f& to, const Pen& pen) {
  for (const bool halo : {true, false}) {
    const Vec3f color = halo ? pen.halo() : pen.ink;
    const float width = halo ? 3 * pen.width : pen.width, opacity = halo ? 0.5f : 1.0f;
    draw_line(picture, from.x(), from.y(), bend.x(), bend.y(), width, color, opacity);
    draw_line(picture, bend.x(), bend.y(), to.x(), to.y(), width, color, opacity);
    const float half = (halo ? 2.2f : 1.2f) * pen.width;
    fill_field(picture, to.x() - half, to.y() - half, 2 * half, 2 * half, color, opacity);
  }
}

}  // namespace

std::vector<PartPlace> seen_places(const DrawList& list, float aspect,
                                   std::span<const std::uint32_t> parts) {
  const PartBuffer buffer(list, aspect);
  const std::vector<int> distances = edge_distances(buffer);
  struct Best {
    int distance = 0, x = 0, y = 0, pixels = 0;
  };
  std::map<std::uint32_t, Best> found;
  for (int y = 0; y < buffer.height(); ++y)
    for (int x = 0; x < buffer.width(); ++x) {
      const std::uint32_t part = buffer.part(x, y);
      if (part == 0 || !std::ranges::binary_search(parts, part)) continue;
      Best& best = found[part];
      ++best.pixels;
      const int distance = distances[std::size_t(y * buffer.width() + x)];
      if (distance > best.distance) best = {distance, x, y, best.pixels};
    }
  std::vector<PartPlace> out;
  for (const auto& [part, best] : found)
    if (best.pixels >= kFewPixels)
      out.push_back({part, (float(best.x) + 0.5f) / float(buffer.width()),
                     (float(best.y) + 0.5f) / float(buffer.height()), best.pixels});
  return out;
}

std::vector<PlateLabel> plate_labels(const Anatomy& anatomy, std::span<const PartPlace> places) {
  std::map<std::string, const PartPlace*> largest;
  for (const PartPlace& place : places) {
    std::string text = part_label(anatomy, place.part);
    for (const char* side : {", left", ", right"})
      if (text.ends_with(side)) text.resize(text.size() - std::string(side).size());
    const PartPlace*& best = largest[text];
    if (!best || best->pixels < place.pixels) best = &place;
  }
  std::vector<PlateLabel> out;
  for (const auto& [text, place] : largest) out.push_back({text, place->x, place->y});
  return out;
}

void draw_labels(Image& picture, std::vector<PlateLabel> labels) {
  if (labels.empty()) return;
  const float width = float(picture.width), height = float(picture.height);
  for (PlateLabel& label : labels) label.x *= width, label.y *= height;
  std::ranges::sort(labels, {}, &PlateLabel::x);
  const std::size_t half = (labels.size() + 1) / 2;
  std::vector<PlateLabel> columns[2]{{labels.begin(), labels.begin() + std::ptrdiff_t(half)},
                                     {labels.begin() + std::ptrdiff_t(half), labels.end()}};
  const float size = std::min(kLargest * height, 0.96f * height / (float(half) * kLeading));
  const float edge = kEdge * width, line = std::max(1.0f, kLineWidth * height);
  std::vector<float> rows;
  for (const int side : {0, 1}) {
    spread(columns[side], rows, kLeading * size, 1.2f * size, height - 0.6f * size);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const PlateLabel& label = columns[side][k];
      const float column = side == 0 ? edge : width - edge, away = side == 0 ? 1.0f : -1.0f;
      const float end = column + away * (text_width(label.text, size) + 0.4f * size);
      const float row = rows[k] - 0.33f * size;  // through the middle of small letters
      const Pen pen{ink_on(picture, int(column), int(row)), line};
      write_name(picture, label.text, column, rows[k],
                 {.size = size, .align = side == 0 ? Align::left : Align::right}, pen);
      const float bend = end + away * size;
      draw_leader(picture, {end, row}, {bend, row}, {label.x, label.y}, pen);
    }
  }
}

}  // namespace ecorche
