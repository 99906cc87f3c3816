#include "viewer/window/panel_pixels.h"

#include <imgui.h>

#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace ecorche {
namespace {

constexpr std::uint64_t kFirst = 0xcbf29ce484222325u, kPrime = 0x100000001b3u;

// Fowler, Noll and Vo's 1a, by words of eight bytes.
std::uint64_t hashed(std::uint64_t hash, const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  for (; bytes >= 8; at += 8, bytes -= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, 8);
    hash = (hash ^ word) * kPrime;
    hash ^= hash >> 32;
  }
  for (; bytes > 0; ++at, --bytes) hash = (hash ^ std::uint64_t(*at)) * kPrime;
  return hash;
}

std::uint64_t hash_of(const ImDrawList& list, std::uint64_t hash) {
  hash = hashed(hash, list.VtxBuffer.Data, std::size_t(list.VtxBuffer.size_in_bytes()));
  hash = hashed(hash, list.IdxBuffer.Data, std::size_t(list.IdxBuffer.size_in_bytes()));
  for (const ImDrawCmd& command : list.CmdBuffer)
    hash = hashed(hash, &command.ClipRect, sizeof command.ClipRect);
  return hash;
}

// What a command covers of where it may draw.
ImVec4 box_of(const ImDrawList& list, const ImDrawCmd& command) {
  ImVec4 out(1e9f, 1e9f, -1e9f, -1e9f);
  for (unsigned k = 0; k < command.ElemCount; ++k) {
    const auto vertex = list.IdxBuffer[int(command.IdxOffset + k)] + command.VtxOffset;
    const ImVec2& at = list.VtxBuffer[int(vertex)].pos;
    out = {std::min(out.x, at.x), std::min(out.y, at.y), std::max(out.z, at.x),
           std::max(out.w, at.y)};
  }
  const ImVec4& clip = command.ClipRect;
  return {std::max(out.x, clip.x), std::max(out.y, clip.y), std::min(out.z, clip.z),
          std::min(out.w, clip.w)};
}

// The panel that a list of it, or of an area within it, belongs to.
std::string panel_name(const ImDrawList& list) {
  const std::string name = list._OwnerName ? list._OwnerName : "";
  return name.substr(0, name.find('/'));
}

}  // namespace

PanelPixels::PanelPixels(Renderer::GetProc get_proc) : gl_(load_gl(get_proc)) {}

std::map<std::string, PanelPixels::Panel> PanelPixels::panels_of(const ImDrawData& data, int width,
                                                                 int height) const {
  std::map<std::string, Panel> out;
  const ImVec2 scale = data.FramebufferScale;
  for (int k = 0; k < data.CmdListsCount; ++k) {
    const ImDrawList& list = *data.CmdLists[k];
    const std::string name = panel_name(list);
    const auto [at, fresh] = out.try_emplace(name);
    Panel& panel = at->second;
    panel.lists.push_back(k);
    panel.hash = hash_of(list, fresh ? kFirst : panel.hash);
    panel.passing = name.empty() || name.starts_with("##");
    if (fresh) panel.box = {width, height, 0, 0};
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const ImVec4 seen = box_of(list, command);
      if (seen.x >= seen.z || seen.y >= seen.w) continue;
      panel.box.x0 = std::min(panel.box.x0, int(std::floor(seen.x * scale.x)));
      panel.box.y0 = std::min(panel.box.y0, int(std::floor(seen.y * scale.y)));
      panel.box.x1 = std::max(panel.box.x1, int(std::ceil(seen.z * scale.x)));
      panel.box.y1 = std::max(panel.box.y1, int(std::ceil(seen.w * scale.y)));
    }
    PixelBox& box = panel.box;
    box.x0 = std::max(box.x0, 0), box.y0 = std::max(box.y0, 0);
    box.x1 = std::min(box.x1, width), box.y1 = std::min(box.y1, height);
  }
  return out;
}

void PanelPixels::draw(ImDrawData& data, int width, int height) {
  if (store_.width() != width || store_.height() != height) {
    store_.resize(width, height);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
    kept_.clear();
  }
  const std::string over = panel_name(*ImGui::GetBackgroundDrawList());
  std::map<std::string, Panel> panels = panels_of(data, width, height);
  for (auto& [name, panel] : panels) {
    if (name == over) continue;
    for (const auto& [other_name, other] : panels) {
      const PixelBox &a = panel.box, &b = other.box;
      if (other_name != name && other_name != over && a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 &&
          b.y0 < a.y1)
        panel.passing = true;
    }
  }

  std::vector<ImDrawList*> behind, anew;
  std::vector<const PixelBox*> copied, to_store;
  for (int k = 0; k < data.CmdListsCount; ++k) {
    ImDrawList* const list = data.CmdLists[k];
    const std::string name = panel_name(*list);
    const Panel& panel = panels.at(name);
    if (name == over) {
      behind.push_back(list);
      continue;
    }
    Kept& kept = kept_[name];
    const bool same = !panel.passing && kept.hash == panel.hash;
    if (!(same && kept.stored)) anew.push_back(list);
    if (k != panel.lists.back()) continue;  // once a panel
    if (same && kept.stored) {
      copied.push_back(&panel.box);
      continue;
    }
    if (same) to_store.push_back(&panel.box);
    kept = {panel.hash, same};
  }

  const auto draw_lists = [&](std::vector<ImDrawList*>& lists) {
    if (lists.empty()) return;
    const std::pair all(data.CmdLists, data.CmdListsCount);
    data.CmdLists = lists.data();
    data.CmdListsCount = int(lists.size());
    ImGui_ImplOpenGL3_RenderDrawData(&data);
    data.CmdLists = all.first;
    data.CmdListsCount = all.second;
  };
  draw_lists(behind);
  for (const PixelBox* box : copied) put_pixels(gl_, *box, store_);
  draw_lists(anew);
  for (const PixelBox* box : to_store) keep_pixels(gl_, *box, store_);
}

}  // namespace ecorche
