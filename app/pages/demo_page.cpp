#include "app/pages/demo_page.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace ecorche {
namespace {

using Row = std::vector<std::string>;

std::string milliseconds(double ms) {
  if (!std::isfinite(ms)) return "-";
  return ms < 1000 ? fmt::format("{:.3g} ms", ms) : fmt::format("{:.3g} s", ms / 1000);
}

// The paper ran on one Pentium 4 of 1.8 GHz; most of the difference is twenty years of hardware,
// which the page says.
void add_timings(HtmlPage& page, const Report& report) {
  page.add_heading("Time, beside the template paper's Table 1");
  struct Line {
    const char *stage, *paper;
    double ms;
  };
  const auto time = [&](const char* name) {
    return report.number(std::string("timings_ms.") + name);
  };
  const double per_frame = report.number("frame_ms");
  const Line lines[] = {{"skeleton for the skin and transformation of bones",
                         "2.1 minutes + 1.2 seconds", time("fit_bones")},
                        {"transformation of muscles", "1.3 seconds", time("fit_muscles")},
                        {"muscle dilation", "1.2 minutes", time("dilation")},
                        {"anchoring", "28.6 minutes", time("anchoring")},
                        {"one animated frame", "3 seconds", per_frame}};
  std::vector<Row> rows;
  for (const Line& line : lines) rows.push_back({line.stage, line.paper, milliseconds(line.ms)});
  const Row header{"stage", "paper (186 muscles, 5 slices, Pentium 4)", "here"};
  page.add_table(header, rows);
  page.add_paragraph(
      fmt::format("Here: {:.0f} muscles of {:.0f} slices, {:.0f} rays, {:.0f} skin vertices, "
                  "{:.0f} threads. Twenty years of hardware are the "
                  "larger part of the difference; `ecorche bench` compares with what today's "
                  "machine can do at best.",
                  report.number("muscles"), report.number("slices"), report.number("rays"),
                  report.number("skin_vertices"), report.number("threads")));
}

// A figure and its target; `most` is NaN if it has none.
struct Asked {
  const char *what, *name, *unit;
  double scale, most;
};

void add_quality(HtmlPage& page, const DemoRecord& record, const Report& report) {
  page.add_heading("Quality");
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const Asked lines[] = {
      {"bone vertices outside the skin", "fit.bone_vertices_outside", "", 1, 0},
      {"muscle surface points outside the skin", "fit.muscle_points_outside_share", " %", 100,
       1e-3},
      {"gap from superficial limb muscles to the fat layer, median", "fit.superficial_gap_median",
       " mm", 1000, 3e-3},
      {"palpable landmarks whose depth is more than 4 mm off its bracket",
       "fit.landmarks_off_bracket", "", 1, 0},
      {"largest volume change of any muscle over the jump", "quality.muscle_volume_drift_max", " %",
       100, 1e-2},
      {"skin coordinates that are not finite", "quality.skin_not_finite", "", 1, 0},
      {"flipped skin triangles, worst frame", "quality.skin_flipped_share_max", " %", 100, 1e-3},
      {"flipped skin triangles, mean of all frames", "quality.skin_flipped_share_mean", " %", 100,
       nothing},
      {"linear blend skinning: flipped, worst frame", "quality.linear_blend.skin_flipped_share_max",
       " %", 100, nothing},
      {"linear blend skinning: flipped, mean of all frames",
       "quality.linear_blend.skin_flipped_share_mean", " %", 100, nothing},
      {"edge stretch, 99th percentile, worst frame", "quality.skin_stretch_p99_max", "", 1,
       nothing},
      {"linear blend skinning: edge stretch", "quality.linear_blend.skin_stretch_p99_max", "", 1,
       nothing},
      {"slide of planted feet, 95th percentile", "motion.foot_slide_p95", " mm", 1000, nothing}};
  std::vector<Row> rows;
  for (const Asked& line : lines) {
    const double value = report.number(line.name);
    const std::string measured = std::isfinite(value)
                                     ? fmt::format("{:.3g}{}", value * line.scale, line.unit)
                                     : "not measured";
    const bool wanted = std::isfinite(line.most);
    rows.push_back({line.what, measured,
                    wanted ? fmt::format("at most {:g}{}", line.most * line.scale, line.unit) : "",
                    !wanted              ? ""
                    : value <= line.most ? "met"
                                         : "missed"});
  }
  const Row header{"figure", "measured", "asked", ""};
  page.add_table(header, rows);
  if (record.missed.empty()) page.add_paragraph("Every accuracy target was met.");
  for (const std::string& target : record.missed) page.add_paragraph("Missed: " + target + ".");
}

void add_curves(HtmlPage& page, const DemoRecord& record) {
  if (record.curves.empty()) return;
  Plot lengths{"Length of the muscle's line over its length at rest",
               "time, s",
               "of rest",
               record.seconds,
               {},
               record.events};
  Plot bulges{
      "Thickness of the belly over its thickness at rest: it swells as the muscle shortens, "
      "because its volume stays",
      "time, s",
      "of rest",
      record.seconds,
      {},
      record.events};
  for (const MuscleCurve& curve : record.curves) {
    lengths.series.push_back({curve.label, curve.length});
    bulges.series.push_back({curve.label, curve.thickness});
  }
  page.add_plot(lengths);
  page.add_plot(bulges);
}

}  // namespace

std::string demo_page(const DemoRecord& record, const Report& report) {
  HtmlPage page("The long jump");
  page.add_paragraph(
      "A skeleton of 178 bones and a complete musculature, put into an athlete's skin and moved by "
      "a long jump. Every picture and figure on "
      "this page was made by the run that wrote it.");
  page.add_heading("From the template to the athlete");
  for (const Picture& picture : record.fit_pictures) page.add_picture(picture.png, picture.caption);
  page.add_heading("In motion");
  for (const Picture& picture : record.motion_pictures)
    page.add_picture(picture.png, picture.caption);
  add_curves(page, record);
  add_quality(page, record, report);
  add_timings(page, report);
  return page.to_string();
}

}  // namespace ecorche
