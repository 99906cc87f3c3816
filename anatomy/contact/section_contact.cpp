#include "anatomy/contact/section_contact.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/contact/press_outline.h"
#include "anatomy/contact/section_levels.h"
#include "anatomy/contact/section_shape.h"

namespace ecorche::inline v1 {
namespace {

// Response of a pass to penetration.
struct ContactParameters {
  // Factor of the penetration that is removed. Above 1, since bellies that have been cut back swell
  // by a part of it again. Less: overlap stays; more: sections draw apart.
  float relaxation = 1;
  // Least share of a section's area that is left, 0 .. 1. Less: a belly that loses much swells at
  // its ends, which stick out; more: overlap stays.
  float least_area = kLeastArea;
  // Growth blocked in all directions, 0 .. 1. Less: a section that several passes cut grows thin
  // and long where it is free; more: bellies swell as a whole instead.
  float least_blocked = 0;
};
constexpr ContactParameters kFirstPass{.relaxation = 2.3f};
constexpr ContactParameters kLaterPass{.relaxation = 3, .least_area = 0.6f, .least_blocked = 0.3f};

// Volume by which a section must have lain in others, over that of all muscles, to be resolved by a
// deep pass: not at all up to the first, wholly from the second on, smoothly between. Less: slower
// frames; more: overlap stays.
constexpr float kDeep = 2e-5f;
constexpr float kSurelyDeep = 4e-5f;

// Sampling of the other section along an own ray, from the own centre (0) to the outline (1).
// Place up to which a ray that has passed the other's centre line is sampled ever later, up to its
// end: it began beside the line.
constexpr float kEarly = 0.3f;
constexpr float kThrough = 4;         // weight of a ray that pierces the other, per unit of level
constexpr float kLeastStart = 0.05f;  // least level of the own centre

constexpr std::size_t kLanesAtOnce = 8;
constexpr std::size_t kAhead = 8;    // pairs that are prefetched ahead
constexpr std::size_t kGrain = 512;  // members of a task

inline const SectionShape& shape_of(const SectionContactWorkspace& workspace, int member) {
  return *workspace.shapes[member];
}

inline void fetch(const ContactSection& section) {
  __builtin_prefetch(&section);
  __builtin_prefetch(reinterpret_cast<const char*>(&section) + 64);
}

// Sets where the own section lies in the other's coordinates. False where its outline stays off the
// box that the other blocks.
inline bool locate(const SectionContactWorkspace& workspace, int own, int other, ContactPair& out) {
  const ContactSection &a = workspace.sections[own], &b = workspace.sections[other];
  const OutlineBox& box = shape_of(workspace, own).box;
  const Float4 x = load4(b.to_local[0]), y = load4(b.to_local[1]), z = load4(b.to_local[2]);
  const Float4 at = (a.center[0] - b.center[0]) * x + (a.center[1] - b.center[1]) * y +
                    (a.center[2] - b.center[2]) * z;
  const Float4 u = a.width[0] * x + a.width[1] * y + a.width[2] * z;
  const Float4 v = a.thickness[0] * x + a.thickness[1] * y + a.thickness[2] * z;
  const Float4 right = box.right * u, left = -box.left * u, up = box.up * v, down = -box.down * v;
  const Float4 least = at + smaller(right, left) + smaller(up, down),
               most = at + larger(right, left) + larger(up, down);
  const TwoMasks off = (TwoMasks)((least > load4(b.high)) | (most < -load4(b.low)));
  store(at, out.center);
  store(u, out.width);
  store(v, out.thickness);
  return (off[0] | off[1]) == 0;
}

// Of the own section's rays: penetration relative to the outline's factor, and blocked growth.
struct PairContact {
  Float8 penetration{}, blocked{};
};

// Samples the other's level along the own section's rays.
inline PairContact contact_of(const SectionContactWorkspace& workspace, const ContactPair& m) {
  const SectionShape &own = shape_of(workspace, m.own), &probed = shape_of(workspace, m.other);
  const ContactSection& other = workspace.sections[m.other];
  const float x0 = m.center[0], y0 = m.center[1];
  const Float8 u = load8(own.along_width.data()), v = load8(own.along_thickness.data()), zero{},
               one = all8(1);
  const Float8 ex = u * m.width[0] + v * m.thickness[0], ey = u * m.width[1] + v * m.thickness[1];
  // Where the ray has passed the other's centre line, its nearest place to that line counts.
  const Float8 passing = -(x0 * ex + y0 * ey) / (ex * ex + ey * ey + 1e-12f);
  const Float8 early =
      1 - larger(passing, zero) *
              ((1 - kEarly) / kEarly);  // begun beside the other's line, it has passed it at once
  const Float8 at = passing > kEarly ? smaller(passing, one) : early;
  const Float8 z = m.center[2] + at * (u * m.width[2] + v * m.thickness[2]);
  const Float8 within = larger(1 - larger(z * other.high[3], -z * other.low[3]), zero);
  const auto [numerator, denominator] = level_parts(probed, x0 + at * ex, y0 + at * ey);
  const Float8 level = numerator / denominator;
  const Float8 deep = larger(1 - level, zero), through = larger(1 - kThrough * (1 - at), zero),
               sure = smaller(kThrough * deep, one);
  const Float8 counts = within * (sure + (1 - sure) * through);
  const float start = m.center[3];
  // both times the denominator, so that one division need not wait for the other
  const Float8 share = at * denominator;
  const Float8 back =
      numerator < denominator
          ? 1 - start * share / (share + larger(start * denominator - numerator, zero))
          : zero;
  return {counts * back,
          counts * larger(smaller((1 + kNearLevels - level) * (1 / kNearLevels), one), zero)};
}

// Level functions of eight shapes.
struct ShapesX8 {
  std::array<Float8, 9> harmonics;
  struct {
    Float8 high_free, high_steep, low_free, low_steep;
  } sides;
};

// Sets the levels of the own centres in the sections that they meet, eight at once.
void set_starts(const SectionContactWorkspace& workspace, std::span<ContactPair> pairs) {
  for (std::size_t k = 0; k < pairs.size(); k += kLanesAtOnce) {
    std::array<Float8, kLanesAtOnce> first, rest;
    Float8 x{}, y{};
    for (std::size_t i = 0; i < kLanesAtOnce; ++i) {
      const ContactPair& m = pairs[std::min(k + i, pairs.size() - 1)];
      const SectionShape& probed = shape_of(workspace, m.other);
      first[i] = load8(probed.harmonics.data());
      const Float4 sides = load4(&probed.sides.high_free);
      rest[i] = Float8{sides[0], sides[1], sides[2], sides[3], probed.harmonics[8]};
      x[i] = m.center[0];
      y[i] = m.center[1];
    }
    transpose(first);
    transpose(rest);
    const ShapesX8 shapes{
        {first[0], first[1], first[2], first[3], first[4], first[5], first[6], first[7], rest[4]},
        {rest[0], rest[1], rest[2], rest[3]}};
    const Float8 start = larger(level_of(shapes, x, y), all8(kLeastStart));
    for (std::size_t i = 0; i < kLanesAtOnce && k + i < pairs.size(); ++i)
      pairs[k + i].center[3] = start[i];
  }
}

inline Float4 own_sphere(const SectionContactWorkspace& workspace, int own) {
  return load4(workspace.own_spheres[own].data());
}

// Offset of another's sphere from this one, and the sum of their radii.
inline Float4 offset_to(const SectionContactWorkspace& workspace, Float4 sphere, int other) {
  return load4(workspace.spheres[other].data()) - sphere;
}

inline bool in_reach(const SectionContactWorkspace& workspace, int own, int other) {
  const Float4 d = offset_to(workspace, own_sphere(workspace, own), other);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < d[3] * d[3];
}

// The same for eight others.
inline Int8 in_reach(const SectionContactWorkspace& workspace, Float4 sphere, const int* others) {
  std::array<Float8, 4> rows;
  for (std::size_t i = 0; i < 4; ++i)
    rows[i] = __builtin_shufflevector(offset_to(workspace, sphere, others[i]),
                                      offset_to(workspace, sphere, others[i + 4]), 0, 1, 2, 3, 4, 5,
                                      6, 7);
  const Float8 xy0 = __builtin_shufflevector(rows[0], rows[1], 0, 8, 1, 9, 4, 12, 5, 13),
               xy2 = __builtin_shufflevector(rows[2], rows[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Float8 zr0 = __builtin_shufflevector(rows[0], rows[1], 2, 10, 3, 11, 6, 14, 7, 15),
               zr2 = __builtin_shufflevector(rows[2], rows[3], 2, 10, 3, 11, 6, 14, 7, 15);
  const auto low = [](Float8 a, Float8 b) {
    return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  };
  const auto high = [](Float8 a, Float8 b) {
    return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  };
  const Float8 x = low(xy0, xy2), y = high(xy0, xy2), z = low(zr0, zr2), reach = high(zr0, zr2);
  return x * x + y * y + z * z < reach * reach;
}

// Pairs of a member whose spheres touch. Without a branch: which pairs do cannot be predicted.
std::size_t find_near(const ContactCandidates& table, const SectionContactWorkspace& workspace,
                      int own, NearPair* near) {
  constexpr int eight = kLanesAtOnce;
  const Int8 places = {0, 1, 2, 3, 4, 5, 6, 7};
  const Float4 sphere = own_sphere(workspace, own);
  const int end = table.first_pairs[own + 1];
  std::size_t count = 0;
  for (int k = table.first_pairs[own]; k < end; k += eight) {
    const Int8 touch = in_reach(workspace, sphere, &table.others[k]) & (places < end - k);
    for (int i = 0; i < eight; ++i) {
      near[count] = {own, k + i};
      count -= std::ptrdiff_t(touch[i]);
    }
  }
  return count;
}

inline bool is_deep(const ContactState& state, std::size_t member) {
  return state.depth[member] > kDeep;
}

// Three coordinates, and 0.
inline Float4 floats(const double* p, const Vec3& origin = Vec3::Zero()) {
  return Float4{float(p[0] - origin[0]), float(p[1] - origin[1]), float(p[2] - origin[2]), 0};
}
// Sets the sections, with their shapes set.
void place_members(const ContactCandidates& table, std::span<const Ellipse> slices,
                   const Vec3& origin, std::size_t begin, std::size_t end,
                   SectionContactWorkspace& workspace) {
  const auto distance = [&](int k) {
    return float((slices[k + 1].center - slices[k].center).norm());
  };
  float after = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const ContactMember& member = table.members[i];
    const SectionShape& shape = *workspace.shapes[i];
    __builtin_prefetch(&workspace.shapes[std::min(i + kAhead, end - 1)]->box);
    const Ellipse& e = slices[member.section];
    ContactSection& s = workspace.sections[i];
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
    const Float4 per = 1 / Float4{a, b, back, on},
                 reach = root(x * x + y * y + Float4{0, along * along, 0, 0});
    const Float4 center = floats(e.center.data(), origin), w = floats(e.axes.data()),
                 t = floats(e.axes.data() + 3), n = floats(e.axes.data() + 6);
    // Coordinates along axes that are aslant to each other.
    const float aslant = float(e.axes.col(0).dot(e.axes.col(1))), upright = 1 - aslant * aslant;
    const Float4 per_width = per[0] / upright * (w - aslant * t),
                 per_thickness = per[1] / upright * (t - aslant * w);
    store(center, s.center);
    store(a * w, s.width);
    store(b * t, s.thickness);
    for (int r = 0; r < 3; ++r)
      store(Float4{per_width[r], per_thickness[r], n[r], 0}, s.to_local[r]);
    store(Float4{shape.reach.left, shape.reach.down, back, per[2]}, s.low);
    store(Float4{shape.reach.right, shape.reach.up, on, per[3]}, s.high);
    workspace.own_spheres[i] = {s.center[0], s.center[1], s.center[2], -reach[0]};
    workspace.spheres[i] = {s.center[0], s.center[1], s.center[2], reach[1]};
  }
}

void resize(const ContactCandidates& table, SectionContactWorkspace& workspace) {
  const std::size_t count = table.members.size();
  workspace.sections.resize(count);
  workspace.shapes.resize(count);
  workspace.spheres.resize(count);
  workspace.own_spheres.resize(count);
}

}  // namespace

void place_sections(const ContactCandidates& table, std::span<const Ellipse> slices,
                    const Vec3& origin, SectionContactWorkspace& workspace, Threads threads) {
  resize(table, workspace);
  parallel_for_ranges(table.members.size(), kGrain, threads,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i)
                          workspace.shapes[i] = &table.shapes[i];
                        place_members(table, slices, origin, begin, end, workspace);
                      });
}

