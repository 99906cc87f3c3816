#include "app/edit/body_actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "anatomy/errors.h"
#include "anatomy/files/quantity.h"
#include "anatomy/files/similar_names.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/document/edited_skeleton.h"
#include "morph/measures/measure_table.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

template <class F>
Document with_joint(Workshop& workshop, const Document& document, const std::string& name,
                    const F& change) {
  check_joint(workshop, document, name);
  return with_part(document, &Document::joints, [&](auto& joints) { change(joints[name]); });
}

void check_body_file(const std::string& file) {
  if (file == "none" || std::filesystem::is_regular_file(file)) return;
  if (std::filesystem::is_directory(file))
    throw InputError(
        fmt::format("argument 'file': '{}': a folder; a body is a file, and a project's folder is "
                    "opened by `ecorche studio FOLDER`",
                    file));
  throw InputError(fmt::format("argument 'file': '{}': there is no such file", file));
}

// The measure's own name and its value in m, or kg.
std::pair<std::string, double> read_measure(Workshop& workshop, const SetMeasure& x) {
  const MeasureTable table =
      read_measure_table(workshop.package(), workshop.package().tables / "body");
  const Measure& measure = table.measures[std::size_t(table.at(x.measure))];
  if (measure.kind == MeasureKind::mass)
    return {measure.id, parse_mass(x.value, "argument 'value'", 1, 500)};
  const LengthRange range{0.01, 3};
  return {measure.id, parse_length(x.value, "argument 'value'", range, range)};
}

}  // namespace

void arguments(Arguments& a, MoveJoint& x) {
  a.text("joint", "joint", x.joint, Need::required, "whose centre is moved; bones stay");
  a.vector("by", x.by, ArgumentUnit::millimetre, Need::required, "how far, in the template's body");
}
Document apply(Workshop& workshop, const Document& document, const MoveJoint& x) {
  return with_joint(workshop, document, x.joint, [&](EditedJoint& joint) { joint.moved += x.by; });
}

void arguments(Arguments& a, TurnAxes& x) {
  a.text("joint", "joint", x.joint, Need::required, "whose axes are turned");
  a.number("flexion", x.flexion, {ArgumentUnit::degree, -180, 180}, Need::optional,
           "about the flexion axis");
  a.number("abduction", x.abduction, {ArgumentUnit::degree, -180, 180}, Need::optional,
           "then about that of abduction");
  a.number("rotation", x.rotation, {ArgumentUnit::degree, -180, 180}, Need::optional,
           "then about that of rotation");
}
Document apply(Workshop& workshop, const Document& document, const TurnAxes& x) {
  return with_joint(workshop, document, x.joint, [&](EditedJoint& joint) {
    joint.turned += Vec3(x.flexion, x.abduction, x.rotation);
  });
}

void arguments(Arguments& a, SetLimits& x) {
  a.text("joint", "joint", x.joint, Need::required, "whose range is set");
  a.choice("angle", x.angle, {"flexion", "abduction", "rotation"}, Need::required,
           "the axis that is meant");
  a.number("min", x.min, {ArgumentUnit::degree, -270, 270}, Need::required,
           "from the anatomical zero");
  a.number("max", x.max, {ArgumentUnit::degree, -270, 270}, Need::required, "likewise");
}
Document apply(Workshop& workshop, const Document& document, const SetLimits& x) {
  if (x.min >= x.max)
    throw InputError(
        fmt::format("argument 'max': '{:g}': expected more than min {:g}", x.max, x.min));
  const int axis = angle_index(x.angle);
  return with_joint(workshop, document, x.joint,
                    [&](EditedJoint& joint) { joint.limits[axis] = std::pair(x.min, x.max); });
}

void arguments(Arguments& a, ResetJoint& x) {
  a.text("joint", "joint", x.joint, Need::required, "that becomes the built-in one again");
}
Document apply(Workshop& workshop, const Document& document, const ResetJoint& x) {
  check_joint(workshop, document, x.joint);
  return with_part(document, &Document::joints, [&](auto& joints) { joints.erase(x.joint); });
}

