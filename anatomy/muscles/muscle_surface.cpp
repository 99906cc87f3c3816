#include "anatomy/muscles/muscle_surface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAtOnce = 4096;  // vertices that one thread places
constexpr int kCapRings = 2;   // between the last slice and the pole
constexpr int kRimSteps =
    kOutlinePoints / 2;      // of a sheet's rounded edge, from its upper to its lower side
constexpr int kBetween = 2;  // columns between two neighbouring strips of a sheet

class Builder {
 public:
  explicit Builder(MuscleSurface& out) : out_(out) {}

  int vertex_count() const { return int(out_.muscle.size()); }
  int face_count() const { return int(faces_.size()) / 3; }

  // Terms may repeat a slice; they are kept as given.
  int vertex(int muscle, std::span<const MuscleSurface::Term> terms, double angle, double belly,
             double along) {
    out_.terms.insert(out_.terms.end(), terms.begin(), terms.end());
    out_.term_begin.push_back(int(out_.terms.size()));
    out_.muscle.push_back(muscle);
    const auto most =
        std::max_element(terms.begin(), terms.end(),
                         [](const auto& a, const auto& b) { return a.weight < b.weight; });
    out_.slice.push_back(most->slice);
    out_.angle.push_back(float(angle));
    out_.belly.push_back(float(belly));
    out_.along.push_back(float(along));
    return vertex_count() - 1;
  }

  void face(int a, int b, int c) {
    faces_.push_back(a);
    faces_.push_back(b);
    faces_.push_back(c);
  }
  // Between ring `low` and ring `high` of n vertices each, `high` further along the tangent.
  void rings(int low, int high, int n) {
    for (int i = 0; i < n; ++i) {
      const int j = (i + 1) % n;
      face(low + i, low + j, high + i);
      face(low + j, high + j, high + i);
    }
  }

  void finish() { out_.F = Eigen::Map<const Triangles>(faces_.data(), face_count(), 3); }

 private:
  MuscleSurface& out_;
  std::vector<int> faces_;
};

// `angle`: eccentric, of the outline's factor.
MuscleSurface::Term term(int slice, double weight, double u, double v, double w, double angle) {
  const float place = angle / (2 * kPi) * kOutlinePoints;
  const float turns = std::floor(place / kOutlinePoints),
              whole = std::round(place - kOutlinePoints * turns);
  const float rest = place - kOutlinePoints * turns;
  // on a direction it is that direction's alone
  const float near = std::abs(rest - whole) < 1e-4f ? whole : rest;
  return {slice, float(weight), float(u), float(v), float(w), near < kOutlinePoints ? near : 0};
}

// Shares of four points in a row, at `u` from the second to the third on the Catmull-Rom curve
// through them. Where there is no first or last, the line goes on through the others.
std::array<double, 4> spline_shares(double u, bool first, bool last) {
  const double u2 = u * u, u3 = u2 * u;
  std::array<double, 4> out{0.5 * (-u3 + 2 * u2 - u), 0.5 * (3 * u3 - 5 * u2 + 2),
                            0.5 * (-3 * u3 + 4 * u2 + u), 0.5 * (u3 - u2)};
  if (!first) out[1] += 2 * out[0], out[2] -= out[0], out[0] = 0;
  if (!last) out[2] += 2 * out[3], out[1] -= out[3], out[3] = 0;
  return out;
}

// A place along a strip: the slice before it, and the way to the next one.
struct Place {
  int slice = 0;
  double share = 0;
};

Place place_at(double at, int slices) {
  const int slice = std::min(int(at), slices - 2);
  return {slice, at - slice};
}

// Calls act(slice, share) with the slices that a place lies between.
template <typename Act>
void each_share(Place place, int slices, bool smooth, Act act) {
  const auto [k, u] = place;
  std::array<double, 4> shares{0, 1 - u, u, 0};
  if (smooth) shares = spline_shares(u, k > 0, k + 2 < slices);
  for (int j = 0; j < 4; ++j)
    if (std::abs(shares[std::size_t(j)]) > 1e-9) act(k - 1 + j, shares[std::size_t(j)]);
}

