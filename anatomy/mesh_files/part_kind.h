// What a part of a scan or character is, by its name and its materials' names.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// body: skin, or nothing is said. The body lies within clothes and headgear; of hair, eyes, mouth,
// props and surroundings (floor, pedestal, camera) no body can be told.
enum class PartKind { body, clothes, headgear, hair, eyes, mouth, prop, surroundings };

// Words of names in English as makers of characters use them: "CC_Base_Eye", "Hero_shirt.001".
// The part's name leads; its materials speak where it says nothing, or says no more than "body".
PartKind kind_of_part(std::string_view name, std::span<const std::string> materials);

inline bool is_covering(PartKind kind) {
  return kind == PartKind::clothes || kind == PartKind::headgear;
}

// Whether a body can be told from it.
inline bool shows_body(PartKind kind) { return kind == PartKind::body || is_covering(kind); }

// What keeps its shape whatever the body does.
inline bool is_rigid(PartKind kind) {
  return kind == PartKind::headgear || kind == PartKind::eyes || kind == PartKind::mouth ||
         kind == PartKind::prop;
}

}  // namespace ecorche::inline v1
