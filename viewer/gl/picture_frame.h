// Constants of all passes of one picture: matrices, light directions, and rectangles of pixels that
// passes are limited to.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "viewer/draw_list.h"
#include "viewer/gl/gpu_mesh.h"

namespace ecorche {

struct Ball {
  glm::vec3 center{0};
  float radius = 1;
};

// A rectangle of pixels, lower left first.
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
};

struct PictureFrame {
  glm::mat4 view_projection{1}, unproject{1};  // world -> clip, and back
  glm::mat4 shadow_view_projection{1};         // world -> clip, seen from the key light
  glm::vec3 key{0}, rim{0};                    // directions in which the lights travel, world, unit
  Ball ball;                     // the part of the world that has shadows and ambient occlusion
  float shadow_texel_world = 0;  // m
  float occlusion_reach = 0;     // m, reach of ambient occlusion
  PixelWindow figure;            // pixels that items can reach
  PixelWindow shadow;            // pixels of the ground that their shadow can reach
  // what the list's cut leaves, n . x + w >= 0; all where there is no cut
  glm::vec4 kept{0, 0, 0, 1};
  PixelWindow shaded;  // pixels that ambient occlusion can darken
};

// Precondition: GpuMeshes::begin(list). width, height: of the picture, pixels; shadow_size: texels
// a side of the shadow map, 0: none.
PictureFrame make_picture_frame(const DrawList& list, const GpuMeshes& meshes, int width,
                                int height, int shadow_size);

}  // namespace ecorche
