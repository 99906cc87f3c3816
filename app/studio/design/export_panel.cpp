#include "app/studio/design/export_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

#include "anatomy/errors.h"
#include "app/studio/design/fields.h"

namespace ecorche {
namespace {

// What is written, the ending of its file, and the action with what it says beside the file.
struct ExportKind {
  const char *name, *ending, *action, *more;
};
// The first of an ending is meant by a name alone.
constexpr std::array kExports{
    ExportKind{"character", ".glb", "write_character", ""},
    ExportKind{"template, for fit --template", ".glb", "write_template", ""},
    ExportKind{"model for OpenSim", ".osim", "write_model", ""},
    ExportKind{"model for MuJoCo", ".xml", "write_model", ""},
    ExportKind{"picture", ".png", "render", ""},
    ExportKind{"picture, transparent around", ".png", "render", " background=transparent"},
    ExportKind{"atlas plate, names beside it", ".png", "render",
               " labels=superficial camera=front layers=muscles,bones size=1600x2000"},
    ExportKind{"turntable", ".mp4", "film", ""},
    ExportKind{"film of the motion, two cameras", ".mp4", "film", ""},
    ExportKind{"picked muscle", ".txt", "export_muscle", ""},
    ExportKind{"its curves over the motion", ".csv", "curves", ""}};
constexpr std::size_t kMotionFilm = 8;

// Half of the motion from the front, half from the left.
std::string cuts_of(const Motion& motion) {
  const double end = double(motion.frames.size() - 1) / motion.fps, half = 0.5 * end;
  return fmt::format(" \"shots=front 0-{:.2f}; left {:.2f}-{:.2f}\"", half, half, end);
}

std::string export_line(const DesignSession& session, const PanelState& state) {
  const std::string ending = std::filesystem::path(state.export_file).extension();
  std::size_t kind = std::size_t(std::max(state.export_kind, 0));
  if (state.export_kind < 0 || ending != kExports[kind].ending)
    kind = std::size_t(std::ranges::find(kExports, ending, &ExportKind::ending) - kExports.begin());
  if (kind >= kExports.size())
    throw InputError(state.export_file +
                     ": expected a name with .glb, .osim, .xml, .png, .mp4, .txt or .csv");
  std::string out = fmt::format("{} file={}{}", kExports[kind].action,
                                ecorche::quoted(state.export_file), kExports[kind].more);
  const Motion& motion = *session.shown().motion;
  if (kind == kMotionFilm && motion.frames.size() < 2)
    throw InputError("no motion is played: drop one into the window, or take the turntable");
  if (kind == kMotionFilm) out += cuts_of(motion);
  return out;
}

// A name that is free, of the kind's ending.
std::string free_name(const ExportKind& kind) {
  for (int number = 1; number < 10000; ++number)
    if (std::string name = fmt::format("studio-{:04}{}", number, kind.ending);
        !std::filesystem::exists(name))
      return name;
  return std::string("studio") + kind.ending;
}

void write(DesignSession& session, PanelState& state) {
  try {
    if (!session.run(export_line(session, state), "export")) return;
    state.asks_export = false;
    session.say(
        fmt::format("writing {} ...", std::filesystem::absolute(state.export_file).string()));
  } catch (const std::exception& error) {
    session.refuse(error, "export");
  }
}

}  // namespace

void draw_export(DesignSession& session, PanelState& state, ViewDocument& document) {
  if (!state.asks_export) return;
  ImGui::SetNextItemWidth(16 * ImGui::GetFontSize());
  const char* shown =
      state.export_kind < 0 ? "by the file's ending" : kExports[state.export_kind].name;
  if (ImGui::BeginCombo("##kind", shown, ImGuiComboFlags_HeightLargest)) {
    for (int k = 0; k < int(kExports.size()); ++k) {
      if (ImGui::Selectable(kExports[k].name, k == state.export_kind)) {
        state.export_kind = k;
        state.export_file = free_name(kExports[k]);
      }
      name_place(document, fmt::format("export kind:{}", kExports[k].name));
    }
    ImGui::EndCombo();
  }
  name_place(document, "export kind");
  help_of_last("What is written; the action stands in the search box under its name");
  const bool entered =
      text_field("##export", state.export_file, "my-arm.glb", 9 * ImGui::GetFontSize());
  name_place(document, "export file");
  ImGui::SameLine();
  if ((ImGui::Button("write it") || entered) && !state.export_file.empty()) write(session, state);
  name_place(document, "write it");
  ImGui::SameLine();
  if (ImGui::Button("not now###no export")) state.asks_export = false;
  show_fault(session, "export");
}

}  // namespace ecorche
