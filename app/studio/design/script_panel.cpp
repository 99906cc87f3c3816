#include "app/studio/design/script_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/studio/design/export_panel.h"
#include "app/studio/design/fields.h"

namespace ecorche {
namespace {

constexpr ImGuiWindowFlags kBar = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                  ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoTitleBar |
                                  ImGuiWindowFlags_AlwaysAutoResize;

// Under a name that is free, in the folder that the program was started in.
void save_script(DesignSession& session) {
  for (int number = 1; number < 10000; ++number) {
    const std::filesystem::path file = fmt::format("studio-{:04}.txt", number);
    if (std::filesystem::exists(file)) continue;
    try {
      write_file_atomically(file, script_of(session.session().history()));
      session.say(fmt::format("script: {}", std::filesystem::absolute(file).string()));
    } catch (const std::exception& error) {
      session.say(error.what());
    }
    return;
  }
}

void draw_fit_state(DesignSession& session, ViewDocument& document) {
  BackgroundFit& fit = session.fit();
  if (const std::string problem = fit.problem(); !problem.empty()) {
    fault_text("no body for this yet: " + problem);
    return;
  }
  if (fit.is_cancelled()) {
    quiet_text("the body is as it was fitted before");
    ImGui::SameLine();
    if (ImGui::SmallButton("fit now")) fit.ask(session.to_fit(), true);
    name_place(document, "fit now");
    return;
  }
  if (!fit.busy()) return;
  const std::string stage = fit.stage();
  ImGui::ProgressBar(float(fit.share()), {6 * ImGui::GetFontSize(), 0}, "");
  ImGui::SameLine();
  if (ImGui::Button("cancel")) fit.cancel();
  name_place(document, "cancel");
  help_of_last("Keep the body that is shown; the muscles that were changed stay as a sketch");
  ImGui::SameLine();
  ImGui::TextUnformatted(stage.empty() ? "waiting ..." : stage.c_str());
}

void draw_folder(DesignSession& session, PanelState& state, ViewDocument& document) {
  if (!state.asks_folder) return;
  ImGui::TextUnformatted("Save the project as a folder:");
  const bool entered = text_field("##folder", state.folder, "my-arm", 9 * ImGui::GetFontSize());
  name_place(document, "folder");
  ImGui::SameLine();
  if ((ImGui::Button("save here") || entered) && !state.folder.empty() &&
      session.run("save " + ecorche::quoted(state.folder), "save")) {
    state.asks_folder = false;
    state.closes = state.asks_to_close;
  }
  ImGui::SameLine();
  if (ImGui::Button("not now")) state.asks_folder = state.asks_to_close = false;
}

// An area is done when the person says so: more strokes may follow.
void draw_asked_area(DesignSession& session, PanelState& state, ViewDocument& document) {
  BoneClick& click = *state.bone_click;
  ImGui::TextWrapped("%s",
                     fmt::format("Paint the {} on the bone: hold the button and move over it.",
                                 click.paints_origin ? "origin" : "insertion")
                         .c_str());
  if (!click.painted.empty()) {
    const bool done = ImGui::Button("done###area done");
    name_place(document, "area done");
    ImGui::SameLine();
    if (ImGui::Button("again###area again")) click.painted.clear();
    ImGui::SameLine();
    if (done && session.run(line_of_area(click, session.session().document()), "bar")) {
      state.bone_click.reset();
      return;
    }
  }
  if (ImGui::Button("leave it###no click")) state.bone_click.reset();
  name_place(document, "no click");
}

void draw_asked_click(DesignSession& session, PanelState& state, ViewDocument& document) {
  using For = BoneClick::For;
  if (state.bone_click->what == For::area) {
    draw_asked_area(session, state, document);
    return;
  }
  const For what = state.bone_click->what;
  ImGui::TextWrapped(
      "%s", what == For::origin      ? "A new muscle: click on a bone where it begins (its origin)."
            : what == For::insertion ? "Now click on a bone where it ends (its insertion)."
                                     : "Click on a bone where the point is to lie.");
  if (ImGui::Button("leave it###no click")) state.bone_click.reset();
  name_place(document, "no click");
  help_of_last("Escape");
}

void draw_closing(DesignSession& session, PanelState& state, ViewDocument& document) {
  if (!state.asks_to_close || state.asks_folder) return;
  ImGui::TextUnformatted("There are changes that are not saved.");
  if (ImGui::Button("save and close")) {
    save_or_ask(session, state);
    state.closes = !state.asks_folder && !session.session().unsaved();
  }
  ImGui::SameLine();
  if (ImGui::Button("close without")) state.closes = true;
  name_place(document, "close without");
  ImGui::SameLine();
  if (ImGui::Button("stay")) state.asks_to_close = false;
  name_place(document, "stay");
}

// Until this session has actions of its own, which it would take the place of.
void draw_left_sessions(DesignSession& session, PanelState& state, ViewDocument& document) {
  if (state.left.empty() || session.session().has_project() || session.session().unsaved()) return;
  const UnsavedSession& first = state.left.front();
  ImGui::TextWrapped("A session ended before it was saved (%s).",
                     unsaved_session_text(first).c_str());
  const bool taken = ImGui::Button("go on with it");
  name_place(document, "go on with it");
  ImGui::SameLine();
  const bool forgotten = ImGui::Button("forget it");
  name_place(document, "forget it");
  ImGui::SameLine();
  const bool later = ImGui::Button("not now###no session");
  if (!taken && !forgotten && !later) return;
  const std::filesystem::path folder = first.folder;
  state.left.erase(state.left.begin());
  if (taken) session.take_up(folder);
  if (forgotten) forget_unsaved_session(folder);
}

// Where nothing has been done yet.
void draw_recent_projects(DesignSession& session, PanelState& state, ViewDocument& document) {
  const Session& now = session.session();
  if (state.projects.empty() || now.has_project() || now.unsaved() ||
      now.history().steps.size() > 1)
    return;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Go on with");
  std::optional<std::filesystem::path> taken;
  for (const std::filesystem::path& project : state.projects) {
    const std::string name = project.filename().string();
    ImGui::SameLine();
    ImGui::PushID(project.c_str());
    if (ImGui::Button(name.c_str())) taken = project;
    name_place(document, "project:" + name);
    help_of_last(project.string());
    ImGui::PopID();
  }
  if (taken) session.take_up_project(*taken);
}

bool has_word(const ActionKind& kind, const std::string& typed) {
  const std::string word = typed.substr(0, typed.find(' '));
  const std::string all = fmt::format("{} {} {}", kind.name, kind.group, kind.help);
  return word == kind.name ||
         (typed.find(' ') == std::string::npos && all.find(word) != std::string::npos);
}

void draw_kind(const ActionKind& kind, PanelState& state, bool alone) {
  if (ImGui::Selectable(kind.name)) {
    state.typed = std::string(kind.name) + " ";
    state.actions_begin = true;
  }
  ImGui::SameLine(9.5f * ImGui::GetFontSize());
  ImGui::TextUnformatted(kind.help);
  if (*kind.example) {
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 9.5f * ImGui::GetFontSize());
    quiet_text(fmt::format("{} {}", kind.name, kind.example));
  }
  if (!alone) return;
  for (const ArgumentInfo& each : arguments_of(kind)) {
    std::string kinds = each.kind;
    for (std::size_t k = 0; k < each.words.size(); ++k)
      kinds = (k ? kinds + "|" : "") + each.words[k];
    if (each.unit != ArgumentUnit::none) kinds += std::string(" ") + unit_name(each.unit);
    ImGui::BulletText("%s", fmt::format("{} ({}{}): {}", each.key, kinds,
                                        each.required ? "" : ", optional", each.help)
                                .c_str());
  }
}

}  // namespace

