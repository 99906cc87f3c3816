#include "anatomy/posed_contact.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints, kSpokes = kContactPoints;

constexpr float kMostPress = 0.85f;   // of a factor
constexpr float kNear = 0.2f;         // levels above 1 at which a neighbour keeps a section from growing
constexpr float kLeastFactor = 0.1f;
constexpr float kSheetFree = 0.8f;    // of the half width: from there on a sheet's strip leaves off beside the next one,
constexpr float kSheetSteep = 4;      // so many times as fast
constexpr float kOver = 2.3f;         // bellies that have parted half-way swell back a part of it: so much more is taken
constexpr float kMostRegrowth = 1.5f; // of the factors that are free
// The second time:
constexpr float kOverAgain = 3;
constexpr float kLeastAgain = 0.6f;   // of the area that a section has left: a belly that loses much swells in its ends, which stick out
constexpr float kHeldAgain = 0.8f;    // on all sides: what is pressed twice from many would grow thin and long where it is free
constexpr float kEarly = 0.3f;        // of the way to the outline
constexpr float kThrough = 4;         // how fast a piercing ray counts, per level
constexpr int kRoomDirections = 64;
constexpr float kRoomMargin = 1.02f;  // for what lies between them,
constexpr float kFewMargin = 1.06f;   // or between the outline's own

struct Directions {
  SliceOutline cosine, sine;
};
const Directions kDirections = [] {
  Directions out;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kCount;
    out.cosine[i] = static_cast<float>(std::cos(angle));
    out.sine[i] = static_cast<float>(std::sin(angle));
  }
  return out;
}();

// Eight directions at once, or the three measures: the compiler keeps them in one register where there is one so wide.
typedef float Eight __attribute__((vector_size(32)));
typedef float Four __attribute__((vector_size(16)));
typedef std::int64_t FourMasks __attribute__((vector_size(32)));
typedef std::int64_t TwoMasks __attribute__((vector_size(16)));
static_assert(sizeof(Eight) == sizeof(ContactSpokes));

