// Private to the writers of characters: our values as glTF `extras`. skinning/files/extras_read.h
// reads them.
#pragma once

#include <tiny_gltf.h>

#include <string>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1::gltf {

using Object = tinygltf::Value::Object;
using Array = tinygltf::Value::Array;

tinygltf::Value number(double value);
tinygltf::Value text(const std::string& value);
tinygltf::Value vector3(const Vec3& v);

tinygltf::Value joint_extras(const Joint& joint);
tinygltf::Value bone_extras(const Bone& bone);
tinygltf::Value muscle_extras(
    const Muscle& muscle,
    tinygltf::Value strips);  // `strips`: what stands for strips_text (GlbBuilder::keep_text)
tinygltf::Value fascia_extras(const FasciaSheet& sheet);
std::string strips_text(const Muscle& muscle);  // JSON
tinygltf::Value body_extras(const Body& body);

}  // namespace ecorche::inline v1::gltf
