#include "morph/dilation/dilate_muscles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/muscles/action_line.h"
#include "morph/dilation/bone_rays.h"
#include "morph/dilation/close_raphes.h"
#include "morph/dilation/dilate_strip.h"
#include "morph/dilation/lay_wall.h"
#include "morph/dilation/lift_off_bones.h"
#include "morph/dilation/pack_muscles.h"
#include "morph/dilation/packed_sections.h"
#include "morph/dilation/part_from_bones.h"
#include "morph/dilation/pull_inside_skin.h"
#include "morph/dilation/remove_spikes.h"
#include "morph/dilation/restore_layers.h"
#include "morph/dilation/slim_muscles.h"
#include "morph/dilation/straighten_strips.h"
#include "morph/dilation/tissue_stretch.h"

namespace ecorche::inline v1 {

namespace {

// Sections of all muscles in order, made once and written back once: their frames cost as much as
// their rays.
struct Sections {
  std::vector<Ellipse> slices;
  std::vector<std::size_t> muscle_begin;  // #muscles + 1

  std::span<Ellipse> of(std::size_t muscle) {
    return std::span(slices).subspan(muscle_begin[muscle],
                                     muscle_begin[muscle + 1] - muscle_begin[muscle]);
  }
};

// Calls f(strip, its slices) for all strips of a muscle; `slices` are the muscle's.
template <class Function>
void for_strips(std::vector<Strip>& strips, std::span<Ellipse> slices, const Function& f) {
  std::size_t first = 0;
  for (Strip& strip : strips) {
    f(strip, slices.subspan(first, strip.slices.size()));
    first += strip.slices.size();
  }
}

template <class Function>
void for_muscles(std::size_t count, const Function& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4), [&](const auto& range) {
    for (std::size_t m = range.begin(); m < range.end(); ++m) f(m);
  });
}

Sections sections_of(std::vector<Muscle>& muscles) {
  Sections out;
  out.muscle_begin = slice_begins(muscles);
  out.slices.resize(out.muscle_begin.back());
  for_muscles(muscles.size(), [&](std::size_t m) {
    for_strips(muscles[m].strips, out.of(m), [](const Strip& strip, std::span<Ellipse> slices) {
      if (strip.slices.size() >= 2) std::ranges::copy(rest_slices(strip), slices.begin());
    });
  });
  return out;
}

void write_sections(Sections& sections, std::vector<Muscle>& muscles) {
  for_muscles(muscles.size(), [&](std::size_t m) { set_slices(muscles[m], sections.of(m)); });
}

double volume_of(std::vector<Strip>& strips, std::span<Ellipse> slices) {
  double volume = 0;
  for_strips(strips, slices, [&](const Strip&, std::span<Ellipse> some) {
    volume += some.size() >= 2 ? tube_volume(some) : 0;
  });
  return volume;
}

// --- paper -----------------------------------------------------------------------------

// The factor of one muscle: the least (|O S| - layer) / |O E| of all rays. With the cut, a ray ends
// where even the thickest layer could not let it lower the factor; what it misses beyond cannot
// change the result.
double least_factor(std::span<const Ellipse> slices, const SkinRays& rays, const FatLayer& fat,
                    double thickest, std::span<const Vec2> directions, bool cut,
                    StripCount& count) {
  double factor = std::numeric_limits<double>::infinity();
  for (const Ellipse& slice : slices) {
    for (const Vec2& direction : directions) {
      const Vec3 to_edge = slice.axes.leftCols<2>() * slice.radii.cwiseProduct(direction);
      const double edge = to_edge.norm();
      if (edge <= 0) continue;
      const double far = cut ? factor * edge + thickest : std::numeric_limits<double>::infinity();
      const RayHit hit = rays.first_hit(slice.center, to_edge / edge, far);
      ++count.rays;
      if (hit.triangle < 0) {
        count.misses += !std::isfinite(far);
        continue;
      }
      factor =
          std::min(factor, std::max(0.0, double(hit.distance - fat.at(rays.mesh().F, hit))) / edge);
    }
  }
  return std::isfinite(factor) ? factor : 1;
}