double s_at(const Strip& strip, Place place) {
  const double begin = strip.slices[std::size_t(place.slice)].s,
               end = strip.slices[std::size_t(place.slice) + 1].s;
  return begin + place.share * (end - begin);
}

// Of a strip with a raphe, for each section: 1 where its width axis leads away from the mid-plane,
// -1 where it leads there.
std::vector<double> lateral_widths(const Strip& strip, Side side) {
  std::vector<double> out;
  if (strip.raphe <= 0 || side == Side::middle) return out;
  for (const Ellipse& slice : rest_slices(strip))
    out.push_back((slice.axes(0, 0) > 0) == (side == Side::left) ? 1 : -1);
  return out;
}

void add_tube(Builder& build, int muscle, Side side, const Strip& strip, int first_slice,
              const MuscleSurfaceOptions& options) {
  const int slices = strip.slices.size(), points = options.points_per_slice,
            steps = options.rows_between + 1, rows = (slices - 1) * steps + 1;
  const std::vector<double> lateral = lateral_widths(strip, side);
  std::vector<MuscleSurface::Term> terms;
  const auto ring = [&](int row, double flat, double out) {
    const int begin = build.vertex_count();
    const Place place = place_at(double(row) / steps, slices);
    const double s = s_at(strip, place);
    for (int i = 0; i < points; ++i) {
      const double angle = 2 * kPi * i / points;
      terms.clear();
      double width_share = lateral.empty() ? 1 : 0;
      each_share(place, slices, true, [&](int k, double share) {
        terms.push_back(term(first_slice + k, share, flat * std::cos(angle), flat * std::sin(angle),
                             out, angle));
        if (!lateral.empty())
          width_share += share * 0.5 * (1 + lateral[std::size_t(k)] * std::cos(angle));
      });
      build.vertex(muscle, terms, angle, flesh_weight(strip, s, width_share), s);
    }
    return begin;
  };
  const auto pole = [&](int k, double out) {
    const MuscleSurface::Term t = term(first_slice + k, 1, 0, 0, out, 0);
    return build.vertex(muscle, {&t, 1}, 0, flesh_weight(strip, strip.slices[k].s),
                        strip.slices[k].s);
  };
  const int low = pole(0, -1);
  std::vector<int> rings;
  for (int c = kCapRings; c > 0; --c) {
    const double a = 0.5 * kPi * c / (kCapRings + 1);
    rings.push_back(ring(0, std::cos(a), -std::sin(a)));
  }
  for (int row = 0; row < rows; ++row) rings.push_back(ring(row, 1, 0));
  for (int c = 1; c <= kCapRings; ++c) {
    const double a = 0.5 * kPi * c / (kCapRings + 1);
    rings.push_back(ring(rows - 1, std::cos(a), std::sin(a)));
  }
  const int high = pole(slices - 1, 1);
  for (int i = 0; i < points; ++i) build.face(low, rings[0] + (i + 1) % points, rings[0] + i);
  for (size_t r = 0; r + 1 < rings.size(); ++r) build.rings(rings[r], rings[r + 1], points);
  for (int i = 0; i < points; ++i)
    build.face(high, rings.back() + i, rings.back() + (i + 1) % points);
}

// The strips of a sheet in the order in which they lie, each with the sign of its width that points
// on along that order.
struct SheetOrder {
  std::vector<int> strip;  // index among the muscle's strips
  std::vector<double> sign;
};

double gap(const std::vector<std::vector<Ellipse>>& strips, int a, int b) {
  double sum = 0;
  for (int q = 0; q <= 4; ++q) {
    const auto at = [&](int i) -> const Vec3& {
      return strips[i][(strips[i].size() - 1) * q / 4].center;
    };
    sum += (at(a) - at(b)).norm();
  }
  return sum;
}

