// What a part of a character is, by its name and its materials' names.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// body: skin, or nothing is said; covering: clothes and shoes, the body lies within; other: hair,
// eyes, teeth and props, of which no body can be told.
enum class PartKind { body, covering, other };

// Words of names in English as makers of characters use them: "CC_Base_Eye", "Hero_shirt.001".
// The part's name leads; its materials speak where it says nothing.
PartKind kind_of_part(std::string_view name, std::span<const std::string> materials);

}  // namespace ecorche::inline v1
