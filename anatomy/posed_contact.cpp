#include "anatomy/posed_contact.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints, kSpokes = kContactPoints;

constexpr float kMostPress = 0.55f;   // of a factor
constexpr float kNear = 0.2f;         // levels above 1 at which a neighbour keeps a section from growing
constexpr float kLeastFactor = 0.1f;
constexpr float kSheetFree = 0.8f;    // of the half width: from there on a sheet's strip leaves off beside the next one
constexpr float kOver = 1.7f;         // bellies that have parted half-way swell back a part of it: so much more is taken
constexpr float kMostRegrowth = 1.5f; // of the factors that are free
constexpr float kEarly = 0.3f;        // of the way to the outline
constexpr float kThrough = 4;         // how fast a piercing ray counts, per level

struct Directions {
  SliceOutline cosine, sine;
  ContactSpokes spoke_cosine, spoke_sine;
};
const Directions kDirections = [] {
  Directions out;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kCount;
    out.cosine[i] = static_cast<float>(std::cos(angle));
    out.sine[i] = static_cast<float>(std::sin(angle));
    if (i % 2 == 0) out.spoke_cosine[i / 2] = out.cosine[i], out.spoke_sine[i / 2] = out.sine[i];
  }
  return out;
}();

inline float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Eight directions at once: the compiler keeps them in one register where there is one so wide.
typedef float Eight __attribute__((vector_size(32)));
static_assert(sizeof(Eight) == sizeof(ContactSpokes));

