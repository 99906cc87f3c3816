#include "app/edit/comparison.h"

#include <algorithm>
#include <filesystem>

#include "app/edit/refit.h"

namespace ecorche {
namespace {

// The newest of the documents before that makes another body.
std::optional<Document> before_edit(const History& history) {
  for (std::size_t k = history.now; k-- > 0;)
    if (!fits_alike(history.steps[k].document, document_now(history)))
      return history.steps[k].document;
  return std::nullopt;
}

}  // namespace

const ComparedSkin* compared_skin(std::string_view name) {
  const auto found = std::ranges::find_if(
      kComparedSkins, [&](const ComparedSkin& skin) { return skin.name == name; });
  return found == kComparedSkins.end() ? nullptr : &*found;
}

bool names_file(std::string_view with) {
  return !with.empty() && with != "none" && with != "saved" && with != "before" &&
         !compared_skin(with);
}

std::optional<Document> compared_document(const History& history, const Document& saved) {
  const Document& now = document_now(history);
  const std::string& with = now.trial->comparison.with;
  if (with.empty() || compared_skin(with)) return std::nullopt;
  std::optional<Document> out;
  if (with == "saved") {
    out = saved;
  } else if (with == "before") {
    out = before_edit(history);
  } else {
    out = with_part(now, &Document::body, [&](EditedBody& body) {
      body.file = with;
      body.targets.clear();
    });
  }
  if (out) out->trial = now.trial;
  return out;
}

ComparedNames compared_names(const Document& document) {
  const std::string& with = document.trial->comparison.with;
  if (const ComparedSkin* skin = compared_skin(with)) return {"ours", skin->label};
  if (with == "saved") return {"now", "as it was saved"};
  if (with == "before") return {"now", "before the last edit"};
  const std::filesystem::path& own = document.body->file;
  return {own.empty() ? "the template's body" : own.stem().string(),
          std::filesystem::path(with).stem().string()};
}

}  // namespace ecorche