void set_radii(std::vector<Strip>& strips, std::span<Ellipse> slices) {
  for_strips(strips, slices, [](Strip& strip, std::span<Ellipse> some) {
    for (std::size_t k = 0; k < some.size(); ++k) strip.slices[k].radii = some[k].radii;
  });
}

void dilate_paper(std::vector<Muscle>& muscles, const std::vector<Muscle>& original,
                  Sections& sections, const SkinRays& rays, const FatLayer& fat,
                  const DilateOptions& options, std::vector<StripCount>& counts,
                  DilateReport& report) {
  const double thickest = *std::max_element(fat.thickness.begin(), fat.thickness.end());
  const std::vector<Vec2> directions = ray_directions(options.rays);
  for_muscles(muscles.size(), [&](std::size_t m) {
    std::size_t s = 0;
    for_strips(muscles[m].strips, sections.of(m),
               [&](const Strip& strip, std::span<Ellipse> slices) {
                 const Strip& from = original[m].strips[s++];
                 const double length_scale =
                     from.rest_length > 0 ? strip.rest_length / from.rest_length : 1;
                 for (std::size_t k = 0; k < slices.size(); ++k)
                   slices[k].radii = options.alpha * length_scale * from.slices[k].radii;
               });
    const double factor =
        least_factor(sections.of(m), rays, fat, thickest, directions, options.cut_rays, counts[m]);
    for (Ellipse& slice : sections.of(m)) slice.radii *= factor;
    set_radii(muscles[m].strips, sections.of(m));
    report.muscles[m].factor = factor;
  });
}

// --- ecorche ---------------------------------------------------------------------------

// At the end of every stage, muscles that are held take the sections that they had then. The
// stretch of the flesh is no stage, nor are muscles lifted off bones by themselves: both hand
// changes on to those around, and take little time.
class Stages {
 public:
  Stages(const DilationTrace& trace, Sections& sections) : trace_(trace), sections_(sections) {}

  void follow() {
    trace_.for_held(sections_.muscle_begin, [&](std::size_t k, std::size_t before) {
      sections_.slices[k] = trace_.before->stages[done_][before];
    });
    ++done_;
    if (trace_.record) trace_.record->stages.push_back(sections_.slices);
  }

 private:
  const DilationTrace& trace_;
  Sections& sections_;
  std::size_t done_ = 0;
};

// Whether the sections of two muscles are each other's mirror images, to a millimetre.
bool are_even(std::span<const Ellipse> left, std::span<const Ellipse> right, double plane) {
  constexpr double kEven = 1e-3;  // m
  return std::ranges::equal(left, right, [plane](const Ellipse& a, const Ellipse& b) {
    const Vec3 image(2 * plane - a.center.x(), a.center.y(), a.center.z());
    return (image - b.center).norm() < kEven && (a.radii - b.radii).norm() < kEven;
  });
}

// For each muscle of the right side its partner on the left, -1 for all others, for those that are
// no mirror images, and where nothing is to be mirrored.
std::vector<int> left_partners(const Anatomy& anatomy, Sections& sections,
                               const DilateOptions& options) {
  std::vector<int> partners(anatomy.muscles.size(), -1);
  if (!options.even_about) return partners;
  for (std::size_t m = 0; m < partners.size(); ++m) {
    const Muscle& muscle = anatomy.muscles[m];
    if (muscle.side != Side::right) continue;
    const int left = find_muscle(anatomy, muscle.name.substr(0, muscle.name.size() - 1) + "l");
    if (left < 0 || anatomy.muscles[left].strips.size() != muscle.strips.size()) continue;
    if (!are_even(sections.of(std::size_t(left)), sections.of(m), *options.even_about)) continue;
    partners[m] = left;
  }
  return partners;
}

