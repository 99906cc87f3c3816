#include "app/edit/line_actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "app/edit/document/edit_muscle.h"

namespace ecorche {
namespace {

constexpr double kSamePlace = 1e-4;  // of two sections, as a share of the line
constexpr int kMostStrips = 64, kMostPoints = 32;

void muscle_and_strip(Arguments& a, std::string& muscle, int& strip) {
  a.text("muscle", "muscle", muscle, Need::optional, "whose strip is meant; else the picked one");
  a.whole("strip", strip, 1, kMostStrips, Need::optional, "counted from 1");
}

// Where a new point makes the line least longer: the place in the path that it goes to.
std::size_t best_place(const MuscleTable& frame, const std::vector<TablePoint>& path,
                       const Vec3& at) {
  std::size_t best = 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Vec3 a = position(frame, path[k - 1]), b = position(frame, path[k]);
    const double longer = (at - a).norm() + (b - at).norm() - (b - a).norm();
    if (longer >= least) continue;
    least = longer;
    best = k;
  }
  return best;
}

// Direction of the polyline at a share of its length.
Vec3 direction_at(const MuscleTable& frame, const std::vector<TablePoint>& path, double s) {
  double whole = 0;
  for (std::size_t k = 1; k < path.size(); ++k)
    whole += (position(frame, path[k]) - position(frame, path[k - 1])).norm();
  double left = s * whole;
  for (std::size_t k = 1;; ++k) {
    const Vec3 piece = position(frame, path[k]) - position(frame, path[k - 1]);
    if (left <= piece.norm() || k + 1 == path.size()) return piece.normalized();
    left -= piece.norm();
  }
}

void roll_by(const MuscleTable& frame, const TableStrip& strip, double degrees,
             TableSection& section) {
  if (degrees == 0) return;
  const Vec3 along = direction_at(frame, strip.path, section.s);
  section.width = Eigen::AngleAxisd(degrees * kDegree, along) * section.width;
}

auto section_at(TableStrip& strip, double at) {
  return std::ranges::find_if(strip.sections, [&](const TableSection& section) {
    return std::abs(section.s - at) < kSamePlace;
  });
}

// The section that lies at this place by its neighbours.
TableSection between_neighbours(const TableStrip& strip, double at) {
  const auto after = std::ranges::upper_bound(strip.sections, at, {}, &TableSection::s);
  const TableSection &b = *after, &a = *(after - 1);
  const double u = (at - a.s) / (b.s - a.s);
  const Vec3 other = a.width.dot(b.width) < 0 ? Vec3(-b.width) : b.width;
  return {at, (1 - u) * a.radii + u * b.radii, ((1 - u) * a.width + u * other).normalized()};
}

int meant_wrap(const Document& document, const std::string& name) {
  if (const int known = find_wrap(*document.frame, name); known >= 0) return known;
  std::vector<std::string> names;
  for (const TableWrap& wrap : document.frame->wraps) names.push_back(wrap.name);
  throw InputError(fmt::format("argument 'wrap': '{}': there is no such wrap; there are {}", name,
                               fmt::join(names, ", ")));
}

void fill_sizes(const std::optional<double>& radius, const std::optional<double>& half,
                const Vec3& axis, const Vec3& axes, TableWrap& wrap) {
  if (radius) wrap.radii.head<2>().setConstant(1e-3 * *radius);
  if (radius && wrap.kind == Wrap::Kind::sphere) wrap.radii.z() = 1e-3 * *radius;
  if (half && wrap.kind == Wrap::Kind::cylinder) wrap.radii.z() = 1e-3 * *half;
  if (axis.norm() > 1e-6) wrap.axis = axis.normalized();
  if (axes.minCoeff() > 0 && wrap.kind == Wrap::Kind::ellipsoid) wrap.radii = metres(axes);
  if (wrap.radii.minCoeff() < 1e-4 || wrap.radii.maxCoeff() > 1)
    throw InputError(fmt::format("wrap '{}': sizes {:g}, {:g}, {:g} mm: expected 0.1 .. 1000",
                                 wrap.name, 1e3 * wrap.radii.x(), 1e3 * wrap.radii.y(),
                                 1e3 * wrap.radii.z()));
}

// As its line of wraps.txt says it. Throws InputError for what cannot be one.
TableWrap settled(const Document& document, const TableWrap& wrap) {
  return read_wraps(*document.frame, wrap_text(*document.frame, wrap), wrap.name).front();
}

Document with_wraps(const Document& document, std::vector<TableWrap> wraps) {
  return with_part(document, &Document::frame,
                   [&](MuscleTable& frame) { frame.wraps = std::move(wraps); });
}

}  // namespace