std::string script_of(const History& history) {
  std::string out;
  for (std::size_t k = 1; k <= history.now; ++k) out += history.steps[k].line + "\n";
  return out;
}

void save_or_ask(DesignSession& session, PanelState& state) {
  if (session.session().has_project())
    session.run("save", "save");
  else
    state.asks_folder = true;
}

void draw_script_panel(DesignSession& session, ViewDocument& document) {
  quiet_text("Every change is a line of a script. Click one to go back to it.");
  const History& history = session.session().history();
  if (ImGui::Button("copy")) {
    ImGui::SetClipboardText(script_of(history).c_str());
    session.say("the script is on the clipboard");
  }
  ImGui::SameLine();
  if (ImGui::Button("save as script")) save_script(session);
  name_place(document, "save script");
  help_of_last("For ecorche studio --script, into the folder in which the program was started");
  ImGui::BeginChild("lines");
  const int now = int(history.now), all = int(history.steps.size());
  int wanted = now;
  for (int k = 0; k < all; ++k) {
    const std::string line = k == 0 ? "as it was opened" : history.steps[std::size_t(k)].line;
    ImGui::PushID(k);
    if (k > now)
      ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    if (ImGui::Selectable(line.c_str(), k == now)) wanted = k;
    if (k > now) ImGui::PopStyleColor();
    help_of_last(line);
    ImGui::PopID();
  }
  static std::size_t seen = 0;
  if (seen != history.steps.size()) ImGui::SetScrollHereY(1);
  seen = history.steps.size();
  ImGui::EndChild();
  if (wanted < now) session.run(fmt::format("undo {}", now - wanted), "script");
  if (wanted > now) session.run(fmt::format("redo {}", wanted - now), "script");
}