SheetOrder order_strips(const std::vector<std::vector<Ellipse>>& strips) {
  const int n = strips.size();
  const auto length = [&](const std::vector<int>& order) {
    double sum = 0;
    for (int i = 0; i + 1 < n; ++i) sum += gap(strips, order[i], order[i + 1]);
    return sum;
  };
  SheetOrder best;
  for (int i = 0; i < n; ++i) best.strip.push_back(i);
  // the author's order stands unless another is clearly better
  double shortest = 0.8 * length(best.strip);
  for (int start = 0; start < n; ++start) {
    std::vector<int> order{start};
    std::vector<bool> used(n, false);
    used[start] = true;
    while (int(order.size()) < n) {
      int next = -1;
      for (int i = 0; i < n; ++i)
        if (!used[i] &&
            (next < 0 || gap(strips, order.back(), i) < gap(strips, order.back(), next)))
          next = i;
      used[next] = true;
      order.push_back(next);
    }
    if (length(order) < shortest) {
      shortest = length(order);
      best.strip = order;
    }
  }
  for (int i = 0; i < n; ++i) {
    const auto& own = strips[best.strip[i]];
    const auto& low = strips[best.strip[std::max(i - 1, 0)]];
    const auto& high = strips[best.strip[std::min(i + 1, n - 1)]];
    double votes = 0;
    for (size_t k = 0; k < own.size(); ++k) {
      const auto at = [&](const std::vector<Ellipse>& other) -> const Vec3& {
        return other[(other.size() - 1) * k / (own.size() - 1)].center;
      };
      votes += own[k].axes.col(0).dot(at(high) - at(low));
    }
    best.sign.push_back(votes < 0 ? -1 : 1);
  }
  return best;
}

// One surface over the strips: a loop a row runs round the last strip's edge, back over the upper
// sides, round the first strip's edge and along the lower sides. Between strips the sides are
// Catmull-Rom curves through the crests.
class Sheet {
 public:
  Sheet(const Muscle& muscle, const std::vector<std::vector<Ellipse>>& rest,
        std::span<const int> first_slice, double thickness, int rows_between)
      : muscle_(muscle),
        order_(order_strips(rest)),
        first_slice_(first_slice.begin(), first_slice.end()),
        thickness_(thickness),
        smooth_(rows_between > 0) {
    for (const Strip& strip : muscle.strips) rows_ = std::max(rows_, int(strip.slices.size()));
    rows_ = (rows_ - 1) * (rows_between + 1) + 1;
  }

  void add(Builder& build, int index) const {
    std::vector<int> rings;
    int n = 0;
    for (int k = -1; k <= rows_; ++k) {
      const int begin = build.vertex_count();
      const int row = std::clamp(k, 0, rows_ - 1);
      const double flat = k < 0 || k == rows_ ? 0.5 : 1, out = k < 0 ? -0.7 : k == rows_ ? 0.7 : 0;
      loop(build, index, row, flat, out);
      rings.push_back(begin);
      n = build.vertex_count() - begin;
    }
    for (size_t r = 0; r + 1 < rings.size(); ++r) build.rings(rings[r], rings[r + 1], n);
    lid(build, rings.front(), n, false);
    lid(build, rings.back(), n, true);
  }

 private:
  int count() const { return int(order_.strip.size()); }

  const Strip& strip_at(int i) const { return muscle_.strips[order_.strip[i]]; }

  // Of strip `i` (in order) at a row; rows of strips with fewer slices fall between their slices.
  Place place_of(int i, int row) const {
    const int slices = strip_at(i).slices.size();
    return place_at(double(row) * (slices - 1) / (rows_ - 1), slices);
  }

  void add_terms(std::vector<MuscleSurface::Term>& terms, int i, int row, double weight, double u,
                 double v, double w, double angle) const {
    const double sign = order_.sign[i];
    if (sign < 0) angle += kPi;
    each_share(place_of(i, row), strip_at(i).slices.size(), smooth_, [&](int k, double share) {
      terms.push_back(
          term(first_slice_[order_.strip[i]] + k, weight * share, sign * u, sign * v, w, angle));
    });
  }