void find_in_reach(const SectionContactWorkspace& workspace, int own, int first, int last,
                   std::vector<int>& reached) {
  const Float4 sphere = own_sphere(workspace, own);
  reached.clear();
  constexpr int eight = kLanesAtOnce;
  for (int k = first; k <= last; k += eight) {
    std::array<int, kLanesAtOnce> others;
    for (int i = 0; i < eight; ++i) others[i] = std::min(k + i, last);
    const Int8 touch = in_reach(workspace, sphere, others.data());
    for (int i = 0; i < eight && k + i <= last; ++i)
      if (touch[i]) reached.push_back(k + i);
  }
}

bool find_penetration(const SectionContactWorkspace& workspace, int own, int first, int last,
                      RadialSamples& penetration, RadialSamples& blocked) {
  bool met = false;
  PairContact sum;
  ContactPair m;
  for (int k = first; k <= last; ++k) {
    if (!in_reach(workspace, own, k) || !locate(workspace, own, k, m)) continue;
    met = true;
    m.own = own;
    m.other = k;
    set_starts(workspace, {&m, 1});
    const PairContact contact = contact_of(workspace, m);
    sum.penetration += contact.penetration;
    sum.blocked += contact.blocked;
  }
  if (!met) return false;
  store(sum.penetration, penetration.data());
  store(sum.blocked, blocked.data());
  return true;
}

