// Private to the character reader and writer: conversions between our values and glTF `extras`.
#pragma once

#include <tiny_gltf.h>

#include <string>

#include "anatomy/anatomy.h"

namespace ecorche::gltf {

using Object = tinygltf::Value::Object;
using Array = tinygltf::Value::Array;

tinygltf::Value number(double value);
tinygltf::Value text(const std::string& value);
tinygltf::Value vector3(const Vec3& v);

tinygltf::Value joint_extras(const Joint& joint);
tinygltf::Value bone_extras(const Bone& bone);
tinygltf::Value muscle_extras(const Muscle& muscle, tinygltf::Value strips);  // `strips`: what stands for strips_text (GlbBuilder::keep_text)
std::string strips_text(const Muscle& muscle);  // JSON
tinygltf::Value body_extras(const Body& body);

// The readers throw InputError "<where>: ..." for what is missing, of the wrong type or not finite.
void read_joint_extras(const tinygltf::Value& value, const std::string& where, Joint& joint);
void read_bone_extras(const tinygltf::Value& value, const std::string& where, Bone& bone);
void read_muscle_extras(const tinygltf::Value& value, const std::string& where, Muscle& muscle);
void read_body_extras(const tinygltf::Value& value, const std::string& where, Body& body);
int read_schema(const tinygltf::Value& value, const std::string& where);

}  // namespace ecorche::gltf