void arguments(Arguments& a, MovePoint& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.whole("point", x.point, 1, kMostPoints, Need::required, "of the line, 1 is the origin");
  a.vector("by", x.by, ArgumentUnit::millimetre, Need::optional, "how far");
  a.text("to", "place", x.to, Need::optional, "where to, before `by`");
  a.text("snap", "bone", x.snap, Need::optional, "at last onto the surface of this bone");
}

Document apply(Workshop& workshop, const Document& document, const MovePoint& x) {
  if (x.to.empty() && x.snap.empty() && x.by.isZero())
    throw InputError("argument 'by' is missing: how far, or to= a place, or snap= a bone");
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    TablePoint& point = point_of(muscle, x.strip, x.point);
    if (!x.to.empty()) point = read_place(workshop, document, x.to);
    point.offset += metres(x.by);
    if (!x.snap.empty())
      point = place_on_bone(workshop, document, x.snap, position(*document.frame, point));
  });
}

void arguments(Arguments& a, AddPoint& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.text("at", "place", x.at, Need::required, "LANDMARK, LANDMARK+L,U,F or BONE@L,U,F");
  a.whole("after", x.after, 0, kMostPoints, Need::optional,
          "point that it follows; 0: where the line becomes least longer");
}

Document apply(Workshop& workshop, const Document& document, const AddPoint& x) {
  const TablePoint point = read_place(workshop, document, x.at);
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    std::vector<TablePoint>& path = strip_of(muscle, x.strip).path;
    if (x.after >= int(path.size()))
      throw InputError(
          fmt::format("argument 'after': '{}': expected 1 .. {}; the last point is the "
                      "insertion",
                      x.after, path.size() - 1));
    const std::size_t place =
        x.after > 0 ? std::size_t(x.after)
                    : best_place(*document.frame, path, position(*document.frame, point));
    path.insert(path.begin() + long(place), point);
  });
}

void arguments(Arguments& a, RemovePoint& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.whole("point", x.point, 1, kMostPoints, Need::required, "of the line, 1 is the origin");
}

Document apply(Workshop&, const Document& document, const RemovePoint& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    point_of(muscle, x.strip, x.point);
    std::vector<TablePoint>& path = strip_of(muscle, x.strip).path;
    if (path.size() <= 2)
      throw InputError(
          fmt::format("argument 'point': '{}': origin and insertion are all that strip "
                      "{} of {} has",
                      x.point, x.strip, muscle.name));
    path.erase(path.begin() + (x.point - 1));
  });
}

void arguments(Arguments& a, SetSection& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.number("at", x.at, {ArgumentUnit::none, 0, 1}, Need::required,
           "share of the line; a section is there already or is made");
  a.number("width", x.width, {ArgumentUnit::millimetre, 0.1, 500}, "full; by its neighbours");
  a.number("thickness", x.thickness, {ArgumentUnit::millimetre, 0.1, 500},
           "full; by its neighbours");
  a.number("roll", x.roll, {ArgumentUnit::degree, -360, 360}, "turned so far about the line");
}

Document apply(Workshop&, const Document& document, const SetSection& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    TableStrip& strip = strip_of(muscle, x.strip);
    auto section = section_at(strip, x.at);
    if (section == strip.sections.end()) {
      const TableSection made = between_neighbours(strip, x.at);
      section = strip.sections.insert(
          std::ranges::upper_bound(strip.sections, x.at, {}, &TableSection::s), made);
    }
    if (x.width) section->radii.x() = 1e-3 * *x.width / 2;
    if (x.thickness) section->radii.y() = 1e-3 * *x.thickness / 2;
    roll_by(*document.frame, strip, x.roll.value_or(0), *section);
  });
}

void arguments(Arguments& a, RemoveSection& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.number("at", x.at, {ArgumentUnit::none, 0, 1}, Need::required, "share of the line");
}

Document apply(Workshop&, const Document& document, const RemoveSection& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    TableStrip& strip = strip_of(muscle, x.strip);
    const auto section = section_at(strip, x.at);
    if (section == strip.sections.end() || x.at == 0 || x.at == 1) {
      std::vector<double> places;
      for (const TableSection& each : strip.sections)
        if (each.s > 0 && each.s < 1) places.push_back(each.s);
      throw InputError(fmt::format("argument 'at': '{:g}': sections that can go lie at {:g}", x.at,
                                   fmt::join(places, ", ")));
    }
    strip.sections.erase(section);
  });
}