void mirror_sections(const std::vector<int>& partners, double plane, Sections& sections) {
  for (std::size_t m = 0; m < partners.size(); ++m) {
    if (partners[m] < 0) continue;
    const std::span<Ellipse> right = sections.of(m), left = sections.of(std::size_t(partners[m]));
    for (std::size_t k = 0; k < right.size() && right.size() == left.size(); ++k) {
      right[k].center = {2 * plane - left[k].center.x(), left[k].center.y(), left[k].center.z()};
      right[k].radii = left[k].radii;
    }
  }
}

void mirror_outlines_of(const std::vector<int>& partners, Sections& sections) {
  for (std::size_t m = 0; m < partners.size(); ++m)
    if (partners[m] >= 0) mirror_outlines(sections.of(std::size_t(partners[m])), sections.of(m));
}

// Ends in fascia go with the flesh, as high over bone among what lies over them as they were.
FreeEnds ends_of(const Muscle& muscle) {
  return {muscle.origin_bone.empty(), muscle.insertion_bone.empty()};
}

// Muscles part from bones and from one another, and are slimmed to what they are to hold.
void share_room(Anatomy& anatomy, const std::vector<Muscle>& original,
                std::span<const Ellipse> carried, Sections& sections,
                const std::vector<int>& partners, const SkinRays& rays, const FatLayer& fat,
                const DilateOptions& options, const DilationTrace& trace, Stages& stages,
                DilateReport& report) {
  std::vector<Muscle>& muscles = anatomy.muscles;
  const std::vector<int> given = trace.with_held(partners);
  std::vector<double> wanted;
  for (const MuscleDilation& muscle : report.muscles) wanted.push_back(muscle.wanted);
  std::shared_ptr<const BoneRays> bones = trace.before ? trace.before->bones : nullptr;
  if (!bones && options.share && !anatomy.bones.empty())
    bones = std::make_shared<const BoneRays>(make_bone_rays(anatomy, options.even_about));
  if (trace.record) trace.record->bones = bones;
  if (bones) {
    lift_off_bones(muscles, sections.slices, carried, partners, *bones, rays);
    mirror_sections(partners, options.even_about.value_or(0), sections);
    stages.follow();
    write_sections(sections, muscles);
  }
  if (options.share) {
    straighten_strips(muscles, original, given, sections.slices);
    mirror_sections(partners, options.even_about.value_or(0), sections);
    close_raphes(muscles, sections.slices);
    write_sections(sections, muscles);
    lay_wall(anatomy, sections.slices, given, rays, bones.get());
    mirror_sections(partners, options.even_about.value_or(0), sections);
    stages.follow();
    write_sections(sections, muscles);
    report.rays +=
        pack_muscles(anatomy, sections.slices, wanted, partners, rays, fat, {}, trace).rays;
  }
  if (options.most_volume)
    slim_muscles(muscles, sections.slices, wanted, partners, *options.most_volume, rays);
  if (options.share) remove_spikes(muscles, original, given, sections.slices);
  mirror_sections(partners, options.even_about.value_or(0), sections);
  mirror_outlines_of(partners, sections);
  write_sections(sections, muscles);
  if (!bones) return;
  std::vector<char> grown(muscles.size(), 1);
  for (std::size_t m = 0; m < muscles.size(); ++m) grown[m] = !trace.holds(m);
  report.rays += pull_inside_skin(muscles, sections.slices, grown, rays).rays;
  part_from_bones(muscles, sections.slices, given, *bones);
  mirror_outlines_of(partners, sections);
  stages.follow();
  write_sections(sections, muscles);
  report.rays += restore_layers(anatomy, sections.slices, given, rays, fat);
  // What was raised over ribs from beneath them holds them now.
  constexpr double kLeftRaised = 0.03;
  part_from_bones(muscles, sections.slices, given, *bones, kLeftRaised);
  mirror_outlines_of(partners, sections);
  // Which of two triangles a ray meets in their common edge depends on how the search tree was
  // built: what that leaves in the last digits goes.
  constexpr double kGrid = 1e-12;  // m
  for (Ellipse& slice : sections.slices)
    slice.center = (slice.center / kGrid).array().round() * kGrid;
  trace.for_held(sections.muscle_begin, [&](std::size_t k, std::size_t before) {
    sections.slices[k] = trace.before->finished[before];
  });
  write_sections(sections, muscles);
}

