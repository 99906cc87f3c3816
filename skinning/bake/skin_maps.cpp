#include "skinning/bake/skin_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <tuple>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kMargin = 4;            // texels that go on beyond seams
constexpr double kLeastRange = 1e-4;  // m
// Cosine between the normals, at least: a map cannot show what faces inwards.
constexpr double kSteepest = 0.1;

using Row2 = Eigen::RowVector2f;

// Vertices with one place on the texture each: those on seams are split.
struct Split {
  std::vector<int> vertex;  // #T, of the skin
  std::vector<int> corner;  // 3 #F, of these
};

Split split_at_seams(const DetailedSkin& skin) {
  Split out;
  std::map<std::tuple<int, float, float>, int> found;
  for (std::size_t c = 0; c < skin.corners.size(); ++c) {
    const int v = skin.smooth.F(Eigen::Index(c / 3), Eigen::Index(c % 3));
    const auto [at, fresh] =
        found.try_emplace({v, skin.corners[c][0], skin.corners[c][1]}, int(out.vertex.size()));
    if (fresh) out.vertex.push_back(v);
    out.corner.push_back(at->second);
  }
  return out;
}

// Directions on the skin in which the texture goes right and up, #T: perpendicular to the normal
// and each other.
struct Frames {
  std::vector<Vec3> right, up;
};

Frames texture_frames(const DetailedSkin& skin, const Split& split, const Points& normals) {
  const auto& [V, F] = skin.smooth;
  Frames out{std::vector<Vec3>(split.vertex.size(), Vec3::Zero()),
             std::vector<Vec3>(split.vertex.size(), Vec3::Zero())};
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const std::size_t c = 3 * std::size_t(f);
    const Eigen::RowVector2d a = (skin.corners[c + 1] - skin.corners[c]).cast<double>(),
                             b = (skin.corners[c + 2] - skin.corners[c]).cast<double>();
    const double sign = a[0] * b[1] - a[1] * b[0] > 0 ? 1 : -1;
    const Vec3 p = V.row(F(f, 1)) - V.row(F(f, 0)), q = V.row(F(f, 2)) - V.row(F(f, 0));
    for (std::size_t k = 0; k < 3; ++k) {
      out.right[std::size_t(split.corner[c + k])] += sign * (b[1] * p - a[1] * q);
      out.up[std::size_t(split.corner[c + k])] += sign * (a[0] * q - b[0] * p);
    }
  }
  for (std::size_t i = 0; i < split.vertex.size(); ++i) {
    const Vec3 n = normals.row(split.vertex[i]);
    Vec3& t = out.right[i];
    t -= t.dot(n) * n;
    t = t.norm() > 1e-12 ? Vec3(t.normalized()) : Vec3(n.unitOrthogonal());
    const Vec3 b = n.cross(t);
    out.up[i] = out.up[i].dot(b) < 0 ? Vec3(-b) : b;
  }
  return out;
}

// Displacement and normal in the texture's frame, #T x 4.
using Details = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;
Details details_of(const DetailedSkin& skin, const Split& split) {
  const Points smooth = vertex_normals(skin.smooth),
               detailed = vertex_normals({skin.detailed, skin.smooth.F});
  const Frames frames = texture_frames(skin, split, smooth);
  Details out(Eigen::Index(split.vertex.size()), 4);
  for (std::size_t i = 0; i < split.vertex.size(); ++i) {
    const int v = split.vertex[i];
    const Vec3 n = smooth.row(v), m = detailed.row(v);
    const double by = (skin.detailed.row(v) - skin.smooth.V.row(v)).dot(smooth.row(v));
    out.row(Eigen::Index(i)) << float(by), float(m.dot(frames.right[i])),
        float(m.dot(frames.up[i])), float(std::max(m.dot(n), kSteepest));
  }
  return out;
}

struct Canvas {
  int size;
  std::vector<Eigen::RowVector4f> texels;
  std::vector<char> filled;
};