template <class V>
inline V load_as(const float* p) {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline Eight load(const float* p) { return load_as<Eight>(p); }
template <class V>
inline void store(V v, float* p) {
  std::memcpy(p, &v, sizeof v);
}
inline Eight all(float x) { return Eight{} + x; }
template <class V>
inline V larger(V a, V b) {
  return a > b ? a : b;
}
template <class V>
inline V smaller(V a, V b) {
  return a < b ? a : b;
}
inline bool any_above_zero(Eight v) {
  const FourMasks m = (FourMasks)(v > 0);
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
inline Eight root(Eight v) {
  for (std::size_t i = 0; i < kSpokes; ++i) v[i] = std::sqrt(v[i]);
  return v;
}

inline const ContactShape& shape_of(const ContactMemory& memory, int member) { return *memory.shapes[static_cast<std::size_t>(member)]; }

inline void fetch(const ContactSection& section) {
  __builtin_prefetch(&section);
  __builtin_prefetch(reinterpret_cast<const char*>(&section) + 64);
}

// Level of points given in a section's own measures: 0 on its line, 1 on its outline.
inline Eight level_of(const ContactShape& shape, Eight x, Eight y) {
  const OutlineWaves& w = shape.waves;
  const SheetSides& sides = shape.sides;
  x = sides.high_steep * larger(x - sides.high_free, Eight{}) + sides.low_steep * smaller(x + sides.low_free, Eight{});
  // The factor times the fourth power of the radius, by powers of x + i y, so that one root and one division do.
  const Eight xx = x * x, yy = y * y, square = xx + yy + 1e-12f, rho = root(square);
  const Eight re2 = xx - yy, im2 = 2 * x * y, re3 = re2 * x - im2 * y, im3 = im2 * x + re2 * y, re4 = re2 * re2 - im2 * im2, im4 = 2 * re2 * im2;
  const Eight even = square * (square * w[0] + re2 * w[2] + im2 * w[6]) + re4 * w[4] + im4 * w[8];
  const Eight odd = square * (x * w[1] + y * w[5]) + re3 * w[3] + im3 * w[7];
  const Eight fourth = square * square;
  return rho * fourth / larger(even + rho * odd, kLeastFactor * fourth);
}

// Where the own section lies in the other's measures. False where its outline stays off all that the other meets.
inline bool measure(const ContactMemory& memory, int own, int other, ContactMeeting& out) {
  const ContactSection &a = memory.sections[static_cast<std::size_t>(own)], &b = memory.sections[static_cast<std::size_t>(other)];
  const OutlineBox& box = shape_of(memory, own).box;
  const Four x = load_as<Four>(b.to_measures[0]), y = load_as<Four>(b.to_measures[1]), z = load_as<Four>(b.to_measures[2]);
  const Four at = (a.center[0] - b.center[0]) * x + (a.center[1] - b.center[1]) * y + (a.center[2] - b.center[2]) * z;
  const Four u = a.width[0] * x + a.width[1] * y + a.width[2] * z;
  const Four v = a.thickness[0] * x + a.thickness[1] * y + a.thickness[2] * z;
  const Four right = box.right * u, left = -box.left * u, up = box.up * v, down = -box.down * v;
  const Four least = at + smaller(right, left) + smaller(up, down), most = at + larger(right, left) + larger(up, down);
  const TwoMasks off = (TwoMasks)((least > load_as<Four>(b.high)) | (most < -load_as<Four>(b.low)));
  store(at, out.center);
  store(u, out.width);
  store(v, out.thickness);
  return (off[0] | off[1]) == 0;
}

// What a pair, or pairs, say of the own section's rays: the share of the outline's factor to give, and how little it may grow.
struct Answer {
  Eight press{}, near{};
  bool presses = false;
};

// Asks the other where the own section's rays are: how deep that is in it, and how much its word counts.
inline void ask(const ContactMemory& memory, const ContactMeeting& m, Answer& sum) {
  const ContactShape &own = shape_of(memory, m.own), &asked = shape_of(memory, m.other);
  const ContactSection& other = memory.sections[static_cast<std::size_t>(m.other)];
  const float x0 = m.center[0], y0 = m.center[1];
  const Eight u = load(own.along_width.data()), v = load(own.along_thickness.data()), zero{}, one = all(1);
  const Eight ex = u * m.width[0] + v * m.thickness[0], ey = u * m.width[1] + v * m.thickness[1];
  // Where the ray has passed the other's line already, the nearest place on its way counts.
  const Eight passing = -(x0 * ex + y0 * ey) / (ex * ex + ey * ey + 1e-12f);
  const Eight early = 1 - larger(passing, zero) * ((1 - kEarly) / kEarly);  // begun beside the other's line, it is past it from the start
  const Eight at = passing > kEarly ? smaller(passing, one) : early;
  const Eight z = m.center[2] + at * (u * m.width[2] + v * m.thickness[2]);
  const Eight within = larger(1 - larger(z * other.high[3], -z * other.low[3]), zero);
  const Eight level = level_of(asked, x0 + at * ex, y0 + at * ey);
  const Eight deep = larger(1 - level, zero), through = larger(1 - kThrough * (1 - at), zero), sure = smaller(kThrough * deep, one);
  const Eight counts = within * (sure + (1 - sure) * through);
  sum.near += counts * larger(smaller((1 + kNear - level) * (1 / kNear), one), zero);
  if (!any_above_zero(counts * deep)) return;
  const Eight start = larger(level_of(asked, all(x0), all(y0)), all(0.05f));
  const Eight back = level < 1 ? 1 - start * at / (at + larger(start - level, zero)) : zero;
  sum.press += counts * back;
  sum.presses = true;
}

inline bool in_reach(const ContactMemory& memory, int at_own, int at_other) {
  const std::array<float, 4>&own = memory.balls[static_cast<std::size_t>(at_own)], &other = memory.balls[static_cast<std::size_t>(at_other)];
  const float x = own[0] - other[0], y = own[1] - other[1], z = own[2] - other[2];
  const float reach = memory.wide[static_cast<std::size_t>(at_own)] + other[3];
  return x * x + y * y + z * z < reach * reach;
}

// An outline by its even and its odd directions.
struct Halves {
  Eight even, odd;
};

inline Eight next(Eight v) { return __builtin_shufflevector(v, v, 1, 2, 3, 4, 5, 6, 7, 0); }

inline Halves halves(const SliceOutline& outline) {
  const Eight low = load(outline.data()), high = load(outline.data() + kSpokes);
  return {__builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14), __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15)};
}

inline float sum(Eight v) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); }

// Area, or that of two mixed, over the sine between directions.
inline float area_of(const Halves& a, const Halves& b) { return sum(a.even * b.odd + a.odd * next(b.even)); }

