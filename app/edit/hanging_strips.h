// Which muscles hang on bones that are to go.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "app/edit/document/workshop.h"

namespace ecorche {

// Names without side of the bones that built-in joints carry; `joints` are without side, too.
std::set<std::string> bones_of(Workshop& workshop, const std::vector<std::string>& joints);

// Muscles of which a strip has a point on a bone, or slides over a wrap that rides on one.
struct HangingStrips {
  std::vector<std::string> muscles;  // names
  std::string words() const;         // the first few
};
// `bones` without side; `side`: middle means both.
HangingStrips hanging_on(const Document& document, const std::set<std::string>& bones, Side side);

// Strips that have a point on these bones are taken away, and muscles that have no other. Throws
// InputError for a muscle that would be left on one side alone.
Document without_strips_on(Document document, const std::set<std::string>& bones, Side side);

}  // namespace ecorche