inline Eight load(const float* p) {
  Eight v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(Eight v, float* p) { std::memcpy(p, &v, sizeof v); }
inline Eight all(float x) { return Eight{} + x; }
inline Eight larger(Eight a, Eight b) { return a > b ? a : b; }
inline Eight smaller(Eight a, Eight b) { return a < b ? a : b; }
inline Eight root(Eight v) {
  float a[kSpokes];
  store(v, a);
  for (float& x : a) x = std::sqrt(x);
  return load(a);
}

// Level of points given in a section's own measures: 0 on its line, 1 on its outline.
inline Eight level_of(const OutlineWaves& w, int sides, Eight x, Eight y) {
  if (sides != 0) {  // beside a sheet's next strip the section is flat as far as it goes, and then leaves off
    const Eight size = larger(x, -x), flat = 4 * larger(size - kSheetFree, Eight{});
    const Eight high = sides & 2 ? flat : size, low = sides & 1 ? -flat : -size;
    x = x > Eight{} ? high : low;
  }
  const Eight rho = root(x * x + y * y + 1e-12f), per = 1 / rho;
  const Eight c1 = x * per, s1 = y * per;
  const Eight c2 = c1 * c1 - s1 * s1, s2 = 2 * c1 * s1;
  const Eight c3 = c2 * c1 - s2 * s1, s3 = s2 * c1 + c2 * s1;
  const Eight c4 = c2 * c2 - s2 * s2, s4 = 2 * c2 * s2;
  const Eight factor = w[0] + w[1] * c1 + w[2] * c2 + w[3] * c3 + w[4] * c4 + w[5] * s1 + w[6] * s2 + w[7] * s3 + w[8] * s4;
  return rho / larger(factor, all(kLeastFactor));
}

// Whether a section's outline, which lies at x0 and reaches along xa and xb for its own axes, stays below -far or above +further.
inline bool apart(const OutlineBox& own, float x0, float xa, float xb, float further, float far) {
  const float most = (xa > 0 ? own.right : -own.left) * xa + (xb > 0 ? own.up : -own.down) * xb;
  const float least = (xa > 0 ? own.left : -own.right) * xa + (xb > 0 ? own.down : -own.up) * xb;
  return x0 - least > further || x0 + most < -far;
}

// Adds what one section of the other muscle has to say.
inline bool meet(const ContactTable& table, const ContactMemory& memory, int from, int to, float* press, float* near) {
  const auto at_own = static_cast<std::size_t>(from), at_other = static_cast<std::size_t>(to);
  const ContactSection &own = memory.sections[at_own], &other = memory.sections[at_other];
  const OutlineBox &box = table.boxes[at_own], &room = table.boxes[at_other];
  const float away[3] = {own.center[0] - other.center[0], own.center[1] - other.center[1], own.center[2] - other.center[2]};
  const float z0 = dot(away, other.tangent);
  const float za = dot(own.width, other.tangent), zb = dot(own.thickness, other.tangent);
  if (apart(box, z0 * other.per_after, za * other.per_after, zb * other.per_after, 1, 1e9f) || apart(box, z0 * other.per_before, za * other.per_before, zb * other.per_before, 1e9f, 1)) return false;
  const float y0 = dot(away, other.thickness) * other.per_thickness2, ya = dot(own.width, other.thickness) * other.per_thickness2,
              yb = dot(own.thickness, other.thickness) * other.per_thickness2;
  if (apart(box, y0, ya, yb, room.up + kNear, room.down + kNear)) return false;
  const float x0 = dot(away, other.width) * other.per_width2, xa = dot(own.width, other.width) * other.per_width2, xb = dot(own.thickness, other.width) * other.per_width2;
  if (apart(box, x0, xa, xb, room.right + 0.5f, room.left + 0.5f)) return false;
  const OutlineWaves& waves = table.waves[at_other];
  const int sides = table.sides[at_other];
  const float* spokes = table.spokes[at_own].data();
  const Eight start = larger(level_of(waves, sides, all(x0), all(y0)), all(0.05f)), zero{}, one = all(1);
  const Eight f = load(spokes), u = f * load(kDirections.spoke_cosine.data()), v = f * load(kDirections.spoke_sine.data());
  const Eight ex = u * xa + v * xb, ey = u * ya + v * yb;
  // Where the ray has passed the other's line already, the nearest place on its way counts.
  const Eight passing = -(x0 * ex + y0 * ey) / (ex * ex + ey * ey + 1e-12f);
  const Eight early = 1 - larger(passing, zero) * ((1 - kEarly) / kEarly);  // begun beside the other's line, it is past it from the start
  const Eight at = passing > kEarly ? smaller(passing, one) : early;
  const Eight level = level_of(waves, sides, x0 + at * ex, y0 + at * ey);
  const Eight z = z0 + at * (u * za + v * zb);
  const Eight within = larger(1 - larger(z * other.per_after, -z * other.per_before), zero);
  const Eight deep = larger(1 - level, zero), through = larger(1 - kThrough * (1 - at), zero), sure = smaller(kThrough * deep, one);
  const Eight counts = within * (sure + (1 - sure) * through);
  const Eight falls = larger(start - level, zero);
  const Eight back = deep > 0 ? 1 - start * at / (at + falls) : zero;
  store(load(press) + counts * back, press);
  const Eight held = larger(smaller((1 + kNear - level) * (1 / kNear), one), zero);
  store(load(near) + counts * held, near);
  return true;
}

double area_of(const SliceOutline& a, const SliceOutline& b) {
  double sum = 0;
  for (std::size_t i = 0; i < kCount; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[(i + 1) % kCount]);
  return sum;
}

// Gives a pressed outline its area back where it is free to grow.
void give_back(const SliceOutline& before, const SliceOutline& freedom, SliceOutline& outline) {
  SliceOutline more;
  for (std::size_t i = 0; i < kCount; ++i) more[i] = freedom[i] * outline[i];
  const double q0 = area_of(outline, outline) - area_of(before, before), q1 = area_of(outline, more) + area_of(more, outline), q2 = area_of(more, more);
  if (!(q0 < 0)) return;
  const double wish = -2 * q0 / (q1 + std::sqrt(std::max(0.0, q1 * q1 - 4 * q2 * q0)) + 1e-9);
  const float growth = static_cast<float>(wish / (1 + wish / static_cast<double>(kMostRegrowth)));
  for (std::size_t i = 0; i < kCount; ++i) outline[i] += growth * more[i];
}

}  // namespace

OutlineWaves outline_waves(const SliceOutline& outline) {
  OutlineWaves out{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const float f = outline[i] / static_cast<float>(kCount);
    out[0] += f;
    for (std::size_t n = 1; n <= kHarmonics; ++n) {
      out[n] += 2 * f * kDirections.cosine[n * i % kCount];
      out[kHarmonics + n] += 2 * f * kDirections.sine[n * i % kCount];
    }
  }
  return out;
}

OutlineBox outline_box(const SliceOutline& outline) {
  OutlineBox out{0, 0, 0, 0};
  for (std::size_t i = 0; i < kCount; ++i) {
    const float x = outline[i] * kDirections.cosine[i], y = outline[i] * kDirections.sine[i];
    out = {std::max(out.right, x), std::max(out.left, -x), std::max(out.up, y), std::max(out.down, -y)};
  }
  return out;
}

