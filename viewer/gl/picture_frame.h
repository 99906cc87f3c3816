// What stays the same from pass to pass of one picture: matrices, light directions, and the pixels
// that a pass has to touch.
#pragma once

#include "viewer/draw_list.h"
#include "viewer/gl/gpu_mesh.h"

namespace ecorche {

struct Ball {
  Vec3f center = Vec3f::Zero();
  float radius = 1;
};

// A rectangle of pixels, lower left first.
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
};

struct PictureFrame {
  Mat4f view_projection, unproject, shadow_view_projection;
  Vec3f key, rim;                // the way the lights travel, world, unit
  Ball ball;                     // what shadows and ambient occlusion are worked out for
  float shadow_texel_world = 0;  // m
  float occlusion_reach = 0;     // m: how far ambient occlusion looks
  PixelWindow figure;            // pixels that items can reach
  PixelWindow shadow;            // pixels of the ground that their shadow can reach
  PixelWindow shaded;            // pixels that ambient occlusion can darken
};

// `meshes` have taken the list's meshes (GpuMeshes::begin). width, height: of the picture, pixels;
// shadow_size: texels a side, 0: none.
PictureFrame make_picture_frame(const DrawList& list, const GpuMeshes& meshes, int width,
                                int height, int shadow_size);

}  // namespace ecorche
