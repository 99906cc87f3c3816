// Private to the character reader: glTF `extras` as our values. skinning/files/gltf_values.h writes
// them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1::extras {

// All throw InputError "<where>: ..." for what is missing, of the wrong type or not finite.
// `value`: what `extras` holds, null where there are none.
void read_joint(const nlohmann::json& value, const std::string& where, Joint& joint);
void read_bone(const nlohmann::json& value, const std::string& where, Bone& bone);
void read_muscle(const nlohmann::json& value, const std::string& where, Muscle& muscle);
void read_fascia(const nlohmann::json& value, const std::string& where, FasciaSheet& sheet);
void read_body(const nlohmann::json& value, const std::string& where, Body& body);
int read_schema(const nlohmann::json& value, const std::string& where);

}  // namespace ecorche::inline v1::extras