void look_at_sections(const ContactTable& table, std::span<const Ellipse> slices, const Vec3& origin, ContactMemory& memory) {
  memory.sections.resize(slices.size());
  memory.balls.resize(slices.size());
  for (const ContactStrip& strip : table.strips) {
    float before = 0;
    for (int k = strip.begin; k < strip.end; ++k) {
      const Ellipse& e = slices[static_cast<std::size_t>(k)];
      ContactSection& s = memory.sections[static_cast<std::size_t>(k)];
      const float after = k + 1 < strip.end ? static_cast<float>((slices[static_cast<std::size_t>(k) + 1].center - e.center).norm()) : 0;
      const float a = std::max(static_cast<float>(e.radii.x()), 1e-5f), b = std::max(strip.thickness * static_cast<float>(e.radii.y()), 1e-5f);
      for (int r = 0; r < 3; ++r) {
        s.center[r] = static_cast<float>(e.center[r] - origin[r]);
        s.width[r] = a * static_cast<float>(e.axes(r, 0));
        s.thickness[r] = b * static_cast<float>(e.axes(r, 1));
        s.tangent[r] = static_cast<float>(e.axes(r, 2));
      }
      s.per_width2 = 1 / (a * a);
      s.per_thickness2 = 1 / (b * b);
      s.per_before = 1 / std::max(before > 0 ? before : 0.5f * std::min(a, b), 1e-5f);
      s.per_after = 1 / std::max(after > 0 ? after : 0.5f * std::min(a, b), 1e-5f);
      const float along = std::max(before, after);
      const OutlineBox& box = table.boxes[static_cast<std::size_t>(k)];
      s.wide = std::hypot(a * std::max(box.left, box.right), b * std::max(box.up, box.down));
      s.reach = std::sqrt(s.wide * s.wide + along * along);
      memory.balls[static_cast<std::size_t>(k)] = {s.center[0], s.center[1], s.center[2], s.reach};
      before = after;
    }
  }
}

bool press_of(const ContactTable& table, const ContactMemory& memory, const ContactGroup& group, ContactSpokes& press, ContactSpokes& near) {
  const std::array<float, 4>& own = memory.balls[static_cast<std::size_t>(group.own)];
  const float wide = memory.sections[static_cast<std::size_t>(group.own)].wide;
  bool met = false;
  for (int k = group.first; k <= group.last; ++k) {
    const std::array<float, 4>& other = memory.balls[static_cast<std::size_t>(k)];
    const float x = own[0] - other[0], y = own[1] - other[1], z = own[2] - other[2], reach = wide + other[3];
    if (x * x + y * y + z * z >= reach * reach) continue;
    if (!met) press.fill(0), near.fill(0);
    met = meet(table, memory, group.own, k, press.data(), near.data()) || met;
  }
  return met;
}

void press_outline(const ContactSpokes& press, const ContactSpokes& held, SliceOutline& outline) {
  const SliceOutline before = outline;
  SliceOutline freedom;
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::size_t a = i / 2, b = (i + 1) / 2 % kSpokes;  // the same, or those on either side
    const float p = 0.5f * (press[a] + press[b]);
    outline[i] *= 1 - p / (1 + p * (1 / kMostPress - 1));
    freedom[i] = std::max(1 - 0.5f * (held[a] + held[b]), 0.0f);
  }
  give_back(before, freedom, outline);
}

void give_way_to_neighbours(const ContactTable& table, const Vec3& origin, std::span<Ellipse> slices, ContactMemory& memory) {
  memory.changed.assign(slices.size(), 0);
  look_at_sections(table, slices, origin, memory);
  ContactSpokes press, near, most, held;
  for (std::size_t o = 0; o < table.owners.size(); ++o) {
    most.fill(0);
    held.fill(0);
    for (int g = table.owner_begin[o]; g < table.owner_begin[o + 1]; ++g) {
      const ContactGroup& group = table.groups[static_cast<std::size_t>(g)];
      if (!press_of(table, memory, group, press, near)) continue;
      for (std::size_t i = 0; i < kSpokes; ++i) {
        most[i] = std::max(most[i], press[i] - group.at_rest[i]);
        held[i] = std::max(held[i], near[i]);
      }
    }
    if (!(*std::max_element(most.begin(), most.end()) > 0)) continue;
    const auto k = static_cast<std::size_t>(table.owners[o]);
    for (float& p : most) p *= kOver;
    press_outline(most, held, slices[k].outline);
    memory.changed[k] = 1;
  }
}

}  // namespace ecorche
