#include "anatomy/contact/muscle_contact.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/contact/section_levels.h"

namespace ecorche {
namespace {

// bellies that have parted half-way swell back a part of it: so much more is taken
constexpr float kOver = 2.3f;
// Again:
constexpr float kOverAgain = 3;
// of the area that a section has left: a belly that loses much swells in its ends, which stick out
constexpr float kLeastAgain = 0.6f;
// on all sides: what is pressed from many again and again would grow thin and long where it is free
constexpr float kHeldAgain = 0.3f;
// of all muscles' volume: who was to give less is not looked at once more,
constexpr float kDeep = 2e-5f;
constexpr float kSurelyDeep = 4e-5f;  // and by all from here on
// Where a section is asked:
constexpr float kEarly = 0.3f;        // of the way to the outline
constexpr float kThrough = 4;         // how fast a piercing ray counts, per level
constexpr float kLeastStart = 0.05f;  // level from which a ray begins
constexpr std::size_t kLanesAtOnce = 8;
constexpr std::size_t kAhead = 8;  // pairs that memory is asked for ahead
constexpr std::size_t kRun = 512;  // members that a thread looks at

inline const ContactShape& shape_of(const ContactMemory& memory, int member) {
  return *memory.shapes[member];
}

inline void fetch(const ContactSection& section) {
  __builtin_prefetch(&section);
  __builtin_prefetch(reinterpret_cast<const char*>(&section) + 64);
}

// Where the own section lies in the other's measures. False where its outline stays off all that
// the other meets.
inline bool measure(const ContactMemory& memory, int own, int other, ContactMeeting& out) {
  const ContactSection &a = memory.sections[own], &b = memory.sections[other];
  const OutlineBox& box = shape_of(memory, own).box;
  const Four x = load_as<Four>(b.to_measures[0]), y = load_as<Four>(b.to_measures[1]),
             z = load_as<Four>(b.to_measures[2]);
  const Four at = (a.center[0] - b.center[0]) * x + (a.center[1] - b.center[1]) * y +
                  (a.center[2] - b.center[2]) * z;
  const Four u = a.width[0] * x + a.width[1] * y + a.width[2] * z;
  const Four v = a.thickness[0] * x + a.thickness[1] * y + a.thickness[2] * z;
  const Four right = box.right * u, left = -box.left * u, up = box.up * v, down = -box.down * v;
  const Four least = at + smaller(right, left) + smaller(up, down),
             most = at + larger(right, left) + larger(up, down);
  const TwoMasks off = (TwoMasks)((least > load_as<Four>(b.high)) | (most < -load_as<Four>(b.low)));
  store(at, out.center);
  store(u, out.width);
  store(v, out.thickness);
  return (off[0] | off[1]) == 0;
}

// What a pair, or pairs, say of the own section's rays: the share of the outline's factor to give,
// and how little it may grow.
struct Answer {
  Eight press{}, near{};
};

// Asks the other where the own section's rays are: how deep that is in it, and how much its word
// counts.
inline Answer ask(const ContactMemory& memory, const ContactMeeting& m) {
  const ContactShape &own = shape_of(memory, m.own), &asked = shape_of(memory, m.other);
  const ContactSection& other = memory.sections[m.other];
  const float x0 = m.center[0], y0 = m.center[1];
  const Eight u = load(own.along_width.data()), v = load(own.along_thickness.data()), zero{},
              one = all(1);
  const Eight ex = u * m.width[0] + v * m.thickness[0], ey = u * m.width[1] + v * m.thickness[1];
  // Where the ray has passed the other's line already, the nearest place on its way counts.
  const Eight passing = -(x0 * ex + y0 * ey) / (ex * ex + ey * ey + 1e-12f);
  const Eight early =
      1 -
      larger(passing, zero) *
          ((1 - kEarly) / kEarly);  // begun beside the other's line, it is past it from the start
  const Eight at = passing > kEarly ? smaller(passing, one) : early;
  const Eight z = m.center[2] + at * (u * m.width[2] + v * m.thickness[2]);
  const Eight within = larger(1 - larger(z * other.high[3], -z * other.low[3]), zero);
  const auto [over, under] = level_parts(asked, x0 + at * ex, y0 + at * ey);
  const Eight level = over / under;
  const Eight deep = larger(1 - level, zero), through = larger(1 - kThrough * (1 - at), zero),
              sure = smaller(kThrough * deep, one);
  const Eight counts = within * (sure + (1 - sure) * through);
  const float start = m.center[3];
  // both times `under`, so that one division need not wait for the other
  const Eight share = at * under;
  const Eight back =
      over < under ? 1 - start * share / (share + larger(start * under - over, zero)) : zero;
  return {counts * back,
          counts * larger(smaller((1 + kNearLevels - level) * (1 / kNearLevels), one), zero)};
}

// What eight shapes say of levels.
struct EightShapes {
  std::array<Eight, 9> waves;
  struct {
    Eight high_free, high_steep, low_free, low_steep;
  } sides;
};

// Levels of the middles of the own sections in those that they meet, eight at once.
void set_starts(const ContactMemory& memory, std::span<ContactMeeting> meetings) {
  for (std::size_t k = 0; k < meetings.size(); k += kLanesAtOnce) {
    std::array<Eight, kLanesAtOnce> first, rest;
    Eight x{}, y{};
    for (std::size_t i = 0; i < kLanesAtOnce; ++i) {
      const ContactMeeting& m = meetings[std::min(k + i, meetings.size() - 1)];
      const ContactShape& asked = shape_of(memory, m.other);
      first[i] = load(asked.waves.data());
      const Four sides = load_as<Four>(&asked.sides.high_free);
      rest[i] = Eight{sides[0], sides[1], sides[2], sides[3], asked.waves[8]};
      x[i] = m.center[0];
      y[i] = m.center[1];
    }
    transpose(first);
    transpose(rest);
    const EightShapes shapes{
        {first[0], first[1], first[2], first[3], first[4], first[5], first[6], first[7], rest[4]},
        {rest[0], rest[1], rest[2], rest[3]}};
    const Eight start = larger(level_of(shapes, x, y), all(kLeastStart));
    for (std::size_t i = 0; i < kLanesAtOnce && k + i < meetings.size(); ++i)
      meetings[k + i].center[3] = start[i];
  }
}

inline Four own_ball(const ContactMemory& memory, int own) {
  return load_as<Four>(memory.own_balls[own].data());
}

// What another's ball lies apart from this, and their radii together.
inline Four apart(const ContactMemory& memory, Four ball, int other) {
  return load_as<Four>(memory.balls[other].data()) - ball;
}

inline bool in_reach(const ContactMemory& memory, int own, int other) {
  const Four d = apart(memory, own_ball(memory, own), other);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < d[3] * d[3];
}

// The same of eight others.
inline EightMasks in_reach(const ContactMemory& memory, Four ball, const int* others) {
  std::array<Eight, 4> rows;
  for (std::size_t i = 0; i < 4; ++i)
    rows[i] = __builtin_shufflevector(apart(memory, ball, others[i]),
                                      apart(memory, ball, others[i + 4]), 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight xy0 = __builtin_shufflevector(rows[0], rows[1], 0, 8, 1, 9, 4, 12, 5, 13),
              xy2 = __builtin_shufflevector(rows[2], rows[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight zr0 = __builtin_shufflevector(rows[0], rows[1], 2, 10, 3, 11, 6, 14, 7, 15),
              zr2 = __builtin_shufflevector(rows[2], rows[3], 2, 10, 3, 11, 6, 14, 7, 15);
  const auto low = [](Eight a, Eight b) {
    return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  };
  const auto high = [](Eight a, Eight b) {
    return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  };
  const Eight x = low(xy0, xy2), y = high(xy0, xy2), z = low(zr0, zr2), reach = high(zr0, zr2);
  return x * x + y * y + z * z < reach * reach;
}

// Pairs of a member whose balls touch. Each step keeps what it passes on without a branch: which do
// is as good as chance.
std::size_t find_near(const ContactTable& table, const ContactMemory& memory, int own,
                      ContactPair* near) {
  constexpr int eight = kLanesAtOnce;
  const EightMasks places = {0, 1, 2, 3, 4, 5, 6, 7};
  const Four ball = own_ball(memory, own);
  const int end = table.first_pairs[own + 1];
  std::size_t count = 0;
  for (int k = table.first_pairs[own]; k < end; k += eight) {
    const EightMasks touch = in_reach(memory, ball, &table.others[k]) & (places < end - k);
    for (int i = 0; i < eight; ++i) {
      near[count] = {own, k + i};
      count -= std::ptrdiff_t(touch[i]);
    }
  }
  return count;
}

inline bool deep(const ContactMemory& memory, std::size_t member) {
  return memory.deep[member] > kDeep;
}

// Three coordinates, and none.
inline Four floats(const double* p, const Vec3& origin = Vec3::Zero()) {
  return Four{float(p[0] - origin[0]), float(p[1] - origin[1]), float(p[2] - origin[2]), 0};
}
void look_at(const ContactTable& table, std::span<const Ellipse> slices, const Vec3& origin,
             std::size_t begin, std::size_t end, ContactMemory& memory) {
  const auto distance = [&](int k) {
    return float((slices[k + 1].center - slices[k].center).norm());
  };
  float after = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const ContactMember& member = table.members[i];
    const ContactShape& shape = *memory.shapes[i];
    __builtin_prefetch(&memory.shapes[std::min(i + kAhead, end - 1)]->box);
    const Ellipse& e = slices[member.section];
    ContactSection& s = memory.sections[i];
    const bool follows = i > begin && table.members[i - 1].section + 1 == member.section;
    const float before = member.first ? 0 : follows ? after : distance(member.section - 1);
    after = member.last ? 0 : distance(member.section);
    const float a = std::max(float(e.radii.x()), 1e-5f),
                b = std::max(member.thickness * float(e.radii.y()), 1e-5f);
    const float end_reach = std::max(0.5f * std::min(a, b), 1e-5f);
    const float back = before > 0 ? std::max(before, 1e-5f) : end_reach,
                on = after > 0 ? std::max(after, 1e-5f) : end_reach;
    const float along = std::max(before, after), x = a * std::max(shape.box.left, shape.box.right),
                y = b * std::max(shape.box.up, shape.box.down);
    // One division and one root for all of them.
    const Four per = 1 / Four{a, b, back, on},
               reach = root(x * x + y * y + Four{0, along * along, 0, 0});
    const Four center = floats(e.center.data(), origin), w = floats(e.axes.data()),
               t = floats(e.axes.data() + 3), n = floats(e.axes.data() + 6);
    const Four per_width = per[0] * w, per_thickness = per[1] * t;
    store(center, s.center);
    store(a * w, s.width);
    store(b * t, s.thickness);
    for (int r = 0; r < 3; ++r)
      store(Four{per_width[r], per_thickness[r], n[r], 0}, s.to_measures[r]);
    store(Four{shape.room.left, shape.room.down, back, per[2]}, s.low);
    store(Four{shape.room.right, shape.room.up, on, per[3]}, s.high);
    memory.own_balls[i] = {s.center[0], s.center[1], s.center[2], -reach[0]};
    memory.balls[i] = {s.center[0], s.center[1], s.center[2], reach[1]};
  }
}

void make_room(const ContactTable& table, ContactMemory& memory) {
  const std::size_t count = table.members.size();
  memory.sections.resize(count);
  memory.shapes.resize(count);
  memory.balls.resize(count);
  memory.own_balls.resize(count);
}

}  // namespace

void look_at_sections(const ContactTable& table, std::span<const Ellipse> slices,
                      const Vec3& origin, ContactMemory& memory, Threads threads) {
  make_room(table, memory);
  each_run(table.members.size(), kRun, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) memory.shapes[i] = &table.shapes[i];
    look_at(table, slices, origin, begin, end, memory);
  });
}

bool press_of(const ContactMemory& memory, int own, int first, int last, ContactSpokes& press,
              ContactSpokes& near) {
  bool met = false;
  Answer sum;
  ContactMeeting m;
  for (int k = first; k <= last; ++k) {
    if (!in_reach(memory, own, k) || !measure(memory, own, k, m)) continue;
    met = true;
    m.own = own;
    m.other = k;
    set_starts(memory, {&m, 1});
    const Answer answer = ask(memory, m);
    sum.press += answer.press;
    sum.near += answer.near;
  }
  if (!met) return false;
  store(sum.press, press.data());
  store(sum.near, near.data());
  return true;
}

float given_volume(const ContactSection& section, const ContactShape& shape,
                   const ContactSpokes& press) {
  const auto square = [](const float* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
  const Eight u = load(shape.along_width.data()), v = load(shape.along_thickness.data());
  const Eight squares = u * u * square(section.width) + v * v * square(section.thickness);
  constexpr float sector = 6.2831853f / kContactPoints;
  return sector * sum(larger(load(press.data()), Eight{}) * squares) * 0.5f *
         (section.low[2] + section.high[2]);
}

namespace {

// Pairs of members first .. last that are near enough to press: of all members, or of those alone
// that were deep enough the last time.
std::span<const ContactMeeting> meetings_of(const ContactTable& table, const ContactMemory& memory,
                                            Parting parting, int first, int last,
                                            ContactWork& work) {
  std::size_t near = 0, met = 0;
  for (int own = first; own < last; ++own)
    if (parting == Parting::all || deep(memory, std::size_t(own)))
      near += find_near(table, memory, own, work.near.data() + near);
  const auto other_of = [&](std::size_t k) { return table.others[work.near[k].pair]; };
  for (std::size_t k = 0; k < near; ++k) {
    fetch(memory.sections[other_of(std::min(k + kAhead, near - 1))]);
    ContactMeeting& m = work.meetings[met];
    m.own = work.near[k].own;
    m.other = other_of(k);
    m.group = table.group_of[work.near[k].pair];
    met += measure(memory, m.own, m.other, m);
    __builtin_prefetch(&shape_of(memory, m.other).waves);
    __builtin_prefetch(&table.groups[m.group].at_rest);
  }
  const std::span<ContactMeeting> meetings{work.meetings.data(), met};
  set_starts(memory, meetings);
  return meetings;
}

// How hard sections are pressed, and what keeps them from growing beside what they meet.
struct Giving {
  float over = 1;
  float least = kLeastArea;  // of a section's area, that is left
  float least_held = 0;
  std::span<const ContactSpokes> held{};  // #sections, or none
  bool again = false;                     // it is kept in mind how deep they were
  Parting parting = Parting::all;
};

// How much of what a section is to give way counts, by how much it was to give the last time. Keeps
// in mind how much that is now.
float counted(const Giving& giving, float now, float& deep) {
  const float before = deep;
  deep = now;
  return giving.parting == Parting::all
             ? 1
             : float(smooth_step(double(kDeep), double(kSurelyDeep), double(before)));
}

// What sections are told by those that they meet. A group's word is the sum of its meetings', and
// of several groups the largest counts. Without a branch: where a group or a section's meetings end
// is as good as chance.
std::span<const ContactPress> presses_of(const ContactTable& table,
                                         std::span<const ContactMeeting> meetings,
                                         const ContactMemory& memory, ContactWork& work) {
  if (meetings.empty()) return {};
  ContactPress* out = work.presses.data() - 1;
  int own = -1, group = -1;
  Eight press{}, near{}, most{}, held{};
  for (const ContactMeeting& m : meetings) {
    const Answer answer = ask(memory, m);
    press = only_if(m.group == group, press) + answer.press;
    near = only_if(m.group == group, near) + answer.near;
    most = larger(only_if(m.own == own, most), press - load(table.groups[m.group].at_rest.data()));
    held = larger(only_if(m.own == own, held), near);
    out += m.own != own;
    own = m.own;
    group = m.group;
    out->own = own;
    store(most, out->press.data());
    store(held, out->near.data());
  }
  return {work.presses.data(), out + 1};
}

// Outlines of sections.
void give_way(const ContactTable& table, std::span<const ContactPress> presses,
              const Giving& giving, std::span<Ellipse> slices, ContactMemory& memory) {
  for (const ContactPress& p : presses) {
    Eight most = load(p.press.data());
    const bool gives = any_above_zero(most);
    if (giving.again) {
      const std::size_t own = p.own;
      const float volume =
          gives ? given_volume(memory.sections[own], shape_of(memory, p.own), p.press) : 0;
      most *= counted(giving, volume / table.whole, memory.deep[own]);
    }
    if (!gives) continue;
    const std::size_t section = table.members[p.own].section;
    Eight held =
        larger(larger(load(table.held[p.own].data()), load(p.near.data())), all(giving.least_held));
    if (!giving.held.empty()) held = larger(held, load(giving.held[section].data()));
    ContactSpokes by, hold;
    store(giving.over * most, by.data());
    store(held, hold.data());
    press_outline(by, hold, slices[section].outline, giving.least);
    memory.changed[section] = 1;
  }
}

// A section writes its own outline alone, and reads what memory has kept of the others.
void give_way(const ContactTable& table, const Giving& giving, std::span<Ellipse> slices,
              ContactMemory& memory, Threads threads) {
  memory.changed.assign(slices.size(), 0);
  if (giving.again && giving.parting == Parting::all) memory.deep.assign(table.members.size(), 0);
  const std::size_t workers = threads == Threads::all ? tbb::this_task_arena::max_concurrency() : 1;
  if (memory.work.size() < workers) memory.work.resize(workers);
  for (ContactWork& work : memory.work) {
    work.near.resize(std::size_t(table.most_pairs) +
                     1);  // one is written before it is known whether it is kept
    work.meetings.resize(table.most_pairs);
    work.presses.resize(table.most_pairs);
  }
  each_run(table.blocks.size() - 1, 1, threads, [&](std::size_t first, std::size_t last) {
    ContactWork& work = memory.work[threads == Threads::all
                                        ? std::size_t(tbb::this_task_arena::current_thread_index())
                                        : 0];
    for (std::size_t b = first; b < last; ++b) {
      const auto meetings =
          meetings_of(table, memory, giving.parting, table.blocks[b], table.blocks[b + 1], work);
      give_way(table, presses_of(table, meetings, memory, work), giving, slices, memory);
    }
  });
}

// Marks those that are asked or ask.
void choose(const ContactTable& table, Parting parting, ContactMemory& memory) {
  memory.chosen.assign(table.members.size(), parting == Parting::all);
  if (parting == Parting::all) return;
  for (std::size_t i = 0; i < table.members.size(); ++i) {
    if (!deep(memory, i)) continue;
    memory.chosen[i] = 1;
    for (int k = table.first_pairs[i]; k < table.first_pairs[i + 1]; ++k)
      memory.chosen[table.others[k]] = 1;
  }
}

// With the outlines that they have now.
void look_at_outlines(const ContactTable& table, std::span<const Ellipse> slices,
                      std::span<const SliceOutline> at_rest, const Vec3& origin, Parting parting,
                      ContactMemory& memory, Threads threads) {
  make_room(table, memory);
  memory.pressed.resize(table.members.size());
  choose(table, parting, memory);
  each_run(table.members.size(), kRun, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = i;
      for (; i < end && memory.chosen[i]; ++i) {
        const std::size_t section = table.members[i].section;
        const SliceOutline& outline = slices[section].outline;
        memory.shapes[i] = &table.shapes[i];
        if (outline == at_rest[section]) continue;
        reshape(table.shapes[i].sides, outline, memory.pressed[i]);
        memory.shapes[i] = &memory.pressed[i];
      }
      look_at(table, slices, origin, first, i, memory);
    }
  });
}

}  // namespace

void give_way_to_neighbours(const ContactTable& table, const Vec3& origin,
                            std::span<Ellipse> slices, ContactMemory& memory, Threads threads) {
  look_at_sections(table, slices, origin, memory, threads);
  give_way(table, {.over = kOver}, slices, memory, threads);
}

void give_way_again(const ContactTable& table, const Vec3& origin,
                    std::span<const SliceOutline> at_rest, std::span<const ContactSpokes> held,
                    Parting parting, std::span<Ellipse> slices, ContactMemory& memory,
                    Threads threads) {
  look_at_outlines(table, slices, at_rest, origin, parting, memory, threads);
  give_way(table, {kOverAgain, kLeastAgain, kHeldAgain, held, true, parting}, slices, memory,
           threads);
}

}  // namespace ecorche
