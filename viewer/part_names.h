// Parts of a character by what people call them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche {

// "femur_l", "skin", "eyes"; empty for a part that the anatomy lacks.
std::string part_name(const Anatomy& anatomy, std::uint32_t part);
// "biceps brachii, long head, left".
std::string part_label(const Anatomy& anatomy, std::uint32_t part);
// Skin, eyes, then muscles, then bones in the anatomy's order.
std::vector<std::uint32_t> all_parts(const Anatomy& anatomy);

// The parts that a name means, rising: a bone or muscle ("femur_l", without its side both), all
// that begin so ("biceps", "rectus_femoris"), a region of muscles ("thigh", "forearm_r"), a layer
// ("deep"), "muscles", "bones", "skin", "eyes". A star stands for any letters, a question mark for
// one; blanks for underscores; large letters are small ones. Empty where nothing is called so.
std::vector<std::uint32_t> parts_named(const Anatomy& anatomy, std::string_view name);
// The same for names with commas between them, together, rising. Throws UsageError that begins with
// `where` and names the nearest for a name that means nothing.
std::vector<std::uint32_t> parts_of_list(const Anatomy& anatomy, const std::string& names,
                                         const std::string& where);

// What is called most alike, of `names`; empty where nothing is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

}  // namespace ecorche
