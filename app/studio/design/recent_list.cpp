#include "app/studio/design/recent_list.h"

#include <imgui.h>

#include <vector>

#include "app/edit/recent_files.h"
#include "app/studio/design/fields.h"

namespace ecorche {

void draw_recent(DesignSession& session, const std::string& kind, const std::string& action,
                 const std::string& where, ViewDocument& document) {
  ImGui::PushID(kind.c_str());
  ImGui::SetNextItemWidth(-1);
  const bool open = ImGui::BeginCombo("##recent", ("recent: " + kind + " ...").c_str());
  name_place(document, "recent " + kind);
  if (open) {
    // read while the list is open only
    const std::vector<RecentFile> all = recent_files(session.session().kept_unsaved());
    bool any = false;
    for (const RecentFile& each : all) {
      if (each.kind != kind) continue;
      any = true;
      ImGui::PushID(each.file.c_str());
      if (ImGui::Selectable(each.file.filename().c_str()))
        session.run(action + " " + ecorche::quoted(each.file.string()), where);
      name_place(document, "recent:" + each.file.filename().string());
      help_of_last(each.file.string());
      ImGui::PopID();
    }
    if (!any) quiet_text("none yet");
    ImGui::EndCombo();
  }
  ImGui::PopID();
}

}  // namespace ecorche
