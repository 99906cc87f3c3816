#include "anatomy/muscles/fascia_again.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/same_muscle.h"
#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {
namespace {

bool same_bones(const Anatomy& a, const Anatomy& b) {
  return rest_positions(a.skeleton) == rest_positions(b.skeleton) &&
         std::ranges::equal(a.bones, b.bones, [](const Bone& x, const Bone& y) {
           return x.name == y.name && x.joint == y.joint && x.mesh.V == y.mesh.V &&
                  x.mesh.F == y.mesh.F;
         });
}

bool same_sheet(const FasciaSheet& a, const FasciaSheet& b) {
  return a.rows == b.rows && a.columns == b.columns && a.V == b.V && a.belly == b.belly &&
         a.bones == b.bones;
}

// Bones alone push or carry it, so that what one of these sheets meets may be another's.
bool goes_with_bones(const FasciaSheet& sheet) {
  return is_sleeve(sheet) || sheet.bones.size() > 2;
}

// About a section that only one of the bodies has: a point of a sheet within it may have to do with
// the section.
struct Ball {
  Vec3 centre;
  double radius = 0;
};

void add_changed(std::span<const Ellipse> slices, std::span<const int> there,
                 std::vector<Ball>& out) {
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const double reach = slices[k].radii.maxCoeff();
    if (there[k] < 0)
      out.push_back(
          {slices[k].center, std::max(2 * reach + kFasciaReach, reach + kFasciaLiftReach)});
  }
}

bool is_reached(const Points& sheet, std::span<const Ball> changed) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < sheet.rows(); ++i) box.extend(sheet.row(i).transpose());
  return std::ranges::any_of(changed, [&](const Ball& ball) {
    return box.exteriorDistance(ball.centre) <= ball.radius &&
           (sheet.rowwise() - ball.centre.transpose()).rowwise().squaredNorm().minCoeff() <=
               ball.radius * ball.radius;
  });
}

// Names of bones of sleeves and of bands.
struct NamedBones {
  std::set<std::string> sleeves, bands;
  void add(const FasciaSheet& sheet) {
    (is_sleeve(sheet) ? sleeves : bands).insert(sheet.bones.begin(), sheet.bones.end());
  }
  // Whether the sheet names a bone of one of the other kind.
  bool meet(const FasciaSheet& sheet) const {
    const std::set<std::string>& others = is_sleeve(sheet) ? bands : sleeves;
    return std::ranges::any_of(sheet.bones,
                               [&](const std::string& name) { return others.contains(name); });
  }
};

// A band over a joint is pushed by what its sleeve is: where one of them is made anew, the other
// is.
void let_go_of_bands(const Anatomy& anatomy, const Anatomy& before, std::vector<int>& known) {
  NamedBones fresh;
  std::vector<char> kept(before.fascia.size(), 0);
  for (std::size_t n = 0; n < known.size(); ++n) {
    if (known[n] >= 0) kept[std::size_t(known[n])] = 1;
    if (known[n] < 0 && goes_with_bones(anatomy.fascia[n])) fresh.add(anatomy.fascia[n]);
  }
  for (std::size_t n = 0; n < kept.size(); ++n)
    if (!kept[n] && goes_with_bones(before.fascia[n])) fresh.add(before.fascia[n]);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t n = 0; n < known.size(); ++n) {
      const FasciaSheet& sheet = anatomy.fascia[n];
      if (known[n] < 0 || !goes_with_bones(sheet) || !fresh.meet(sheet)) continue;
      known[n] = -1;
      fresh.add(sheet);
      changed = true;
    }
  }
}

