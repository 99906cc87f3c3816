#include "app/studio/design/bench_window.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "app/edit/session.h"
#include "app/studio/design/design_window.h"

namespace ecorche {
namespace {

constexpr const char* kSession = R"(wait
click find
type biceps brachii long
frames 3
click list:biceps_brachii_long
frames 5
turn 120,20
turn -120,-20
drag point:1:4 24,-10
key Ctrl + Z
wait
drag point:1:4 -24,10
wait
drag point:1:4 12,9
key Ctrl + Z
wait
drop {}
wait
frames 120
)";

}  // namespace

std::vector<WindowLine> bench_window(const Common& common, Report& report) {
  namespace fs = std::filesystem;
  const fs::path input =
      fs::temp_directory_path() / fmt::format("ecorche_bench_{}.txt", ::getpid());
  const fs::path walk = common.assets.tables / "motions" / "walk.bvh";
  std::ofstream(input) << fmt::format(fmt::runtime(kSession), fs::absolute(walk).string());
  WindowOptions options{.input = input};
  options.width = 1280;
  options.height = 720;
  try {
    Session session(common, report, {});
    session.begin_here();
    run_design_window(session, common, report, {}, options);
  } catch (...) {
    fs::remove(input);
    throw;
  }
  fs::remove(input);
  const auto ms = [&](const char* figure) {
    return report.number(std::string("window.") + figure);
  };
  return {
      {"studio_playing", "studio: a walk plays, all muscles, 13k skin, median",
       ms("playing.p50_ms"), 33.3},
      {"studio_playing_cpu", "the same, CPU time of all threads", ms("playing.cpu_ms"), 33.3},
      {"studio_turning", "studio: the view turns, median", ms("turning.p50_ms"), 16.7},
      {"studio_turning_cpu", "the same, CPU time of all threads", ms("turning.cpu_ms"), 16.7},
      {"studio_edit_p50", "studio: a muscle dragged till drawn, median", ms("editing.p50_ms"), 50},
      {"studio_edit_p95", "the same, 95 of 100", ms("editing.p95_ms"), 50},
      {"studio_edit_cpu", "the same, CPU time of all threads, median", ms("editing.cpu_ms"), 50},
      {"studio_edit_cpu_p95", "the same, 95 of 100", ms("editing.cpu_p95_ms"), 50},
      {"studio_undo", "studio: an edit taken back, longest", ms("undoing.most_ms"), 30},
      {"studio_stall", "studio: longest frame while a body is fitted", ms("while_fitting.most_ms"),
       100},
      {"studio_stall_own", "the same, CPU time of the window's thread",
       ms("while_fitting.own_most_ms"), 100},
      {"studio_settled", "studio: a body fitted again after an edit of a muscle", ms("fit_ms"),
       2000},
      {"studio_settled_cpu", "the same, CPU time of all threads, the window's drawing included",
       ms("fit_cpu_ms"), 2000}};
}

}  // namespace ecorche