float penetration_volume(const ContactSection& section, const SectionShape& shape,
                         const RadialSamples& penetration) {
  const auto square = [](const float* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
  const Float8 u = load8(shape.along_width.data()), v = load8(shape.along_thickness.data());
  const Float8 squares = u * u * square(section.width) + v * v * square(section.thickness);
  constexpr float sector = 6.2831853f / kContactDirections;
  return sector * sum(larger(load8(penetration.data()), Float8{}) * squares) * 0.5f *
         (section.low[2] + section.high[2]);
}

namespace {

// A pass: its parameters, and what it reads and keeps beside the sections.
struct Pass {
  ContactParameters parameters;
  std::span<const RadialSamples> blocked{};  // #sections, or none
  ContactState* state = nullptr;             // of later passes
  bool deep_only = false;
};

// Pairs of members first .. last that are in contact: of all of them, or of deep ones alone.
std::span<const ContactPair> find_pairs_section_contact(const ContactCandidates& table,
                                                        const SectionContactWorkspace& workspace,
                                                        const Pass& pass, int first, int last,
                                                        ContactThreadWorkspace& local) {
  std::size_t near = 0, met = 0;
  for (int own = first; own < last; ++own)
    if (!pass.deep_only || is_deep(*pass.state, std::size_t(own)))
      near += find_near(table, workspace, own, local.near.data() + near);
  const auto other_of = [&](std::size_t k) { return table.others[local.near[k].pair]; };
  for (std::size_t k = 0; k < near; ++k) {
    fetch(workspace.sections[other_of(std::min(k + kAhead, near - 1))]);
    ContactPair& m = local.pairs[met];
    m.own = local.near[k].own;
    m.other = other_of(k);
    m.group = table.group_of[local.near[k].pair];
    met += locate(workspace, m.own, m.other, m);
    __builtin_prefetch(&shape_of(workspace, m.other).harmonics);
    __builtin_prefetch(&table.groups[m.group].at_rest);
  }
  const std::span<ContactPair> pairs{local.pairs.data(), met};
  set_starts(workspace, pairs);
  return pairs;
}

// Weight of a section's penetration, by its depth in the pass before; sets the depth of this one.
float weight_of(const Pass& pass, float now, float& depth) {
  const float before = depth;
  depth = now;
  return !pass.deep_only ? 1
                         : float(smooth_step(double(kDeep), double(kSurelyDeep), double(before)));
}

// Responses of the sections of these pairs. A group's penetration is the sum of its pairs', and of
// several groups the largest counts. Without a branch: where a group or a section's pairs end
// cannot be predicted.
std::span<const OutlineResponse> find_responses(const ContactCandidates& table,
                                                std::span<const ContactPair> pairs,
                                                const SectionContactWorkspace& workspace,
                                                ContactThreadWorkspace& local) {
  if (pairs.empty()) return {};
  OutlineResponse* out = local.responses.data() - 1;
  int own = -1, group = -1;
  Float8 penetration{}, near{}, most{}, blocked{};
  for (const ContactPair& m : pairs) {
    const PairContact contact = contact_of(workspace, m);
    penetration = only_if(m.group == group, penetration) + contact.penetration;
    near = only_if(m.group == group, near) + contact.blocked;
    most = larger(only_if(m.own == own, most),
                  penetration - load8(table.groups[m.group].at_rest.data()));
    blocked = larger(only_if(m.own == own, blocked), near);
    out += m.own != own;
    own = m.own;
    group = m.group;
    out->own = own;
    store(most, out->penetration.data());
    store(blocked, out->blocked.data());
  }
  return {local.responses.data(), out + 1};
}

// Cuts outlines back.
void respond(const ContactCandidates& table, std::span<const OutlineResponse> responses,
             const Pass& pass, std::span<Ellipse> slices, SectionContactWorkspace& workspace) {
  for (const OutlineResponse& p : responses) {
    Float8 most = load8(p.penetration.data());
    const bool gives = any_above_zero(most);
    if (pass.state) {
      const std::size_t own = p.own;
      const float volume = gives ? penetration_volume(workspace.sections[own],
                                                      shape_of(workspace, p.own), p.penetration)
                                 : 0;
      most *= weight_of(pass, volume / table.total_volume, pass.state->depth[own]);
    }
    if (!gives) continue;
    const std::size_t section = table.members[p.own].section;
    Float8 blocked = larger(larger(load8(table.blocked[p.own].data()), load8(p.blocked.data())),
                            all8(pass.parameters.least_blocked));
    if (!pass.blocked.empty()) blocked = larger(blocked, load8(pass.blocked[section].data()));
    RadialSamples by, still;
    store(pass.parameters.relaxation * most, by.data());
    store(blocked, still.data());
    press_outline(by, still, slices[section].outline, pass.parameters.least_area);
    workspace.changed[section] = 1;
  }
}

// Precondition: placed sections. A section writes its own outline alone, and reads what the
// workspace holds of the others.
void resolve(const ContactCandidates& table, const Pass& pass, std::span<Ellipse> slices,
             SectionContactWorkspace& workspace, Threads threads) {
  workspace.changed.assign(slices.size(), 0);
  const std::size_t workers = threads == Threads::all ? tbb::this_task_arena::max_concurrency() : 1;
  if (workspace.threads.size() < workers) workspace.threads.resize(workers);
  for (ContactThreadWorkspace& local : workspace.threads) {
    local.near.resize(std::size_t(table.most_pairs) +
                      1);  // one is written before it is known whether it is kept
    local.pairs.resize(table.most_pairs);
    local.responses.resize(table.most_pairs);
  }
  parallel_for_ranges(
      table.blocks.size() - 1, 1, threads, [&](std::size_t first, std::size_t last) {
        ContactThreadWorkspace& local =
            workspace.threads[threads == Threads::all
                                  ? std::size_t(tbb::this_task_arena::current_thread_index())
                                  : 0];
        for (std::size_t b = first; b < last; ++b) {
          const auto pairs = find_pairs_section_contact(table, workspace, pass, table.blocks[b],
                                                        table.blocks[b + 1], local);
          respond(table, find_responses(table, pairs, workspace, local), pass, slices, workspace);
        }
      });
}

// Selected sections with the outlines that they have now.
void place_updated(const LaterPass& pass, std::span<const Ellipse> slices,
                   SectionContactWorkspace& workspace, Threads threads) {
  const ContactCandidates& table = pass.candidates;
  resize(table, workspace);
  workspace.updated.resize(table.members.size());
  parallel_for_ranges(
      table.members.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t first = i;
          for (; i < end && workspace.selected[i]; ++i) {
            const std::size_t section = table.members[i].section;
            const SliceOutline& outline = slices[section].outline;
            workspace.shapes[i] = &table.shapes[i];
            if (outline == pass.at_rest[section]) continue;
            update_section_shape(table.shapes[i].sides, outline, workspace.updated[i]);
            workspace.shapes[i] = &workspace.updated[i];
          }
          place_members(table, slices, pass.origin, first, i, workspace);
        }
      });
}

}  // namespace