// Gives a pressed outline its area back where it is free to grow.
inline void give_back(const Halves& before, const Halves& freedom, float least, Halves& outline) {
  const Halves more{freedom.even * outline.even, freedom.odd * outline.odd};
  const float lost = area_of(before, before) - area_of(outline, outline), once = area_of(outline, more) + area_of(more, outline), twice = area_of(more, more);
  if (!(lost > 0)) return;
  const float wish = 2 * lost / (once + std::sqrt(once * once + 4 * twice * lost) + 1e-9f);
  const float growth = wish / (1 + wish / kMostRegrowth);
  outline.even += growth * more.even;
  outline.odd += growth * more.odd;
  const float area = area_of(outline, outline), missing = least * area_of(before, before) - area;
  if (missing <= 0) return;
  // It goes no farther than that leaves so much: were it to swell as a whole, what is free would stick out far.
  const Halves back{before.even - outline.even, before.odd - outline.odd};
  const float first = area_of(outline, back) + area_of(back, outline), second = area_of(back, back);
  const float share = 2 * missing / (first + std::sqrt(std::max(first * first + 4 * second * missing, 0.0f)) + 1e-9f);
  outline.even += share * back.even;
  outline.odd += share * back.odd;
}

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

// What a section asks others with.
void set_spokes(const SliceOutline& outline, ContactShape& out) {
  out.box = {0, 0, 0, 0};
  for (std::size_t i = 0; i < kSpokes; ++i) {
    const float x = out.along_width[i] = outline[2 * i] * kDirections.cosine[2 * i], y = out.along_thickness[i] = outline[2 * i] * kDirections.sine[2 * i];
    out.box = {std::max(out.box.right, x), std::max(out.box.left, -x), std::max(out.box.up, y), std::max(out.box.down, -y)};
  }
}

void add_room(float x, float y, OutlineBox& room) {
  room = {std::max(room.right, x), std::max(room.left, -x), std::max(room.up, y), std::max(room.down, -y)};
}

// The room of a tube that leaves off beside its sheet's next strip.
void narrow_room(const SheetSides& sides, OutlineBox& room) {
  if (sides.low_steep != 1) room.left = sides.low_free + room.left / sides.low_steep;
  if (sides.high_steep != 1) room.right = sides.high_free + room.right / sides.high_steep;
}

// A section's shape with another outline than at rest.
void reshape(const SheetSides& sides, const SliceOutline& outline, ContactShape& out) {
  out.waves = outline_waves(outline);
  set_spokes(outline, out);
  out.room = {0, 0, 0, 0};
  out.sides = {};
  for (const float sign : {1.0f, -1.0f}) {
    const Eight x = sign * load(kDirections.cosine.data()), y = sign * load(kDirections.sine.data());
    const Eight far = kFewMargin * (1 + kNear) / level_of(out, x, y);
    for (std::size_t i = 0; i < kSpokes; ++i) add_room(far[i] * x[i], far[i] * y[i], out.room);
  }
  out.sides = sides;
  narrow_room(sides, out.room);
}

}  // namespace

ContactShape contact_shape(const SliceOutline& outline, int sides) {
  ContactShape out;
  out.waves = outline_waves(outline);
  set_spokes(outline, out);
  out.room = {0, 0, 0, 0};
  for (int i = 0; i < kRoomDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRoomDirections;
    const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const float far = kRoomMargin * (1 + kNear) / level_of(out, all(c), all(s))[0];
    add_room(far * c, far * s, out.room);
  }
  if (sides & 1) out.sides.low_free = kSheetFree, out.sides.low_steep = kSheetSteep;
  if (sides & 2) out.sides.high_free = kSheetFree, out.sides.high_steep = kSheetSteep;
  narrow_room(out.sides, out.room);
  return out;
}

namespace {

// Three coordinates, and none.
inline Four floats(const double* p, const Vec3& origin = Vec3::Zero()) {
  return Four{static_cast<float>(p[0] - origin[0]), static_cast<float>(p[1] - origin[1]), static_cast<float>(p[2] - origin[2]), 0};
}

// Do(first, last) for all members, on this thread or on all.
template <class Do>
void each_run(const ContactTable& table, int threads, const Do& act) {
  constexpr std::size_t kRun = 512;
  if (threads <= 1) return act(0, table.members.size());
  // Isolated: while it waits, this thread must not begin another pose in the same memory.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, table.members.size(), kRun), [&](const auto& some) { act(some.begin(), some.end()); });
  });
}