// Of each sheet the one before that is the same in all that it looks at; -1: none.
std::vector<int> known_sheets(const Anatomy& anatomy, const Anatomy& before,
                              const SharedSections& shared) {
  std::vector<int> out(anatomy.fascia.size(), -1);
  if (!same_bones(anatomy, before)) return out;
  std::vector<Ball> changed;
  add_changed(rest_slices(anatomy), shared.before, changed);
  add_changed(rest_slices(before), shared.now, changed);
  std::unordered_map<std::string, int> were;
  for (std::size_t n = 0; n < before.fascia.size(); ++n)
    were.emplace(before.fascia[n].name, int(n));
  for (std::size_t n = 0; n < out.size(); ++n) {
    const FasciaSheet& sheet = anatomy.fascia[n];
    const auto was = were.find(sheet.name);
    if (was != were.end() && same_sheet(sheet, before.fascia[std::size_t(was->second)]) &&
        (goes_with_bones(sheet) || !is_reached(sheet.V, changed)))
      out[n] = was->second;
  }
  let_go_of_bands(anatomy, before, out);
  return out;
}

// Appends sheets of other surfaces.
class Merger {
 public:
  explicit Merger(FasciaSurface& out) : out_(out) { out_.term_begin.push_back(0); }

  // `slices`: where the surface's are; null: they are ours.
  void add(const FasciaSurface& from, int part, const std::vector<int>* slices) {
    const FasciaSurface::Part& was = from.parts[std::size_t(part)];
    const int sheet = int(out_.parts.size());
    FasciaSurface::Part& own = out_.parts.emplace_back(was);
    own.sheet = sheet;
    own.vertex_begin = out_.vertices();
    own.push_begin = int(out_.clearances.size());
    for (int i = was.vertex_begin; i < was.vertex_end; ++i) add_point(from, i, slices);
    own.vertex_end = out_.vertices();
    const auto pushes = from.clearances.begin() + was.push_begin;
    out_.clearances.insert(out_.clearances.end(), pushes,
                           pushes + long(was.reaches.size()) * (was.vertex_end - was.vertex_begin));
    if (was.sleeve)
      for (const int k : was.reaches) {
        reaches_[&from].emplace(k, int(out_.reaches.size()));
        out_.reaches.push_back(from.reaches[std::size_t(k)]);
      }
    sources_.push_back(&from);
  }

  void finish() {
    for (std::size_t n = 0; n < out_.parts.size(); ++n)
      for (int& k : out_.parts[n].reaches) k = reaches_[sources_[n]].at(k);
    triangulate(out_);
  }

 private:
  void add_point(const FasciaSurface& from, int point, const std::vector<int>* slices) {
    const std::size_t term_count = out_.terms.size(), cover_count = out_.lift.covers.size();
    append_point(from, point, out_);
    if (!slices) return;
    for (FasciaSurface::Term& term : std::span(out_.terms).subspan(term_count))
      term.carrier = term.carrier < from.slices ? (*slices)[std::size_t(term.carrier)]
                                                : term.carrier - from.slices + out_.slices;
    for (FasciaLift::Cover& cover : std::span(out_.lift.covers).subspan(cover_count)) {
      const int begin = (*slices)[std::size_t(cover.begin)];
      cover.end = begin + cover.end - cover.begin;
      cover.begin = begin;
    }
  }

  FasciaSurface& out_;
  std::vector<const FasciaSurface*> sources_;  // of parts
  std::unordered_map<const FasciaSurface*, std::unordered_map<int, int>> reaches_;
};

}  // namespace

FasciaSurface make_fascia_again(const Anatomy& anatomy, const FasciaBefore& before) {
  if (!before.surface) return make_fascia_surface(anatomy);
  const SharedSections shared = shared_sections(anatomy, *before.anatomy);
  const std::vector<int> known = known_sheets(anatomy, *before.anatomy, shared);
  Anatomy changed = anatomy;
  changed.fascia.clear();
  for (std::size_t n = 0; n < known.size(); ++n)
    if (known[n] < 0) changed.fascia.push_back(anatomy.fascia[n]);
  const FasciaSurface fresh = make_fascia_surface(changed);
  FasciaSurface out;
  out.slices = fresh.slices;
  Merger merger(out);
  int next = 0;
  for (const int was : known) {
    if (was < 0)
      merger.add(fresh, next++, nullptr);
    else
      merger.add(*before.surface, was, &shared.now);
  }
  merger.finish();
  return out;
}

}  // namespace ecorche::inline v1