float draw_top_bar(DesignSession& session, PanelState& state, ViewDocument& document,
                   const BarPlace& place) {
  ImGui::SetNextWindowPos({place.left, place.top}, ImGuiCond_Always);
  ImGui::SetNextWindowSizeConstraints({place.width, 0}, {place.width, 1000});
  float bottom = place.top;
  if (ImGui::Begin("bar", nullptr, kBar)) {
    const History& history = session.session().history();
    if (ImGui::Button("undo") && history.now > 0) session.run("undo", "bar");
    name_place(document, "undo");
    help_of_last("Ctrl + Z");
    ImGui::SameLine();
    if (ImGui::Button("redo") && history.now + 1 < history.steps.size()) session.run("redo", "bar");
    help_of_last("Ctrl + Shift + Z");
    ImGui::SameLine();
    if (ImGui::Button(session.session().unsaved() ? "save *###save" : "save###save"))
      save_or_ask(session, state);
    name_place(document, "save");
    help_of_last("Ctrl + S; the star says that there are changes");
    ImGui::SameLine();
    if (ImGui::Button("export")) state.asks_export = !state.asks_export;
    name_place(document, "export");
    help_of_last(
        "Characters, models, pictures, films and tables into files; F12: a picture of this view");
    ImGui::SameLine();
    if (ImGui::Button("actions")) state.actions = state.actions_begin = !state.actions;
    name_place(document, "actions");
    help_of_last("Ctrl + P: find and run any action");
    ImGui::SameLine();
    if (ImGui::Button("keys")) document.help = !document.help;
    name_place(document, "keys");
    help_of_last("F1");
    ImGui::SameLine();
    if (ImGui::Button("tour")) state.asks_tour = true;
    name_place(document, "tour");
    help_of_last("The first steps, shown where they are done");
    draw_left_sessions(session, state, document);
    draw_recent_projects(session, state, document);
    if (!session.session().no_journal().empty()) fault_text(session.session().no_journal());
    if (session.shows_saved()) ImGui::TextUnformatted("as it was saved; C: as it is");
    if (state.bone_click) draw_asked_click(session, state, document);
    draw_folder(session, state, document);
    draw_export(session, state, document);
    draw_closing(session, state, document);
    draw_fit_state(session, document);
    show_unseen_fault(session);
    const std::string& tried = session.tried_line();
    if (!tried.empty()) ImGui::TextWrapped("%s", tried.c_str());
    for (const std::string& text : {session.message(), document.message})
      if (tried.empty() && !text.empty()) quiet_text(text);
    bottom = ImGui::GetWindowPos().y + ImGui::GetWindowHeight();
  }
  ImGui::End();
  return bottom;
}

void draw_actions_box(DesignSession& session, PanelState& state, ViewDocument& document,
                      const BarPlace& place) {
  if (!state.actions) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({place.left, place.top + 0.4f * ImGui::GetFontSize()}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({place.width, std::min(0.6f * size.y, 26 * ImGui::GetFontSize())},
                           ImGuiCond_Always);
  bool open = true;
  if (ImGui::Begin("Actions", &open,
                   ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                       ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
    if (text_field("##typed", state.typed, "search, or type a line as in a script and press Enter",
                   -1, state.actions_begin) &&
        !state.typed.empty()) {
      if (session.run(state.typed, "actions")) state.typed.clear();
      state.actions_begin = true;
    } else {
      state.actions_begin = false;
    }
    name_place(document, "action line");
    show_fault(session, "actions");
    ImGui::BeginChild("kinds");
    std::vector<const ActionKind*> found;
    for (const ActionKind& kind : action_kinds())
      if (has_word(kind, state.typed)) found.push_back(&kind);
    for (const ActionKind* kind : found) draw_kind(*kind, state, found.size() == 1);
    if (found.empty()) quiet_text("no action has this word");
    ImGui::EndChild();
  }
  ImGui::End();
  if (!open) state.actions = false;
}

}  // namespace ecorche