void look_at(const ContactTable& table, std::span<const Ellipse> slices, const Vec3& origin, std::size_t begin, std::size_t end, ContactMemory& memory) {
  const auto distance = [&](int k) { return static_cast<float>((slices[static_cast<std::size_t>(k) + 1].center - slices[static_cast<std::size_t>(k)].center).norm()); };
  float after = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const ContactMember& member = table.members[i];
    const ContactShape& shape = *memory.shapes[i];
    const Ellipse& e = slices[static_cast<std::size_t>(member.section)];
    ContactSection& s = memory.sections[i];
    const bool follows = i > begin && table.members[i - 1].section + 1 == member.section;
    const float before = member.first ? 0 : follows ? after : distance(member.section - 1);
    after = member.last ? 0 : distance(member.section);
    const float a = std::max(static_cast<float>(e.radii.x()), 1e-5f), b = std::max(member.thickness * static_cast<float>(e.radii.y()), 1e-5f);
    const float per_a = 1 / a, per_b = 1 / b;
    const Four center = floats(e.center.data(), origin), w = floats(e.axes.data()), t = floats(e.axes.data() + 3), n = floats(e.axes.data() + 6);
    store(center, s.center);
    store(a * w, s.width);
    store(b * t, s.thickness);
    for (int r = 0; r < 3; ++r) store(Four{w[r] * per_a, t[r] * per_b, n[r], 0}, s.to_measures[r]);
    const float end_reach = std::max(0.5f * std::min(a, b), 1e-5f);
    const float back = before > 0 ? std::max(before, 1e-5f) : end_reach, on = after > 0 ? std::max(after, 1e-5f) : end_reach;
    store(Four{shape.room.left, shape.room.down, back, 1 / back}, s.low);
    store(Four{shape.room.right, shape.room.up, on, 1 / on}, s.high);
    const float along = std::max(before, after), x = a * std::max(shape.box.left, shape.box.right), y = b * std::max(shape.box.up, shape.box.down);
    memory.wide[i] = std::sqrt(x * x + y * y);
    memory.balls[i] = {s.center[0], s.center[1], s.center[2], std::sqrt(x * x + y * y + along * along)};
  }
}

void make_room(const ContactTable& table, ContactMemory& memory) {
  const std::size_t count = table.members.size();
  memory.sections.resize(count);
  memory.shapes.resize(count);
  memory.balls.resize(count);
  memory.wide.resize(count);
}

}  // namespace

void look_at_sections(const ContactTable& table, std::span<const Ellipse> slices, const Vec3& origin, ContactMemory& memory, int threads) {
  make_room(table, memory);
  each_run(table, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) memory.shapes[i] = &table.shapes[i];
    look_at(table, slices, origin, begin, end, memory);
  });
}

bool press_of(const ContactMemory& memory, int own, int first, int last, ContactSpokes& press, ContactSpokes& near) {
  bool met = false;
  Answer sum;
  ContactMeeting m;
  for (int k = first; k <= last; ++k) {
    if (!in_reach(memory, own, k) || !measure(memory, own, k, m)) continue;
    met = true;
    m.own = own;
    m.other = k;
    ask(memory, m, sum);
  }
  if (!met) return false;
  store(sum.press, press.data());
  store(sum.near, near.data());
  return true;
}

void press_outline(const ContactSpokes& press, const ContactSpokes& held, SliceOutline& outline, float least) {
  static_assert(kCount == 16 && kSpokes == 8);
  const auto left = [](Eight p) { return 1 - p / root(1 + p * p * (1 / (kMostPress * kMostPress))); };
  const Eight p = load(press.data()), h = load(held.data()), zero{};
  const Halves before = halves(outline), freedom{larger(1 - h, zero), larger(1 - 0.5f * (h + next(h)), zero)};
  Halves pressed{before.even * left(p), before.odd * left(0.5f * (p + next(p)))};
  give_back(before, freedom, least, pressed);
  store(__builtin_shufflevector(pressed.even, pressed.odd, 0, 8, 1, 9, 2, 10, 3, 11), outline.data());
  store(__builtin_shufflevector(pressed.even, pressed.odd, 4, 12, 5, 13, 6, 14, 7, 15), outline.data() + kSpokes);
}

