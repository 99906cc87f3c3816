// The meshes of one file, as its reader hands them over.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

using Colours = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;  // red, green, blue
using TextureCoordinates = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;

// What a file does not say is empty: normals, colours and the like have a row for each or none.
struct MeshPart {
  // of the glTF node; empty in other formats, which give one part in the order of the file's
  // vertices
  std::string name;
  TriMesh mesh;                  // a cloud of points has no faces
  Points normals{};              // #V x 3, unit length; 0 where the file has none
  Colours colours{};             // #V x 3, 0 .. 1, as they stand in the file
  TextureCoordinates texture{};  // 3 #F x 2, of each corner; v grows upwards
  Eigen::VectorXf confidence{};  // #V, as it stands in the file
  std::vector<std::string> materials{};
  std::vector<int> face_materials{};  // #F, of `materials`, -1: none; empty where there are none
};

struct MeshFile {
  std::vector<MeshPart> parts;
  std::vector<std::string> notes;  // repairs and what was not read, for people
  std::string format{};            // "obj", "ply", "stl", "off", "pcd", "glb", "gltf", "fbx", "dae"
  std::optional<double> unit{};    // m, of the coordinates, where format or file say it
  std::optional<Vec3> up{};        // likewise
};

struct MeshReadOptions {
  bool clouds = false;  // points without faces are handed over; else UnfitError
  // Skinned meshes of glTF, FBX and COLLADA stand as their joints' nodes do; else as they were
  // bound, which is placed where most joints agree on it, or taken as it stands where none do.
  bool node_pose = false;
};

}  // namespace ecorche::inline v1