void draw_triangle(const std::array<Row2, 3>& at, const std::array<Eigen::RowVector4f, 3>& value,
                   Canvas& canvas) {
  const Row2 a = at[1] - at[0], b = at[2] - at[0];
  const float area = a[0] * b[1] - a[1] * b[0];
  if (std::abs(area) < 1e-12f) return;
  const auto low = [&](int k) {
    return std::max(0, int(std::floor(std::min({at[0][k], at[1][k], at[2][k]}) - 0.5f)));
  };
  const auto high = [&](int k) {
    return std::min(canvas.size - 1, int(std::ceil(std::max({at[0][k], at[1][k], at[2][k]}))));
  };
  for (int y = low(1); y <= high(1); ++y)
    for (int x = low(0); x <= high(0); ++x) {
      const Row2 p = Row2(float(x) + 0.5f, float(y) + 0.5f) - at[0];
      const float s = (p[0] * b[1] - p[1] * b[0]) / area, t = (a[0] * p[1] - a[1] * p[0]) / area;
      constexpr float kEdge = -1e-4f;
      if (s < kEdge || t < kEdge || s + t > 1 - kEdge) continue;
      const std::size_t i = std::size_t(y) * std::size_t(canvas.size) + std::size_t(x);
      canvas.texels[i] = (1 - s - t) * value[0] + s * value[1] + t * value[2];
      canvas.filled[i] = 1;
    }
}

// Empty texels next to filled ones take their mean.
void grow(Canvas& canvas) {
  const std::vector<char> filled = canvas.filled;
  const int n = canvas.size;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(n) + std::size_t(x);
      if (filled[i]) continue;
      Eigen::RowVector4f sum = Eigen::RowVector4f::Zero();
      int count = 0;
      for (int k = 0; k < 9; ++k) {
        const int u = x + k % 3 - 1, w = y + k / 3 - 1;
        if (u < 0 || w < 0 || u >= n || w >= n) continue;
        const std::size_t j = std::size_t(w) * std::size_t(n) + std::size_t(u);
        if (!filled[j]) continue;
        sum += canvas.texels[j];
        ++count;
      }
      if (count == 0) continue;
      canvas.texels[i] = sum / float(count);
      canvas.filled[i] = 1;
    }
}

std::uint8_t to_byte(float value) {  // of -1 .. 1, 0 is 128
  return std::uint8_t(std::clamp(std::lround(128 + 127 * value), 0L, 255L));
}

}  // namespace

SkinMaps skin_maps(const DetailedSkin& skin, int size) {
  const Triangles& F = skin.smooth.F;
  if (size <= 0 || skin.detailed.rows() != skin.smooth.V.rows() ||
      Eigen::Index(skin.corners.size()) != 3 * F.rows())
    throw std::invalid_argument("skin_maps: skins, corners or size do not go together");
  const Split split = split_at_seams(skin);
  const Details details = details_of(skin, split);
  const std::size_t count = std::size_t(size) * std::size_t(size);
  Canvas canvas{size, std::vector<Eigen::RowVector4f>(count, Eigen::RowVector4f(0, 0, 0, 1)),
                std::vector<char>(count, 0)};
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    std::array<Row2, 3> at;
    std::array<Eigen::RowVector4f, 3> value;
    for (std::size_t k = 0; k < 3; ++k) {
      const Row2& corner = skin.corners[3 * std::size_t(f) + k];
      at[k] = float(size) * Row2(corner[0], 1 - corner[1]);
      value[k] = details.row(split.corner[3 * std::size_t(f) + k]);
    }
    draw_triangle(at, value, canvas);
  }
  for (int step = 0; step < kMargin; ++step) grow(canvas);
  SkinMaps out;
  out.size = size;
  out.range = std::max(kLeastRange, double(details.col(0).cwiseAbs().maxCoeff()));
  for (const Eigen::RowVector4f& texel : canvas.texels) {
    const Eigen::RowVector3f n = texel.tail<3>().normalized();
    for (int k = 0; k < 3; ++k) out.normals.push_back(to_byte(n[k]));
    out.displacement.push_back(to_byte(texel[0] / float(out.range)));
  }
  return out;
}

}  // namespace ecorche::inline v1