void arguments(Arguments& a, SetBody& x) {
  a.text("file", "file", x.file, Need::required,
         "body, character or skin on the base mesh; none: the template's own body");
}
Document apply(Workshop&, const Document& document, const SetBody& x) {
  check_body_file(x.file);
  return with_part(document, &Document::body, [&](EditedBody& body) {
    body.file = x.file == "none" ? std::filesystem::path() : std::filesystem::path(x.file);
  });
}

void arguments(Arguments& a, SetMeasure& x) {
  a.text("measure", "measure", x.measure, Need::required, "as `ecorche list measures` names it");
  a.text("value", "length or mass", x.value, Need::required, "with its unit: 82cm, 70kg");
}
Document apply(Workshop& workshop, const Document& document, const SetMeasure& x) {
  const auto [name, value] = read_measure(workshop, x);
  return with_part(document, &Document::body,
                   [&](EditedBody& body) { body.targets[name] = value; });
}

void arguments(Arguments& a, FreeMeasure& x) {
  a.text("measure", "measure", x.measure, Need::required, "that is not asked for any more");
}
Document apply(Workshop&, const Document& document, const FreeMeasure& x) {
  std::vector<std::string> names;
  for (const auto& [name, value] : document.body->targets) names.push_back(name);
  if (!document.body->targets.contains(x.measure))
    throw InputError(fmt::format("argument 'measure': '{}': it is not asked for; there are [{}]",
                                 x.measure, fmt::join(names, ", ")));
  return with_part(document, &Document::body,
                   [&](EditedBody& body) { body.targets.erase(x.measure); });
}

void arguments(Arguments& a, SetLayer& x) {
  a.number("factor", x.factor, {ArgumentUnit::none, 0.2, 5}, Need::required,
           "times the fat over the muscles that the build lets expect");
  a.text("site", "site", x.site, Need::optional,
         "of data/fat.csv, about which alone, on top of all: abdominal, front_thigh, ...");
}
Document apply(Workshop& workshop, const Document& document, const SetLayer& x) {
  if (x.site.empty())
    return with_part(document, &Document::body, [&](EditedBody& body) { body.layer = x.factor; });
  const std::vector<std::string>& sites = workshop.fat_sites();
  if (std::ranges::find(sites, x.site) == sites.end())
    throw InputError(fmt::format("argument 'site': '{}': there is no such site{}", x.site,
                                 did_you_mean(x.site, sites)));
  return with_part(document, &Document::body, [&](EditedBody& body) {
    if (x.factor == 1)
      body.layer_sites.erase(x.site);
    else
      body.layer_sites[x.site] = x.factor;
  });
}

void arguments(Arguments& a, SetFit& x) {
  a.choice("method", x.method, {"ecorche", "paper"}, Need::optional,
           "each section grows for itself, or each muscle by one factor");
  a.number("alpha", x.alpha, {ArgumentUnit::none, 0.01, 10},
           "paper: share of the length's change that muscles start with across");
  a.number("clearance", x.clearance, {ArgumentUnit::millimetre, 0, 20},
           "kept between muscles and the layer over them");
  a.number("rays", x.rays, {ArgumentUnit::none, 8, 64}, "a slice");
  a.number("slices", x.slices, {ArgumentUnit::none, 0, 24},
           "of each strip; 0: as many as its length asks");
}
Document apply(Workshop&, const Document& document, const SetFit& x) {
  Document out = document;
  FitSettings& fit = out.fit;
  if (!x.method.empty())
    fit.method = x.method == "paper" ? DilateMethod::paper : DilateMethod::ecorche;
  if (x.alpha) fit.alpha = *x.alpha;
  if (x.clearance) fit.clearance = *x.clearance;
  if (x.rays) fit.rays = int(*x.rays);
  if (x.slices && *x.slices > 0 && *x.slices < 6)
    throw InputError(fmt::format("argument 'slices': '{:g}': expected 0 or 6 .. 24", *x.slices));
  if (x.slices) fit.slices = int(*x.slices);
  return out;
}

}  // namespace ecorche