  void emit(Builder& build, int index, const std::vector<MuscleSurface::Term>& terms, int i,
            int row, double angle) const {
    const double s = s_at(strip_at(i), place_of(i, row));
    build.vertex(index, terms, angle, flesh_weight(strip_at(i), s), s);
  }

  void rim(Builder& build, int index, int i, int row, double flat, double out, double from) const {
    for (int step = 0; step <= kRimSteps; ++step) {
      const double angle = from + kPi * step / kRimSteps;
      std::vector<MuscleSurface::Term> terms;
      add_terms(terms, i, row, 1, std::cos(angle), flat * thickness_ * std::sin(angle), out, angle);
      emit(build, index, terms, i, row, angle);
    }
  }

  // Crest of the sheet's side (+1 upper) between strips i and i + 1.
  void between(Builder& build, int index, int i, double u, int row, double flat, double out,
               int side) const {
    const std::array<double, 4> weight = spline_shares(u, i > 0, i + 2 < count());
    std::vector<MuscleSurface::Term> terms;
    for (int j = 0; j < 4; ++j)
      if (weight[j] != 0)
        add_terms(terms, i - 1 + j, row, weight[j], 0, side * flat * thickness_, out,
                  side * 0.5 * kPi);
    emit(build, index, terms, u < 0.5 ? i : i + 1, row, side * 0.5 * kPi);
  }

  void loop(Builder& build, int index, int row, double flat, double out) const {
    const int n = count();
    rim(build, index, n - 1, row, flat, out, -0.5 * kPi);
    for (int i = n - 2; i >= 0; --i) {
      for (int q = kBetween; q >= 1; --q)
        between(build, index, i, double(q) / (kBetween + 1), row, flat, out, 1);
      if (i > 0) crest(build, index, i, row, flat, out, 1);
    }
    rim(build, index, 0, row, flat, out, 0.5 * kPi);
    for (int i = 0; i + 1 < n; ++i) {
      if (i > 0) crest(build, index, i, row, flat, out, -1);
      for (int q = 1; q <= kBetween; ++q)
        between(build, index, i, double(q) / (kBetween + 1), row, flat, out, -1);
    }
  }

  void crest(Builder& build, int index, int i, int row, double flat, double out, int side) const {
    std::vector<MuscleSurface::Term> terms;
    add_terms(terms, i, row, 1, 0, side * flat * thickness_, out, side * 0.5 * kPi);
    emit(build, index, terms, i, row, side * 0.5 * kPi);
  }

  // Closes an end by a zip between the upper and lower sides; the loop starts at the lower end of
  // the last strip's rim.
  void lid(Builder& build, int begin, int n, bool high) const {
    // the loop vertex at the rim's tip; upper side onward, lower side backward
    const int middle = kRimSteps / 2;
    const auto upper = [&](int j) { return begin + (middle + j) % n; };
    const auto lower = [&](int j) { return begin + (middle - j + n) % n; };
    const auto face = [&](int a, int b, int c) {
      high ? build.face(a, b, c) : build.face(a, c, b);
    };
    for (int j = 0; j < n / 2; ++j) {
      if (j > 0) face(upper(j), upper(j + 1), lower(j));
      if (j + 1 < n / 2) face(upper(j + 1), lower(j + 1), lower(j));
    }
  }

  const Muscle& muscle_;
  SheetOrder order_;
  std::vector<int> first_slice_;
  double thickness_;
  bool smooth_;
  int rows_ = 2;
};

struct Frame {
  Vec3 center, width, thickness, tangent;
};

Frame frame_of(const Ellipse& e) {
  return {e.center, e.radii.x() * e.axes.col(0), e.radii.y() * e.axes.col(1),
          std::min(e.radii.x(), e.radii.y()) * e.axes.col(2)};
}