void arguments(Arguments& a, ScaleSections& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "whose sections are meant");
  a.whole("strip", x.strip, 0, kMostStrips, Need::optional, "0: all strips");
  a.number("width", x.width, {ArgumentUnit::none, 0.05, 20}, Need::optional, "times as wide");
  a.number("thickness", x.thickness, {ArgumentUnit::none, 0.05, 20}, Need::optional,
           "times as thick");
  a.number("roll", x.roll, {ArgumentUnit::degree, -360, 360}, Need::optional,
           "turned about the line");
}

Document apply(Workshop&, const Document& document, const ScaleSections& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    if (x.strip > 0) strip_of(muscle, x.strip);
    for (int k = 1; k <= int(muscle.strips.size()); ++k) {
      if (x.strip > 0 && k != x.strip) continue;
      TableStrip& strip = muscle.strips[std::size_t(k - 1)];
      for (TableSection& section : strip.sections) {
        section.radii = section.radii.cwiseProduct(Vec2(x.width, x.thickness));
        roll_by(*document.frame, strip, x.roll, section);
      }
    }
  });
}

void arguments(Arguments& a, SetBelly& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.number("begin", x.begin, {ArgumentUnit::none, 0, 1},
           "where the flesh begins, share of the line");
  a.number("end", x.end, {ArgumentUnit::none, 0, 1}, "where it ends");
}

Document apply(Workshop&, const Document& document, const SetBelly& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    TableStrip& strip = strip_of(muscle, x.strip);
    strip.belly_begin = x.begin.value_or(strip.belly_begin);
    strip.belly_end = x.end.value_or(strip.belly_end);
  });
}

void arguments(Arguments& a, AddStrip& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "that gets a strip more");
  a.whole("like", x.like, 1, kMostStrips, Need::optional, "strip that it is a copy of");
  a.vector("by", x.by, ArgumentUnit::millimetre, Need::optional, "how far beside it");
}

Document apply(Workshop&, const Document& document, const AddStrip& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    TableStrip strip = strip_of(muscle, x.like);
    for (TablePoint& point : strip.path) point.offset += metres(x.by);
    muscle.strips.insert(muscle.strips.begin() + x.like, std::move(strip));
  });
}

void arguments(Arguments& a, RemoveStrip& x) {
  a.text("muscle", "muscle", x.muscle, Need::optional, "that loses a strip");
  a.whole("strip", x.strip, 1, kMostStrips, Need::required, "counted from 1");
}

Document apply(Workshop&, const Document& document, const RemoveStrip& x) {
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    strip_of(muscle, x.strip);
    if (muscle.strips.size() == 1)
      throw InputError(
          fmt::format("argument 'strip': '1': it is all that {} has; remove_muscle "
                      "takes the whole muscle away",
                      muscle.name));
    muscle.strips.erase(muscle.strips.begin() + (x.strip - 1));
  });
}

void arguments(Arguments& a, NewWrap& x) {
  a.text("name", "name", x.name, Need::required, "of the wrap");
  a.choice("kind", x.kind, {"sphere", "cylinder", "ellipsoid"}, Need::required, "its form");
  a.text("at", "place", x.at, Need::required, "its middle: LANDMARK+L,U,F or BONE@L,U,F");
  a.number("radius", x.radius, {ArgumentUnit::millimetre, 0.1, 1000}, Need::optional,
           "of a sphere or cylinder");
  a.number("half", x.half, {ArgumentUnit::millimetre, 0.1, 1000}, Need::optional,
           "half of a cylinder's length");
  a.vector("axis", x.axis, ArgumentUnit::none, Need::optional, "direction of a cylinder");
  a.vector("axes", x.axes, ArgumentUnit::millimetre, Need::optional, "semi axes of an ellipsoid");
}

Document apply(Workshop& workshop, const Document& document, const NewWrap& x) {
  if (find_wrap(*document.frame, x.name) >= 0)
    throw InputError(fmt::format("argument 'name': '{}': there is a wrap of that name", x.name));
  if (x.name.find_first_of(" #\t") != std::string::npos)
    throw InputError(fmt::format("argument 'name': '{}': expected one word", x.name));
  const TablePoint at = read_place(workshop, document, x.at);
  TableWrap wrap;
  wrap.name = x.name;
  wrap.kind = x.kind == "sphere"     ? Wrap::Kind::sphere
              : x.kind == "cylinder" ? Wrap::Kind::cylinder
                                     : Wrap::Kind::ellipsoid;
  wrap.landmark = at.landmark;
  wrap.offset = at.offset;
  wrap.radii.setConstant(1e-2);
  fill_sizes(x.radius, x.half, x.axis, x.axes, wrap);
  std::vector<TableWrap> wraps = document.frame->wraps;
  wraps.push_back(settled(document, wrap));
  return with_wraps(document, std::move(wraps));
}