void dilate_ecorche(Anatomy& anatomy, const std::vector<Muscle>& original, Sections& sections,
                    const SkinRays& rays, const FatLayer& fat, const DilateOptions& options,
                    const DilationTrace& trace, std::vector<StripCount>& counts,
                    DilateReport& report) {
  std::vector<Muscle>& muscles = anatomy.muscles;
  const std::vector<int> partners = left_partners(anatomy, sections, options),
                         given = trace.with_held(partners);
  Stages stages(trace, sections);
  const double plane = options.even_about.value_or(0);
  TissueStretch flesh(anatomy, rays, fat);
  const std::vector<Ellipse> carried = sections.slices;
  std::vector<std::vector<double>> heights(muscles.size());
  for (int round = 0; round < options.rounds; ++round) {
    flesh.look_at(sections.slices);
    for_muscles(muscles.size(), [&](std::size_t m) {
      if (partners[m] >= 0 || lies_in_fat(muscles[m])) return;
      if (round == 0) heights[m] = heights_in_room(sections.of(m), int(m), flesh);
      std::size_t first = 0;
      for_strips(muscles[m].strips, sections.of(m),
                 [&](const Strip& strip, std::span<Ellipse> slices) {
                   stretch_strip(strip, slices, int(m), ends_of(muscles[m]),
                                 std::span(heights[m]).subspan(first, slices.size()), flesh);
                   first += slices.size();
                 });
    });
    mirror_sections(partners, plane, sections);
  }
  const GrowthLimits limits{ray_directions(options.rays), options.clearance, options.most,
                            options.least};
  const FatLayer skin = skin_of(fat);
  for_muscles(muscles.size(), [&](std::size_t m) {
    if (given[m] >= 0) return;
    const FatLayer& layer = lies_in_fat(muscles[m]) ? skin : fat;
    for_strips(
        muscles[m].strips, sections.of(m), [&](const Strip& strip, std::span<Ellipse> slices) {
          counts[m].add(
              grow_strip(strip, slices, muscles[m].layer == "superficial", rays, layer, limits));
        });
  });
  mirror_sections(partners, plane, sections);
  write_sections(sections, muscles);
  std::vector<char> suspects(muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m)
    suspects[m] = counts[partners[m] < 0 ? m : std::size_t(partners[m])].near_skin;
  const InsideReport inside = pull_inside_skin(muscles, sections.slices, suspects, rays);
  report.rays += flesh.rays() + inside.rays;
  report.surface_outside = inside.outside;
  report.surface_left = inside.left;
  stages.follow();
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (trace.holds(m)) set_slices(muscles[m], sections.of(m));
  share_room(anatomy, original, carried, sections, partners, rays, fat, options, trace, stages,
             report);
}

// Where the skin crosses itself or folds, room can be shared out until sections have passed each
// other or left. A muscle is never written so.
int restore_collapsed(std::vector<Muscle>& muscles, const std::vector<Ellipse>& carried,
                      const std::vector<MuscleDilation>& report, Sections& sections) {
  constexpr double kFurthest = 0.15;  // m: how far a section may go from where it was carried
  int count = 0;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const std::span<const Ellipse> before =
        std::span(carried).subspan(sections.muscle_begin[m], sections.of(m).size());
    const bool whole = volume_of(muscles[m].strips, sections.of(m)) > 0;
    const bool near =
        std::ranges::equal(sections.of(m), before, [](const Ellipse& a, const Ellipse& b) {
          return (a.center - b.center).norm() < kFurthest;
        });
    if (report[m].wanted <= 0 || (whole && near)) continue;
    ++count;
    std::ranges::copy(before, sections.of(m).begin());
    set_slices(muscles[m], sections.of(m));
  }
  return count;
}