template <typename Positions>
void evaluate(const MuscleSurface& surface, std::span<const Ellipse> slices, Positions& positions) {
  using Scalar = typename Positions::Scalar;
  positions.resize(surface.vertices(), 3);
  const tbb::blocked_range<int> all(0, surface.vertices(), kAtOnce);
  tbb::parallel_for(all, [&](const tbb::blocked_range<int>& range) {
    int last = -1;
    Frame f = frame_of(Ellipse());
    for (int i = range.begin(); i < range.end(); ++i) {
      Vec3 p = Vec3::Zero();
      for (int j = surface.term_begin[i]; j < surface.term_begin[i + 1]; ++j) {
        const MuscleSurface::Term& t = surface.terms[j];
        if (t.slice != last) f = frame_of(slices[last = t.slice]);
        const double factor = outline_factor(slices[t.slice].outline, double(t.place));
        p += double(t.weight) *
             (f.center + factor * (double(t.u) * f.width + double(t.v) * f.thickness) +
              double(t.w) * f.tangent);
      }
      positions.row(i) = p.transpose().cast<Scalar>();
    }
  });
}

// Thickness that gives the sheet its strips' volume at rest: the enclosed volume is nearly a line
// in it. Outlines do not count, so that a section that makes room for its neighbours does so on the
// drawn surface too.
double sheet_thickness(const Muscle& muscle, const std::vector<std::vector<Ellipse>>& rest) {
  std::vector<Ellipse> slices;
  std::vector<int> first;
  double wanted = 0;
  for (auto strip : rest) {
    for (Ellipse& slice : strip) slice.outline = kEllipticOutline;
    first.push_back(int(slices.size()));
    slices.insert(slices.end(), strip.begin(), strip.end());
    wanted += tube_volume(strip);
  }
  const auto volume = [&](double thickness) {
    MuscleSurface surface;
    surface.term_begin.push_back(0);
    Builder build(surface);
    Sheet(muscle, rest, first, thickness, 0).add(build, 0);
    build.finish();
    Points positions;
    evaluate(surface, slices, positions);
    const MuscleSurface::Part part{0, 0, surface.vertices(), 0, int(surface.F.rows()), true};
    return part_volume(surface, part, positions);
  };
  const double half = volume(0.5), whole = volume(1);
  if (!(whole > half)) return 1;
  return std::clamp(0.5 + 0.5 * (wanted - half) / (whole - half), 0.4, 1.5);
}

// Of one muscle, whose slices begin at `slice`.
MuscleSurface surface_of(const Muscle& muscle, int number, int slice,
                         const MuscleSurfaceOptions& options) {
  MuscleSurface surface;
  surface.term_begin.push_back(0);
  Builder build(surface);
  std::vector<std::vector<Ellipse>> rest;
  std::vector<int> first;
  for (const Strip& strip : muscle.strips) {
    rest.push_back(rest_slices(strip));
    first.push_back(slice);
    slice += int(strip.slices.size());
  }
  MuscleSurface::Part part;
  part.muscle = number;
  part.sheet = options.loft_sheets && muscle.sheet && muscle.strips.size() > 1;
  if (part.sheet) {
    part.thickness = float(sheet_thickness(muscle, rest));
    Sheet(muscle, rest, first, double(part.thickness), options.rows_between)
        .add(build, part.muscle);
  } else {
    for (size_t i = 0; i < muscle.strips.size(); ++i)
      add_tube(build, part.muscle, muscle.side, muscle.strips[i], first[i], options);
  }
  part.vertex_end = build.vertex_count();
  part.face_end = build.face_count();
  surface.parts.push_back(part);
  build.finish();
  return surface;
}

// One surface behind the other.
MuscleSurface joined(std::span<const MuscleSurface> surfaces) {
  MuscleSurface out;
  out.term_begin.push_back(0);
  Eigen::Index faces = 0;
  for (const MuscleSurface& own : surfaces) faces += own.F.rows();
  out.F.resize(faces, 3);
  faces = 0;
  const auto append = [](const auto& from, auto& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const MuscleSurface& own : surfaces) {
    const int vertices = out.vertices(), terms = int(out.terms.size());
    for (std::size_t v = 1; v < own.term_begin.size(); ++v)
      out.term_begin.push_back(terms + own.term_begin[v]);
    append(own.terms, out.terms);
    append(own.muscle, out.muscle);
    append(own.slice, out.slice);
    append(own.angle, out.angle);
    append(own.belly, out.belly);
    append(own.along, out.along);
    for (MuscleSurface::Part part : own.parts) {
      part.vertex_begin += vertices, part.vertex_end += vertices;
      part.face_begin += int(faces), part.face_end += int(faces);
      out.parts.push_back(part);
    }
    out.F.middleRows(faces, own.F.rows()) = own.F.array() + vertices;
    faces += own.F.rows();
  }
  return out;
}

}  // namespace