void select_deep_members(const ContactCandidates& table, const ContactState& state,
                         std::vector<char>& selected) {
  selected.assign(table.members.size(), 0);
  for (std::size_t i = 0; i < table.members.size(); ++i) {
    if (!is_deep(state, i)) continue;
    selected[i] = 1;
    for (int k = table.first_pairs[i]; k < table.first_pairs[i + 1]; ++k)
      selected[table.others[k]] = 1;
  }
}

void resolve_rest_outlines(const ContactCandidates& table, const Vec3& origin,
                           std::span<Ellipse> slices, SectionContactWorkspace& workspace,
                           Threads threads) {
  place_sections(table, slices, origin, workspace, threads);
  resolve(table, {.parameters = kFirstPass}, slices, workspace, threads);
}

void resolve_all_outlines(const LaterPass& pass, std::span<Ellipse> slices, ContactState& state,
                          SectionContactWorkspace& workspace, Threads threads) {
  workspace.selected.assign(pass.candidates.members.size(), 1);
  place_updated(pass, slices, workspace, threads);
  state.depth.assign(pass.candidates.members.size(), 0);
  resolve(pass.candidates, {kLaterPass, pass.blocked, &state, false}, slices, workspace, threads);
}

void resolve_deep_outlines(const LaterPass& pass, std::span<Ellipse> slices, ContactState& state,
                           SectionContactWorkspace& workspace, Threads threads) {
  select_deep_members(pass.candidates, state, workspace.selected);
  place_updated(pass, slices, workspace, threads);
  resolve(pass.candidates, {kLaterPass, pass.blocked, &state, true}, slices, workspace, threads);
}

}  // namespace ecorche::inline v1
