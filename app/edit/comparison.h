// What a document is compared with: another way to move its skin, itself before, or another body.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "app/edit/document/history.h"

namespace ecorche {

// A skin of `compare`, by what choose_skin() calls it, and for people.
struct ComparedSkin {
  const char *name, *method, *label;
};
inline constexpr std::array kComparedSkins{
    ComparedSkin{"linear_blend", "lbs", "linear blend"},
    ComparedSkin{"dual_quaternion", "dqs", "dual quaternions"},
    ComparedSkin{"delta_mush", "deltamush", "delta mush"},
    ComparedSkin{"paper", "paper", "the template paper's skin"}};
const ComparedSkin* compared_skin(std::string_view name);  // null: none of them
// Whether what a document is compared with is a body of a file.
bool names_file(std::string_view with);

// The other document of a comparison, in the trial of now; nothing where there is none, where it is
// another skin of the same body, or where nothing was edited before.
std::optional<Document> compared_document(const History& history, const Document& saved);

// Names of the two for people: "now", "as it was saved".
struct ComparedNames {
  std::string own, other;
};
ComparedNames compared_names(const Document& document);

}  // namespace ecorche