MuscleSurface make_muscle_surface(const Anatomy& anatomy, const MuscleSurfaceOptions& options) {
  if (options.points_per_slice < 8 || options.points_per_slice > 64 ||
      options.points_per_slice % 2 != 0)
    throw std::invalid_argument("make_muscle_surface: " + std::to_string(options.points_per_slice) +
                                " points a slice, need an even 8 .. 64");
  if (options.rows_between < 0 || options.rows_between > 8)
    throw std::invalid_argument("make_muscle_surface: " + std::to_string(options.rows_between) +
                                " rows between slices, need 0 .. 8");
  std::vector<int> slices{0};
  for (const Muscle& muscle : anatomy.muscles) {
    slices.push_back(slices.back());
    for (const Strip& strip : muscle.strips) slices.back() += int(strip.slices.size());
  }
  std::vector<MuscleSurface> own(anatomy.muscles.size());
  tbb::parallel_for(std::size_t{0}, own.size(), [&](std::size_t m) {
    own[m] = surface_of(anatomy.muscles[m], int(m), slices[m], options);
  });
  return joined(own);
}

void update_muscle_surface(const MuscleSurface& surface, const PosedAnatomy& posed,
                           PointsF& positions, PointsF* normals) {
  evaluate(surface, posed.slices, positions);
  if (normals) find_normals(surface.F, positions, *normals);
}

void update_muscle_surface(const MuscleSurface& surface, const PosedAnatomy& posed,
                           Points& positions) {
  evaluate(surface, posed.slices, positions);
}

void update_muscle_surface(const MuscleSurface& surface, std::span<const Ellipse> slices,
                           Points& positions) {
  evaluate(surface, slices, positions);
}

void find_normals(const Triangles& F, const PointsF& positions, PointsF& normals) {
  normals.setZero(positions.rows(), 3);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const int a = F(f, 0), b = F(f, 1), c = F(f, 2);
    const Eigen::RowVector3f ab = positions.row(b) - positions.row(a),
                             ac = positions.row(c) - positions.row(a);
    const Eigen::RowVector3f n = ab.cross(ac);
    normals.row(a) += n;
    normals.row(b) += n;
    normals.row(c) += n;
  }
  for (Eigen::Index i = 0; i < normals.rows(); ++i)
    normals.row(i) /= std::max(normals.row(i).norm(), 1e-20f);
}

double part_volume(const MuscleSurface& surface, const MuscleSurface::Part& part,
                   const Points& positions) {
  if (part.vertex_end <= part.vertex_begin) return 0;
  const Vec3 base = positions.row(part.vertex_begin).transpose();  // near the part, for accuracy
  double volume = 0;
  for (int f = part.face_begin; f < part.face_end; ++f) {
    const Vec3 a = positions.row(surface.F(f, 0)).transpose() - base,
               b = positions.row(surface.F(f, 1)).transpose() - base;
    const Vec3 c = positions.row(surface.F(f, 2)).transpose() - base;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

TriMesh part_mesh(const MuscleSurface& surface, const MuscleSurface::Part& part,
                  const Points& positions) {
  TriMesh mesh;
  mesh.V = positions.middleRows(part.vertex_begin, part.vertex_end - part.vertex_begin);
  mesh.F = surface.F.middleRows(part.face_begin, part.face_end - part.face_begin).array() -
           part.vertex_begin;
  return mesh;
}

}  // namespace ecorche::inline v1
