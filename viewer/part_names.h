// Names of a character's parts, as in files, for people, and as patterns on command lines.
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
// Skin, eyes, then muscles, fascia and bones in the anatomy's order.
std::vector<std::uint32_t> all_parts(const Anatomy& anatomy);

// Parts that a name stands for, ascending: a bone or muscle ("femur_l"; without a side, both), all
// names with that beginning ("biceps", "rectus_femoris"), a sheet of fascia, a region of both
// ("thigh", "forearm_r"), a layer ("deep"), "muscles", "fascia", "bones", "skin", "eyes". `*`
// stands for any letters,
// `?` for one, blanks for underscores; case is ignored. Empty if no part has the name.
std::vector<std::uint32_t> parts_named(const Anatomy& anatomy, std::string_view name);
// The union for names separated by commas, ascending. Throws UsageError for a name that no part
// has; its message begins with `where` and suggests the most similar name.
std::vector<std::uint32_t> parts_of_list(const Anatomy& anatomy, const std::string& names,
                                         const std::string& where);

// The most similar of `names`; empty if none is similar.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

}  // namespace ecorche