void arguments(Arguments& a, SetWrap& x) {
  a.text("wrap", "wrap", x.wrap, Need::required, "its name");
  a.text("at", "place", x.at, Need::optional, "its middle");
  a.vector("by", x.by, ArgumentUnit::millimetre, Need::optional, "how far it moves");
  a.number("radius", x.radius, {ArgumentUnit::millimetre, 0.1, 1000}, "of a sphere or cylinder");
  a.number("half", x.half, {ArgumentUnit::millimetre, 0.1, 1000}, "half of a cylinder's length");
  a.vector("axis", x.axis, ArgumentUnit::none, Need::optional, "direction of a cylinder");
  a.vector("axes", x.axes, ArgumentUnit::millimetre, Need::optional, "semi axes of an ellipsoid");
}

Document apply(Workshop& workshop, const Document& document, const SetWrap& x) {
  std::vector<TableWrap> wraps = document.frame->wraps;
  TableWrap& wrap = wraps[std::size_t(meant_wrap(document, x.wrap))];
  if (!x.at.empty()) {
    const TablePoint at = read_place(workshop, document, x.at);
    wrap.landmark = at.landmark;
    wrap.offset = at.offset;
  }
  wrap.offset += metres(x.by);
  fill_sizes(x.radius, x.half, x.axis, x.axes, wrap);
  wrap = settled(document, wrap);
  return with_wraps(document, std::move(wraps));
}

void arguments(Arguments& a, RemoveWrap& x) {
  a.text("wrap", "wrap", x.wrap, Need::required, "that no muscle slides over any more");
}

Document apply(Workshop&, const Document& document, const RemoveWrap& x) {
  const int gone = meant_wrap(document, x.wrap);
  for (const auto& muscle : document.muscles)
    if (wraps_of(*muscle).contains(gone))
      throw InputError(fmt::format("argument 'wrap': '{}': {} slides over it; leave_wrap first",
                                   x.wrap, muscle->left.name));
  std::vector<TableWrap> wraps = document.frame->wraps;
  wraps.erase(wraps.begin() + gone);
  Document out = with_wraps(document, std::move(wraps));
  for (auto& muscle : out.muscles) {  // indices behind it go down
    const std::set<int> used = wraps_of(*muscle);
    if (used.upper_bound(gone) == used.end()) continue;
    auto moved = std::make_shared<EditedMuscle>(*muscle);
    const auto lower = [gone](TableMuscle& side) {
      for (TableStrip& strip : side.strips)
        for (TableStrip::WrapUse& use : strip.wraps) use.wrap -= use.wrap > gone;
    };
    lower(moved->left);
    if (moved->right) lower(*moved->right);
    muscle = std::move(moved);
  }
  return out;
}

void arguments(Arguments& a, UseWrap& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.text("wrap", "wrap", x.wrap, Need::required, "that the line slides over");
  a.number("radius", x.radius, {ArgumentUnit::millimetre, 0, 1000}, Need::optional,
           "for this line; 0: the wrap's own");
}

Document apply(Workshop&, const Document& document, const UseWrap& x) {
  const int wrap = meant_wrap(document, x.wrap);
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    std::vector<TableStrip::WrapUse>& uses = strip_of(muscle, x.strip).wraps;
    const auto known = std::ranges::find(uses, wrap, &TableStrip::WrapUse::wrap);
    if (known != uses.end())
      known->radius = 1e-3 * x.radius;
    else
      uses.push_back({wrap, 1e-3 * x.radius});
  });
}

void arguments(Arguments& a, LeaveWrap& x) {
  muscle_and_strip(a, x.muscle, x.strip);
  a.text("wrap", "wrap", x.wrap, Need::required, "that the line does not slide over any more");
}

Document apply(Workshop&, const Document& document, const LeaveWrap& x) {
  const int wrap = meant_wrap(document, x.wrap);
  return with_change(document, meant_muscle(document, x.muscle), [&](TableMuscle& muscle) {
    std::vector<TableStrip::WrapUse>& uses = strip_of(muscle, x.strip).wraps;
    if (std::erase_if(uses, [wrap](const auto& use) { return use.wrap == wrap; }) == 0)
      throw InputError(fmt::format("argument 'wrap': '{}': strip {} of {} does not slide over it",
                                   x.wrap, x.strip, muscle.name));
  });
}

}  // namespace ecorche