namespace {

// Meetings of the pairs begin .. end.
std::span<const ContactMeeting> meetings_of(const ContactTable& table, const ContactMemory& memory, int begin, int end, ContactWork& work) {
  // Each step keeps what it passes on without a branch: which do is as good as chance.
  std::size_t near = 0, met = 0;
  for (int k = begin; k < end; ++k) {
    const ContactPair& pair = table.pairs[static_cast<std::size_t>(k)];
    work.near[near] = k;
    near += in_reach(memory, pair.own, pair.other);
    fetch(memory.sections[static_cast<std::size_t>(pair.other)]);
  }
  for (std::size_t k = 0; k < near; ++k) {
    const ContactPair& pair = table.pairs[static_cast<std::size_t>(work.near[k])];
    ContactMeeting& m = work.meetings[met];
    m.own = pair.own;
    m.other = pair.other;
    m.group = pair.group;
    met += measure(memory, pair.own, pair.other, m);
    __builtin_prefetch(&shape_of(memory, pair.other).waves);
  }
  return {work.meetings.data(), met};
}

// How hard sections are pressed, and what keeps them from growing beside what they meet.
struct Giving {
  float over = 1;
  float least = kLeastArea;               // of a section's area, that is left
  float least_held = 0;
  std::span<const ContactSpokes> held{};  // #sections, or none
};

// Outlines of sections, by their meetings, group after group.
void give_way(const ContactTable& table, std::span<const ContactMeeting> meetings, const Giving& giving, std::span<Ellipse> slices, ContactMemory& memory) {
  std::size_t k = 0;
  while (k < meetings.size()) {
    const int own = meetings[k].own;
    Eight most{}, held = load(table.held[static_cast<std::size_t>(own)].data());
    while (k < meetings.size() && meetings[k].own == own) {
      const int at = meetings[k].group;
      Answer sum;
      for (; k < meetings.size() && meetings[k].group == at; ++k) ask(memory, meetings[k], sum);
      held = larger(held, sum.near);
      if (sum.presses) most = larger(most, sum.press - load(table.groups[static_cast<std::size_t>(at)].at_rest.data()));
    }
    if (!any_above_zero(most)) continue;
    const auto section = static_cast<std::size_t>(table.members[static_cast<std::size_t>(own)].section);
    held = larger(held, all(giving.least_held));
    if (!giving.held.empty()) held = larger(held, load(giving.held[section].data()));
    ContactSpokes by, hold;
    store(giving.over * most, by.data());
    store(held, hold.data());
    press_outline(by, hold, slices[section].outline, giving.least);
    memory.changed[section] = 1;
  }
}

// A section writes its own outline alone, and reads what memory has kept of the others.
void give_way(const ContactTable& table, const Giving& giving, std::span<Ellipse> slices, ContactMemory& memory, int threads) {
  memory.changed.assign(slices.size(), 0);
  const auto workers = static_cast<std::size_t>(threads > 1 ? tbb::this_task_arena::max_concurrency() : 1);
  if (memory.work.size() < workers) memory.work.resize(workers);
  for (ContactWork& work : memory.work) {
    work.near.resize(static_cast<std::size_t>(table.most_pairs));
    work.meetings.resize(static_cast<std::size_t>(table.most_pairs));
  }
  const auto blocks = [&](int first, int last, ContactWork& work) {
    for (int b = first; b < last; ++b) {
      const auto i = static_cast<std::size_t>(b);
      give_way(table, meetings_of(table, memory, table.blocks[i], table.blocks[i + 1], work), giving, slices, memory);
    }
  };
  const int count = static_cast<int>(table.blocks.size()) - 1;
  if (threads <= 1) return blocks(0, count, memory.work[0]);
  // Isolated: while it waits, this thread must not begin another pose in the same memory.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count), [&](const auto& some) {
      blocks(some.begin(), some.end(), memory.work[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())]);
    });
  });
}

// With the outlines that they have now.
void look_at_outlines(const ContactTable& table, std::span<const Ellipse> slices, std::span<const SliceOutline> at_rest, const Vec3& origin, ContactMemory& memory,
                      int threads) {
  make_room(table, memory);
  memory.pressed.resize(table.members.size());
  each_run(table, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto section = static_cast<std::size_t>(table.members[i].section);
      const SliceOutline& outline = slices[section].outline;
      memory.shapes[i] = &table.shapes[i];
      if (outline == at_rest[section]) continue;
      reshape(table.shapes[i].sides, outline, memory.pressed[i]);
      memory.shapes[i] = &memory.pressed[i];
    }
    look_at(table, slices, origin, begin, end, memory);
  });
}

}  // namespace

void give_way_to_neighbours(const ContactTable& table, const Vec3& origin, std::span<Ellipse> slices, ContactMemory& memory, int threads) {
  look_at_sections(table, slices, origin, memory, threads);
  give_way(table, {.over = kOver}, slices, memory, threads);
}

void give_way_again(const ContactTable& table, const Vec3& origin, std::span<const SliceOutline> at_rest, std::span<const ContactSpokes> held,
                    std::span<Ellipse> slices, ContactMemory& memory, int threads) {
  look_at_outlines(table, slices, at_rest, origin, memory, threads);
  give_way(table, {kOverAgain, kLeastAgain, kHeldAgain, held}, slices, memory, threads);
}

}  // namespace ecorche