void check(const std::vector<Muscle>& carried, const std::vector<Muscle>& original,
           const SkinRays& rays, const FatLayer& fat, const DilateOptions& options) {
  if (options.rays < 8 || options.rays > 64)
    throw std::invalid_argument(
        fmt::format("dilate_muscles: {} rays; expected 8 .. 64", options.rays));
  if (!(options.alpha > 0))
    throw std::invalid_argument(
        fmt::format("dilate_muscles: alpha {}; expected more than 0", options.alpha));
  if (fat.thickness.size() != std::size_t(rays.mesh().V.rows())) {
    throw std::invalid_argument(
        fmt::format("dilate_muscles: a fat layer of {} vertices for a skin of {}",
                    fat.thickness.size(), rays.mesh().V.rows()));
  }
  bool same = carried.size() == original.size();
  for (std::size_t m = 0; same && m < carried.size(); ++m) {
    const auto &a = carried[m].strips, &b = original[m].strips;
    same = a.size() == b.size();
    for (std::size_t s = 0; same && s < a.size(); ++s)
      same = a[s].slices.size() == b[s].slices.size();
  }
  if (!same)
    throw std::invalid_argument(
        "dilate_muscles: the carried muscles are not those of the original");
}

}  // namespace

DilateReport dilate_muscles(Anatomy& anatomy, const std::vector<Muscle>& carried,
                            const std::vector<Muscle>& original, const SkinRays& rays,
                            const FatLayer& layer, const DilateOptions& options,
                            const DilationTrace& trace) {
  const FatLayer fat = layer_over_muscles(layer);
  check(carried, original, rays, fat, options);
  if (&anatomy.muscles != &carried) anatomy.muscles = carried;
  std::vector<Muscle>& muscles = anatomy.muscles;
  DilateReport report;
  report.muscles.resize(muscles.size());
  std::vector<StripCount> counts(muscles.size());
  Sections sections = sections_of(muscles);
  const std::vector<Ellipse> carried_sections = sections.slices;
  for_muscles(muscles.size(), [&](std::size_t m) {
    report.muscles[m].wanted = volume_of(muscles[m].strips, sections.of(m));
  });
  if (options.method == DilateMethod::paper)
    dilate_paper(muscles, original, sections, rays, fat, options, counts, report);
  else
    dilate_ecorche(anatomy, original, sections, rays, fat, options, trace, counts, report);
  report.collapsed = restore_collapsed(muscles, carried_sections, report.muscles, sections);
  if (trace.record) {
    trace.record->muscle_begin = sections.muscle_begin;
    trace.record->finished = sections.slices;
  }
  for_muscles(muscles.size(), [&](std::size_t m) {
    MuscleDilation& result = report.muscles[m];
    result.volume = muscles[m].volume = volume_of(muscles[m].strips, sections.of(m));
    if (options.method == DilateMethod::ecorche)
      result.factor = result.wanted > 0 ? std::sqrt(result.volume / result.wanted) : 1;
  });
  StripCount all;
  for (const StripCount& c : counts) all.add(c);
  report.slices = sections.slices.size();
  report.rays += all.rays;
  report.misses = all.misses;
  report.pulled_in = all.pulled_in;
  report.pressed = all.pressed;
  report.grown = all.grown;
  for (const MuscleDilation& m : report.muscles) {
    report.target_volume += m.wanted;
    report.volume += m.volume;
  }
  return report;
}

}  // namespace ecorche::inline v1
