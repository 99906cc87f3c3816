#include "app/studio/design/comparison_view.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "app/studio/design/fields.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

constexpr float kGrip = 7;  // pixels to either side of the line that take hold of it

// The part of the other anatomy with the name of one of ours; 0: it has none.
std::uint32_t part_like(const Anatomy& own, const Anatomy& other, std::uint32_t part) {
  const Part of = part_of(part);
  if (of.kind == Part::Kind::skin || of.kind == Part::Kind::eyes) return part;
  const std::string name = part_name(own, part);
  if (of.kind == Part::Kind::muscle) {
    const int found = find_muscle(other, name);
    return found < 0 ? 0 : kFirstMusclePart + std::uint32_t(found);
  }
  if (of.kind == Part::Kind::bone)
    for (std::size_t b = 0; b < other.bones.size(); ++b)
      if (other.bones[b].name == name) return kFirstBonePart + std::uint32_t(b);
  if (of.kind == Part::Kind::fascia)
    for (std::size_t f = 0; f < other.fascia.size(); ++f)
      if (other.fascia[f].name == name) return kFirstFasciaPart + std::uint32_t(f);
  return 0;
}

void parts_like(const Anatomy& own, const Anatomy& other, std::vector<std::uint32_t>& parts) {
  for (std::uint32_t& part : parts) part = part_like(own, other, part);
  std::erase(parts, 0u);
  std::ranges::sort(parts);
}

}  // namespace

void ComparisonView::update() {
  ComparedBody& beside = session_.beside();
  if (!beside.shown() || beside.revision() == revision_) return;
  revision_ = beside.revision();
  const ShownBody& shown = *beside.shown();
  subject_.anatomy = &shown.character().anatomy;
  subject_.model = shown.model.get();
  subject_.frames = int(shown.motion->frames.size());
  subject_.fps = shown.motion->fps;
  subject_.pose = [this](int frame, PosedAnatomy& posed, SkinFrame& skin) {
    session_.beside().pose(session_.workshop(), session_.seen(), frame, posed, skin);
  };
  ++subject_.revision;
}

FigureBeside ComparisonView::figure() const {
  const Comparison& comparison = session_.seen().trial->comparison;
  if (comparison.with.empty() || !session_.beside().shown()) return {};
  return {&subject_, comparison.wiped, float(comparison.share)};
}

void ComparisonView::dress(Appearance& appearance) const {
  const Anatomy& own = session_.anatomy();
  parts_like(own, *subject_.anatomy, appearance.hidden);
  parts_like(own, *subject_.anatomy, appearance.marked);
  if (appearance.selected != 0)
    appearance.selected = part_like(own, *subject_.anatomy, appearance.selected);
}

float ComparisonView::line(const ViewRoom& room) const {
  const Comparison& comparison = session_.seen().trial->comparison;
  return room.x + room.width * (comparison.wiped ? float(comparison.share) : 0.5f);
}

void ComparisonView::draw(const ViewRoom& room) const {
  const Comparison& comparison = session_.seen().trial->comparison;
  if (comparison.with.empty()) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float em = ImGui::GetFontSize(), top = room.y + 0.4f * em, x = line(room);
  const auto write = [&](const std::string& text, float middle) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const ImVec2 at{middle - 0.5f * size.x, top};
    list.AddRectFilled({at.x - 0.4f * em, at.y - 0.2f * em},
                       {at.x + size.x + 0.4f * em, at.y + size.y + 0.2f * em},
                       IM_COL32(25, 26, 28, 190), 0.3f * em);
    list.AddText(at, IM_COL32(240, 240, 235, 255), text.c_str());
  };
  if (!session_.beside().shown()) {
    write(session_.beside().problem().empty() ? "the other figure is being made ..."
                                              : session_.beside().problem(),
          room.x + 0.5f * room.width);
    return;
  }
  const ComparedNames names = compared_names(session_.seen());
  write(names.own, 0.5f * (room.x + x));
  write(names.other, 0.5f * (x + room.x + room.width));
  list.AddLine({x, room.y}, {x, room.y + room.height}, IM_COL32(250, 250, 245, 200), 2);
  if (is_wiped())
    list.AddCircleFilled({x, room.y + 0.5f * room.height}, kGrip, IM_COL32(250, 205, 60, 255));
}

bool ComparisonView::take(const WindowEvent& event, const ViewRoom& room) {
  using Kind = WindowEvent::Kind;
  if (!figure().subject || !is_wiped() || room.width <= 0) return false;
  const auto action = [&] {
    Compare compare;
    compare.with = session_.seen().trial->comparison.with;
    compare.how = "wiped";
    compare.share =
        std::round(1000 * std::clamp((event.x - room.x) / room.width, 0.0f, 1.0f)) / 1000;
    return compare;
  };
  if (event.kind == Kind::press && event.key == GLFW_MOUSE_BUTTON_LEFT &&
      !ImGui::GetIO().WantCaptureMouse && std::abs(event.x - line(room)) <= kGrip) {
    dragged_ = true;
    return true;
  }
  if (!dragged_) return false;
  if (event.kind == Kind::move) session_.try_out(action(), "view");
  if (event.kind == Kind::release) {
    dragged_ = false;
    session_.keep_tried("view");
  }
  return event.kind == Kind::move || event.kind == Kind::release;
}

void draw_comparison_choice(DesignSession& session, ViewDocument& document) {
  const Comparison comparison = session.seen().trial->comparison;
  const auto run = [&](const std::string& with, bool wiped) {
    session.run(fmt::format("compare {} how={} share={:.3g}", ecorche::quoted(with),
                            wiped ? "wiped" : "beside", comparison.share),
                "compare");
  };
  ImGui::SetNextItemWidth(-1);
  const std::string shown = comparison.with.empty()
                                ? std::string("compare with ...")
                                : "beside: " + compared_names(session.seen()).other;
  if (ImGui::BeginCombo("##compare", shown.c_str())) {
    const auto choose = [&](const std::string& with, const std::string& label) {
      if (ImGui::Selectable(label.c_str(), with == comparison.with)) {
        run(with, comparison.wiped);
        if (compared_skin(with)) document.look.skin = 1;  // skins are compared where they are seen
      }
      name_place(document, "compare:" + with);
    };
    choose("none", "nothing");
    for (const ComparedSkin& skin : kComparedSkins) choose(skin.name, skin.label);
    choose("saved", "as it was saved");
    choose("before", "before the last edit");
    static std::string file;
    if (text_field("##other body", file, "another body: FILE.glb, Enter",
                   14 * ImGui::GetFontSize()) &&
        !file.empty()) {
      run(file, comparison.wiped);
      ImGui::CloseCurrentPopup();
    }
    ImGui::EndCombo();
  }
  name_place(document, "compare");
  help_of_last("Another skin over the same bones, what was before an edit, or another body");
  if (!comparison.with.empty()) {
    bool wiped = comparison.wiped;
    if (ImGui::Checkbox("one over the other, wiped", &wiped)) run(comparison.with, wiped);
    name_place(document, "wiped");
    help_of_last("Drag the line in the figure");
  }
  show_fault(session, "compare");
}

}  // namespace ecorche
